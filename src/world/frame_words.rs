//! Words in the names of frames by which a transform may move: whole tokens, never substrings.

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
