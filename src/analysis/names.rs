//! What a frame's name states: vocabulary in tokens, the names of REP-105, and folding.
//!
//! Conventions are looked for in whole tokens, never in substrings: `odom_combined` is not `ned`, and
//! `optical_ranging_sensor` is no camera frame. Must not know the world.

use unicode_normalization::UnicodeNormalization;

use crate::world::FrameId;
use crate::world::frame_words::WORLDS;
pub(crate) use crate::world::frame_words::{has_word, has_word_of, is_moving_part, is_world};

/// Words for lidars.
pub(crate) const LIDARS: &[&str] = &["lidar", "laser", "velodyne", "ouster"];

/// Makers of lidars.
pub(crate) const LIDAR_MAKERS: &[&str] = &["livox", "hesai", "robosense", "rslidar"];

/// Words for inertial sensors: kinds, makers and their series.
pub(crate) const IMUS: &[&str] = &[
    "imu",
    "ins",
    "ahrs",
    "xsens",
    "mti",
    "vectornav",
    "vn100",
    "vn200",
    "microstrain",
    "sbg",
    "adis16470",
    "adis16448",
    "bno055",
    "phidgets",
];

/// Words for cameras.
pub(crate) const CAMERAS: &[&str] = &["camera", "cam"];

/// Words for GNSS receivers.
pub(crate) const GNSS: &[&str] = &["gps", "gnss"];

/// Words that name a sensor and nothing else.
const SENSORS: &[&[&str]] = &[
    LIDARS,
    LIDAR_MAKERS,
    GNSS,
    &[
        "sick",
        "hokuyo",
        "rplidar",
        "camera",
        "realsense",
        "zed",
        "imu",
        "radar",
        "sonar",
    ],
];

/// Words of a platform's base frame.
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

/// Whether the name is that of a sensor and nothing else: `camera_init`, `lidar_map` and `camera_mount` are no sensors.
pub(crate) fn is_sensor(frame: &FrameId) -> bool {
    let says_more = [WORLDS, BASES, &["init", "pose", "mount", "bracket", "holder", "plate"]];
    has_word_of(frame, SENSORS) && !has_word_of(frame, &says_more)
}

/// Whether the name is that of a platform's base frame.
pub(crate) fn is_base(frame: &FrameId) -> bool {
    has_word(frame, BASES)
}

/// Whether the name contains a word for a sensor or another carried device.
pub(crate) fn is_device(frame: &FrameId) -> bool {
    let things = ["sensor", "device", "tracker", "scanner", "marker", "tag", "pose"];
    has_word_of(frame, SENSORS) || has_word_of(frame, &[CAMERAS, &things])
}

/// Whether a topic is, by its name, a command or plan instead of a measurement.
pub(crate) fn is_wish(topic: &str) -> bool {
    const WISHES: &[&str] = &[
        "cmd",
        "command",
        "commanded",
        "setpoint",
        "goal",
        "target",
        "desired",
        "reference",
        "plan",
        "path",
        "trajectory",
    ];
    let words = FrameId::new(topic).tokens();
    words.iter().any(|word| WISHES.contains(&word.as_str()))
}

/// The words of a name before `optical` or `optical_frame`, without an ending; `None` where the name does not end with these.
pub(crate) fn optical_stem(frame: &FrameId) -> Option<Vec<String>> {
    let mut words = frame.tokens();
    if words.last().is_some_and(|word| word == "frame") {
        words.pop();
    }
    (words.pop()? == "optical").then(|| without_ending(words))
}

/// The words of a name without the endings `link` and `frame`, but at least one word.
pub(crate) fn without_ending(mut words: Vec<String>) -> Vec<String> {
    while words.len() > 1 && words.last().is_some_and(|word| word == "link" || word == "frame") {
        words.pop();
    }
    words
}

/// The name folded for comparison without case: canonical composition, lower case, without a leading slash.
pub(crate) fn fold(frame: &FrameId) -> String {
    let name = frame.canonical();
    if name.as_str().is_ascii() {
        return name.as_str().to_ascii_lowercase();
    }
    name.as_str().nfc().collect::<String>().to_lowercase()
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
        assert!(!is_sensor(&"camera_mount".into()));
        assert!(!is_world(&"mapper_link".into()));
        assert!(!is_base(&"basement".into()));
        let stem = |name: &str| optical_stem(&name.into()).map(|words| words.join(" "));
        assert_eq!(stem("camera_color_optical_frame").as_deref(), Some("camera color"));
        assert_eq!(stem("camera_link_optical").as_deref(), Some("camera"));
        assert_eq!(stem("optical_ranging_sensor_left"), None);
    }

    #[test]
    fn standard_names_are_exact_but_for_a_namespace() {
        assert_eq!(standard(&"robot1/odom".into()), Some(("robot1", Standard::Odom)));
        assert_eq!(standard(&"camera_odom_frame".into()), None);
        assert_eq!(standard(&"odom_combined".into()), None);
    }
}
