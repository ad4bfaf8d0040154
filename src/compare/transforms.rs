//! Transforms of two platforms: which are gone, which are new, which are otherwise, and whether one frame moved or all that hang on another.

use std::collections::{BTreeMap, BTreeSet};

use nalgebra::Isometry3;

use crate::math::geodesy::Geodetic;
use crate::math::relation::{Classification, Relation, Tolerance, classify};
use crate::run::Run;
use crate::verdict::Measured;
use crate::world::graph::{Edge, EdgeOrigin};
use crate::world::{ClaimKind, EarthOrigin, FrameId, World};

use super::{Change, Comparison, Kind, place_words};

/// Less is what printing and reading leave (TREE11 warns from here).
const SAME_RAD: f64 = 0.05 * std::f64::consts::PI / 180.0;
/// Metres.
const SAME_M: f64 = 0.001;

/// Frames that a map hangs on.
const MAPS: [&str; 6] = ["map", "world", "earth", "utm", "enu", "local_enu"];

type Pair = (FrameId, FrameId);

/// A rigid transform that somebody states.
struct Stated {
    /// `parent_from_child`.
    pose: Isometry3<f64>,
    who: Vec<String>,
}

pub(super) fn compare(a: &Run, b: &Run, out: &mut Comparison) {
    let (tree_a, tree_b) = (Tree::of(a), Tree::of(b));
    frames(&tree_a, &tree_b, out);
    let mut moved: BTreeMap<FrameId, Vec<(Pair, Classification, Isometry3<f64>)>> = BTreeMap::new();
    for (pair, stated) in &tree_a.rigid {
        let Some(pose) = tree_b.pose(pair) else { continue };
        out.transforms += 1;
        let found = classify(&stated.pose, &pose, &Tolerance::default());
        if found.angle_rad > SAME_RAD || found.distance_m > SAME_M {
            let by = pose * stated.pose.inverse();
            moved.entry(pair.0.clone()).or_default().push((pair.clone(), found, by));
        }
    }
    for (parent, children) in moved {
        let all = tree_a
            .rigid
            .keys()
            .filter(|(above, below)| *above == parent && tree_b.pose(&(above.clone(), below.clone())).is_some());
        let is_whole = children.len() == all.count() && children.len() > 1;
        let first = children.first().map(|(_, _, by)| *by);
        let alike = first.filter(|first| is_whole && children.iter().all(|(_, _, by)| is_near(first, by)));
        if let Some(by) = alike {
            out.changes
                .push(parent_moved(&parent, &children, &by, &tree_a, &tree_b));
            continue;
        }
        for (pair, found, _) in children {
            out.changes.push(child_moved(&pair, &found, &tree_a, &tree_b));
        }
    }
    files(a, b, out);
    origins(a, b, out);
}

fn is_near(a: &Isometry3<f64>, b: &Isometry3<f64>) -> bool {
    let off = a.inverse() * b;
    off.rotation.angle() <= SAME_RAD && (a.translation.vector - b.translation.vector).norm() <= 5.0 * SAME_M
}

fn is_map(frame: &FrameId) -> bool {
    MAPS.contains(&frame.as_str())
}

fn measured(angle_rad: f64, distance_m: f64) -> Vec<Measured> {
    vec![
        Measured::new("turned by", angle_rad.to_degrees(), "deg").limit(SAME_RAD.to_degrees()),
        Measured::new("moved by", distance_m, "m").limit(SAME_M),
    ]
}

fn amount(angle_rad: f64, distance_m: f64) -> String {
    format!(
        "turned by {:.3} deg and moved by {distance_m:.4} m",
        angle_rad.to_degrees()
    )
}

/// All that hangs on a frame moved alike: it is that frame which is otherwise.
fn parent_moved(
    parent: &FrameId,
    children: &[(Pair, Classification, Isometry3<f64>)],
    by: &Isometry3<f64>,
    a: &Tree,
    b: &Tree,
) -> Change {
    let (angle, distance) = (by.rotation.angle(), by.translation.vector.norm());
    let names: Vec<String> = children.iter().map(|((_, child), ..)| format!("`{child}`")).collect();
    let what = if is_map(parent) {
        "the map origin"
    } else {
        "the frame itself"
    };
    let mut change = Change::new(
        Kind::Transform,
        format!("`{parent}`"),
        format!(
            "all {} frames on `{parent}` are {} alike",
            children.len(),
            amount(angle, distance)
        ),
    );
    change.explanation = format!("{what} moved, and not {}", names.join(", "));
    change.measured = measured(angle, distance);
    let who = |tree: &Tree| children.iter().flat_map(|(pair, ..)| tree.who(pair)).collect();
    change.stated = [who(a), who(b)];
    change
}

