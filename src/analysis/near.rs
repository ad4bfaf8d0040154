//! Names that are nearly the same: what was probably meant.
//!
//! Owns the ranking, and the differences that are made on purpose (numbers, left and right). Must not know the world.

use std::cell::Cell;
use std::collections::BTreeMap;
use std::rc::Rc;

use crate::analysis::names;
use crate::world::FrameId;

/// Groups of words that distinguish frames: a name that differs by words of a group is another frame.
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
pub(crate) struct SimilarName<'a> {
    /// The name.
    pub(crate) frame: &'a FrameId,
    /// Number of edits between the two, 0 where only separators, endings or namespaces differ.
    pub(crate) edits: usize,
    /// How they differ, as a predicate before "from".
    pub(crate) how: &'static str,
}

/// Limits of [`Names::nearest`].
#[derive(Clone, Copy, Debug)]
pub(crate) struct Reach {
    /// Edits that still count as a typo.
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

/// Letters of all names that are compared by edits, over all look-ups: a platform with a hundred thousand misspelt names gets suggestions for
/// some of them.
const MOST_COMPARED: usize = 10_000_000;

/// Names that others may be near to, in an index: a look-up does not compare with each.
#[derive(Debug, Default)]
pub(crate) struct Names<'a> {
    /// By the name without separators.
    squeezed: BTreeMap<String, Vec<KnownName<'a>>>,
    /// By the part after the last slash.
    last: BTreeMap<String, Vec<KnownName<'a>>>,
    /// By the name without separators and endings.
    core: BTreeMap<String, Vec<KnownName<'a>>>,
    /// By the digits, in order, and the number of characters: edits change no digit.
    sized: BTreeMap<(String, usize), Vec<KnownName<'a>>>,
    /// Letters that were compared.
    compared: Cell<usize>,
}

/// A name, and in lower case.
type KnownName<'a> = (&'a FrameId, Rc<str>);

impl<'a> Names<'a> {
    /// An index of names.
    pub(crate) fn new(names: impl IntoIterator<Item = &'a FrameId>) -> Self {
        let mut index = Self::default();
        for name in names {
            let lower: Rc<str> = name.as_str().to_lowercase().into();
            let add = |map: &mut BTreeMap<String, Vec<KnownName<'a>>>, key: String| {
                map.entry(key).or_default().push((name, Rc::clone(&lower)));
            };
            add(&mut index.squeezed, squeeze(&lower));
            add(&mut index.last, last(&lower).to_owned());
            add(&mut index.core, core(&lower));
            let size = (digits(&lower), lower.chars().count());
            index.sized.entry(size).or_default().push((name, Rc::clone(&lower)));
        }
        index
    }

    /// The name that `name` was probably meant to be, nearest first, then by name. Names that differ only in case, or by a number or a pair
    /// such as left and right, are none.
    pub(crate) fn nearest(&self, name: &FrameId, reach: Reach) -> Option<SimilarName<'a>> {
        let name = name.as_str().to_lowercase();
        self.alike(&name).or_else(|| self.edited(&name, reach))
    }

    /// Whether so much was compared that names are no longer compared by edits.
    pub(crate) fn is_spent(&self) -> bool {
        self.compared.get() > MOST_COMPARED
    }

    /// The first name that differs in separators, else in namespace or ending.
    fn alike(&self, name: &str) -> Option<SimilarName<'a>> {
        fn among<'m, 'a>(map: &'m BTreeMap<String, Vec<KnownName<'a>>>, key: &str) -> &'m [KnownName<'a>] {
            map.get(key).map_or(&[], Vec::as_slice)
        }
        let core = core(name);
        let squeezed = among(&self.squeezed, &squeeze(name)).iter();
        let squeezed = squeezed.map(|known| (known, 0, "differs only in separators"));
        let is_bare = |known: &&KnownName| !name.contains('/') || !known.1.contains('/');
        let last = among(&self.last, last(name)).iter().filter(is_bare);
        let last = last.map(|known| (known, 1, "differs only in the namespace"));
        let ended = among(&self.core, &core).iter().filter(|_| !core.is_empty());
        let ended = ended.map(|known| (known, 1, "differs only in the ending"));
        let found = squeezed.chain(last).chain(ended);
        let others = found.filter(|((_, lower), ..)| **lower != *name);
        let ((frame, _), _, how) = others.min_by_key(|((frame, _), rank, _)| (*rank, *frame))?;
        Some(SimilarName { frame, edits: 0, how })
    }

    /// The name with the fewest edits, of those of nearly the same length.
    fn edited(&self, name: &str, reach: Reach) -> Option<SimilarName<'a>> {
        let length = name.chars().count();
        let sizes = length.saturating_sub(reach.max_edits).max(reach.min_length)..=length + reach.max_edits;
        if length < reach.min_length {
            return None;
        }
        let mut best: Option<(usize, &'a FrameId)> = None;
        let digits = digits(name);
        for size in sizes {
            for (frame, lower) in self.sized.get(&(digits.clone(), size)).into_iter().flatten() {
                if self.is_spent() {
                    break;
                }
                self.compared.set(self.compared.get() + size);
                if **lower == *name || on_purpose(name, lower) {
                    continue;
                }
                let edits = strsim::damerau_levenshtein(name, lower);
                if edits <= reach.max_edits && best.is_none_or(|best| (edits, *frame) < best) {
                    best = Some((edits, frame));
                }
            }
        }
        let (edits, frame) = best?;
        let how = "differs only by a typo";
        Some(SimilarName { frame, edits, how })
    }
}

fn last(name: &str) -> &str {
    name.rsplit('/').next().unwrap_or_default()
}

fn digits(name: &str) -> String {
    name.chars().filter(char::is_ascii_digit).collect()
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

/// Whether two names with the same digits differ the way two frames of one robot do: in an opposite, or in a short word.
fn on_purpose(a: &str, b: &str) -> bool {
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
        Names::new([&FrameId::new(b)]).nearest(&a.into(), REACH).is_some()
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
        let near = Names::new(&names).nearest(&"velodyne".into(), REACH);
        assert_eq!(near.unwrap().frame.as_str(), "velodyne_link");
    }
}
