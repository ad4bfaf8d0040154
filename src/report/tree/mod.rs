//! The frame tree of a run with who says what: text, Graphviz and Mermaid.
//!
//! This file turns a world into edges with their statements; the drawings stand beside it. It shows and judges nothing:
//! the mark on sources that differ is for the eye.

pub mod dot;
pub mod mermaid;
#[cfg(test)]
mod tests;
pub mod text;

use std::collections::{BTreeMap, BTreeSet};

use nalgebra::Isometry3;

use crate::run::Run;
use crate::source::SourceId;
use crate::world::bag::TfEdge;
use crate::world::graph::{Edge, EdgeOrigin};
use crate::world::{Claim, ClaimKind, FrameId, World};

use super::place::Locator;
use super::text::{number, one_line, trimmed};

/// Rotations that differ by more are marked, radians (0.1 degrees: ten times what three printed decimals of a radian hide).
const SAME_ANGLE_RAD: f64 = 0.1 * std::f64::consts::PI / 180.0;
/// Translations that differ by more are marked, metres.
const SAME_DISTANCE_M: f64 = 0.001;

/// One source's statement of an edge.
struct Statement {
    /// `robot.urdf:12 joint lidar_joint (fixed)`.
    who: String,
    /// `parent_from_child`: constant, or the zero position or first sample of a moving one.
    parent_from_child: Option<Isometry3<f64>>,
    /// Whether the pose holds for as long as was seen.
    constant: bool,
    /// What kind of pose it is, where it is not constant.
    moment: &'static str,
    /// How it differs from the first constant statement.
    differs: Option<String>,
}

/// All statements of one parent and one child.
struct Link {
    statements: Vec<Statement>,
}

/// The edges of a world by parent and child.
struct Links<'a> {
    of: BTreeMap<(&'a FrameId, &'a FrameId), Link>,
    children: BTreeMap<&'a FrameId, Vec<&'a FrameId>>,
}

impl Link {
    /// Whether two sources state different poses.
    fn is_disputed(&self) -> bool {
        self.statements.iter().any(|statement| statement.differs.is_some())
    }

    /// Whether no statement is constant.
    fn moves(&self) -> bool {
        !self.statements.iter().any(|statement| statement.constant)
    }

    /// The statement whose pose is shown: the first constant one, else the first that has a pose.
    fn leading(&self) -> Option<&Statement> {
        let posed = || {
            self.statements
                .iter()
                .filter(|statement| statement.parent_from_child.is_some())
        };
        posed().find(|statement| statement.constant).or_else(|| posed().next())
    }
}

impl<'a> Links<'a> {
    fn new(world: &'a World, locator: &Locator, times: &str) -> Self {
        let types = joint_types(world);
        let mut of: BTreeMap<(&FrameId, &FrameId), Link> = BTreeMap::new();
        for edge in &world.graph().edges {
            if let Some(statement) = statement(world, edge, &types, locator, times) {
                of.entry((&edge.parent, &edge.child))
                    .or_insert_with(|| Link { statements: Vec::new() })
                    .statements
                    .push(statement);
            }
        }
        let mut children: BTreeMap<&FrameId, Vec<&FrameId>> = BTreeMap::new();
        for ((parent, child), link) in &mut of {
            children.entry(parent).or_default().push(child);
            mark_differences(&mut link.statements);
        }
        Self { of, children }
    }

    fn get(&self, parent: &'a FrameId, child: &'a FrameId) -> Option<&Link> {
        self.of.get(&(parent, child))
    }

    fn children(&self, parent: &FrameId) -> &[&'a FrameId] {
        self.children.get(parent).map_or(&[], Vec::as_slice)
    }
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
    locator: &Locator,
    times: &str,
) -> Option<Statement> {
    match edge.origin {
        EdgeOrigin::Joint(index) => {
            let claim = world.claims.get(index)?;
            Some(joint_statement(claim, edge, types, locator))
        }
        EdgeOrigin::Tf(bag, index) => {
            let bag = world.bags.get(bag)?;
            let tf = bag.tf.get(index)?;
            Some(tf_statement(&locator.name(bag.source), tf, edge, times))
        }
    }
}

