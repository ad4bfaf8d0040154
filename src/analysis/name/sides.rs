//! Frames whose names differ only in a word for left and right, and where they are in the platform's base.
//!
//! Must not judge.

use std::collections::BTreeMap;

use nalgebra::{Isometry3, Vector3};

use crate::analysis::{names, places};
use crate::source::Place;
use crate::world::frame_words::{SIDES, pairs_of_sides};
use crate::world::graph::{Edge, EdgeOrigin};
use crate::world::{FrameId, World};

/// A frame in the base of its platform.
#[derive(Clone)]
pub(crate) struct Placed {
    pub(crate) frame: FrameId,
    pub(crate) base_from_frame: Isometry3<f64>,
    /// Whether its origin stays where it is in the base: only its own joint may move.
    pub(crate) stays: bool,
    /// Its transform from its parent; `None` where a file states it in the base.
    pub(crate) own: Option<Own>,
    pub(crate) place: Place,
}

/// The transform of a frame from its parent.
#[derive(Clone)]
pub(crate) struct Own {
    pub(crate) parent: FrameId,
    pub(crate) parent_from_frame: Isometry3<f64>,
    pub(crate) is_rigid: bool,
    /// The axis of its joint in the base, and the joint's limits, if it has both.
    turning: Option<(Vector3<f64>, [f64; 2])>,
}

/// A frame named left, and its counterpart.
pub(crate) struct Pair {
    pub(crate) left: Placed,
    pub(crate) right: Placed,
}

impl Pair {
    /// From the right one to the left one, in the base, metres.
    pub(crate) fn leftward(&self) -> Vector3<f64> {
        self.left.base_from_frame.translation.vector - self.right.base_from_frame.translation.vector
    }

    /// Whether both stay where they are in the base.
    pub(crate) fn stays(&self) -> bool {
        self.left.stays && self.right.stays
    }

    /// How far the left one is from the mirror image of the right one, metres.
    pub(crate) fn asymmetry_m(&self) -> f64 {
        off_mirror_m(&self.left.base_from_frame, &self.right.base_from_frame)
    }

    /// The coordinate of the transform from the parent that, negated in one of the two, makes them mirror images, with the asymmetry that
    /// remains, metres.
    pub(crate) fn negated(&self) -> Option<(&'static str, f64)> {
        let negated = |placed: &Placed, index: usize| {
            let own = placed.own.as_ref()?;
            let base_from_parent = placed.base_from_frame * own.parent_from_frame.inverse();
            let mut turned = own.parent_from_frame;
            let number = turned.translation.vector.get_mut(index)?;
            *number = -*number;
            Some(base_from_parent * turned)
        };
        let asymmetries = ["x", "y", "z"].into_iter().enumerate().filter_map(|(index, word)| {
            let left = off_mirror_m(&negated(&self.left, index)?, &self.right.base_from_frame);
            let right = off_mirror_m(&self.left.base_from_frame, &negated(&self.right, index)?);
            Some((word, left.min(right)))
        });
        asymmetries.min_by(|a, b| a.1.total_cmp(&b.1))
    }

    /// Whether the joints of the two turn as mirror images, by their axes in the base and their limits; `None` where the limits do not say.
    ///
    /// An axis is a pseudovector: its mirror image about the plane y = 0 is (-x, y, -z). Equal limits belong to that axis, limits with the other
    /// signs to its opposite.
    pub(crate) fn turns_alike(&self) -> Option<bool> {
        const ALIKE: f64 = 1e-3;
        const PARALLEL: f64 = 0.99;
        let turning = |placed: &Placed| placed.own.as_ref()?.turning;
        let ((left, [lower, upper]), (right, [other_lower, other_upper])) =
            (turning(&self.left)?, turning(&self.right)?);
        let along = Vector3::new(-left.x, left.y, -left.z).dot(&right);
        let is = |a: f64, b: f64| (a - b).abs() <= ALIKE;
        let same = is(lower, other_lower) && is(upper, other_upper);
        let opposite = is(lower, -other_upper) && is(upper, -other_lower);
        (same != opposite && along.abs() > PARALLEL).then_some((along > 0.0) == same)
    }

    /// The words of the left name without those for sides and corners: parts of one kind share them.
    pub(crate) fn kind(&self) -> Vec<String> {
        let mut words = self.left.frame.tokens();
        words.retain(|word| {
            !SIDES.iter().flatten().any(|side| side == word) && !matches!(word.as_str(), "front" | "rear")
        });
        words
    }

    /// Whether the left one, rotated in the base, sees the right one on its right, in its own axes (of a link, or optical).
    pub(crate) fn looks_backward(&self) -> bool {
        const MOSTLY: f64 = 0.7;
        let seen = self.left.base_from_frame.rotation.inverse() * -self.leftward();
        let is_turned = self.left.base_from_frame.rotation.angle() > 0.1;
        let (link, optical) = (-seen.y, seen.x);
        is_turned && link.max(optical) > MOSTLY * seen.norm()
    }
}

fn off_mirror_m(left: &Isometry3<f64>, right: &Isometry3<f64>) -> f64 {
    let (l, r) = (left.translation.vector, right.translation.vector);
    Vector3::new(l.x - r.x, l.y + r.y, l.z - r.z).norm()
}

