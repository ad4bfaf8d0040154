//! TREE14: corrections of `map` -> `odom` that jump.

use crate::analysis::tree::corrections::{Jump, keepers, was_asked};
use crate::analysis::tree::steps::{of_moving, outstanding, takes_turns};
use crate::analysis::{names::Standard, tf};
use crate::rules::prelude::*;
use crate::world::bag::{TfEdge, TopicEvidence};
use crate::world::{BagEvidence, FrameId, World, content::Step};

pub(crate) struct MapOdomJump;

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Limits {
    /// Shift of the vehicle from which a correction is a jump, metres.
    pub jump_m: f64,
    /// Rotation from which a correction is a jump, degrees.
    pub jump_deg: f64,
    /// A correction is also a jump if it is so many times the 95th percentile ...
    pub times_usual: f64,
    /// ... and at least so large, metres ...
    pub least_m: f64,
    /// ... or degrees.
    pub least_deg: f64,
    /// Corrections needed for the percentile.
    pub min_corrections: u64,
    /// Largest time between an operator's `initialpose` and the jump that it causes, seconds.
    pub initial_pose_s: f64,
}

impl Rule for MapOdomJump {
    const NEEDS: &'static [Need] = &[Need::Tf];
    type Limits = Limits;

    fn judge(world: &Estimates, limits: &Limits, out: &mut Judge) {
        for bag in &world.bags {
            for edge in bag.tf.iter().filter(|edge| is_correction(edge)) {
                judge_edge(world, bag, edge, limits, out);
            }
        }
    }
}

fn is_correction(edge: &TfEdge) -> bool {
    let is = |frame: &FrameId, kind| tf::is_standard(&frame.canonical(), kind);
    !edge.is_static && is(&edge.parent, Standard::Map) && is(&edge.child, Standard::Odom)
}

fn judge_edge(world: &World, bag: &BagEvidence, edge: &TfEdge, limits: &Limits, out: &mut Judge) {
    let (parent, child) = (edge.parent.canonical(), edge.child.canonical());
    let subject = format!("`{parent}` -> `{child}` of {}", world.path(bag.source));
    let steps = &edge.steps;
    if steps.count == 0 {
        return out.too_little(subject, "it has fewer than two consecutive transforms");
    }
    let enough = steps
        .sample
        .iter()
        .filter(|step| step.distance_m > 1e-6 || step.angle_rad > 1e-6)
        .count() as u64;
    let usual = |of: fn(&Step) -> f64| {
        of_moving(steps, 0.95, of)
            .filter(|_| enough >= limits.min_corrections)
            .map(|usual| limits.times_usual * usual)
    };
    let limit_m =
        usual(|step| step.distance_m).map_or(limits.jump_m, |usual| usual.max(limits.least_m).min(limits.jump_m));
    let limit_deg = usual(|step| step.angle_rad.to_degrees()).map_or(limits.jump_deg, |usual| {
        usual.max(limits.least_deg).min(limits.jump_deg)
    });
    let corrections: Vec<Jump> = outstanding(steps)
        .into_iter()
        .map(|step| Jump::new(bag, edge, step))
        .collect();
    let largest = |of: fn(&Jump) -> f64| corrections.iter().map(of).fold(0.0, f64::max);
    let shift = Measured::new("largest shift of the vehicle", largest(|jump| jump.m), "m")
        .limit(limit_m)
        .samples(steps.count);
    let turn = Measured::new("largest rotation", largest(|jump| jump.deg), "deg")
        .limit(limit_deg)
        .samples(steps.count);
    let jumps: Vec<&Jump> = corrections
        .iter()
        .filter(|jump| jump.m > limit_m || jump.deg > limit_deg)
        .collect();
    if jumps.is_empty() {
        if between_windows(bag, edge, limits) {
            out.too_little(
                subject,
                "it changes by more than the limits between the parts of the recording that were read",
            );
        } else if takes_turns(steps) {
            let why = "two publishers alternate with different values, so its steps are not corrections";
            out.not_applicable(subject, why);
        } else {
            out.pass(
                subject,
                [shift, turn, Measured::new("corrections", steps.moving as f64, "count")],
            );
        }
        return;
    }
    let mut finding = finding(bag, edge, subject, &jumps, limits);
    if takes_turns(steps) {
        finding = finding.unless_about(codes::AUTH01, format!("{child}`"));
    }
    let count = Measured::count("jumps", jumps.len()).limit(0.0).samples(steps.moving);
    out.fail(finding.measured(count).measured(shift).measured(turn));
}

