//! Transforms of two platforms: which are gone, new or changed, and whether one frame moved or all children of another.

use std::borrow::Cow;
use std::collections::{BTreeMap, BTreeSet};

use nalgebra::{Isometry3, Translation3, UnitQuaternion};

use crate::math::geodesy::Geodetic;
use crate::math::relation::{Classification, Relation, Tolerance, classify};
use crate::run::Run;
use crate::source::Place;
use crate::verdict::Measured;
use crate::world::graph::{Edge, EdgeOrigin};
use crate::world::{ClaimKind, EarthOrigin, FrameId, World};

use super::{Change, Comparison, Kind, place_words};

/// Less is rounding by printing and reading (TREE11 warns from here).
const SAME_RAD: f64 = 0.05 * std::f64::consts::PI / 180.0;
/// Metres.
const SAME_M: f64 = 0.001;

/// Names of map frames.
const MAPS: [&str; 6] = ["map", "world", "earth", "utm", "enu", "local_enu"];

type Pair = (FrameId, FrameId);

/// A rigid transform that a source states.
#[derive(Clone)]
struct StatedTransform {
    /// Joint, topic or key: what identifies it in the other platform.
    label: String,
    /// `parent_from_child`; the identity in what is not stated.
    pose: Isometry3<f64>,
    /// Whether a rotation and a translation are stated.
    has: [bool; 2],
    /// Where it is stated, in words.
    who: String,
}

/// One transform before and after, and who states it.
struct TransformPair {
    before: Isometry3<f64>,
    after: Isometry3<f64>,
    /// Whether a relation may explain the difference: both state all of it.
    is_whole: bool,
    who: [Vec<String>; 2],
}

impl TransformPair {
    fn found(&self) -> Classification {
        classify(&self.before, &self.after, &Tolerance::default())
    }

    fn is_changed(&self) -> bool {
        !is_same(&self.before, &self.after)
    }
}

/// The statements of one pair of frames before and after: those with the same label are compared with each other, else the first ones.
/// Equal ones are merged.
fn held(before: &[StatedTransform], after: &[StatedTransform]) -> Vec<TransformPair> {
    let labels: BTreeSet<&str> = before.iter().chain(after).map(|one| one.label.as_str()).collect();
    let of = |all: &'_ [StatedTransform], label: &str| all.iter().position(|one| one.label == label).unwrap_or(0);
    let mut held: Vec<TransformPair> = Vec::new();
    for label in labels {
        let (Some(a), Some(b)) = (before.get(of(before, label)), after.get(of(after, label))) else {
            continue;
        };
        let has = [a.has[0] && b.has[0], a.has[1] && b.has[1]];
        if has == [false, false] {
            continue;
        }
        let part = |pose: &Isometry3<f64>| {
            let rotation = if has[0] {
                pose.rotation
            } else {
                UnitQuaternion::identity()
            };
            let translation = if has[1] {
                pose.translation
            } else {
                Translation3::identity()
            };
            Isometry3::from_parts(translation, rotation)
        };
        let (before, after) = (part(&a.pose), part(&b.pose));
        let is_whole = has == [true, true];
        let like = |one: &&mut TransformPair| {
            one.is_whole == is_whole && is_same(&one.before, &before) && is_same(&one.after, &after)
        };
        if let Some(known) = held.iter_mut().find(like) {
            for (known, who) in known.who.iter_mut().zip([&a.who, &b.who]) {
                if !known.contains(who) {
                    known.push(who.clone());
                }
            }
        } else {
            held.push(TransformPair {
                before,
                after,
                is_whole,
                who: [vec![a.who.clone()], vec![b.who.clone()]],
            });
        }
    }
    held
}

fn is_same(a: &Isometry3<f64>, b: &Isometry3<f64>) -> bool {
    (a.rotation.inverse() * b.rotation).angle() <= SAME_RAD
        && (a.translation.vector - b.translation.vector).norm() <= SAME_M
}

