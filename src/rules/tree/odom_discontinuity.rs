//! TREE15: odometry that jumps or is reset.

use crate::analysis::tree::odometry::{Limits, StepBound, Stream, streams};
use crate::analysis::tree::steps::{outstanding, seconds, takes_turns};
use crate::rules::prelude::*;
use crate::world::{BagEvidence, FrameId, content::StepAt};

pub(crate) struct OdomDiscontinuity;

impl Rule for OdomDiscontinuity {
    const NEEDS: &'static [Need] = &[Need::Bag];
    type Limits = Limits;

    fn judge(world: &Estimates, limits: &Limits, out: &mut Judge) {
        for bag in &world.bags {
            for ((odom, child), streams) in streams(bag) {
                let subject = format!("odometry `{odom}` -> `{child}` of {}", world.path(bag.source));
                judge_streams(bag, (subject, &child), &streams, limits, out);
            }
        }
    }
}

fn judge_streams(
    bag: &BagEvidence,
    (subject, child): (String, &FrameId),
    streams: &[Stream],
    limits: &Limits,
    out: &mut Judge,
) {
    let steps = crate::math::stats::total(streams.iter().map(|stream| stream.steps.count));
    let takes_turns = streams.iter().any(|stream| takes_turns(stream.steps));
    if streams.iter().all(|stream| stream.steps.count < limits.min_steps) {
        return out.too_little(subject, format!("{steps} steps, {} are needed", limits.min_steps));
    }
    let bound = StepBound::of(streams);
    let jumps_of = |stream: &Stream| -> Vec<StepAt> {
        let enough = stream.steps.count >= limits.min_steps;
        let all = outstanding(stream.steps)
            .into_iter()
            .filter(|at| enough && bound.is_jump(&at.step, limits));
        all.cloned().collect()
    };
    let found: Vec<(&Stream, Vec<StepAt>)> = streams.iter().map(|stream| (stream, jumps_of(stream))).collect();
    let with_jumps: Vec<_> = found.into_iter().filter(|(_, jumps)| !jumps.is_empty()).collect();
    let Some(((stream, jumps), others)) = with_jumps.split_first() else {
        if takes_turns {
            let why = "two publishers alternate with different values, so its steps are not motion";
            return out.not_applicable(subject, why);
        }
        let all = streams.iter().flat_map(|stream| outstanding(stream.steps));
        // The step that is nearest to its limit.
        let ratio = all.map(|at| at.step.distance_m.min(at.step.surprise_m) / bound.limits(&at.step, limits).0);
        let largest = Measured::new("largest step over its limit", ratio.fold(0.0, f64::max), "1").limit(1.0);
        return out.pass(
            subject,
            [
                largest.samples(steps),
                Measured::new("largest speed", bound.speed, "m/s"),
            ],
        );
    };
    let mut finding = finding(bag, subject, stream, jumps, &bound, limits);
    if takes_turns {
        finding = finding.unless_about(codes::AUTH01, format!("{child}`"));
    }
    for (other, jumps) in others {
        if let Some(first) = jumps.first() {
            let place = Place::message(bag.source, first.after.at.clone());
            let times = if jumps.len() == 1 {
                "once".to_owned()
            } else {
                format!("{} times", jumps.len())
            };
            finding = finding.related(place, format!("`{}` jumps too, {times}", other.topic));
        }
    }
    out.fail(finding);
}

fn finding(
    bag: &BagEvidence,
    subject: String,
    stream: &Stream,
    jumps: &[StepAt],
    bound: &StepBound,
    limits: &Limits,
) -> Finding {
    let excess = |at: &StepAt| {
        let (m, rad) = bound.limits(&at.step, limits);
        (at.step.distance_m / m).max(at.step.angle_rad / rad)
    };
    let Some(worst) = jumps.iter().max_by(|a, b| excess(a).total_cmp(&excess(b))) else {
        return Finding::error(subject, "", Place::whole(bag.source));
    };
    let (m, rad) = bound.limits(&worst.step, limits);
    let since = bag
        .start_ns
        .map_or(0, |start| worst.after.at.log_ns.saturating_sub(start)) as f64
        / 1e9;
    let is_at_origin = |at: &StepAt| {
        let pose = at.after.pose.isometry();
        pose.translation.vector.norm() <= limits.origin && pose.rotation.angle() <= limits.origin
    };
    let is_reset = is_at_origin(worst);
    let what = if is_reset {
        "is reset to its origin:"
    } else {
        "jumps by"
    };
    let message = format!(
        "`{}` -> `{}` on `{}` {what} {:.2} m and {:.1} deg",
        stream.odom,
        stream.child,
        stream.topic,
        worst.step.distance_m,
        worst.step.angle_rad.to_degrees(),
    );
    let detail = format!(
        "The step takes {:.3} s, {since:.1} s after the start of the recording. The largest speed of this odometry is {:.2} m/s.",
        seconds(&worst.step),
        bound.speed,
    );
    let help = if is_reset {
        "keep the odometry running, or restart all that use it as well: `odom` must not jump (REP-105)"
    } else {
        "find what resets or corrects the odometry: `odom` may drift, but must not jump; corrections belong in `map` -> `odom` (REP-105)"
    };
    let mut finding = Finding::error(subject, message, Place::message(bag.source, worst.after.at.clone()))
        .likely()
        .label("first sample after the jump")
        .detail(detail)
        .help(help)
        .related(
            Place::message(bag.source, worst.before.at.clone()),
            "last sample before it",
        )
        .measured(
            Measured::new("step", worst.step.distance_m, "m")
                .limit(m)
                .samples(stream.steps.count),
        )
        .measured(
            Measured::new("rotation of the step", worst.step.angle_rad.to_degrees(), "deg").limit(rad.to_degrees()),
        )
        .measured(Measured::count("jumps", jumps.len()).limit(0.0));
    if is_reset {
        finding = finding.relation("reset");
    }
    let others = jumps.iter().filter(|at| at.after.at != worst.after.at).take(4);
    others.fold(finding, |finding, at| {
        finding.related(
            Place::message(bag.source, at.after.at.clone()),
            format!("jump of {:.2} m", at.step.distance_m),
        )
    })
}
