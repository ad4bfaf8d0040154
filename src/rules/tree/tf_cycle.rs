//! TREE03: frames that are their own ancestor.

use std::collections::BTreeSet;

use crate::analysis::places::published_reading;
use crate::analysis::tree::loops::loops;
use crate::rules::prelude::*;
use crate::source::{SourceId, SourcePart};
use crate::world::{FrameId, World, graph::Edge};

pub(crate) struct TfCycle;

/// Frames of a loop that a headline names.
const SHOWN: usize = 4;

impl Rule for TfCycle {
    const NEEDS: &'static [Need] = &[Need::RobotTfOrLaunch];
    type Limits = NoLimits;

    fn judge(world: &Estimates, _limits: &NoLimits, out: &mut Judge) {
        let loops = loops(world);
        for (cycle, steps) in &loops {
            judge_cycle(world, cycle, steps, out);
        }
        let edges = world.graphs().map(|graph| graph.edges.len()).max().unwrap_or_default();
        if loops.is_empty() && edges > 0 {
            let none = Measured::count("loops", 0).limit(0.0).samples(edges as u64);
            out.pass("frame tree", [none]);
        }
    }
}

fn judge_cycle(world: &World, cycle: &[FrameId], steps: &[&Edge], out: &mut Judge) {
    let sources: BTreeSet<SourceId> = steps.iter().filter_map(|edge| edge.source(world)).collect();
    // The cycle lists each frame before its parent; it is shown from parent to child.
    let mut names: Vec<String> = cycle.iter().rev().map(|frame| format!("`{frame}`")).collect();
    if let Some(first) = names.first().cloned() {
        names.push(first);
    }
    let subject = format!("loop of {}", names.iter().min().map_or("?", String::as_str));
    let chain = names.join(" -> ");
    let why = "A loop has no root: look-ups in tf2 fail (\"contains a loop\").";
    let (message, detail) = if cycle.len() <= SHOWN {
        (format!("{chain} is a loop of {} frames", cycle.len()), why.to_owned())
    } else {
        let first = names.first().map_or("?", String::as_str);
        (
            format!("{first} is its own ancestor, in a loop of {} frames", cycle.len()),
            format!("{chain}. {why}"),
        )
    };
    let mut at: Vec<(&&Edge, Place)> = steps
        .iter()
        .filter_map(|edge| Some((edge, crate::analysis::places::of_edge(world, edge)?)))
        .collect();
    // A published transform, or else the one that was written last, closed the loop.
    let rank = |(edge, place): &(&&Edge, Place)| {
        (
            matches!(place.at, SourcePart::Message(_)),
            edge.is_published(),
            place.clone(),
        )
    };
    let last = (0..at.len()).max_by_key(|index| at.get(*index).map(rank));
    let Some((first, place)) = last.map(|index| at.remove(index)) else {
        return;
    };
    let last = format!("`{}` -> `{}`", first.parent, first.child);
    let joint = |edge: &Edge| {
        let claim = edge.claim(world).filter(|_| !edge.is_published())?;
        Some(format!("`{}` (now `{}`)", claim.label, edge.parent))
    };
    let all = std::iter::once(first).chain(at.iter().map(|(edge, _)| *edge));
    let joints: Option<Vec<String>> = all.map(|edge| joint(edge)).collect();
    let help = match (joints, at.as_slice()) {
        // Without one of the joints the robot would have two roots.
        (Some(joints), _) => format!(
            "correct the parent of the wrong joint, so that all links lead to the root of the robot: {}",
            joints.join(" or ")
        ),
        (None, [(other, _)]) => format!(
            "remove {last} if `{0}` -> `{1}` is right; otherwise remove `{0}` -> `{1}`",
            other.parent, other.child
        ),
        (None, _) => {
            format!("remove {last}; if {last} is right, remove the wrong one of the other transforms of the loop")
        }
    };
    let mut finding = Finding::error(subject, message, place)
        .label(format!("makes `{}` the parent of `{}`", first.parent, first.child))
        .detail(detail)
        .help(help)
        .measured(Measured::count("frames in the loop", cycle.len()).limit(0.0));
    for (edge, place) in at {
        finding = finding.related(place, format!("makes `{}` the parent of `{}`", edge.parent, edge.child));
    }
    // Sources that contradict each other may never have been used together.
    let finding = if sources.len() > 1 { finding.likely() } else { finding };
    out.fail(steps.iter().fold(finding, |finding, edge| {
        finding.confidence(published_reading(world, edge))
    }));
}
