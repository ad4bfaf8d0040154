//! TREE06: the order of `earth`, `map`, `odom` and the base, and sensors above the base.

use std::collections::{BTreeSet, VecDeque};

use crate::analysis::{names, names::Standard, places};
use crate::rules::prelude::*;
use crate::world::{FrameId, World, graph::FrameGraph};

pub(crate) struct Rep105Order;

impl Rule for Rep105Order {
    const NEEDS: &'static [Need] = &[Need::RobotOrTf];
    type Limits = NoLimits;

    fn judge(world: &Estimates, _limits: &NoLimits, out: &mut Judge) {
        let graph = world.graph();
        let (mut judged, mut failed) = (0, false);
        for frame in &graph.frames {
            let Some((namespace, kind)) = names::standard(frame) else {
                continue;
            };
            let parents = graph.parents_of(frame);
            if parents.is_empty() {
                continue;
            }
            judged += 1;
            let above = nearest_standard(graph, frame, namespace);
            let rank = above.as_ref().and_then(names::standard).map(|(_, rank)| rank);
            let finding = match above.as_ref().zip(rank) {
                Some((above, rank)) if rank > kind => reversed(world, frame, above),
                // Several parents are TREE02's: each of the others may be the right one.
                _ if kind != Standard::Base || parents.len() > 1 => None,
                above => past_odom(world, graph, frame, above, namespace)
                    .or_else(|| under_sensor(world, frame, parents.iter().find(|parent| names::is_sensor(parent))?)),
            };
            if let Some(finding) = finding {
                failed = true;
                out.fail(finding);
            }
        }
        if judged > 0 && !failed {
            out.pass(
                "frame order",
                [Measured::count("frames out of order", 0).limit(0.0).samples(judged)],
            );
        }
    }
}

/// The nearest ancestor that is a frame of REP-105 in the same namespace.
fn nearest_standard(graph: &FrameGraph, frame: &FrameId, namespace: &str) -> Option<FrameId> {
    let mut seen: BTreeSet<&FrameId> = BTreeSet::from([frame]);
    let mut queue: VecDeque<&FrameId> = graph.parents_of(frame).into_iter().collect();
    while let Some(above) = queue.pop_front() {
        if seen.insert(above) {
            if names::standard(above).is_some_and(|(space, _)| space == namespace) {
                return Some(above.clone());
            }
            queue.extend(graph.parents_of(above));
        }
    }
    None
}

/// A finding at the edge that gives `frame` its parent.
fn at_edge(world: &World, frame: &FrameId, severity: Severity, message: String) -> Option<Finding> {
    let mut edges = world.graph().edges_to(frame);
    let place = edges.find_map(|edge| places::of_edge(world, edge))?;
    let finding = Finding::new(severity, format!("frame `{frame}`"), message, place).likely();
    Some(finding.measured(Measured::count("frames out of order", 1).limit(0.0)))
}

fn reversed(world: &World, frame: &FrameId, above: &FrameId) -> Option<Finding> {
    let is_child = world.graph().parents_of(frame).contains(above);
    let kin = if is_child { "child" } else { "descendant" };
    let message = format!("`{frame}` is a {kin} of `{above}`; REP-105 requires earth -> map -> odom -> base_link");
    let finding = at_edge(world, frame, Severity::Error, message)?;
    Some(
        finding
            .label(format!("makes `{frame}` a {kin} of `{above}`"))
            .help(format!("publish the inverse transform, with `{frame}` as the parent")),
    )
}

fn past_odom(
    world: &World,
    graph: &FrameGraph,
    frame: &FrameId,
    above: Option<(&FrameId, Standard)>,
    namespace: &str,
) -> Option<Finding> {
    let (map, _) = above.filter(|(_, kind)| *kind == Standard::Map)?;
    let odom = graph
        .frames
        .iter()
        .find(|other| names::standard(other) == Some((namespace, Standard::Odom)))?;
    let message = format!("`{frame}` is a descendant of `{map}` but not of `{odom}` (REP-105: map -> odom -> base)");
    let finding = at_edge(world, frame, Severity::Warning, message)?;
    Some(
        finding
            .label(format!("makes `{frame}` a descendant of `{map}`"))
            .help(format!(
                "let the localizer publish `{map}` -> `{odom}` instead, so that `{odom}` -> `{frame}` stays smooth"
            )),
    )
}

fn under_sensor(world: &World, frame: &FrameId, sensor: &FrameId) -> Option<Finding> {
    let message = format!("sensor `{sensor}` is the parent of `{frame}`; the base should be the parent of its sensors");
    let finding = at_edge(world, frame, Severity::Warning, message)?;
    Some(finding.label(format!("makes `{frame}` a child of `{sensor}`")).help(format!(
        "publish the mounting transform as `{frame}` -> `{sensor}` (the inverse); then odometry can be the parent of the base"
    )))
}