pub(super) fn compare(a: &Run, b: &Run, out: &mut Comparison) {
    let [named_a, named_b] = [a, b].map(by_name);
    if named_a.len() < 2 || named_a.len() != a.worlds.len() || !named_a.keys().eq(named_b.keys()) {
        let all = |run| Side {
            run,
            worlds: run.worlds.iter().collect(),
        };
        return compare_sides(&all(a), &all(b), out);
    }
    for (name, before) in named_a {
        let Some(after) = named_b.get(&name) else { continue };
        let known = out.changes.len();
        let one = |run, world| Side {
            run,
            worlds: vec![world],
        };
        compare_sides(&one(a, before), &one(b, *after), out);
        for change in out.changes.iter_mut().skip(known) {
            change.subject = format!("{name}: {}", change.subject);
            change.message = format!("{name}: {}", change.message);
        }
    }
}

/// One of the two, or one platform of it.
struct Side<'r> {
    run: &'r Run,
    worlds: Vec<&'r World>,
}

/// The platforms of a run by their names below the folder that holds all of them.
fn by_name(run: &Run) -> BTreeMap<String, &World> {
    let labels = || run.worlds.iter().map(|world| world.label.as_str());
    let first: Vec<&str> = labels().next().unwrap_or_default().split('/').collect();
    let common = |label: &str| label.split('/').zip(&first).take_while(|(a, b)| a == *b).count();
    let common = labels().map(common).min().unwrap_or_default();
    let name = |world: &World| world.label.split('/').skip(common).collect::<Vec<_>>().join("/");
    run.worlds.iter().map(|world| (name(world), world)).collect()
}

fn compare_sides(a: &Side, b: &Side, out: &mut Comparison) {
    let (tree_a, tree_b) = (Tree::of(a), Tree::of(b));
    frames(&tree_a, &tree_b, out);
    let mut moved: BTreeMap<&FrameId, Vec<(&Pair, TransformPair)>> = BTreeMap::new();
    let mut known: BTreeMap<&FrameId, usize> = BTreeMap::new();
    for (pair, before) in &tree_a.rigid {
        let Some(after) = tree_b.stated(pair) else { continue };
        out.transforms += 1;
        *known.entry(&pair.0).or_default() += 1;
        let changed = held(before, &after).into_iter().filter(TransformPair::is_changed);
        let changed: Vec<_> = changed.map(|one| (pair, one)).collect();
        if !changed.is_empty() {
            moved.entry(&pair.0).or_default().extend(changed);
        }
    }
    for (parent, children) in moved {
        let by = |held: &TransformPair| held.after * held.before.inverse();
        let is_whole = known.get(parent) == Some(&children.len()) && children.len() > 1;
        let first = children.first().map(|(_, held)| by(held));
        let alike = first.filter(|first| is_whole && children.iter().all(|(_, held)| is_near(first, &by(held))));
        if let Some(by) = alike {
            out.changes.push(parent_moved(parent, children, &by));
            continue;
        }
        out.changes
            .extend(children.into_iter().map(|(pair, held)| child_moved(pair, held)));
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
        Measured::new("rotated by", angle_rad.to_degrees(), "deg").limit(SAME_RAD.to_degrees()),
        Measured::new("moved by", distance_m, "m").limit(SAME_M),
    ]
}

fn amount(angle_rad: f64, distance_m: f64) -> String {
    let turned = format!("rotated by {:.3} deg", angle_rad.to_degrees());
    match (angle_rad > SAME_RAD, distance_m > SAME_M) {
        (true, true) => format!("{turned} and moved by {distance_m:.4} m"),
        (true, false) => turned,
        (false, _) => format!("moved by {distance_m:.4} m"),
    }
}

