//! TREE03: frames that are their own ancestor.

use std::collections::BTreeSet;

use crate::rules::{Judge, Need, NoLimits, Rule, places};
use crate::source::{At, Place, SourceId};
use crate::verdict::{Finding, Measured};
use crate::world::graph::{Edge, EdgeOrigin, FrameGraph};
use crate::world::{FrameId, World};

/// TREE03.
pub struct TfCycle;

impl Rule for TfCycle {
    const PAGE: &'static str = include_str!("../../../rules/tree/tf-cycle.md");
    const NEEDS: &'static [Need] = &[Need::RobotOrTf];
    type Limits = NoLimits;

    fn judge(world: &World, _limits: &NoLimits, out: &mut Judge) {
        let graph = world.graph();
        let loops = loops(world);
        for (cycle, steps) in &loops {
            judge_cycle(world, cycle, steps, out);
        }
        if loops.is_empty() && !graph.edges.is_empty() {
            let none = Measured::count("loops", 0).limit(0.0).samples(graph.edges.len() as u64);
            out.pass("frame tree", [none]);
        }
    }
}

/// The loops that this rule reports: their frames, each before its parent, and the edges from each frame up to the next.
pub(super) fn loops(world: &World) -> Vec<(Vec<FrameId>, Vec<&Edge>)> {
    let graph = world.graph();
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
fn steps<'a>(graph: &'a FrameGraph, cycle: &[FrameId]) -> Option<Vec<&'a Edge>> {
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

/// Whether the edges hold at one time: TF edges must come from one recording (two may show two robots, or one robot
/// before and after a change) and have been published over a common time. A latched edge holds from its first message on.
fn all_at_once(world: &World, steps: &[&Edge]) -> bool {
    let mut from = i64::MIN;
    let mut until = i64::MAX;
    let mut bags = BTreeSet::new();
    for edge in steps {
        if let EdgeOrigin::Tf(bag_index, index) = edge.origin
            && let Some(bag) = world.bags.get(bag_index)
            && let Some(tf) = bag.tf.get(index)
        {
            bags.insert(bag_index);
            from = from.max(tf.first_at.log_ns);
            until = until.min(if tf.is_static { i64::MAX } else { tf.last_at.log_ns });
        }
    }
    bags.len() <= 1 && from <= until
}

fn judge_cycle(world: &World, cycle: &[FrameId], steps: &[&Edge], out: &mut Judge) {
    let sources: BTreeSet<SourceId> = steps
        .iter()
        .filter_map(|edge| places::source_of_edge(world, edge))
        .collect();
    // The cycle lists each frame before its parent; people read from parent to child.
    let mut names: Vec<String> = cycle.iter().rev().map(|frame| format!("`{frame}`")).collect();
    if let Some(first) = names.first().cloned() {
        names.push(first);
    }
    let subject = format!("loop of {}", names.iter().min().map_or("?", String::as_str));
    let message = format!(
        "{} is a loop of {} frames: none of them has a root to be looked up from",
        names.join(" -> "),
        cycle.len()
    );
    let mut at: Vec<(&&Edge, Place)> = steps
        .iter()
        .filter_map(|edge| Some((edge, places::of_edge(world, edge)?)))
        .collect();
    // What was published, or else written last, closed the loop.
    let rank = |place: &Place| (matches!(place.at, At::Message(_)), place.clone());
    let last = (0..at.len()).max_by_key(|index| at.get(*index).map(|(_, place)| rank(place)));
    let Some((first, place)) = last.map(|index| at.remove(index)) else {
        return;
    };
    let mut finding = Finding::error(subject, message, place)
        .label(format!("`{}` is put under `{}`", first.child, first.parent))
        .help("turn round or remove the transform that closes the loop; tf2 answers look-ups with \"contains a loop\"")
        .measured(Measured::count("frames in the loop", cycle.len()).limit(0.0));
    for (edge, place) in at {
        finding = finding.related(place, format!("`{}` is put under `{}`", edge.child, edge.parent));
    }
    // Sources that contradict each other may never have been used together.
    out.fail(if sources.len() > 1 { finding.likely() } else { finding });
}