/// Whether the transform changes by more than a jump, and it is not known how: messages in between were not read.
fn between_windows(bag: &BagEvidence, edge: &TfEdge, limits: &Limits) -> bool {
    let has_more = bag.topics.get(&edge.topic).is_some_and(TopicEvidence::has_more);
    has_more
        && edge
            .extreme
            .as_ref()
            .is_some_and(|(_, rad, m)| *m > limits.jump_m || rad.to_degrees() > limits.jump_deg)
}

fn finding(bag: &BagEvidence, edge: &TfEdge, subject: String, jumps: &[&Jump], limits: &Limits) -> Finding {
    const SHOWN: usize = 5;
    let (parent, child) = (edge.parent.canonical(), edge.child.canonical());
    let shown: Vec<String> = jumps.iter().take(SHOWN).map(|jump| jump.words(bag)).collect();
    let more = jumps.len().saturating_sub(SHOWN);
    let more = if more > 0 {
        format!(" and {more} more")
    } else {
        String::new()
    };
    let list = match jumps {
        [jump] => format!(
            "The jump is {:.1} s after the start of the recording.",
            jump.since_s(bag)
        ),
        _ => format!("Jumps, with the time since the start: {}{more}.", shown.join(", ")),
    };
    let keepers = keepers(bag, &edge.parent);
    let place = |jump: &Jump| Place::message(bag.source, jump.at.after.at.clone());
    let asked = jumps.iter().all(|jump| was_asked(bag, jump, limits.initial_pose_s));
    let worst = jumps.iter().max_by(|a, b| a.m.total_cmp(&b.m));
    let first = worst.map_or_else(|| Place::whole(bag.source), |jump| place(jump));
    let largest = |of: fn(&Jump) -> f64| jumps.iter().map(|jump| of(jump)).fold(0.0, f64::max);
    let message = format!(
        "`{parent}` -> `{child}` jumps {} {:.2} m and {:.1} deg",
        if jumps.len() == 1 {
            "once and moves the vehicle by".to_owned()
        } else {
            format!("{} times and moves the vehicle by up to", jumps.len())
        },
        largest(|jump| jump.m),
        largest(|jump| jump.deg),
    );
    let keep = format!(
        "keep short-lived data (obstacles, tracks, local plans) in `{child}`, which does not jump; at each jump, clear, recompute or transform the \
         data that stay in `{parent}`"
    );
    let finding = if asked {
        Finding::note(subject, message, first)
            .detail(format!("A message on `initialpose` came just before each jump. {list}"))
            .help("do nothing if an operator set the initial pose; otherwise stop the node that publishes on `initialpose`")
    } else if keepers.is_empty() {
        let help = format!("{keep} (REP-105 allows a localizer to jump)");
        Finding::note(subject, message, first).detail(list).help(help)
    } else {
        let verb = if keepers.len() == 1 { "is" } else { "are" };
        let detail = format!("{} {verb} expressed in `{parent}`. {list}", keepers.join(", "));
        let help = format!("{keep}; check the localizer if a jump is not a loop closure");
        Finding::warning(subject, message, first).detail(detail).help(help)
    };
    let others = jumps
        .iter()
        .filter(|jump| worst.is_none_or(|worst| jump.at.after.at != worst.at.after.at))
        .take(SHOWN);
    others.fold(finding.likely().label("after the largest jump"), |finding, jump| {
        finding.related(place(jump), format!("{:.2} m and {:.1} deg", jump.m, jump.deg))
    })
}