fn child_moved((parent, child): &Pair, found: &Classification, a: &Tree, b: &Tree) -> Change {
    let mut change = Change::new(
        Kind::Transform,
        format!("`{parent}` from `{child}`"),
        format!("`{child}` is {}", amount(found.angle_rad, found.distance_m)),
    );
    change.measured = measured(found.angle_rad, found.distance_m);
    let pair = (parent.clone(), child.clone());
    change.stated = [a.who(&pair), b.who(&pair)];
    explain(&mut change, found, || {
        if is_map(parent) {
            format!("the map origin moved, or `{child}` on it")
        } else {
            format!("`{child}` is mounted otherwise, or was calibrated again: no convention error explains it")
        }
    });
    change
}

/// The relation that turns the first into the second, where there is one.
fn explain(change: &mut Change, found: &Classification, otherwise: impl FnOnce() -> String) {
    change.explanation = match found.error() {
        Some(relation) => {
            let also: Vec<&str> = found.class.iter().skip(1).map(|other| other.word()).collect();
            let also = if also.is_empty() {
                String::new()
            } else {
                format!(" (indistinguishable here: {})", also.join(", "))
            };
            change.relation = Some(relation.word());
            format!("{}: {}{also}", relation.word(), relation.describe())
        }
        None if found.best == Some(Relation::Equal) => "a small correction, as a new calibration gives".to_owned(),
        None => otherwise(),
    };
}

/// Frames that only one has, and frames that hang on another parent or became moving or rigid.
fn frames(a: &Tree, b: &Tree, out: &mut Comparison) {
    let listed = |frames: Vec<&FrameId>| {
        frames
            .iter()
            .map(|frame| format!("`{frame}`"))
            .collect::<Vec<_>>()
            .join(", ")
    };
    for (first, second, words) in [(a, b, "is gone"), (b, a, "is new")] {
        for frame in first.frames.difference(&second.frames) {
            let parents = listed(first.parents.get(frame).into_iter().flatten().collect());
            let below = if parents.is_empty() {
                String::new()
            } else {
                format!(", on {parents}")
            };
            let message = format!("`{frame}` {words}{below}");
            out.changes
                .push(Change::new(Kind::Transform, format!("`{frame}`"), message));
        }
    }
    for frame in a.frames.intersection(&b.frames) {
        let (before, after) = (a.parents.get(frame), b.parents.get(frame));
        if let (Some(before), Some(after)) = (before, after) {
            if before != after {
                let message = format!(
                    "`{frame}` hangs on {} instead of {}",
                    listed(after.iter().collect()),
                    listed(before.iter().collect())
                );
                out.changes
                    .push(Change::new(Kind::Transform, format!("`{frame}`"), message));
            } else if a.moving.contains(frame) != b.moving.contains(frame) {
                let (before, after) = if a.moving.contains(frame) {
                    ("moving", "rigid")
                } else {
                    ("rigid", "moving")
                };
                let message = format!("`{frame}` is {after}, and was {before}");
                out.changes
                    .push(Change::new(Kind::Transform, format!("`{frame}`"), message));
            }
        }
    }
}

/// What files beside the tree state: the same pair of frames in both.
fn files(a: &Run, b: &Run, out: &mut Comparison) {
    let (before, after) = (statements(a), statements(b));
    for (pair, first) in &before {
        let turned = (pair.1.clone(), pair.0.clone());
        let second = after.get(pair).map(|stated| (stated, stated.pose));
        let second = second.or_else(|| after.get(&turned).map(|stated| (stated, stated.pose.inverse())));
        let Some((second, pose)) = second else { continue };
        out.transforms += 1;
        let found = classify(&first.pose, &pose, &Tolerance::default());
        if found.angle_rad <= SAME_RAD && found.distance_m <= SAME_M {
            continue;
        }
        let mut change = Change::new(
            Kind::Transform,
            format!("`{}` from `{}` in files", pair.0, pair.1),
            format!("the calibration is {}", amount(found.angle_rad, found.distance_m)),
        );
        change.measured = measured(found.angle_rad, found.distance_m);
        change.stated = [first.who.clone(), second.who.clone()];
        explain(&mut change, &found, || {
            "calibrated again, or mounted otherwise: no convention error explains it".to_owned()
        });
        out.changes.push(change);
    }
}

/// Whole transforms of files, by their frames; of several about one pair the first.
fn statements(run: &Run) -> BTreeMap<Pair, Stated> {
    let mut found: BTreeMap<Pair, Stated> = BTreeMap::new();
    for claim in run.worlds.iter().flat_map(|world| &world.claims) {
        let (ClaimKind::File { .. }, Some(pose), Some((target, source))) = (&claim.kind, &claim.pose, &claim.frames)
        else {
            continue;
        };
        if !(claim.has_rotation && claim.has_translation) {
            continue;
        }
        let who = format!("`{}`, {}", claim.label, place_words(run, &claim.place));
        let stated = found.entry((target.canonical(), source.canonical()));
        stated
            .or_insert_with(|| Stated {
                pose: pose.isometry(),
                who: Vec::new(),
            })
            .who
            .push(who);
    }
    found
}