fn joint_statement(
    claim: &Claim,
    edge: &Edge,
    types: &BTreeMap<(SourceId, &str), &str>,
    locator: &Locator,
) -> Statement {
    let name = match &claim.kind {
        ClaimKind::Joint { joint, .. } => joint.as_str(),
        ClaimKind::File { .. } => claim.label.as_str(),
    };
    let kind = types
        .get(&(claim.place.source, name))
        .copied()
        .unwrap_or(if edge.is_rigid { "fixed" } else { "moving" });
    let place = locator.find(&claim.place);
    let source = locator.name(claim.place.source);
    let place = place
        .start
        .map_or_else(|| source.clone(), |at| format!("{source}:{}", at.line));
    Statement {
        who: one_line(&format!("{place} joint {name} ({kind})")),
        parent_from_child: edge.pose,
        constant: edge.is_rigid,
        moment: "at zero",
        differs: None,
    }
}

fn tf_statement(path: &str, tf: &TfEdge, edge: &Edge, times: &str) -> Statement {
    let rate = if tf.is_static { None } else { rate_hz(tf) };
    let rate = rate.map_or_else(String::new, |hz| format!(" {} Hz", number(hz, 2)));
    // A joint publisher repeats fixed joints on /tf: what never moved can be compared.
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

/// From the median step, which gaps and sampling do not move; else from the whole length.
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

/// `xyz 0.3 0 1.2 m, rpy 0 0 90 deg`, or `identity`. Fixed-axis roll, pitch, yaw: `R = Rz(yaw) Ry(pitch) Rx(roll)`.
fn pose_words(parent_from_child: &Isometry3<f64>) -> String {
    let t = parent_from_child.translation.vector;
    let (roll, pitch, yaw) = parent_from_child.rotation.euler_angles();
    let spell =
        |values: [f64; 3], decimals: usize| values.map(|value| trimmed(&format!("{value:.decimals$}"))).join(" ");
    let xyz = spell([t.x, t.y, t.z], 3);
    let rpy = spell([roll.to_degrees(), pitch.to_degrees(), yaw.to_degrees()], 2);
    if xyz == "0 0 0" && rpy == "0 0 0" {
        return "identity".to_owned();
    }
    format!("xyz {xyz} m, rpy {rpy} deg")
}

/// Frames that are named somewhere but stand in no tree, each with where: first those of messages, then those of files.
fn outsiders<'a>(world: &'a World, locator: &Locator) -> [BTreeMap<&'a str, Vec<String>>; 2] {
    let mut found = [BTreeMap::new(), BTreeMap::new()];
    let frames: &BTreeSet<FrameId> = &world.graph().frames;
    let [messages, files] = &mut found;
    for used in &world.frames {
        if used.role.in_tree() || frames.contains(&used.frame.canonical()) {
            continue;
        }
        let is_message = matches!(used.place.at, crate::source::At::Message(_));
        let list: &mut BTreeMap<&str, Vec<String>> = if is_message { messages } else { files };
        let place = match &used.place.at {
            crate::source::At::Message(message) => {
                format!("{} {}", locator.name(used.place.source), message.topic)
            }
            _ => locator.short(&used.place),
        };
        list.entry(used.frame.as_str())
            .or_default()
            .push(one_line(&format!("{place} ({})", used.role.words())));
    }
    for places in found.iter_mut().flat_map(BTreeMap::values_mut) {
        places.sort();
        places.dedup();
    }
    found
}

/// What a world is called: the paths of its robots, or of its first sources.
fn title(world: &World) -> String {
    let robots: BTreeSet<&str> = world.robots.iter().map(|robot| world.path(robot.source)).collect();
    let named = if robots.is_empty() {
        world.members.iter().map(|id| world.path(*id)).collect()
    } else {
        robots
    };
    let more = named.len().saturating_sub(3);
    let first: Vec<&str> = named.into_iter().take(3).collect();
    let more = if more > 0 {
        format!(" and {more} more")
    } else {
        String::new()
    };
    one_line(&format!("{}{more}", first.join(", ")))
}

/// Worlds that hold any frame.
fn worlds(run: &Run) -> impl Iterator<Item = &World> {
    run.worlds
        .iter()
        .filter(|world| !world.graph().frames.is_empty() || !world.frames.is_empty())
}

/// A frame's name for people.
fn shown(frame: &str) -> String {
    if frame.is_empty() {
        "(empty name)".to_owned()
    } else {
        one_line(frame)
    }
}
