//! The second opinion: what urdf-rs, a parser that consumers use, makes of the same text.
//!
//! Owns the guards around it: it is written for friendly input.

use std::panic::{AssertUnwindSafe, catch_unwind};

use crate::world::robot::{ConsumerJoint, ConsumerOpinion};

use super::known;
use super::repair::Repaired;
use super::xml::Element;

/// Nesting at which urdf-rs is no longer asked: it recurses, and its stack is not ours to size.
const DEEPEST: usize = 100;

/// Size at which it is no longer asked, bytes: it holds the text as a tree three times over.
const LARGEST: usize = 20_000_000;

/// Asks urdf-rs. The text is the repaired one, without looks and without what urdfdom ignores: neither habits of XML
/// nor foreign elements are held against the file. `root` is the root element of the same text, not wrapped.
pub(super) fn ask(repaired: &Repaired, root: &Element<'_>) -> ConsumerOpinion {
    if repaired.depth >= DEEPEST {
        return ConsumerOpinion::NotAsked(format!("elements are nested {} deep", repaired.depth));
    }
    if repaired.text.len() > LARGEST {
        return ConsumerOpinion::NotAsked(format!("the text has {} bytes", repaired.text.len()));
    }
    let text = without_foreign(&repaired.text, root);
    match catch_unwind(AssertUnwindSafe(|| urdf_rs::read_from_string(&text))) {
        Ok(Ok(robot)) => ConsumerOpinion::Loads(joints(&robot)),
        Ok(Err(error)) => ConsumerOpinion::Refuses(one_line(&error.to_string())),
        Err(_) => ConsumerOpinion::Refuses("the parser panicked".to_owned()),
    }
}

/// The text with blanks where elements stand that say nothing about frames or that consumers ignore: urdf-rs refuses
/// files for a material written twice, or for an `<origin>` inside of a `<geometry>`; urdfdom does not.
fn without_foreign(text: &str, root: &Element<'_>) -> String {
    let mut bytes = text.as_bytes().to_vec();
    for element in root.descendants() {
        let Some(parent) = element.parent() else { continue };
        let name = element.name();
        let stays = match parent.name() {
            // A shape that urdf-rs does not know is worth its words.
            "geometry" => !matches!(name, "origin" | "material"),
            parent => known::reads(parent, name) && name != "material",
        };
        if stays {
            continue;
        }
        if let Some(span) = element.place().span() {
            bytes
                .get_mut(span.start..span.end)
                .into_iter()
                .flatten()
                .for_each(|byte| *byte = b' ');
        }
    }
    String::from_utf8(bytes).unwrap_or_else(|_| text.to_owned())
}

fn joints(robot: &urdf_rs::Robot) -> Vec<ConsumerJoint> {
    let mut joints: Vec<ConsumerJoint> = robot
        .joints
        .iter()
        .map(|joint| ConsumerJoint {
            name: joint.name.clone(),
            parent: joint.parent.link.clone(),
            child: joint.child.link.clone(),
            xyz: *joint.origin.xyz,
            rpy: *joint.origin.rpy,
        })
        .collect();
    joints.sort_by(|a, b| (&a.name, &a.parent, &a.child).cmp(&(&b.name, &b.parent, &b.child)));
    joints
}

/// An error text of bounded length on one line.
fn one_line(text: &str) -> String {
    let words: Vec<&str> = text.split_whitespace().collect();
    words.join(" ").chars().take(300).collect()
}
