//! TREE04: transforms of a frame to itself, and transforms without a frame.

use crate::rules::prelude::*;
use crate::source::{Confidence, SourceValue};
use crate::world::{BagEvidence, ClaimKind, FrameId, Robot, World};

pub(crate) struct SelfOrEmptyTransform;

impl Rule for SelfOrEmptyTransform {
    const NEEDS: &'static [Need] = &[Need::Transforms];
    type Limits = NoLimits;

    fn judge(world: &Estimates, _limits: &NoLimits, out: &mut Judge) {
        for bag in world.bags.iter().filter(|bag| !bag.tf.is_empty()) {
            judge_bag(world, bag, out);
        }
        for robot in world.robots.iter().filter(|robot| !robot.joints.is_empty()) {
            judge_robot(world, robot, out);
        }
        judge_files(world, out);
    }
}

/// What is wrong with a pair of names as tf2 sees it, the name that tf2 gives the fault, and what a broadcaster should set.
fn fault(parent: &FrameId, child: &FrameId) -> Option<(&'static str, &'static str, &'static str)> {
    let (parent, child) = (parent.canonical(), child.canonical());
    match (parent.as_str(), child.as_str()) {
        (_, "") => Some(("has no child frame", "TF_NO_CHILD_FRAME_ID", "child_frame_id")),
        ("", _) => Some(("has no parent frame", "TF_NO_FRAME_ID", "header.frame_id")),
        (parent, child) if parent == child => Some((
            "relates a frame to itself",
            "TF_SELF_TRANSFORM",
            "the real parent and the real child",
        )),
        _ => None,
    }
}

fn judge_bag(world: &World, bag: &BagEvidence, out: &mut Judge) {
    let mut failed = false;
    for edge in &bag.tf {
        let Some((what, word, missing)) = fault(&edge.parent, &edge.child) else {
            continue;
        };
        failed = true;
        let pair = format!("`{}` -> `{}`", edge.parent, edge.child);
        let message = format!("{pair} on `{}` {what}: tf2 drops the transform", edge.topic);
        let place = Place::message(bag.source, edge.first_at.clone());
        let subject = format!("{pair} on {}", edge.topic);
        let child = edge.child.canonical();
        let is_stripped = edge.parent != edge.child && edge.parent.canonical() == child;
        let slash = is_stripped.then(|| format!("tf2 strips the leading slash, so both names are `{child}`. "));
        out.fail(
            Finding::error(subject, message, place)
                .detail(format!("{}tf2 logs {word}.", slash.unwrap_or_default()))
                .help(format!(
                    "set {missing} in the broadcaster, or stop the broadcaster if this transform is not needed"
                ))
                .measured(Measured::new("dropped transforms", edge.count as f64, "count").limit(0.0)),
        );
    }
    if !failed {
        let edges = Measured::count("dropped transforms", 0).limit(0.0);
        let subject = format!("TF of {}", world.path(bag.source));
        out.pass(subject, edges.samples(bag.tf.len() as u64));
    }
}

/// Joints that name an empty link. A joint from a link to itself is refused by the URDF rules.
fn judge_robot(world: &World, robot: &Robot, out: &mut Judge) {
    let is_empty = |end: &&SourceValue<String>| FrameId::new(end.value.as_str()).canonical().as_str().is_empty();
    let mut failed = false;
    for joint in &robot.joints {
        for (end, role) in [(&joint.parent, "parent"), (&joint.child, "child")] {
            let Some(end) = end.as_ref().filter(is_empty) else {
                continue;
            };
            failed = true;
            let message = format!("joint `{}` has an empty {role} link", joint.name.value);
            out.fail(
                Finding::error(format!("joint `{}`", joint.name.value), message, end.place.clone())
                    .help(format!("name the link in <{role}>"))
                    .measured(Measured::count("empty names", 1).limit(0.0)),
            );
        }
    }
    if !failed {
        let joints = Measured::count("joints with an empty link name", 0).limit(0.0);
        let subject = format!("robot `{}` in {}", robot.name.value, world.path(robot.source));
        out.pass(subject, [joints.samples(robot.joints.len() as u64)]);
    }
}

fn judge_files(world: &World, out: &mut Judge) {
    let (mut judged, mut failed) = (0, false);
    // Frames that are guessed from a key prove nothing.
    for claim in world.claims.iter().filter(|claim| claim.reading != Confidence::Hint) {
        let (ClaimKind::File { .. }, Some((target, source))) = (&claim.kind, &claim.frames) else {
            continue;
        };
        judged += 1;
        let Some((what, ..)) = fault(target, source) else {
            continue;
        };
        failed = true;
        let message = format!("`{}` (`{target}` -> `{source}`) {what}", claim.label);
        let place = claim.source_place.clone().unwrap_or_else(|| claim.place.clone());
        let subject = format!("`{}` in {}", claim.label, world.path(claim.place.source));
        out.fail(
            Finding::error(subject, message, place)
                .help("name two different frames, or remove the entry")
                .measured(Measured::count("transforms without two frames", 1).limit(0.0)),
        );
    }
    if judged > 0 && !failed {
        let claims = Measured::count("transforms without two frames", 0).limit(0.0);
        out.pass("calibration files", claims.samples(judged));
    }
}
