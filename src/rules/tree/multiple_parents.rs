//! TREE02: frames with more than one parent.

use std::collections::{BTreeMap, BTreeSet};

use crate::analysis::places::{self, published_reading};
use crate::analysis::{names, names::Standard, tf, tree::loops::loops};
use crate::rules::prelude::*;
use crate::world::graph::{Edge, FrameGraph};
use crate::world::{BagEvidence, FrameId, Robot, World, bag::TfEdge, robot::Joint};

pub(crate) struct MultipleParents;

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Limits {
    /// Changes of parent from which two broadcasters conflict ...
    pub min_switches: u64,
    /// ... if there are at least so many for each transform under the rarer parent.
    pub min_share: f64,
}

impl Rule for MultipleParents {
    const NEEDS: &'static [Need] = &[Need::RobotTfOrLaunch];
    type Limits = Limits;

    fn judge(world: &Estimates, limits: &Limits, out: &mut Judge) {
        for robot in &world.robots {
            judge_robot(world, robot, out);
        }
        // A transform that closes a loop always adds a second parent.
        let closing: BTreeSet<(FrameId, FrameId)> = loops(world)
            .iter()
            .flat_map(|(_, steps)| steps)
            .map(|edge| (edge.child.clone(), edge.parent.clone()))
            .collect();
        for bag in world.bags.iter().filter(|bag| !bag.tf.is_empty()) {
            judge_bag(world, bag, &closing, limits, out);
        }
        for launched in world.launched() {
            judge_launched(world, launched, &closing, out);
        }
    }
}

/// What a launch file publishes, in addition to the joints.
fn judge_launched(world: &World, launched: &FrameGraph, closing: &BTreeSet<(FrameId, FrameId)>, out: &mut Judge) {
    let published = || launched.edges.iter().filter(|edge| edge.is_published());
    let mut failed = false;
    let mut file = None;
    for edge in published() {
        file = file.or_else(|| edge.source(world));
        let child = &edge.child;
        // A frame that is its own parent is TREE04's; two publishers of one transform are AUTH01's.
        let others = launched
            .edges_to(child)
            .filter(|other| other.parent != edge.parent && other.parent != *child);
        let other = others.min_by_key(|other| other.origin);
        let (Some(other), Some(place)) = (other.filter(|_| edge.parent != *child), places::of_edge(world, edge)) else {
            continue;
        };
        // Of two published ones, one finding.
        if other.is_published() && other.origin > edge.origin {
            continue;
        }
        failed = true;
        // Of two published ones, the one with parent and child exchanged is the wrong one.
        let lone = [edge, other].map(|one| is_under_a_lone_sensor(world, launched, one));
        let (wrong, kept, place) = match places::of_edge(world, other) {
            Some(place) if lone == [false, true] => (other, edge, place),
            _ => (edge, other, place),
        };
        let mut finding = second_parent(wrong, kept, place, lone.contains(&true) && lone.contains(&false))
            .confidence(published_reading(world, edge))
            .confidence(published_reading(world, other));
        if let Some(place) = places::of_edge(world, kept) {
            finding = finding.related(place, format!("makes `{}` the parent of `{child}`", kept.parent));
        }
        let closes = [edge, other]
            .iter()
            .any(|edge| closing.contains(&(child.clone(), edge.parent.clone())));
        out.fail(if closes {
            finding.unless_about(codes::TREE03, format!("{child}`"))
        } else {
            finding
        });
    }
    if let (false, Some(file)) = (failed, file) {
        let several = Measured::count("frames with more than one parent", 0).limit(0.0);
        let judged = published().count() as u64;
        out.pass(format!("published by {}", world.path(file)), [several.samples(judged)]);
    }
}

/// The finding of a published edge whose child has another parent.
fn second_parent(edge: &Edge, kept: &Edge, place: Place, is_exchanged: bool) -> Finding {
    let (parent, child) = (&edge.parent, &edge.child);
    let subject = format!("frame `{child}`");
    let finding = if is_exchanged {
        let message =
            format!("`{parent}` is published as a parent of `{child}`: parent and child are probably exchanged");
        Finding::error(subject, message, place)
            .relation("exchanged")
            .detail(format!(
                "`{child}` already has the parent `{}`, and nothing else connects `{parent}`. With parent and child exchanged, both have one parent.",
                kept.parent
            ))
            .help(format!(
                "exchange parent and child of this line (`{child}` -> `{parent}`); if the numbers are those of `{child}` in `{parent}`, invert \
                 them, too"
            ))
    } else {
        let message = format!(
            "`{child}` is published under `{parent}`, but already has the parent `{}`",
            kept.parent
        );
        Finding::error(subject, message, place).help(one_parent(child, parent, &kept.parent))
    };
    finding
        .likely()
        .label(format!("makes `{parent}` the parent of `{child}`"))
        .measured(Measured::count("parents", 2).limit(1.0))
}