/// All children of a frame moved equally: that frame itself moved.
fn parent_moved(parent: &FrameId, children: Vec<(&Pair, TransformPair)>, by: &Isometry3<f64>) -> Change {
    let (angle, distance) = (by.rotation.angle(), by.translation.vector.norm());
    let names: Vec<String> = children.iter().map(|((_, child), _)| format!("`{child}`")).collect();
    let what = if is_map(parent) {
        "the map origin"
    } else {
        "the frame itself"
    };
    let mut change = Change::new(
        Kind::Transform,
        format!("`{parent}`"),
        format!(
            "all {} frames on `{parent}` are equally {}",
            children.len(),
            amount(angle, distance)
        ),
    );
    change.explanation = format!("{what} moved, not {}", names.join(", "));
    change.measured = measured(angle, distance);
    for (_, held) in children {
        for (all, who) in change.stated.iter_mut().zip(held.who) {
            all.extend(who);
        }
    }
    change
}

fn child_moved((parent, child): &Pair, held: TransformPair) -> Change {
    let found = held.found();
    let mut change = Change::new(
        Kind::Transform,
        format!("`{parent}` from `{child}`"),
        format!("`{child}` is {}", amount(found.angle_rad, found.distance_m)),
    );
    change.measured = measured(found.angle_rad, found.distance_m);
    change.stated = held.who;
    explain(&mut change, &found, || {
        if is_map(parent) {
            format!("the map origin moved, or `{child}` moved on the map")
        } else {
            format!("`{child}` was probably remounted or recalibrated: no convention error explains the change")
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
        None if found.best == Some(Relation::Equal) => "a small correction, probably a new calibration".to_owned(),
        None => otherwise(),
    };
}

/// Frames that only one has, and frames that have another parent or became moving or rigid.
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
                format!(" (parent {parents})")
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
                    "`{frame}` has the parent {} (was {})",
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
                let message = format!("`{frame}` is {after} (was {before})");
                out.changes
                    .push(Change::new(Kind::Transform, format!("`{frame}`"), message));
            }
        }
    }
}

/// Statements of files besides the tree: those that changed, and those that only one has.
fn files(a: &Side, b: &Side, out: &mut Comparison) {
    let (before, after) = (statements(a), statements(b));
    for (first, second, is_gone) in [(&before, &after, true), (&after, &before, false)] {
        for (subject, stated) in first.iter().filter(|(subject, _)| !second.contains_key(*subject)) {
            let what = if is_gone { "gone from" } else { "new in" };
            let mut change = Change::new(
                Kind::Transform,
                format!("{subject} in files"),
                format!("{subject} is {what} the files"),
            );
            let who = stated.iter().map(|one| one.who.clone()).collect();
            change.stated = if is_gone { [who, Vec::new()] } else { [Vec::new(), who] };
            out.changes.push(change);
        }
    }
    for (subject, first) in &before {
        let Some(second) = after.get(subject) else { continue };
        out.transforms += 1;
        for held in held(first, second).into_iter().filter(TransformPair::is_changed) {
            let found = held.found();
            let mut change = Change::new(
                Kind::Transform,
                format!("{subject} in files"),
                format!("{subject} in files is {}", amount(found.angle_rad, found.distance_m)),
            );
            change.measured = measured(found.angle_rad, found.distance_m);
            let otherwise = || "probably recalibrated or remounted: no convention error explains the change".to_owned();
            if held.is_whole {
                explain(&mut change, &found, otherwise);
            }
            change.stated = held.who;
            out.changes.push(change);
        }
    }
}

