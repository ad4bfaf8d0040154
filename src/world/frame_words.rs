//! Words in the names of frames by which a transform may move: whole tokens, never substrings.

use std::collections::BTreeMap;

use super::FrameId;

/// Words of frames that are fixed to the world, or drift slowly against it.
pub(crate) const WORLDS: &[&str] = &["earth", "world", "map", "odom", "utm", "ecef", "global"];

/// Words of parts that are meant to move, with or without a URDF.
const MOVING: &[&str] = &[
    "wheel", "caster", "steering", "arm", "shoulder", "elbow", "wrist", "gripper", "finger", "hand", "joint", "pan",
    "tilt", "ptz", "head", "neck", "hip", "knee", "ankle", "leg", "turret", "gimbal", "servo",
];

/// Whether one of the words is a token of the name, apart from digits after it: `lidar_2`, `cam0` and `FrontLidar` have
/// the tokens `lidar`, `cam`, `lidar`.
pub(crate) fn has_word(frame: &FrameId, words: &[&str]) -> bool {
    has_word_of(frame, &[words])
}

/// [`has_word`] of several lists.
pub(crate) fn has_word_of(frame: &FrameId, lists: &[&[&str]]) -> bool {
    frame.tokens().iter().any(|token| {
        let stem = token.trim_end_matches(|c: char| c.is_ascii_digit());
        let mut words = lists.iter().copied().flatten();
        words.any(|word| *word == stem || word == token)
    })
}

/// Whether the name is that of a world-like frame.
pub(crate) fn is_world(frame: &FrameId) -> bool {
    has_word(frame, WORLDS)
}

/// Whether the name is that of a part that is meant to move.
pub(crate) fn is_moving_part(frame: &FrameId) -> bool {
    has_word(frame, MOVING)
}

/// Words for a left part, with those for the right one: alone, or of corners and of limbs (front left, left hind).
pub(crate) const SIDES: &[[&str; 2]] = &[
    ["left", "right"],
    ["l", "r"],
    ["fl", "fr"],
    ["ml", "mr"],
    ["rl", "rr"],
    ["bl", "br"],
    ["hl", "hr"],
    ["lf", "rf"],
    ["lm", "rm"],
    ["lr", "rr"],
    ["lb", "rb"],
    ["lh", "rh"],
];

/// The pairs among frames whose names differ in a word for left and right, the left one first.
pub(crate) fn pairs_of_sides<'f>(frames: impl Iterator<Item = &'f FrameId>) -> Vec<(&'f FrameId, &'f FrameId)> {
    let by_words: BTreeMap<Vec<String>, &FrameId> = frames.map(|frame| (frame.tokens(), frame)).collect();
    let counterpart = |words: &[String]| {
        let sides = words.iter().enumerate().flat_map(|(at, word)| {
            let of_word = SIDES.iter().filter(move |[left, _]| left == word);
            of_word.map(move |[_, right]| (at, *right))
        });
        let mut found = sides.filter_map(|(at, right)| {
            let mut other = words.to_vec();
            right.clone_into(other.get_mut(at)?);
            by_words.get(&other).copied()
        });
        found.next()
    };
    let pairs = by_words.iter();
    pairs
        .filter_map(|(words, left)| Some((*left, counterpart(words)?)))
        .collect()
}