/// Whether the parent of a published edge is a sensor that nothing else connects, and its child has one other parent: with parent and
/// child exchanged, both have one parent, and the sensor is connected.
fn is_under_a_lone_sensor(world: &World, launched: &FrameGraph, edge: &Edge) -> bool {
    let sensor = &edge.parent;
    let is_mounted = names::is_device(sensor) || names::has_word(sensor, &["scan"]);
    // Frames that a node attaches to the world at run time.
    let is_located = names::is_world(sensor) || names::has_word(sensor, LOCATED);
    let is_own = |one: &Edge| one.parent == *sensor && one.child == edge.child;
    let is_alone = |graph: &FrameGraph| graph.edges_to(sensor).next().is_none() && graph.edges_from(sensor).all(is_own);
    edge.is_published()
        && is_mounted
        && !is_located
        && launched.parents_of(&edge.child).len() == 2
        && [launched, world.graph(), world.whole()].into_iter().all(is_alone)
}

/// Words of frames that localization observes, not of sensors on the platform.
const LOCATED: &[&str] = &["init", "pose", "tag", "marker", "tracker"];

/// How a frame that two transforms place keeps one parent, and both of these stay connected.
fn one_parent(child: &FrameId, a: &FrameId, b: &FrameId) -> String {
    use Standard::{Base, Map, Odom};
    let kind = |frame: &FrameId| names::standard(frame).map(|(_, kind)| kind);
    let (map, odom) = match [a, b, child].map(kind) {
        [Some(Map), Some(Odom), Some(Base)] => (a, b),
        [Some(Odom), Some(Map), Some(Base)] => (b, a),
        _ => {
            return format!(
                "remove one of the two transforms (a frame has one parent); to connect `{a}` and `{b}` with each other, publish a transform \
                 between these two"
            );
        }
    };
    format!("keep `{odom}` -> `{child}`, and publish `{map}` -> `{odom}` instead of `{map}` -> `{child}` (REP-105)")
}

fn judge_robot(world: &World, robot: &Robot, out: &mut Judge) {
    let mut children: BTreeMap<&str, Vec<&Joint>> = BTreeMap::new();
    for joint in &robot.joints {
        // Joints below conditions of a xacro that was not expanded are alternatives.
        if joint.is_conditional {
            continue;
        }
        // A joint of a link with itself gives it no parent: URDF02.
        let is_self = joint
            .parent
            .as_ref()
            .zip(joint.child.as_ref())
            .is_some_and(|(parent, child)| parent.value == child.value);
        if let Some(child) = joint.child.as_ref().filter(|child| !child.value.is_empty() && !is_self) {
            children.entry(&child.value).or_default().push(joint);
        }
    }
    let mut worst = 0;
    let mut failed = false;
    for (child, joints) in &children {
        worst = worst.max(joints.len());
        let [first, second, rest @ ..] = joints.as_slice() else {
            continue;
        };
        failed = true;
        let end = |joint: &Joint| joint.child.as_ref().map_or(&joint.place, |child| &child.place).clone();
        let message = format!("link `{child}` is the child of {} joints instead of one", joints.len());
        let detail = format!(
            "The joints are `{}`, `{}`{}.",
            first.name.value,
            second.name.value,
            if rest.is_empty() { "" } else { ", ..." },
        );
        let mut finding = Finding::error(format!("frame `{child}`"), message, end(second))
            .label("second joint with this child")
            .detail(detail)
            .help(
                "delete the joint that does not describe the real mounting, or give that joint a child link of its own",
            )
            .measured(Measured::count("joints with this child", joints.len()).limit(1.0))
            .related(end(first), "first joint with this child");
        for joint in rest {
            finding = finding.related(end(joint), "another joint with this child");
        }
        out.fail(finding);
    }
    if !failed && !children.is_empty() {
        let most = Measured::count("joints with the same child, at most", worst).limit(1.0);
        out.pass(
            format!("robot `{}` in {}", robot.name.value, world.path(robot.source)),
            [most],
        );
    }
}