/// The statements of files, by their frames in words; where a file names none, by the key.
fn statements(side: &Side) -> BTreeMap<String, Vec<StatedTransform>> {
    let mut found: BTreeMap<String, Vec<StatedTransform>> = BTreeMap::new();
    let mut seen: BTreeSet<&Place> = BTreeSet::new();
    for claim in side.worlds.iter().flat_map(|world| &world.claims) {
        // A file may be judged with several robots.
        let (ClaimKind::File { .. }, Some(pose), true) = (&claim.kind, &claim.pose, seen.insert(&claim.place)) else {
            continue;
        };
        let has = [claim.has_rotation, claim.has_translation];
        let mut pose = pose.isometry();
        let subject = match &claim.frames {
            None => format!("`{}`", claim.label),
            Some((target, source)) => {
                let mut pair = [target.canonical(), source.canonical()];
                // Either may be stated as the inverse of the other; a part of one has no inverse.
                if pair[0] > pair[1] && has == [true, true] {
                    pair.reverse();
                    pose = pose.inverse();
                }
                format!("`{}` from `{}`", pair[0], pair[1])
            }
        };
        found.entry(subject).or_default().push(StatedTransform {
            label: claim.label.clone(),
            pose,
            has,
            who: format!("`{}`, {}", claim.label, place_words(side.run, &claim.place)),
        });
    }
    found
}

/// Where files put the origin of a map on the Earth.
fn origins(a: &Side, b: &Side, out: &mut Comparison) {
    let of = |side: &Side| -> BTreeMap<String, (EarthOrigin, String)> {
        let all = side.worlds.iter().flat_map(|world| &world.origins);
        all.map(|origin| {
            let words = format!("`{}`, {}", origin.label, place_words(side.run, &origin.place));
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

/// The trees of a run, combined.
struct Tree<'r> {
    worlds: Vec<&'r World>,
    frames: BTreeSet<FrameId>,
    parents: BTreeMap<FrameId, BTreeSet<FrameId>>,
    /// Children of edges that move.
    moving: BTreeSet<FrameId>,
    rigid: BTreeMap<Pair, Vec<StatedTransform>>,
}

impl<'r> Tree<'r> {
    fn of(side: &Side<'r>) -> Self {
        let mut tree = Self {
            worlds: side.worlds.clone(),
            frames: BTreeSet::new(),
            parents: BTreeMap::new(),
            moving: BTreeSet::new(),
            rigid: BTreeMap::new(),
        };
        for world in &side.worlds {
            let graph = world.graph();
            tree.frames.extend(graph.frames.iter().cloned());
            for edge in &graph.edges {
                tree.add(side.run, world, edge);
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
        if !edge.is_rigid {
            self.moving.insert(edge.child.clone());
            return;
        }
        let Some(pose) = edge.pose else { return };
        let statement = match edge.origin {
            EdgeOrigin::Joint(index) | EdgeOrigin::Published(index) => world.claims.get(index).map(|claim| {
                let label = match &claim.kind {
                    ClaimKind::Joint { joint, .. } => format!("joint `{joint}`"),
                    ClaimKind::File { .. } => claim.label.clone(),
                };
                (label, place_words(run, &claim.place))
            }),
            EdgeOrigin::Tf(..) => edge.origin.recorded(world).map(|(bag, tf)| {
                let source = run.sources.get(bag.source.0 as usize);
                (
                    tf.topic.clone(),
                    source.map_or("?", |source| source.path.as_str()).to_owned(),
                )
            }),
        };
        let Some((label, place)) = statement else { return };
        let stated = self.rigid.entry(pair).or_default();
        if !stated.iter().any(|known| known.label == label) {
            stated.push(StatedTransform {
                who: format!("{label}, {place}"),
                label,
                pose,
                has: [true, true],
            });
        }
    }

    /// The statements of a pair, or what follows from a chain of rigid transforms.
    fn stated(&self, (parent, child): &Pair) -> Option<Cow<'_, [StatedTransform]>> {
        if let Some(stated) = self.rigid.get(&(parent.clone(), child.clone())) {
            return Some(Cow::Borrowed(stated));
        }
        let chained = self
            .worlds
            .iter()
            .find_map(|world| world.graph().chain(parent, child, |edge| edge.is_rigid));
        let (pose, _) = chained?;
        Some(Cow::Owned(vec![StatedTransform {
            label: String::new(),
            pose,
            has: [true, true],
            who: "a chain of transforms".to_owned(),
        }]))
    }
}
