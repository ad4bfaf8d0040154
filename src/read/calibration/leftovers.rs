//! What looks like a transform or a part of one and was not read: listed in reports, so that nothing is ignored silently.
//!
//! Owns the criteria. Covariances, gains, intrinsics, lists of points and tracks do not count.

use std::collections::{BTreeMap, BTreeSet};

use crate::source::Span;
use crate::world::{Claim, FrameId};

use super::document::{Kind, Node};
use super::generic::is_over_time;
use super::names::{self, PairHalf};
use super::numbers::{self, Numbers};

/// A part that no reader took a statement of.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Leftover {
    /// The keys from the root to it, joined by `/`.
    pub(super) label: String,
    /// Its place, including its key.
    pub(super) span: Span,
    /// Whether it looks like a whole transform, and not like half of one.
    pub(super) is_whole: bool,
}

/// More of one file are not kept.
const MOST: usize = 1000;

/// Words of sensors and of where they are mounted.
#[rustfmt::skip]
const MOUNTED: &[&str] = &[
    "mount", "mounts", "mounting", "mountings", "mounted", "lever", "lidar", "laser", "camera", "cam", "imu", "gnss", "gps",
    "radar", "velodyne", "sensor", "sensors",
];
/// Words of values that have three or four numbers and describe no mounting. Values below such a key are not mountings either.
#[rustfmt::skip]
const OTHER: &[&str] = &[
    "pid", "kp", "ki", "kd", "goal", "target", "home", "dock", "initial", "init", "start", "waypoint", "waypoints", "path", "route",
    "trajectory", "joint", "joints", "color", "colour", "rgb", "rgba", "box", "crop", "voxel", "leaf", "roi", "polygon", "dimensions",
    "extent", "min", "max", "com", "mass", "force", "torque", "wrench", "twist", "speed", "rate", "tolerance", "threshold", "process",
    "config", "resolution", "fov", "focal", "pixel", "tag", "tags", "marker", "markers", "landmark", "landmarks", "world", "map",
    "viewpoint", "viewer", "rviz", "spawn", "kinematics", "dh", "damping", "stiffness", "offsets",
];

/// Values of which no claim has a number and no problem is reported, in the order of the text.
pub(super) fn collect(roots: &[Node], text: &str, claims: &[Claim], problems: &[Span]) -> Vec<Leftover> {
    let literals = claims
        .iter()
        .flat_map(|claim| claim.translation_literals.iter().chain(&claim.rotation_literals));
    let mut search = Search {
        text,
        known: literals.map(|literal| literal.span.start).collect(),
        problems,
        path: Vec::new(),
        found: Vec::new(),
    };
    for root in roots {
        search.visit(root, None);
    }
    search.found
}

/// A key, or an index of a list.
enum Part<'a> {
    Key(&'a str),
    Index(usize),
}

struct Search<'a> {
    text: &'a str,
    /// Where the numbers of claims begin.
    known: BTreeSet<usize>,
    problems: &'a [Span],
    path: Vec<Part<'a>>,
    found: Vec<Leftover>,
}

fn has(key: &str, list: &[&str]) -> bool {
    let words = FrameId::new(names::last_part(key)).tokens();
    words.iter().any(|word| list.contains(&word.as_str()))
}

impl<'a> Search<'a> {
    fn visit(&mut self, node: &'a Node, key: Option<&'a Node>) {
        if let Some(found) = numbers::numbers(node, self.text) {
            if self.is_transform(&found) {
                self.add(node, key, true);
            }
            return;
        }
        match &node.kind {
            Kind::Scalar { .. } => {}
            Kind::Sequence(items) if is_over_time(items) => {}
            Kind::Sequence(items) => {
                for (index, item) in items.iter().enumerate() {
                    self.path.push(Part::Index(index));
                    self.visit(item, key);
                    self.path.pop();
                }
            }
            Kind::Mapping(pairs) => {
                if let Some((key, value)) = self.pose_key(node) {
                    self.path.push(Part::Key(key.text().unwrap_or_default()));
                    self.add(value, Some(key), true);
                    self.path.pop();
                }
                let halves = self.halves(node);
                for (index, (key, child)) in pairs.iter().enumerate() {
                    let Some(name) = key.text().filter(|name| !names::is_never(name) && !has(name, OTHER)) else {
                        continue;
                    };
                    self.path.push(Part::Key(name));
                    if halves.contains(&index) {
                        self.add(child, Some(key), halves.len() > 1);
                    } else {
                        self.visit(child, Some(key));
                    }
                    self.path.pop();
                }
            }
        }
    }

    fn add(&mut self, node: &Node, key: Option<&Node>, is_whole: bool) {
        let span = key.map_or(node.span, |key| node.span.cover(key.span));
        let is_said = self
            .problems
            .iter()
            .any(|at| span.start <= at.end && at.start <= span.end);
        if is_said || self.found.len() >= MOST || self.has_known(node) {
            return;
        }
        let parts = self.path.iter().map(|part| match part {
            Part::Key(key) => (*key).to_owned(),
            Part::Index(index) => index.to_string(),
        });
        let label: Vec<String> = parts.collect();
        self.found.push(Leftover {
            label: label.join("/"),
            span,
            is_whole,
        });
    }

