//! The frame tree of a run with the sources of transforms: text, Graphviz, Mermaid and SVG.
//!
//! Owns the words that the drawings share. Does not judge: the mark on sources that differ is only a visual aid.

pub mod chain;
pub mod dot;
mod layout;
mod links;
pub mod mermaid;
pub mod moment;
mod origin;
mod sketch;
pub mod svg;
#[cfg(test)]
mod tests;
pub mod text;

use std::collections::{BTreeMap, BTreeSet};
use std::fmt::Write;

use nalgebra::Isometry3;

use crate::run::Run;
use crate::source::{Place, SourceId, SourcePart};
use crate::world::{ClaimKind, FrameId, World};

use super::place::Locator;
use super::text::{one_line, trimmed};
use links::{Link, Links};

/// Short names of the sources of one world: paths without their common folder, which is shown once.
struct Names<'a> {
    locator: &'a Locator<'a>,
    /// The common folder with its last slash; empty if there is none.
    folder: String,
}

impl<'a> Names<'a> {
    fn new(world: &World, locator: &'a Locator<'a>) -> Self {
        let mut paths = world.members.iter().map(|id| locator.whole_path(*id));
        let mut folder = paths.next().unwrap_or_default();
        folder = folder
            .rfind('/')
            .and_then(|slash| folder.get(..=slash))
            .unwrap_or_default();
        for path in paths {
            while !path.starts_with(folder) {
                let parent = folder.trim_end_matches('/').rfind('/');
                folder = parent.and_then(|slash| folder.get(..=slash)).unwrap_or_default();
            }
        }
        Self {
            locator,
            folder: folder.to_owned(),
        }
    }

    fn short<'b>(&self, path: &'b str) -> &'b str {
        path.strip_prefix(self.folder.as_str()).unwrap_or(path)
    }

    /// `drive.mcap`, `robot.xacro (expanded)`.
    fn name(&self, id: SourceId) -> String {
        self.short(&self.locator.name(id)).to_owned()
    }

    /// `robot.urdf:12`.
    fn line(&self, place: &Place) -> String {
        let place = &*self.locator.written(place);
        let name = self.name(place.source);
        match self.locator.find(place).start {
            Some(at) => format!("{name}:{}", at.line),
            None => name,
        }
    }
}

/// `xyz 0.3 0 1.2 m, rpy 0 0 90 deg`, or `identity`. Fixed-axis roll, pitch, yaw: `R = Rz(yaw) Ry(pitch) Rx(roll)`.
fn pose_words(parent_from_child: &Isometry3<f64>) -> String {
    let t = parent_from_child.translation.vector;
    let (roll, pitch, yaw) = parent_from_child.rotation.euler_angles();
    let spell =
        |values: [f64; 3], decimals: usize| values.map(|value| trimmed(&format!("{value:.decimals$}"))).join(" ");
    let xyz = spell([t.x, t.y, t.z], 3);
    let rpy = spell([roll.to_degrees(), pitch.to_degrees(), yaw.to_degrees()], 2);
    if xyz == "0 0 0" && rpy == "0 0 0" {
        return "identity".to_owned();
    }
    format!("xyz {xyz} m, rpy {rpy} deg")
}

/// Frames that are named somewhere but are not in a tree, each with its places: first those of messages, then those of files.
/// Frames of a calibration that is shown itself are omitted.
fn outsiders<'a>(world: &'a World, names: &Names) -> [BTreeMap<&'a str, Vec<String>>; 2] {
    let mut found = [BTreeMap::new(), BTreeMap::new()];
    let frames: &BTreeSet<FrameId> = &world.whole().frames;
    let calibrated: BTreeSet<&FrameId> = world
        .claims
        .iter()
        .filter(|claim| matches!(claim.kind, ClaimKind::File { .. }))
        .flat_map(|claim| claim.target().into_iter().chain(claim.source_frame()))
        .collect();
    let [messages, files] = &mut found;
    for used in &world.frames {
        if used.role.in_tree() || frames.contains(&used.frame.canonical()) {
            continue;
        }
        let (list, place): (&mut BTreeMap<&str, Vec<String>>, String) = match &used.place.at {
            SourcePart::Message(message) => (
                &mut *messages,
                format!("{} {}", names.name(used.place.source), message.topic),
            ),
            _ if calibrated.contains(&used.frame) => continue,
            _ => (&mut *files, names.line(&used.place)),
        };
        list.entry(used.frame.as_str())
            .or_default()
            .push(one_line(&format!("{place} ({})", used.role.words())));
    }
    for places in found.iter_mut().flat_map(BTreeMap::values_mut) {
        places.sort();
        places.dedup();
    }
    found
}

/// The title of a world: its robots, or its first sources, and their folder.
fn title(world: &World, names: &Names) -> String {
    let robots: BTreeSet<&str> = world
        .robots
        .iter()
        .map(|robot| names.locator.whole_path(robot.source))
        .collect();
    let paths = if robots.is_empty() {
        world.members.iter().map(|id| names.locator.whole_path(*id)).collect()
    } else {
        robots
    };
    let more = paths.len().saturating_sub(3);
    let first: Vec<&str> = paths.into_iter().take(3).map(|path| names.short(path)).collect();
    let mut title = first.join(", ");
    if more > 0 {
        let _ = write!(title, " and {more} more");
    }
    // The folder of all platforms is shown at the end.
    if !names.folder.is_empty() && names.folder != names.locator.folder() {
        let _ = write!(title, " in {}", names.folder);
    }
    one_line(&title)
}

/// The sources of an edge, a line for each; `mark` precedes those that differ.
fn label(link: &Link, mark: &str) -> String {
    let lines: Vec<String> = link
        .statements
        .iter()
        .map(|statement| match &statement.differs {
            Some(differs) => format!("{mark}{} ({differs})", statement.who),
            None => statement.who.clone(),
        })
        .collect();
    lines.join("\n")
}

/// Worlds with frames.
fn worlds(run: &Run) -> impl Iterator<Item = &World> {
    run.worlds
        .iter()
        .filter(|world| !world.whole().frames.is_empty() || !world.frames.is_empty() || !world.claims.is_empty())
}

/// A frame's name for people.
fn shown(frame: &str) -> String {
    if frame.is_empty() {
        "(empty name)".to_owned()
    } else {
        one_line(frame)
    }
}
