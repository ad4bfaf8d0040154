//! The edges of a world with the statements of each source: URDF joints, TF of recordings, calibration files.

use std::collections::BTreeMap;

use nalgebra::Isometry3;

use crate::source::{Confidence, SourceId};
use crate::world::bag::TfEdge;
use crate::world::graph::{Edge, EdgeOrigin};
use crate::world::{Claim, ClaimKind, FrameId, Pose, World};

use super::super::text::{number, one_line};
use super::Names;

/// Rotations that differ by more are marked, radians (0.1 degrees: ten times what three printed decimals of a radian hide).
const SAME_ANGLE_RAD: f64 = 0.1 * std::f64::consts::PI / 180.0;
/// Translations that differ by more are marked, metres.
const SAME_DISTANCE_M: f64 = 0.001;

/// One source's statement of an edge.
pub(super) struct Statement {
    /// `robot.urdf:12 joint lidar_joint (fixed)`.
    pub(super) who: String,
    /// `parent_from_child`: constant, or the zero position or first sample of a moving one.
    pub(super) parent_from_child: Option<Isometry3<f64>>,
    /// Whether the pose never changed.
    pub(super) constant: bool,
    /// The kind of pose, if it is not constant.
    pub(super) moment: &'static str,
    /// How it differs from the first constant statement.
    pub(super) differs: Option<String>,
}

/// All statements of one parent and one child.
pub(super) struct Link {
    pub(super) statements: Vec<Statement>,
}

/// The edges of a world by parent and child.
pub(super) struct Links<'a> {
    pub(super) of: BTreeMap<(&'a FrameId, &'a FrameId), Link>,
    children: BTreeMap<&'a FrameId, Vec<&'a FrameId>>,
    /// Transforms in files between frames that are not parent and child: `` `camera` from `lidar` `` with its place.
    pub(super) beside: BTreeMap<String, Vec<String>>,
}

impl Link {
    /// Whether two sources state different poses.
    pub(super) fn is_disputed(&self) -> bool {
        self.statements.iter().any(|statement| statement.differs.is_some())
    }

    /// Whether no statement is constant.
    pub(super) fn moves(&self) -> bool {
        !self.statements.iter().any(|statement| statement.constant)
    }

    /// The statement whose pose is shown: the first constant one, else the first that has a pose.
    pub(super) fn leading(&self) -> Option<&Statement> {
        let posed = || {
            self.statements
                .iter()
                .filter(|statement| statement.parent_from_child.is_some())
        };
        posed().find(|statement| statement.constant).or_else(|| posed().next())
    }
}

impl<'a> Links<'a> {
    pub(super) fn new(world: &'a World, names: &Names, times: &str) -> Self {
        let types = joint_types(world);
        let mut of: BTreeMap<(&FrameId, &FrameId), Link> = BTreeMap::new();
        for edge in &world.whole().edges {
            if let Some(statement) = statement(world, edge, &types, names, times) {
                of.entry((&edge.parent, &edge.child))
                    .or_insert_with(|| Link { statements: Vec::new() })
                    .statements
                    .push(statement);
            }
        }
        let beside = calibrations(world, names, &mut of);
        let mut children: BTreeMap<&FrameId, Vec<&FrameId>> = BTreeMap::new();
        for ((parent, child), link) in &mut of {
            children.entry(parent).or_default().push(child);
            mark_differences(&mut link.statements);
        }
        Self { of, children, beside }
    }

    pub(super) fn get(&self, parent: &'a FrameId, child: &'a FrameId) -> Option<&Link> {
        self.of.get(&(parent, child))
    }

    pub(super) fn children(&self, parent: &FrameId) -> &[&'a FrameId] {
        self.children.get(parent).map_or(&[], Vec::as_slice)
    }
}

/// Adds the statements of calibration files to their edges, and returns the others.
fn calibrations<'a>(
    world: &'a World,
    names: &Names,
    of: &mut BTreeMap<(&'a FrameId, &'a FrameId), Link>,
) -> BTreeMap<String, Vec<String>> {
    let frames = &world.whole().frames;
    let mut beside: BTreeMap<String, Vec<String>> = BTreeMap::new();
    for claim in &world.claims {
        let (ClaimKind::File { .. }, Some((target, source)), false) =
            (&claim.kind, &claim.frames, claim.is_published())
        else {
            continue;
        };
        let who = one_line(&format!("{} {}", names.line(&claim.place), claim.label));
        let target_from_source = claim.pose.as_ref().map(Pose::isometry);
        let known = frames.get(&target.canonical()).zip(frames.get(&source.canonical()));
        let stated = known.map(|(target, source)| {
            if of.contains_key(&(target, source)) {
                ((target, source), target_from_source)
            } else {
                ((source, target), target_from_source.map(|pose| pose.inverse()))
            }
        });
        match stated.and_then(|(pair, pose)| of.get_mut(&pair).zip(Some(pose))) {
            // Half a transform, or one whose direction is a guess, is named but not compared.
            Some((link, parent_from_child)) => link.statements.push(Statement {
                who: format!("{who} (calibration)"),
                parent_from_child,
                constant: claim.has_rotation && claim.has_translation && claim.reading > Confidence::Hint,
                moment: "calibration",
                differs: None,
            }),
            None => beside.entry(one_line(&claim.name())).or_default().push(who),
        }
    }
    beside
}

