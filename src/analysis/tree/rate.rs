//! The error of linear interpolation between the poses of an edge. Measures; must not judge.

use crate::math::stats::quantile;
use crate::verdict::Measured;
use crate::world::content::Step;

/// What the steps of an edge show.
pub(crate) struct Rate {
    /// How many they are.
    pub(crate) steps: u64,
    /// Median gap, seconds.
    pub(crate) usual_s: f64,
    /// 99th percentile of the gaps, seconds.
    pub(crate) long_s: f64,
    /// 99th percentile of the error of interpolation, metres.
    pub(crate) error_m: f64,
    /// The same, degrees.
    pub(crate) error_deg: f64,
}

impl Rate {
    /// Between two poses a gap `g` apart, a straight line misses a path of acceleration `a` by `a g²/8`; the surprise is
    /// `a g²`.
    pub(crate) fn of(steps: &[&Step]) -> Option<Self> {
        let of = |value: &dyn Fn(&Step) -> f64, q: f64| {
            let values: Vec<f64> = steps.iter().map(|step| value(step)).collect();
            quantile(&values, q)
        };
        let gap = |step: &Step| step.dt_ns as f64 / 1e9;
        Some(Self {
            steps: steps.len() as u64,
            usual_s: of(&gap, 0.5)?,
            long_s: of(&gap, 0.99)?,
            error_m: of(&|step| step.surprise_m, 0.99)? / 8.0,
            error_deg: (of(&|step| step.surprise_rad, 0.99)? / 8.0).to_degrees(),
        })
    }

    /// The numbers with the limits of the errors.
    pub(crate) fn measured(&self, max_error_m: f64, max_error_deg: f64) -> [Measured; 4] {
        let error = |what: &str, value, unit, limit| {
            let what = format!("error of the interpolated {what} (99th percentile)");
            Measured::new(what, value, unit).limit(limit).samples(self.steps)
        };
        [
            error("position", self.error_m, "m", max_error_m),
            error("rotation", self.error_deg, "deg", max_error_deg),
            Measured::new("time between two transforms (median)", self.usual_s, "s").samples(self.steps),
            Measured::new("time between two transforms (99th percentile)", self.long_s, "s").samples(self.steps),
        ]
    }
}
