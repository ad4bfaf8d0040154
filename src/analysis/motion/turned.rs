//! The orientation of a stream at any time.

use nalgebra::UnitQuaternion;

use crate::analysis::{motion::along::near, motion::stream::Stream, motion::yaw::OrientedRow};
use crate::math::readings::Reading;

/// `world_from_body` over time, as published.
pub(crate) struct Orientations {
    /// Runs of `(seconds after the recording's start, orientation)`.
    pub(crate) runs: Vec<Vec<(f64, UnitQuaternion<f64>)>>,
}

impl Orientations {
    /// Of each row; rows without an orientation are left out.
    pub(crate) fn of<R: OrientedRow>(stream: &Stream<R>) -> Self {
        let runs = stream.stretches.iter().map(|rows| {
            let of = |slots| Reading::Xyzw.world_from_body(slots);
            let pairs = rows.iter().map(|timed| (timed.t_s, of(timed.row.slots())));
            pairs.filter_map(|(t_s, turned)| Some((t_s, turned?))).collect()
        });
        Self { runs: runs.collect() }
    }

    /// All times and quaternions, run by run, for [`crate::analysis::Estimates::shared`].
    pub(crate) fn numbers(&self) -> impl Iterator<Item = f64> {
        self.runs.iter().flat_map(|run| {
            let rows = run
                .iter()
                .flat_map(|(t_s, turned)| [*t_s].into_iter().chain(turned.coords.iter().copied()));
            [run.len() as f64].into_iter().chain(rows)
        })
    }

    /// The orientation at a time, between two that are known and not farther apart than this.
    pub(crate) fn at(&self, t_s: f64, max_step_s: f64) -> Option<UnitQuaternion<f64>> {
        let ([from, to], share) = near(&self.runs, t_s, max_step_s)?;
        Some(from.try_slerp(to, share, 1e-9).unwrap_or(*to))
    }
}