/// Types of joints as written, by source and name.
fn joint_types(world: &World) -> BTreeMap<(SourceId, &str), &str> {
    world
        .robots
        .iter()
        .flat_map(|robot| {
            robot
                .joints
                .iter()
                .map(|joint| ((robot.source, joint.name.value.as_str()), joint.kind.value.as_str()))
        })
        .collect()
}

fn statement(
    world: &World,
    edge: &Edge,
    types: &BTreeMap<(SourceId, &str), &str>,
    names: &Names,
    times: &str,
) -> Option<Statement> {
    match edge.origin {
        EdgeOrigin::Joint(index) => {
            let claim = world.claims.get(index)?;
            Some(joint_statement(claim, edge, types, names))
        }
        EdgeOrigin::Published(index) => {
            let claim = world.claims.get(index)?;
            Some(Statement {
                who: one_line(&format!("{} {} (published)", names.line(&claim.place), claim.label)),
                parent_from_child: edge.pose,
                constant: claim.reading > Confidence::Hint,
                moment: "perhaps",
                differs: None,
            })
        }
        EdgeOrigin::Tf(bag, index) => {
            let bag = world.bags.get(bag)?;
            let tf = bag.tf.get(index)?;
            Some(tf_statement(&names.name(bag.source), tf, edge, times))
        }
    }
}

fn joint_statement(claim: &Claim, edge: &Edge, types: &BTreeMap<(SourceId, &str), &str>, names: &Names) -> Statement {
    let name = match &claim.kind {
        ClaimKind::Joint { joint, .. } => joint.as_str(),
        ClaimKind::File { .. } => claim.label.as_str(),
    };
    let kind = types
        .get(&(claim.place.source, name))
        .copied()
        .unwrap_or(if edge.is_rigid { "fixed" } else { "moving" });
    Statement {
        who: one_line(&format!("{} joint {name} ({kind})", names.line(&claim.place))),
        parent_from_child: edge.pose,
        constant: edge.is_rigid,
        moment: "at zero",
        differs: None,
    }
}

fn tf_statement(path: &str, tf: &TfEdge, edge: &Edge, times: &str) -> Statement {
    let rate = if tf.is_static { None } else { rate_hz(tf) };
    let rate = rate.map_or_else(String::new, |hz| format!(" {} Hz", number(hz, 2)));
    // A joint publisher repeats fixed joints on /tf: a transform that never moved can be compared.
    let still = tf
        .extreme
        .as_ref()
        .is_some_and(|(_, angle_rad, distance_m)| *angle_rad <= SAME_ANGLE_RAD && *distance_m <= SAME_DISTANCE_M);
    Statement {
        who: one_line(&format!("{path} {}{rate} {times}{}", tf.topic, tf.count)),
        parent_from_child: edge.pose,
        constant: tf.is_static || (still && tf.count > 1),
        moment: "first sample",
        differs: None,
    }
}

/// From the median step, which gaps and sampling do not change; else from the whole duration.
fn rate_hz(tf: &TfEdge) -> Option<f64> {
    let step_ns = tf
        .stamps
        .median_step_ns
        .filter(|step| *step > 0)
        .map(|step| step as f64)
        .or_else(|| {
            let length = tf.last_at.log_ns.checked_sub(tf.first_at.log_ns)?;
            (length > 0 && tf.count > 1).then(|| length as f64 / (tf.count - 1) as f64)
        })?;
    Some(1e9 / step_ns)
}

fn mark_differences(statements: &mut [Statement]) {
    let Some(first) = statements
        .iter()
        .find(|statement| statement.constant && statement.parent_from_child.is_some())
        .and_then(|statement| statement.parent_from_child)
    else {
        return;
    };
    for statement in statements.iter_mut().filter(|statement| statement.constant) {
        if let Some(other) = statement.parent_from_child {
            let angle_rad = first.rotation.angle_to(&other.rotation);
            let distance_m = (first.translation.vector - other.translation.vector).norm();
            if angle_rad > SAME_ANGLE_RAD || distance_m > SAME_DISTANCE_M {
                statement.differs = Some(format!(
                    "differs by {} deg, {} m",
                    number(angle_rad.to_degrees(), 3),
                    number(distance_m, 3)
                ));
            }
        }
    }
}