/// The pairs of a platform in one base frame, by the frame tree or by one file.
pub(crate) struct Group {
    pub(crate) base: FrameId,
    pub(crate) pairs: Vec<Pair>,
}

impl Group {
    /// Whether the base is one by REP-105, not that of a gripper or an arm.
    pub(crate) fn is_of_whole_platform(&self) -> bool {
        is_standard(&self.base)
    }
}

/// All pairs of a world: those of the frame tree by base frame, then those that files state in a base frame.
pub(crate) fn groups(world: &World) -> Vec<Group> {
    let graph = world.graph();
    let mut open: BTreeMap<&FrameId, &FrameId> = pairs_of_sides(graph.frames.iter()).into_iter().collect();
    let mut groups = Vec::new();
    let is_root = |frame: &FrameId| graph.edges_to(frame).next().is_none();
    let is_body = |frame: &&FrameId| is_base_of_axes(frame) && (is_root(frame) || is_standard(frame));
    for base in graph.frames.iter().filter(is_body) {
        if open.is_empty() {
            break;
        }
        let usable = |edge: &Edge| edge.is_rigid || matches!(edge.origin, EdgeOrigin::Joint(_));
        let reached: BTreeMap<&FrameId, Isometry3<f64>> = graph.reach(base, usable).into_iter().collect();
        let placed = |frame: &FrameId| {
            let (edge, base_from_frame) = (graph.edges_to(frame).next()?, *reached.get(frame)?);
            Some(Placed {
                frame: frame.clone(),
                base_from_frame,
                stays: graph.rigid().between(base, &edge.parent).is_some(),
                own: Some(Own {
                    parent: edge.parent.clone(),
                    parent_from_frame: edge.pose?,
                    is_rigid: edge.is_rigid,
                    turning: turning(world, edge, &base_from_frame),
                }),
                place: places::of_numbers(world, edge)?,
            })
        };
        let mut pairs = Vec::new();
        for left in reached.keys() {
            let right = open.get(left).and_then(|right| placed(right));
            if let Some((left_placed, right)) = right.and_then(|right| Some((placed(left)?, right))) {
                open.remove(left);
                pairs.push(Pair {
                    left: left_placed,
                    right,
                });
            }
        }
        groups.push(Group {
            base: base.clone(),
            pairs,
        });
    }
    let mut stated: BTreeMap<_, Vec<Placed>> = BTreeMap::new();
    for claim in world
        .claims
        .iter()
        .filter(|claim| !claim.is_published() && claim.is_rigid())
    {
        let (Some(target), Some(frame), Some(pose)) = (claim.target(), claim.source_frame(), &claim.pose) else {
            continue;
        };
        if claim.has_translation && is_base_of_axes(target) && !graph.frames.contains(&frame.canonical()) {
            stated
                .entry((claim.place.source, target.canonical()))
                .or_default()
                .push(Placed {
                    frame: frame.canonical(),
                    base_from_frame: pose.isometry(),
                    stays: true,
                    own: None,
                    place: claim.place.clone(),
                });
        }
    }
    groups.extend(stated.into_iter().map(|((_, base), placed)| Group {
        base,
        pairs: pairs(&placed),
    }));
    groups.retain(|group| !group.pairs.is_empty());
    groups
}

/// The axis of an edge's joint in the base, and its limits.
fn turning(world: &World, edge: &Edge, base_from_frame: &Isometry3<f64>) -> Option<(Vector3<f64>, [f64; 2])> {
    let joint = places::joint_of(world, edge.claim(world)?)?;
    let limit = joint.limit.as_ref()?;
    let axis = Vector3::from(joint.axis.as_ref()?.array()?).try_normalize(f64::EPSILON)?;
    let limits = [limit.lower.as_ref()?.value, limit.upper.as_ref()?.value];
    Some((base_from_frame.rotation * axis, limits))
}

/// Whether a frame has x forward, y left, z up by its name (REP-105): it is the base of the whole platform, and declares no other axes.
fn is_base_of_axes(frame: &FrameId) -> bool {
    let tokens = frame.tokens();
    let is_of_side = tokens
        .iter()
        .any(|word| SIDES.iter().flatten().any(|side| side == word));
    let declares = tokens
        .iter()
        .any(|word| matches!(word.as_str(), "frd" | "ned" | "rfu" | "optical"));
    names::is_base(frame) && !is_of_side && !declares
}

fn is_standard(frame: &FrameId) -> bool {
    matches!(names::standard(frame), Some((_, names::Standard::Base)))
}

fn pairs(placed: &[Placed]) -> Vec<Pair> {
    let by_name: BTreeMap<&FrameId, &Placed> = placed.iter().rev().map(|one| (&one.frame, one)).collect();
    let of = |frame: &FrameId| by_name.get(frame).map(|placed| (*placed).clone());
    let pairs = pairs_of_sides(by_name.keys().copied()).into_iter();
    let pairs = pairs.filter_map(|(left, right)| {
        Some(Pair {
            left: of(left)?,
            right: of(right)?,
        })
    });
    pairs.collect()
}
