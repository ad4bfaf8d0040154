//! Values along a run in the order of time: the two around a time.
//!
//! Must not know the meaning of the values.

use nalgebra::Vector3;

/// The two values of a run, in the order of time, around a time, and the interpolation factor between them.
pub(crate) fn around<V>(run: &[(f64, V)], t_s: f64) -> Option<([&(f64, V); 2], f64)> {
    between(run, run.partition_point(|(t, _)| *t < t_s), t_s)
}

/// As [`around`], in the first run that covers the time; `None` if the two are further apart than this, seconds.
pub(crate) fn near<V>(runs: &[Vec<(f64, V)>], t_s: f64, max_step_s: f64) -> Option<([&V; 2], f64)> {
    let covers = |run: &&Vec<(f64, V)>| {
        run.first().is_some_and(|first| first.0 <= t_s) && run.last().is_some_and(|last| last.0 >= t_s)
    };
    let ([(from_s, from), (to_s, to)], share) = around(runs.iter().find(covers)?, t_s)?;
    (to_s - from_s <= max_step_s).then_some(([from, to], share))
}

/// The `after`-th value of a run and the one before it; the first one has none before it.
fn between<V>(run: &[(f64, V)], after: usize, t_s: f64) -> Option<([&(f64, V); 2], f64)> {
    let after = after.max(1);
    let (a, b) = (run.get(after - 1)?, run.get(after)?);
    (a.0 <= t_s).then(|| ([a, b], (t_s - a.0) / (b.0 - a.0)))
}

/// [`around`] for times that mostly increase: searches near the last place first.
pub(crate) struct Follower<'r, V> {
    run: &'r [(f64, V)],
    after: usize,
}

/// Steps ahead that are searched one by one.
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
    /// The value at a time, interpolated linearly.
    pub(crate) fn at(&mut self, t_s: f64) -> Option<Vector3<f64>> {
        let ([(_, a), (_, b)], share) = self.around(t_s)?;
        Some(a + (b - a) * share)
    }
}
