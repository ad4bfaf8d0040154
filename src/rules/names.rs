//! What a frame's name says: vocabulary in tokens, the names of REP-105, cleaning and folding.
//!
//! Conventions are looked for in whole tokens, never in substrings: `odom_combined` is not `ned`, and
//! `optical_ranging_sensor` is no camera frame. Must not know the world.

use unicode_normalization::UnicodeNormalization;

use crate::world::FrameId;

/// Words that name a sensor and nothing else.
const SENSORS: &[&str] = &[
    "lidar",
    "laser",
    "velodyne",
    "ouster",
    "livox",
    "hesai",
    "robosense",
    "rslidar",
    "sick",
    "hokuyo",
    "rplidar",
    "camera",
    "realsense",
    "zed",
    "imu",
    "gps",
    "gnss",
    "radar",
    "sonar",
];

/// Words of frames that are fixed to the world, or drift slowly against it.
const WORLDS: &[&str] = &["earth", "world", "map", "odom", "utm", "ecef", "global"];

/// Words of the frame that stands for the whole platform.
const BASES: &[&str] = &[
    "base",
    "body",
    "robot",
    "vehicle",
    "ego",
    "chassis",
    "footprint",
    "rover",
    "car",
    "hull",
    "trunk",
    "pelvis",
    "torso",
    "cog",
    "vut",
];

/// Words of parts that are meant to move, also where no URDF says so.
const MOVING: &[&str] = &[
    "wheel", "caster", "steering", "arm", "shoulder", "elbow", "wrist", "gripper", "finger", "hand", "joint", "pan",
    "tilt", "ptz", "head", "neck", "hip", "knee", "ankle", "leg", "turret", "gimbal", "servo",
];

/// The frames of REP-105 that have an order, from the root down.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) enum Standard {
    /// `earth`.
    Earth,
    /// `map`.
    Map,
    /// `odom`.
    Odom,
    /// `base_link` or `base_footprint`.
    Base,
}

/// The namespace and the REP-105 frame of a name, if it is exactly one of the standard names.
pub(crate) fn standard(frame: &FrameId) -> Option<(&str, Standard)> {
    let name = frame.as_str();
    let (namespace, last) = name.rsplit_once('/').unwrap_or(("", name));
    let kind = match last {
        "earth" => Standard::Earth,
        "map" => Standard::Map,
        "odom" => Standard::Odom,
        "base_link" | "base_footprint" => Standard::Base,
        _ => return None,
    };
    Some((namespace, kind))
}

fn has_any(frame: &FrameId, words: &[&str]) -> bool {
    frame
        .tokens()
        .iter()
        .any(|token| words.contains(&token.trim_end_matches(|c: char| c.is_ascii_digit())))
}

/// Whether the name says "sensor" and does not also say "world": `camera_init` and `lidar_map` are no sensors.
pub(crate) fn is_sensor(frame: &FrameId) -> bool {
    has_any(frame, SENSORS) && !has_any(frame, WORLDS) && !has_any(frame, BASES) && !frame.has_token("init")
}

/// Whether the name is that of a world-like frame.
pub(crate) fn is_world(frame: &FrameId) -> bool {
    has_any(frame, WORLDS)
}

/// Whether the name is that of a platform's own frame.
pub(crate) fn is_base(frame: &FrameId) -> bool {
    has_any(frame, BASES)
}

/// Whether the name is that of a part that is meant to move.
pub(crate) fn is_moving_part(frame: &FrameId) -> bool {
    has_any(frame, MOVING)
}

/// The name folded for comparison without case: canonical composition, lower case, without a leading slash.
pub(crate) fn fold(frame: &FrameId) -> String {
    frame.canonical().as_str().nfc().collect::<String>().to_lowercase()
}

/// Whether a character has no width or controls something, so that two names can look alike and differ.
pub(crate) fn is_invisible(c: char) -> bool {
    (c.is_control() && !c.is_whitespace())
        || matches!(c, '\u{ad}' | '\u{200b}'..='\u{200f}' | '\u{202a}'..='\u{202e}' | '\u{2060}'..='\u{2064}' | '\u{feff}')
}

/// The name without what must not be in one: invisible characters, blanks at its ends, slashes at its ends and doubled,
/// decomposed letters. Blanks inside are kept.
pub(crate) fn clean(name: &str) -> String {
    let visible: String = name.nfc().filter(|c| !is_invisible(*c)).collect();
    visible
        .trim()
        .split('/')
        .map(str::trim)
        .filter(|segment| !segment.is_empty())
        .collect::<Vec<_>>()
        .join("/")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn vocabulary_is_matched_in_tokens() {
        assert!(is_sensor(&"front_camera2_link".into()));
        assert!(is_sensor(&"lidar0".into()));
        assert!(!is_sensor(&"camera_init".into()));
        assert!(!is_sensor(&"camera_odom_frame".into()));
        assert!(!is_world(&"mapper_link".into()));
        assert!(!is_base(&"basement".into()));
    }

    #[test]
    fn standard_names_are_exact_but_for_a_namespace() {
        assert_eq!(standard(&"robot1/odom".into()), Some(("robot1", Standard::Odom)));
        assert_eq!(standard(&"camera_odom_frame".into()), None);
        assert_eq!(standard(&"odom_combined".into()), None);
    }

    #[test]
    fn cleaning_keeps_a_good_name() {
        assert_eq!(clean("robot1/base_link"), "robot1/base_link");
        assert_eq!(clean(" /lidar\u{200b}// "), "lidar");
        assert_eq!(clean("caf\u{65}\u{301}"), "caf\u{e9}");
        assert_eq!(clean("front lidar"), "front lidar");
    }
}
