//! Loops of the frame tree.

use std::collections::BTreeSet;

use crate::world::graph::{Edge, EdgeOrigin, FrameGraph};
use crate::world::{FrameId, World};

/// The loops that TREE03 reports: their frames, each before its parent, and the edges from each frame up to the next.
pub(crate) fn loops(world: &World) -> Vec<(Vec<FrameId>, Vec<&Edge>)> {
    let of = |graph| of_graph(world, graph);
    let mut loops = of(world.graph());
    for graph in world.launched() {
        let is_new = |frames: &Vec<FrameId>| !loops.iter().any(|(known, _)| known == frames);
        let new: Vec<_> = of(graph).into_iter().filter(|(frames, _)| is_new(frames)).collect();
        loops.extend(new);
    }
    loops
}

fn of_graph<'w>(world: &'w World, graph: &'w FrameGraph) -> Vec<(Vec<FrameId>, Vec<&'w Edge>)> {
    graph
        .cycles()
        .into_iter()
        // A frame that is its own parent is TREE04's.
        .filter(|cycle| cycle.len() > 1)
        .filter_map(|cycle| {
            let steps = steps(graph, &cycle)?;
            all_at_once(world, &steps).then_some((cycle, steps))
        })
        .collect()
}

/// The edges from each frame of the cycle up to the next one. Where several sources state a step, one that is shared by
/// most steps is taken, so that a loop inside one file is shown as one.
pub(crate) fn steps<'a>(graph: &'a FrameGraph, cycle: &[FrameId]) -> Option<Vec<&'a Edge>> {
    let step = |(child, parent): (&FrameId, &FrameId)| {
        let edges: Vec<&Edge> = graph.edges_to(child).filter(|edge| edge.parent == *parent).collect();
        (!edges.is_empty()).then_some(edges)
    };
    let choices: Vec<Vec<&Edge>> = cycle
        .iter()
        .zip(cycle.iter().cycle().skip(1))
        .map(step)
        .collect::<Option<_>>()?;
    let kind = |edge: &Edge| match edge.origin {
        EdgeOrigin::Joint(_) => (0, 0),
        EdgeOrigin::Tf(bag, _) => (1, bag),
        EdgeOrigin::Published(_) => (2, 0),
    };
    let kinds: BTreeSet<(u8, usize)> = choices.iter().flatten().map(|edge| kind(edge)).collect();
    let covered = |wanted: &(u8, usize)| {
        choices
            .iter()
            .filter(|edges| edges.iter().any(|edge| kind(edge) == *wanted))
            .count()
    };
    let best = kinds.iter().max_by_key(|wanted| covered(wanted)).copied()?;
    choices
        .iter()
        .map(|edges| edges.iter().find(|edge| kind(edge) == best).or(edges.first()).copied())
        .collect()
}

/// Whether the edges are valid at one time: TF edges must come from one recording (two may show two robots, or one robot
/// before and after a change) and have been published over a common time. A latched edge is valid from its first message on.
pub(crate) fn all_at_once(world: &World, steps: &[&Edge]) -> bool {
    let mut from = i64::MIN;
    let mut until = i64::MAX;
    let mut bags = BTreeSet::new();
    for edge in steps {
        if let Some((bag, tf)) = edge.origin.recorded(world) {
            bags.insert(bag.source);
            from = from.max(tf.first_at.log_ns);
            until = until.min(if tf.is_static { i64::MAX } else { tf.last_at.log_ns });
        }
    }
    bags.len() <= 1 && from <= until
}