    /// Whether a claim contains a number of this value.
    fn has_known(&self, node: &Node) -> bool {
        // A literal begins after the quote of its text.
        self.known.range(node.span.start..=node.span.end).next().is_some()
    }

    /// Whether a key on the path means a transform, or a mounting.
    fn speaks(&self) -> bool {
        let mut keys = self.path.iter().filter_map(|part| match part {
            Part::Key(key) => Some(*key),
            Part::Index(_) => None,
        });
        keys.any(|key| names::is_transform(key) || has(key, MOUNTED))
    }

    /// Numbers that are a transform by their values, or by their count under a key that means one.
    fn is_transform(&self, found: &Numbers) -> bool {
        let key = match self.path.iter().rev().find(|part| matches!(part, Part::Key(_))) {
            Some(Part::Key(key)) => *key,
            _ => "",
        };
        let is_mounted = self
            .path
            .iter()
            .any(|part| matches!(part, Part::Key(key) if names::is_mountings(key)));
        let is_named = names::is_transform(key) || is_mounted;
        if let Some((rows, cols, literals)) = found.matrix() {
            let values = numbers::values(literals);
            return is_named || cols == 4 && numbers::is_rigid_or_turned_over(rows, &values);
        }
        if let Some(four) = found.vector(4) {
            return names::is_rotation(key) && numbers::near_unit(four);
        }
        let count = found.literals().len();
        // A row of lists is points.
        matches!(found, Numbers::Flat(_)) && is_named && matches!(count, 6 | 7)
    }

    /// Which pairs of a mapping are halves of a transform by their keys and their numbers.
    fn halves(&self, node: &'a Node) -> BTreeSet<usize> {
        let half = |(key, child): &(Node, Node)| {
            let name = key.text().filter(|name| !names::is_never(name) && !has(name, OTHER))?;
            let (_, half) = names::half(name)?;
            let found = numbers::numbers(child, self.text);
            let count = found
                .as_ref()
                .map_or_else(|| axes(child), |found| found.literals().len());
            let fits = match half {
                PairHalf::Translation | PairHalf::Angles => count == 3,
                PairHalf::Rotation => matches!(count, 3 | 4 | 9),
            };
            fits.then_some(half)
        };
        let halves: Vec<(usize, PairHalf)> = node
            .pairs()
            .iter()
            .enumerate()
            .filter_map(|(index, pair)| Some((index, half(pair)?)))
            .collect();
        let is_place = |(_, half): &(usize, PairHalf)| *half == PairHalf::Translation;
        let is_pair = halves.iter().any(is_place) && !halves.iter().all(is_place);
        let is_listed = matches!(self.path.last(), Some(Part::Index(_)));
        // Half a transform alone can be anything, unless the keys around it mean mountings.
        if is_pair && !is_listed || self.speaks() {
            halves.into_iter().map(|(index, _)| index).collect()
        } else {
            BTreeSet::new()
        }
    }

    /// The first key of a place and a heading that are numbers of a mapping, each under a key of its own, with names that are not read.
    fn pose_key(&self, node: &'a Node) -> Option<(&'a Node, &'a Node)> {
        let is_number = |value: &Node| numbers::literal(value).is_some_and(|literal| literal.value.is_finite());
        let pairs = node.pairs().iter().filter(|(_, value)| is_number(value));
        let keys: BTreeMap<String, &'a (Node, Node)> = pairs
            .filter_map(|pair| Some((pair.0.text()?.to_lowercase(), pair)))
            .collect();
        let have = |stem: &str, ends: &[&str]| ends.iter().all(|end| keys.contains_key(&format!("{stem}{end}")));
        let is_pose = |stem: &str| {
            let bare = stem.strip_suffix('t').unwrap_or(stem);
            let turns = [
                &["roll", "pitch", "yaw"][..],
                &["yaw"],
                &["rx", "ry", "rz"],
                &["qx", "qy", "qz", "qw"],
            ];
            (!bare.is_empty() || self.speaks())
                && have(stem, &["x", "y", "z"])
                && turns.iter().any(|turn| have(bare, turn))
        };
        let is_stem = |stem: &str| matches!(stem, "" | "t") || stem.ends_with('_');
        let first = keys
            .iter()
            .find(|(key, _)| key.strip_suffix('x').is_some_and(|stem| is_stem(stem) && is_pose(stem)));
        let is_listed = matches!(self.path.last(), Some(Part::Index(_)));
        first.filter(|_| !is_listed).map(|(_, (key, value))| (key, value))
    }
}

/// How many of `x`, `y`, `z`, `w`, or of roll, pitch and yaw, a mapping holds as numbers.
fn axes(node: &Node) -> usize {
    let count = |keys: &[&str]| {
        let numbers = keys.iter().filter_map(|key| numbers::literal(node.get(key)?));
        numbers.filter(|literal| literal.value.is_finite()).count()
    };
    count(&["x", "y", "z", "w"]).max(count(&["roll", "pitch", "yaw"]))
}
