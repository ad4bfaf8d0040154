//! Names that are nearly the same: what was probably meant.
//!
//! Owns the ranking, and the differences that are made on purpose (numbers, left and right). Must not know the world.

use crate::analysis::names;
use crate::world::FrameId;

/// Words that stand for each other's opposite: a name that differs by them is another frame.
const OPPOSITES: &[&[&str]] = &[
    &["left", "right", "l", "r", "center", "centre", "middle", "mid"],
    &[
        "front", "rear", "back", "side", "f", "b", "fl", "fr", "rl", "rr", "bl", "br",
    ],
    &["top", "bottom", "upper", "lower", "up", "down"],
    &["inner", "outer", "near", "far", "long", "short", "wide", "narrow"],
    &[
        "infra",
        "infra1",
        "infra2",
        "rgb",
        "color",
        "colour",
        "depth",
        "ir",
        "mono",
        "stereo",
        "confidence",
    ],
    &[
        "gyro", "accel", "mag", "imu", "gps", "gnss", "lidar", "radar", "camera", "laser", "sonar",
    ],
    &["north", "south", "east", "west"],
    &["ned", "enu", "nwu", "flu", "frd"],
    &["base", "map", "odom", "world", "earth"],
];

/// A name that was probably meant.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Near<'a> {
    /// The name.
    pub(crate) frame: &'a FrameId,
    /// Number of edits between the two, 0 where only separators, endings or namespaces differ.
    pub(crate) edits: usize,
    /// How they differ, in words.
    pub(crate) how: &'static str,
}

/// Limits of [`nearest`].
#[derive(Clone, Copy, Debug)]
pub(crate) struct Reach {
    /// Edits that still count as a slip.
    pub(crate) max_edits: usize,
    /// Shortest name for which edits are counted.
    pub(crate) min_length: usize,
}

impl Reach {
    /// The reach of a suggestion in a help text. NAME03, which judges by it, has its own limits.
    pub(crate) const SUGGESTION: Self = Self {
        max_edits: 2,
        min_length: 6,
    };
}

/// The candidate that `name` was probably meant to be, nearest first, then by name. Names that differ only in case, or
/// by a number or a pair such as left and right, are none.
pub(crate) fn nearest<'a>(
    name: &FrameId,
    candidates: impl IntoIterator<Item = &'a FrameId>,
    reach: Reach,
) -> Option<Near<'a>> {
    candidates
        .into_iter()
        .filter_map(|candidate| {
            let (rank, edits, how) = compare(name.as_str(), candidate.as_str(), reach)?;
            Some((
                (rank, edits, candidate),
                Near {
                    frame: candidate,
                    edits,
                    how,
                },
            ))
        })
        .min_by(|(a, _), (b, _)| a.cmp(b))
        .map(|(_, near)| near)
}

fn compare(a: &str, b: &str, reach: Reach) -> Option<(u8, usize, &'static str)> {
    let (a, b) = (a.to_lowercase(), b.to_lowercase());
    if a == b {
        return None;
    }
    if squeeze(&a) == squeeze(&b) {
        return Some((0, 0, "differs only in separators"));
    }
    let last = |s: &str| s.rsplit('/').next().unwrap_or_default().to_owned();
    if last(&a) == last(&b) && (!a.contains('/') || !b.contains('/')) {
        return Some((1, 0, "differs only in the namespace"));
    }
    let (core_a, core_b) = (core(&a), core(&b));
    if !core_a.is_empty() && core_a == core_b {
        return Some((1, 0, "differs only in the ending"));
    }
    if a.chars().count().min(b.chars().count()) < reach.min_length || on_purpose(&a, &b) {
        return None;
    }
    let edits = strsim::damerau_levenshtein(&a, &b);
    (edits <= reach.max_edits).then_some((2, edits, "differs by a slip of the pen"))
}

fn squeeze(name: &str) -> String {
    name.chars().filter(|c| c.is_alphanumeric()).collect()
}

fn words(name: &str) -> Vec<String> {
    FrameId::new(name).tokens()
}

/// The name without separators and without the endings `link` and `frame`.
fn core(name: &str) -> String {
    names::without_ending(words(name)).concat()
}

/// Whether two names differ the way two frames of one robot do: in a number, in an opposite, or in a short word.
fn on_purpose(a: &str, b: &str) -> bool {
    let digits = |s: &str| s.chars().filter(char::is_ascii_digit).collect::<String>();
    if digits(a) != digits(b) {
        return true;
    }
    let (words_a, words_b) = (words(a), words(b));
    if words_a.len() != words_b.len() {
        let known = |word: &String| OPPOSITES.iter().any(|group| group.contains(&word.as_str()));
        let lost = words_a.iter().filter(|word| !words_b.contains(word));
        let added = words_b.iter().filter(|word| !words_a.contains(word));
        return lost.chain(added).any(known);
    }
    words_a.iter().zip(&words_b).filter(|(a, b)| a != b).any(|(a, b)| {
        let opposite = OPPOSITES
            .iter()
            .any(|group| group.contains(&a.as_str()) && group.contains(&b.as_str()));
        opposite || a.chars().count().max(b.chars().count()) < 4
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    const REACH: Reach = Reach {
        max_edits: 2,
        min_length: 6,
    };

    fn near(a: &str, b: &str) -> bool {
        nearest(&a.into(), [&FrameId::new(b)], REACH).is_some()
    }

    #[test]
    fn slips_are_near() {
        for (a, b) in [
            ("velodyne", "velodyn"),
            ("velodyne", "veloydne"),
            ("base_imu", "baseimu"),
            ("imu", "imu_link"),
            ("lidar_frame", "lidar_link"),
            ("robot1/lidar", "lidar"),
            ("camera_optcial_frame", "camera_optical_frame"),
        ] {
            assert!(near(a, b), "{a} {b}");
        }
    }

    #[test]
    fn siblings_are_not() {
        for (a, b) in [
            ("camera_1", "camera_2"),
            ("camera1_link", "camera_link"),
            ("left_wheel", "right_wheel"),
            ("camera_l_link", "camera_r_link"),
            ("imu_link", "gps_link"),
            ("camera_ir_link", "camera_rgb_link"),
            ("robot1/lidar", "robot2/lidar"),
            ("Lidar", "lidar"),
            ("base_imu", "base_link"),
        ] {
            assert!(!near(a, b), "{a} {b}");
        }
    }

    #[test]
    fn the_nearest_is_taken() {
        let names: Vec<FrameId> = ["velodyme", "velodyne_link", "base"].map(FrameId::from).to_vec();
        assert_eq!(
            nearest(&"velodyne".into(), &names, REACH).unwrap().frame.as_str(),
            "velodyne_link"
        );
    }
}
