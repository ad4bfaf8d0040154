//! TREE10: transforms that are too infrequent for tf2 to interpolate between them.

use std::collections::BTreeSet;

use crate::analysis::{names, names::Standard, tf, tree::rate::Rate};
use crate::rules::prelude::*;
use crate::world::{BagEvidence, FrameId, bag::TfEdge, content::Step};

pub(crate) struct TfRateTooLow;

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Limits {
    min_steps: usize,
    min_moving: u64,
    max_undone: f64,
    max_error_m: f64,
    max_error_deg: f64,
}

impl Rule for TfRateTooLow {
    const NEEDS: &'static [Need] = &[Need::Bag, Need::Tf];
    type Limits = Limits;

    fn judge(world: &Estimates, limits: &Limits, out: &mut Judge) {
        for bag in &world.bags {
            let carrying = carrying(bag);
            let edges = bag.tf.iter().filter(|edge| !edge.is_static && !corrects(edge));
            for edge in edges.filter(|edge| carrying.contains(&edge.child.canonical())) {
                judge_edge(bag, edge, limits, out);
            }
        }
    }
}

/// The frames that data depend on: those of sensors and bases, and all their ancestors.
fn carrying(bag: &BagEvidence) -> BTreeSet<FrameId> {
    let by_child = tf::by_child(bag);
    let is_base = |frame: &&FrameId| matches!(names::standard(frame), Some((_, Standard::Base)));
    let sensors = tf::sensor_frames(bag).map(|(frame, _, _)| frame);
    let mut queue: Vec<FrameId> = by_child.keys().filter(is_base).cloned().chain(sensors).collect();
    let mut carrying = BTreeSet::new();
    while let Some(frame) = queue.pop() {
        if carrying.insert(frame.clone()) {
            let above = by_child.get(&frame).into_iter().flatten();
            queue.extend(above.map(|edge| edge.parent.canonical()));
        }
    }
    carrying
}

/// Whether an edge corrects a drift, such as `map` -> `odom`: it may jump, and does not carry the motion.
fn corrects(edge: &TfEdge) -> bool {
    let child = edge.child.canonical();
    matches!(names::standard(&child), Some((_, Standard::Odom | Standard::Map)))
}

fn judge_edge(bag: &BagEvidence, edge: &TfEdge, limits: &Limits, out: &mut Judge) {
    let subject = format!("rate of `{}` from `{}` on `{}`", edge.parent, edge.child, edge.topic);
    let steps = &edge.steps;
    if steps.moving == 0 && steps.count > 0 {
        return out.not_applicable(subject, format!("it does not move in {} steps", steps.count));
    }
    let is_known = |step: &&Step| step.surprise_m.is_finite() && step.surprise_rad.is_finite();
    let known: Vec<&Step> = steps.sample.iter().filter(is_known).collect();
    let rate = Rate::of(&known).filter(|_| known.len() >= limits.min_steps && steps.moving >= limits.min_moving);
    let Some(rate) = rate else {
        return out.too_little(
            subject,
            format!(
                "{} steps, {} of them moving: {} and {} are needed",
                steps.count, steps.moving, limits.min_steps, limits.min_moving
            ),
        );
    };
    let undone = steps.undone as f64 / steps.count.max(1) as f64;
    if undone > limits.max_undone {
        let why = format!(
            "{:.0} % of the steps are reversed by the next one: two publishers probably alternate",
            undone * 100.0
        );
        return out.not_applicable(subject, why);
    }
    let measured = rate.measured(limits.max_error_m, limits.max_error_deg);
    let times = (rate.error_m / limits.max_error_m).max(rate.error_deg / limits.max_error_deg);
    if times <= 1.0 {
        return out.pass(subject, measured);
    }
    let pair = format!("`{}` -> `{}`", edge.parent, edge.child);
    let (cause, help) = if rate.long_s > 3.0 * rate.usual_s {
        (
            format!("gaps of {:.2} s are too long", rate.long_s),
            format!(
                "look for dropped or delayed transforms: the median time between two transforms is only {:.2} s",
                rate.usual_s
            ),
        )
    } else {
        let (now, needed) = (1.0 / rate.usual_s, (times.sqrt() / rate.usual_s).ceil());
        (
            format!("{now:.1} Hz is too slow"),
            format!("publish {pair} at {needed:.0} Hz or more (now {now:.1} Hz)"),
        )
    };
    let message = format!(
        "{pair}: {cause}, interpolation is off by {:.3} m and {:.2} deg",
        rate.error_m, rate.error_deg
    );
    let first = steps.most_surprising.first();
    let place = first.map_or(&edge.first_at, |step| &step.after.at).clone();
    let finding = Finding::warning(subject, message, Place::message(bag.source, place))
        .likely()
        .label("largest deviation from a straight line")
        .detail(
            "tf2 interpolates linearly between two transforms. The error is how far a path with the measured acceleration is from that line.",
        )
        .help(help);
    out.fail(finding.measured(measured));
}