fn judge_bag(
    world: &World,
    bag: &BagEvidence,
    closing: &BTreeSet<(FrameId, FrameId)>,
    limits: &Limits,
    out: &mut Judge,
) {
    let mut failed = false;
    let mut judged = 0;
    for (child, edges) in tf::by_child(bag) {
        judged += 1;
        // A frame that is its own parent is TREE04's.
        let parents = edges.iter().map(|edge| edge.parent.canonical());
        let parents: BTreeSet<FrameId> = parents.filter(|parent| *parent != child).collect();
        if child.as_str().is_empty() || parents.len() < 2 {
            continue;
        }
        failed = true;
        let outside = |parent: &&FrameId| !closing.contains(&(child.clone(), (*parent).clone()));
        let finding = judge_child(bag, &child, &edges, &parents, limits);
        // One of its two parents is below it, and closes a loop.
        let is_loop = parents.iter().filter(outside).count() < 2 && parents.len() == 2;
        out.fail(if is_loop {
            finding.unless_about(codes::TREE03, format!("{child}`"))
        } else {
            finding
        });
    }
    if !failed {
        let several = Measured::count("frames with more than one parent", 0).limit(0.0);
        out.pass(format!("TF of {}", world.path(bag.source)), [several.samples(judged)]);
    }
}

fn judge_child(
    bag: &BagEvidence,
    child: &FrameId,
    edges: &[&TfEdge],
    parents: &BTreeSet<FrameId>,
    limits: &Limits,
) -> Finding {
    let known = bag.parent_switches.iter().find(|switch| switch.child == *child);
    // Without a count of changes: edges whose times overlap alternate; otherwise one follows the other.
    let overlap =
        edges.iter().map(|edge| edge.first_at.log_ns).max() < edges.iter().map(|edge| edge.last_at.log_ns).min();
    let rarest = edges.iter().map(|edge| edge.count).min().unwrap_or(0);
    let switches = known.map_or(if overlap { 2 * rarest } else { 1 }, |switch| switch.switches);
    let is_fight = switches >= limits.min_switches && switches as f64 >= limits.min_share * rarest as f64;
    let is_latched = edges.iter().any(|edge| edge.is_static);
    let last = edges.iter().map(|edge| &edge.first_at).max_by_key(|at| at.log_ns);
    let place = known.map(|switch| &switch.at).or(last).cloned();
    let place = place.map_or_else(|| Place::whole(bag.source), |at| Place::message(bag.source, at));
    let subject = format!("frame `{child}`");
    let listed = tf::listed(parents);
    let finding = if is_latched {
        let message = format!("`{child}` has {} parents in TF: {listed}", parents.len());
        Finding::error(subject, message, place)
            .detail(
                "At least one of the parents is static. Listeners use the parent that they received last, and keep static transforms until they \
                 restart.",
            )
            .help("stop the node that publishes the wrong parent, and restart the listeners")
    } else if is_fight {
        let message = format!(
            "`{child}` switches {switches} times between {} parents in TF ({listed})",
            parents.len()
        );
        Finding::error(subject, message, place)
            .detail(
                "Two broadcasters publish the frame. tf2 stores transforms by child, and does not interpolate across a \
                 change of parent.",
            )
            .help("stop the broadcaster of the wrong parent (often a driver and a filter both publish odometry)")
    } else {
        let times = if switches == 1 {
            "once".to_owned()
        } else {
            format!("{switches} times")
        };
        let message = format!("`{child}` changes its parent {times} in TF ({listed})");
        Finding::note(subject, message, place).help(format!(
            "check that `{child}` is handed over on purpose; between the last transform with the old parent and the first with the new one, tf2 \
             does not interpolate, but holds the last pose on the old parent"
        ))
    };
    let mut finding = finding.measured(Measured::count("parents", parents.len()).limit(1.0));
    if !is_latched {
        let switches = Measured::new("changes of parent", switches as f64, "count");
        finding = finding.measured(if is_fight {
            switches.at_least(limits.min_switches as f64)
        } else {
            switches
        });
    }
    for parent in parents {
        if let Some(edge) = edges.iter().find(|edge| edge.parent.canonical() == *parent) {
            let kind = if edge.is_static {
                "static transform"
            } else {
                "transform"
            };
            let note = format!("first {kind} with parent `{parent}` ({} in total)", edge.count);
            let place = Place::message(bag.source, edge.first_at.clone());
            let is_primary = finding.places.first().is_some_and(|label| label.place == place);
            finding = if is_primary {
                finding.label(note)
            } else {
                finding.related(place, note)
            };
        }
    }
    finding
}
