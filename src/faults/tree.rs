//! Mistakes in names of frames and in the tree that they form.

mod edges;
mod joints;

use std::collections::BTreeMap;

use crate::source::SourceId;
use crate::world::bag::{HeaderFrame, TopicEvidence};
use crate::world::{FrameId, FrameRole, World};

use super::{Change, Family, Fault, Subject, SubjectPlace, mountings};

use edges::TfMistake;
use joints::JointMistake;

/// Another name in the headers of a topic; `None` where it is the same.
struct Header(fn(&str) -> Option<String>);

impl Change for Header {
    fn subjects(&self, world: &World) -> Vec<Subject> {
        let mut subjects = Vec::new();
        for (bag, evidence) in world.bags.iter().enumerate() {
            for topic in evidence.topics.values().filter(|topic| is_looked_up(topic)) {
                let is_known = |frame: &&FrameId| world.graph().frames.contains(&frame.canonical());
                let Some(frame) = topic.header_frames.keys().find(is_known) else {
                    continue;
                };
                let Some(renamed) = (self.0)(frame.as_str()) else {
                    continue;
                };
                let words = [topic.topic.as_str(), frame.as_str(), renamed.as_str()];
                subjects.push(Subject {
                    name: format!("frame of topic `{}`", topic.topic),
                    words: words.map(|word| format!("`{word}`")).to_vec(),
                    at: SubjectPlace::Topic {
                        bag,
                        topic: topic.topic.clone(),
                    },
                });
            }
        }
        subjects
    }

    fn apply(&self, world: &mut World, subject: &Subject) -> bool {
        let SubjectPlace::Topic { bag, topic } = &subject.at else {
            return false;
        };
        rename_header(world, *bag, topic, |frame| (self.0)(frame.as_str()).map(FrameId::new))
    }
}

/// Whether the frame of a topic is looked up: sensors, and poses.
fn is_looked_up(topic: &TopicEvidence) -> bool {
    mountings::is_of_a_sensor(topic) || topic.content.odometry.is_some() || topic.content.motion.poses.is_some()
}

/// Gives the headers of a topic another frame. False where none is renamed.
pub(super) fn rename_header(
    world: &mut World,
    bag: usize,
    topic: &str,
    name: impl Fn(&FrameId) -> Option<FrameId>,
) -> bool {
    let Some(bag) = world.bags.get_mut(bag) else {
        return false;
    };
    let source = bag.source;
    let Some(evidence) = bag.topics.get_mut(topic) else {
        return false;
    };
    let renamed = rename_keys(&mut evidence.header_frames, &name);
    for member in evidence.members.values_mut() {
        rename_keys(&mut member.header_frames, &name);
    }
    rename_uses(world, (source, topic), FrameRole::Header, &name);
    world.forget();
    renamed
}

fn rename_keys(frames: &mut BTreeMap<FrameId, HeaderFrame>, name: impl Fn(&FrameId) -> Option<FrameId>) -> bool {
    let known = std::mem::take(frames);
    let mut has_changed = false;
    for (frame, used) in known {
        let renamed = name(&frame).filter(|other| *other != frame);
        has_changed |= renamed.is_some();
        frames
            .entry(renamed.unwrap_or(frame))
            .and_modify(|known| known.count += used.count)
            .or_insert(used);
    }
    has_changed
}

/// Renames the uses of frames in one role on a topic; an empty name is no use.
fn rename_uses(
    world: &mut World,
    (source, topic): (SourceId, &str),
    role: FrameRole,
    name: impl Fn(&FrameId) -> Option<FrameId>,
) {
    for used in &mut world.frames {
        let is_it = used.role == role && used.place.source == source && used.place.topic() == Some(topic);
        if let (true, Some(renamed)) = (is_it, name(&used.frame)) {
            used.frame = renamed;
        }
    }
    world
        .frames
        .retain(|used| !used.frame.as_str().is_empty() || used.role != role);
}

/// A name without the letter in its middle.
fn typo(name: &str) -> Option<String> {
    let middle = name.chars().count() / 2;
    let is_letter = name.chars().nth(middle).is_some_and(char::is_alphanumeric);
    let at = if is_letter { middle } else { middle + 1 };
    let renamed: String = name
        .chars()
        .enumerate()
        .filter(|(index, _)| *index != at)
        .map(|(_, letter)| letter)
        .collect();
    (renamed.len() > 1 && renamed != name).then_some(renamed)
}

