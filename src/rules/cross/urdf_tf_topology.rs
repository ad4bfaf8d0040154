//! CROSS06: the TF tree of a recording contradicts the URDF.

use std::collections::BTreeMap;

use crate::rules::prelude::*;
use crate::world::{BagEvidence, FrameId, Robot, World, bag::TfEdge, robot::Joint};

pub(crate) struct UrdfTfTopology;

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Limits {
    moves_deg: f64,
    moves_m: f64,
}

impl Rule for UrdfTfTopology {
    const NEEDS: &'static [Need] = &[Need::Robot, Need::Tf];
    type Limits = Limits;

    fn judge(world: &Estimates, limits: &Limits, out: &mut Judge) {
        for robot in world.robots.iter().filter(|robot| robot.fragment.is_none()) {
            let joints: BTreeMap<FrameId, &Joint> = robot
                .joints
                .iter()
                .filter_map(|joint| Some((FrameId::new(&joint.child.as_ref()?.value).canonical(), joint)))
                .collect();
            for bag in world.bags.iter().filter(|bag| !bag.tf.is_empty()) {
                judge_bag(world, robot, &joints, bag, limits, out);
            }
        }
    }
}

fn judge_bag(
    world: &World,
    robot: &Robot,
    joints: &BTreeMap<FrameId, &Joint>,
    bag: &BagEvidence,
    limits: &Limits,
    out: &mut Judge,
) {
    let subject = format!("robot `{}` in {}", robot.name.value, world.path(bag.source));
    let shared: Vec<(&TfEdge, &Joint)> = bag
        .tf
        .iter()
        .filter_map(|edge| Some((edge, *joints.get(&edge.child.canonical())?)))
        .collect();
    if shared.is_empty() {
        let why = "no child frame of TF is a link of this robot: give the description that the recording was made with";
        return out.missing(subject, why);
    }
    let mut differing = 0;
    for (edge, joint) in &shared {
        let findings = [parent_differs(bag, edge, joint), fixed_moves(bag, edge, joint, limits)];
        for finding in findings.into_iter().flatten() {
            differing += 1;
            out.fail(finding);
        }
    }
    if differing == 0 {
        let differ = Measured::count("edges that differ", 0).limit(0.0);
        out.pass(subject, [differ, Measured::count("edges in both", shared.len())]);
    }
}

fn parent_differs(bag: &BagEvidence, edge: &TfEdge, joint: &Joint) -> Option<Finding> {
    let stated = joint.parent.as_ref()?;
    let parent = edge.parent.canonical();
    if FrameId::new(&stated.value).canonical() == parent {
        return None;
    }
    let message = format!(
        "the parent of `{}` is `{parent}` in TF, but `{}` in the URDF",
        edge.child, stated.value
    );
    let place = Place::message(bag.source, edge.first_at.clone());
    let finding = Finding::warning(format!("frame `{}`", edge.child), message, place)
        .detail("With both published, tf2 uses the parent that came last.")
        .label(format!("parent `{parent}` on `{}`", edge.topic))
        .related(stated.place.clone(), format!("parent of joint `{}`", joint.name.value))
        .help("publish the frame from one source only, and correct the other")
        .measured(Measured::count("parents stated", 2).limit(1.0));
    Some(finding)
}

fn fixed_moves(bag: &BagEvidence, edge: &TfEdge, joint: &Joint, limits: &Limits) -> Option<Finding> {
    let (sample, angle_rad, distance_m) = edge.extreme.as_ref()?;
    let angle_deg = angle_rad.to_degrees();
    if !joint.is_fixed() || (angle_deg <= limits.moves_deg && *distance_m <= limits.moves_m) {
        return None;
    }
    let message = format!(
        "joint `{}` is fixed, but `{}` moves on `{}` by up to {angle_deg:.2} deg, {distance_m:.3} m",
        joint.name.value, edge.child, edge.topic,
    );
    let rotation = Measured::new("rotation", angle_deg, "deg").limit(limits.moves_deg);
    let translation = Measured::new("translation", *distance_m, "m").limit(limits.moves_m);
    let place = Place::message(bag.source, sample.at.clone());
    let finding = Finding::warning(format!("frame `{}`", edge.child), message, place)
        .label("differs most from the first transform")
        .related(
            joint.kind.place.clone(),
            format!("joint `{}` is fixed here", joint.name.value),
        )
        .help("give the joint its real type in the URDF, or stop the node that publishes a moving transform")
        .measured([rotation, translation].map(|moved| moved.samples(edge.count)));
    Some(finding)
}
