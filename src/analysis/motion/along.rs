//! Values along a run in the order of time: which two a time lies between.
//!
//! Must not know what the values are of.

use nalgebra::Vector3;

/// The two values of a run, in the order of time, that a time lies between, and its share of the way from one to the other.
pub(crate) fn around<V>(run: &[(f64, V)], t_s: f64) -> Option<([&(f64, V); 2], f64)> {
    between(run, run.partition_point(|(t, _)| *t < t_s), t_s)
}

/// As [`around`], of the first run that covers the time; `None` where the two are farther apart than this, seconds.
pub(crate) fn near<V>(runs: &[Vec<(f64, V)>], t_s: f64, max_step_s: f64) -> Option<([&V; 2], f64)> {
    let covers = |run: &&Vec<(f64, V)>| {
        run.first().is_some_and(|first| first.0 <= t_s) && run.last().is_some_and(|last| last.0 >= t_s)
    };
    let ([(from_s, from), (to_s, to)], share) = around(runs.iter().find(covers)?, t_s)?;
    (to_s - from_s <= max_step_s).then_some(([from, to], share))
}

/// Of the run's values the `after`-th and the one before it; the first is after nothing.
fn between<V>(run: &[(f64, V)], after: usize, t_s: f64) -> Option<([&(f64, V); 2], f64)> {
    let after = after.max(1);
    let (a, b) = (run.get(after - 1)?, run.get(after)?);
    (a.0 <= t_s).then(|| ([a, b], (t_s - a.0) / (b.0 - a.0)))
}

/// A run that is asked for times that mostly grow: as [`around`], and looks near the last place first.
pub(crate) struct Follower<'r, V> {
    run: &'r [(f64, V)],
    after: usize,
}

/// Steps ahead that are looked at one by one.
const NEAR: usize = 16;

impl<'r, V> Follower<'r, V> {
    pub(crate) fn new(run: &'r [(f64, V)]) -> Self {
        Self { run, after: 0 }
    }

    pub(crate) fn around(&mut self, t_s: f64) -> Option<([&'r (f64, V); 2], f64)> {
        let is_before = |at: usize| self.run.get(at).is_some_and(|(t, _)| *t < t_s);
        let begins = self.after == 0 || is_before(self.after - 1);
        let near = (self.after..self.after + NEAR)
            .find(|at| !is_before(*at))
            .filter(|_| begins);
        self.after = near.unwrap_or_else(|| self.run.partition_point(|(t, _)| *t < t_s));
        between(self.run, self.after, t_s)
    }
}

impl Follower<'_, Vector3<f64>> {
    /// The line through the values, at a time.
    pub(crate) fn at(&mut self, t_s: f64) -> Option<Vector3<f64>> {
        let ([(_, a), (_, b)], share) = self.around(t_s)?;
        Some(a + (b - a) * share)
    }
}
