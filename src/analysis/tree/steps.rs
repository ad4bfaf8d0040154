//! Steps of a stream of poses that stand out, each once.
//!
//! Must not judge.

use crate::math::stats::quantile;
use crate::world::content::{Step, StepAt, StepEvidence};

/// The steps that are kept with their poses, each once, in the order of the recording.
pub(crate) fn outstanding(steps: &StepEvidence) -> Vec<&StepAt> {
    let mut kept: Vec<&StepAt> = [&steps.farthest, &steps.widest, &steps.most_surprising]
        .into_iter()
        .flatten()
        .collect();
    kept.sort_by_key(|step| (step.after.at.index, step.after.at.field.clone()));
    kept.dedup_by(|a, b| a.after.at == b.after.at);
    kept
}

/// Whether every second step reverses the one before: two publishers alternate, which is a different fault from a jump.
pub(crate) fn takes_turns(steps: &StepEvidence) -> bool {
    steps.undone >= 10 && steps.undone.saturating_mul(4) >= steps.moving
}

/// A quantile of a quantity over the steps that move; `None` where none does.
pub(crate) fn of_moving(steps: &StepEvidence, q: f64, of: impl Fn(&Step) -> f64) -> Option<f64> {
    const MOVES: f64 = 1e-6;
    let moving = steps
        .sample
        .iter()
        .filter(|step| step.distance_m > MOVES || step.angle_rad > MOVES);
    quantile(&moving.map(of).collect::<Vec<_>>(), q)
}

/// Seconds of a step by its stamps.
pub(crate) fn seconds(step: &Step) -> f64 {
    step.dt_ns as f64 / 1e9
}
