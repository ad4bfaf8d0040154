//! CROSS01: two sources state different transforms for one pair of frames.

use crate::analysis::{
    cross::notation::KeyNotations,
    cross::pair::{Pair, Statement},
    cross::statements::pairs,
};
use crate::rules::prelude::*;
use crate::world::{
    Claim, World,
    graph::{Edge, Step},
};

pub(crate) struct ExtrinsicConsistency;

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Limits {
    equal_deg: f64,
    equal_m: f64,
    warn_deg: f64,
    warn_m: f64,
}

impl Rule for ExtrinsicConsistency {
    const NEEDS: &'static [Need] = &[Need::Transforms];
    type Limits = Limits;

    fn judge(world: &Estimates, limits: &Limits, out: &mut Judge) {
        let pairs = pairs(world, out);
        let notations = KeyNotations::of(&pairs);
        for pair in pairs {
            judge_pair(world, pair, &notations, limits, out);
        }
    }
}

fn judge_pair(world: &World, mut pair: Pair, notations: &KeyNotations, limits: &Limits, out: &mut Judge) {
    let subject = pair.subject(world);
    let found = pair.classify();
    let (angle_deg, distance_m) = (found.angle_rad.to_degrees(), found.distance_m);
    let measured = [
        Measured::new("rotation difference", angle_deg, "deg")
            .turn()
            .limit(limits.equal_deg),
        Measured::new("translation difference", distance_m, "m").limit(limits.equal_m),
    ];
    if angle_deg <= limits.equal_deg && distance_m <= limits.equal_m {
        return out.pass(subject, measured);
    }
    if let Some(why) = &pair.repeats {
        return out.not_applicable(subject, why);
    }
    if pair.alternatives {
        let why = "the same key in two files of a folder may be of two devices or two versions: only convention errors are reported";
        return out.not_applicable(subject, why);
    }
    let is_row = |one: &Statement| one.claim(world).is_some_and(Claim::is_row);
    if pair.reference.place.source == pair.other.place.source && is_row(&pair.reference) && is_row(&pair.other) {
        let why =
            "rows of one table for one sensor may be of several cars or dates: only convention errors are reported";
        return out.not_applicable(subject, why);
    }
    let small = angle_deg <= limits.warn_deg && distance_m <= limits.warn_m;
    let (severity, help) = if small {
        (
            Severity::Warning,
            "use the newer calibration in both; if neither is newer, find out which one was measured",
        )
    } else {
        // Small differences are those of a new calibration.
        notations.confirm(&mut pair);
        (
            Severity::Error,
            "find out which of the two was measured, and use it in both",
        )
    };
    let [other, reference] = pair.names(world);
    let message = format!("{other} differs from {reference} by {angle_deg:.2} deg and {distance_m:.3} m");
    let [rotation, translation] = measured;
    let finding = Finding::new(severity, subject, message, pair.other.place.clone())
        .detail(pair.frames_stated() + &chain(world, &pair.other) + &chain(world, &pair.reference))
        .help(help)
        .unless(codes::CROSS02)
        .unless(codes::QUAT03)
        .measured(rotation)
        .measured(translation);
    out.fail(pair.point_at_all(finding));
}

/// The frames of a chain, as a sentence behind a space; nothing where a single statement has the transform.
fn chain(world: &World, one: &Statement) -> String {
    let graph = world.graph();
    let is_of_source = |edge: &Edge| edge.is_rigid && edge.source(world) == Some(one.place.source);
    let find = || graph.chain(&one.target, &one.source_frame, is_of_source);
    let Some((_, steps)) = one.is_chain().then(find).flatten() else {
        return String::new();
    };
    let step = |step: &Step| {
        let edge = graph.edges.get(step.edge)?;
        Some(if step.forward {
            format!(" -> `{}`", edge.child)
        } else {
            format!(" <- `{}`", edge.parent)
        })
    };
    let frames: String = steps.iter().filter_map(step).collect();
    format!(
        " The chain is `{}`{frames} in {}.",
        one.target,
        world.path(one.place.source)
    )
}