/// Where files put the origin of a map on the Earth.
fn origins(a: &Run, b: &Run, out: &mut Comparison) {
    let of = |run: &Run| -> BTreeMap<String, (EarthOrigin, String)> {
        let all = run.worlds.iter().flat_map(|world| &world.origins);
        all.map(|origin| {
            let words = format!("`{}`, {}", origin.label, place_words(run, &origin.place));
            (format!("{} {}", origin.format, origin.label), (origin.clone(), words))
        })
        .collect()
    };
    let (before, after) = (of(a), of(b));
    for (key, (first, who_first)) in &before {
        let Some((second, who_second)) = after.get(key) else {
            continue;
        };
        out.transforms += 1;
        let place = |origin: &EarthOrigin| {
            let [latitude, longitude] = origin.latitude_longitude_deg?;
            Geodetic::from_degrees(latitude, longitude, origin.altitude_m.unwrap_or(0.0))
        };
        let (Some(from), Some(to)) = (place(first), place(second)) else {
            continue;
        };
        let offset = from.enu_of(&to);
        if offset.norm() <= SAME_M {
            continue;
        }
        let mut change = Change::new(
            Kind::Origin,
            format!("`{}`", first.label),
            format!(
                "the map origin moved by {:.3} m: {:.3} m east, {:.3} m north, {:.3} m up",
                offset.norm(),
                offset.x,
                offset.y,
                offset.z
            ),
        );
        change.measured = vec![Measured::new("moved by", offset.norm(), "m").limit(SAME_M)];
        change.stated = [vec![who_first.clone()], vec![who_second.clone()]];
        out.changes.push(change);
    }
}

/// The trees of a run, put together.
struct Tree<'r> {
    worlds: &'r [World],
    frames: BTreeSet<FrameId>,
    parents: BTreeMap<FrameId, BTreeSet<FrameId>>,
    /// Children of edges that move.
    moving: BTreeSet<FrameId>,
    rigid: BTreeMap<Pair, Stated>,
}

impl<'r> Tree<'r> {
    fn of(run: &'r Run) -> Self {
        let mut tree = Self {
            worlds: &run.worlds,
            frames: BTreeSet::new(),
            parents: BTreeMap::new(),
            moving: BTreeSet::new(),
            rigid: BTreeMap::new(),
        };
        for world in &run.worlds {
            let graph = world.graph();
            tree.frames.extend(graph.frames.iter().cloned());
            for edge in &graph.edges {
                tree.add(run, world, edge);
            }
        }
        tree
    }

    fn add(&mut self, run: &Run, world: &World, edge: &Edge) {
        let pair = (edge.parent.clone(), edge.child.clone());
        self.parents
            .entry(edge.child.clone())
            .or_default()
            .insert(edge.parent.clone());
        let who = match edge.origin {
            EdgeOrigin::Joint(index) | EdgeOrigin::Published(index) => world.claims.get(index).map(|claim| {
                let joint = match &claim.kind {
                    ClaimKind::Joint { joint, .. } => joint.as_str(),
                    ClaimKind::File { .. } => claim.label.as_str(),
                };
                format!("joint `{joint}`, {}", place_words(run, &claim.place))
            }),
            EdgeOrigin::Tf(bag, index) => world.bags.get(bag).and_then(|bag| {
                let edge = bag.tf.get(index)?;
                let path = run
                    .sources
                    .get(bag.source.0 as usize)
                    .map_or("?", |source| source.path.as_str());
                Some(format!("{}, {path}", edge.topic))
            }),
        };
        if !edge.is_rigid {
            self.moving.insert(edge.child.clone());
            return;
        }
        let Some(pose) = edge.pose else { return };
        let stated = self
            .rigid
            .entry(pair)
            .or_insert_with(|| Stated { pose, who: Vec::new() });
        if let Some(who) = who.filter(|who| !stated.who.contains(who)) {
            stated.who.push(who);
        }
    }

    /// `parent_from_child`, over any chain of rigid transforms.
    fn pose(&self, (parent, child): &Pair) -> Option<Isometry3<f64>> {
        let direct = self
            .rigid
            .get(&(parent.clone(), child.clone()))
            .map(|stated| stated.pose);
        direct.or_else(|| {
            self.worlds
                .iter()
                .find_map(|world| world.graph().chain(parent, child, |edge| edge.is_rigid))
                .map(|(pose, _)| pose)
        })
    }

    fn who(&self, pair: &Pair) -> Vec<String> {
        self.rigid
            .get(pair)
            .map(|stated| stated.who.clone())
            .unwrap_or_default()
    }
}
