//! The second opinion: how urdf-rs, a parser that consumers use, reads the same text.
//!
//! Owns the guards around it: it is written for trusted input.

use std::panic::{AssertUnwindSafe, catch_unwind};

use crate::world::robot::{ConsumerJoint, ConsumerOpinion};

use super::known;
use super::plain;
use super::xml::Element;

/// Nesting beyond which urdf-rs is not run: it recurses, and the size of its stack cannot be set here.
const DEEPEST: usize = 100;

/// Size beyond which it is not run, bytes: it briefly takes thirty times the text. The largest known robots have a tenth of it.
const LARGEST: usize = 2_000_000;

/// Parses the robot with urdf-rs, without visuals and without what urdfdom ignores: neither the style of the XML nor foreign
/// elements count as faults.
pub(super) fn ask(root: &Element<'_>) -> ConsumerOpinion {
    let (text, depth) = without_foreign(root);
    if depth >= DEEPEST {
        return ConsumerOpinion::NotAsked(format!("elements are nested {depth} deep"));
    }
    if text.len() > LARGEST {
        return ConsumerOpinion::NotAsked(format!("the description has {} bytes", text.len()));
    }
    match catch_unwind(AssertUnwindSafe(|| urdf_rs::read_from_string(&text))) {
        Ok(Ok(robot)) => ConsumerOpinion::Loads(joints(&robot)),
        Ok(Err(error)) => ConsumerOpinion::Refuses(words(&error.to_string())),
        Err(_) => ConsumerOpinion::Refuses("the parser panicked".to_owned()),
    }
}

/// Its message, in one line. It gets the attributes of one element in random order, and may count either of two faulty ones:
/// the count is removed.
fn words(error: &str) -> String {
    let line = one_line(error);
    match line.split_once(", expected ") {
        Some((what, _)) if what.ends_with("element count") => what.to_owned(),
        _ => line,
    }
}

/// The elements that a consumer reads and that are not plain, without the whitespace between them: urdf-rs refuses files
/// for a material written twice, or for an `<origin>` inside of a `<geometry>`, urdfdom does not; and it reads each
/// character three times. With the deepest nesting of the text.
fn without_foreign(root: &Element<'_>) -> (String, usize) {
    enum Step<'a> {
        Open(Element<'a>),
        Close(&'a str),
    }
    let mut out = String::new();
    let (mut depth, mut deepest) = (0_usize, 0);
    let mut stack = vec![Step::Open(*root)];
    while let Some(step) = stack.pop() {
        match step {
            Step::Close(name) => {
                depth = depth.saturating_sub(1);
                out.push_str("</");
                out.push_str(name);
                out.push('>');
            }
            Step::Open(element) => {
                let first = stack.len();
                stack.push(Step::Close(element.repaired_name()));
                stack.extend(
                    element
                        .children()
                        .filter(|child| stays(&element, child))
                        .map(Step::Open),
                );
                deepest = deepest.max(depth + 1);
                element.write_start(&mut out);
                if stack.len() == first + 1 {
                    stack.truncate(first);
                    out.push_str("/>");
                } else {
                    depth += 1;
                    out.push('>');
                    // The first child is opened next, the end tag comes last.
                    if let Some(inside) = stack.get_mut(first + 1..) {
                        inside.reverse();
                    }
                }
            }
        }
    }
    (out, deepest)
}

fn stays(parent: &Element<'_>, child: &Element<'_>) -> bool {
    let name = child.name();
    match parent.name() {
        // urdf-rs reads links, joints and materials, and does not check whether the links of a joint exist.
        "robot" => name == "joint" || (name == "link" && !plain::is_plain_link(child)),
        "link" if plain::is_plain(child) => false,
        "joint" if plain::is_plain_in_joint(child) => false,
        // urdf-rs reports a shape that it does not know.
        "geometry" => !matches!(name, "origin" | "material"),
        parent => known::reads(parent, name) && name != "material",
    }
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_counted_by_chance_is_not_told() {
        let error = "custom: Wrong vector element count, expected 3 found 2 for [$(optenv XYZ 0 0)]";
        assert_eq!(words(error), "custom: Wrong vector element count");
        assert_eq!(words("missing field, expected 3"), "missing field, expected 3");
    }
}