/// A name whose words begin with capital letters.
fn capital(name: &str) -> Option<String> {
    let mut starts = true;
    let letters = name.chars().map(|letter| {
        let is_first = std::mem::replace(&mut starts, !letter.is_alphanumeric());
        if is_first { letter.to_ascii_uppercase() } else { letter }
    });
    let renamed: String = letters.collect();
    (renamed != name).then_some(renamed)
}

/// A mistake of the tree.
macro_rules! tree {
    ($name:literal, $change:expr, $sentence:literal, $($named:tt)*) => {
        fault!(Tree, $name, $sentence, $change, [], $($named)*)
    };
}

const TREE: &str = "/tf and /tf_static, or the URDF, beside the messages";
const URDF: &str = "the whole URDF";

/// Every mistake of this kind.
pub(super) static FAULTS: &[Fault] = &[
    tree!(
        "frame-typo",
        Header(typo),
        "The frame of a topic is misspelt: a letter is missing.",
        ["is not in the tree, but", "but is the frame of"],
        ["NAME03", "TREE07"],
        TREE
    ),
    tree!(
        "frame-case",
        Header(capital),
        "The frame of a topic is written with other capital letters than in TF.",
        ["is spelled `"],
        ["NAME01"],
        TREE
    ),
    tree!(
        "frame-slash",
        Header(|name| (!name.starts_with('/')).then(|| format!("/{name}"))),
        "The frame of a topic starts with a slash.",
        ["starts with a slash"],
        ["NAME02"],
        TREE
    ),
    tree!(
        "frame-blank",
        Header(|name| Some(format!("{name} "))),
        "The frame of a topic ends with a blank.",
        ["starts or ends with whitespace"],
        ["NAME02"],
        TREE
    ),
    tree!(
        "frame-empty",
        Header(|name| (!name.is_empty()).then(String::new)),
        "The messages of a topic name no frame.",
        ["have an empty frame_id"],
        ["TREE07"],
        TREE
    ),
    tree!(
        "frame-orphan",
        TfMistake::Missing,
        "A transform is not published: the frames below it belong to another tree.",
        [
            "not connected to the tree of",
            "TF does not connect",
            "but not in TF",
            "but is the frame of",
            "missing from TF",
            "but no latched transforms"
        ],
        ["TREE01", "TREE07", "TREE08", "TREE09"],
        TREE
    ),
    tree!(
        "frame-second-parent",
        TfMistake::SecondParent,
        "A frame has two parents: a second program publishes it below another frame.",
        ["parents in TF", "changes its parent"],
        ["TREE02", "CROSS06"],
        TREE
    ),
    tree!(
        "frame-loop",
        TfMistake::Loop,
        "Frames form a loop: the root of the tree is published below one of its own frames.",
        ["is a loop of", "in a loop of"],
        ["TREE03"],
        TREE
    ),
    tree!(
        "frame-self",
        TfMistake::OwnParent,
        "A transform relates a frame to itself.",
        ["relates a frame to itself"],
        ["TREE04"],
        TREE
    ),
    Fault {
        family: Family::Tree,
        name: "frame-parent-child",
        sentence: "Parent and child of a transform are exchanged.",
        change: &TfMistake::Exchanged,
        relations: &["inverse"],
        texts: &[
            "is the parent of `",
            "parents in TF",
            "changes its parent",
            "REP-105 requires",
        ],
        seen_by: crate::faults::Seers(&["TREE06", "TREE02", "CROSS02", "CROSS06"]),
        record: TREE,
    },
    tree!(
        "joint-missing",
        JointMistake::Missing,
        "A joint is missing in the URDF: its links are connected to nothing.",
        ["root links instead of one", "not connected to the tree of"],
        ["TREE12", "TREE01"],
        URDF
    ),
    tree!(
        "joint-second-parent",
        JointMistake::SecondParent,
        "A link of the URDF is the child of two joints.",
        ["joints instead of one"],
        ["TREE02"],
        URDF
    ),
    tree!(
        "joint-loop",
        JointMistake::Loop,
        "The joints of the URDF form a loop.",
        ["is a loop of", "in a loop of"],
        ["TREE03"],
        URDF
    ),
];

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_changed_and_stay_names() {
        assert_eq!(typo("lidar_link").as_deref(), Some("lidar_ink"));
        assert_eq!(typo("os_sensor").as_deref(), Some("os_snsor"));
        assert_eq!(typo("a"), None);
        assert_eq!(capital("base_link").as_deref(), Some("Base_Link"));
        assert_eq!(capital("Base"), None);
    }
}
