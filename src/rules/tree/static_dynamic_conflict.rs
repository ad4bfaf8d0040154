//! TREE05: transforms published both on `/tf_static` and on `/tf`, and transforms on `/tf` that never change.

use crate::analysis::relate::{Difference, PoseTolerance};
use crate::analysis::tree::latched::explanation;
use crate::analysis::{names, tf};
use crate::rules::prelude::*;
use crate::world::{BagEvidence, FrameId, World, bag::TfEdge, robot::Joint};

pub(crate) struct StaticDynamicConflict;

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Limits {
    /// Rotation up to which two transforms are equal, degrees.
    pub same_deg: f64,
    /// Translation up to which two transforms are equal, metres.
    pub same_m: f64,
    /// Deviation (radians and metres) below which an edge is constant.
    pub constant: f64,
    /// Transforms needed to call an edge constant.
    pub min_samples: u64,
    /// Time needed to call an edge constant, seconds.
    pub min_time_s: f64,
}

impl Rule for StaticDynamicConflict {
    const NEEDS: &'static [Need] = &[Need::Tf];
    type Limits = Limits;

    fn judge(world: &Estimates, limits: &Limits, out: &mut Judge) {
        for bag in world.bags.iter().filter(|bag| !bag.tf.is_empty()) {
            let mut failed = false;
            let children = tf::by_child(bag);
            for (child, edges) in &children {
                let conflict = pair(edges).map(|(fixed, moving)| conflict(bag, child, fixed, moving, limits));
                let finding = conflict.or_else(|| constant(world, bag, child, edges, limits));
                failed |= finding.is_some();
                if let Some(finding) = finding {
                    out.fail(finding);
                }
            }
            if !failed {
                let both = Measured::count("frames both latched and moving", 0).limit(0.0);
                let subject = format!("TF of {}", world.path(bag.source));
                out.pass(subject, both.samples(children.len() as u64));
            }
        }
    }
}

/// A latched and a moving edge with the same parent. With different parents it is TREE02's.
fn pair<'a>(edges: &[&'a TfEdge]) -> Option<(&'a TfEdge, &'a TfEdge)> {
    edges.iter().filter(|edge| edge.is_static).find_map(|fixed| {
        let same = |edge: &&&TfEdge| !edge.is_static && edge.parent.canonical() == fixed.parent.canonical();
        edges.iter().find(same).map(|moving| (*fixed, *moving))
    })
}

fn conflict(bag: &BagEvidence, child: &FrameId, fixed: &TfEdge, moving: &TfEdge, limits: &Limits) -> Finding {
    let pose = |edge: &TfEdge| edge.first().map(|sample| sample.pose.isometry());
    let (at, until) = (moving.first_at.clone(), fixed.first_at.clone());
    let parent = fixed.parent.canonical();
    let (one, other) = (&fixed.topic, &moving.topic);
    let what = format!("`{parent}` -> `{child}` is on `{one}` and on `{other}`");
    let same = PoseTolerance {
        deg: limits.same_deg,
        m: limits.same_m,
    };
    let difference = pose(fixed)
        .zip(pose(moving))
        .map(|(fixed, moving)| Difference::between(&fixed, &moving, same));
    let words = difference.as_ref().map_or("", |one| one.words.as_str());
    let how = words.split(" (").next().unwrap_or(words);
    let mut finding = Finding::error(format!("frame `{child}`"), format!("{what}{how}"), Place::message(bag.source, at))
        .label("first on the moving topic")
        .help(format!(
            "publish `{child}` only on `{one}` (only on `{other}` if `{child}` moves), with the value that fits the mounting: tf2 erases the history of a frame that changes between the two topics"
        ))
        .measured(Measured::count("kinds of topic", 2).limit(1.0))
        .related(Place::message(bag.source, until), "first on the latched topic");
    if let Some(difference) = difference {
        finding = finding.detail(explanation(&difference).trim_start());
        finding.measured.extend(difference.measured);
        finding.relation = difference.relation.map(str::to_owned);
    }
    finding
}

/// A note on a moving edge that never changes, if its joint or name shows that it is fixed.
fn constant(world: &World, bag: &BagEvidence, child: &FrameId, edges: &[&TfEdge], limits: &Limits) -> Option<Finding> {
    let [edge] = edges else { return None };
    let time_s = edge.last_at.log_ns.saturating_sub(edge.first_at.log_ns) as f64 / 1e9;
    let deviation = edge.extreme.as_ref().map_or(0.0, |(_, rad, m)| rad.max(*m));
    if edge.is_static || edge.first().is_none() || edge.count < limits.min_samples || time_s < limits.min_time_s {
        return None;
    }
    let stands_still = names::is_world(child) || names::standard(child).is_some() || names::is_moving_part(child);
    let joint = world.robots.iter().flat_map(|robot| &robot.joints).find(|joint| {
        let link = joint.child.as_ref();
        link.is_some_and(|link| FrameId::new(link.value.as_str()).canonical() == *child)
    });
    let meant_fixed = joint.map_or_else(|| !stands_still && names::is_sensor(child), Joint::is_fixed);
    if deviation >= limits.constant || !meant_fixed {
        return None;
    }
    let message = format!(
        "`{}` -> `{child}` never changes, but is published {} times on `{}` in {time_s:.0} s",
        edge.parent, edge.count, edge.topic
    );
    let place = Place::message(bag.source, edge.first_at.clone());
    let change = Measured::new("largest change", deviation, "rad or m").limit(limits.constant);
    let finding = Finding::note(format!("frame `{child}`"), message, place)
        .help(
            "publish it once on `/tf_static`: then late listeners have it for all times, and the recording is smaller",
        )
        .measured(change.samples(edge.count))
        .measured(Measured::new("duration of the data", time_s, "s").at_least(limits.min_time_s));
    Some(if joint.is_some() { finding } else { finding.likely() })
}
