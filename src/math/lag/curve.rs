//! The correlation at every lag.

use super::Options;
use super::grid::{Piece, Segment, pairs};
use crate::math::effective::dot;

/// Correlations at the lags that count, in grid steps.
pub(super) struct Curve {
    first_lag: i64,
    values: Vec<Option<f64>>,
}

/// Sums over the pairs of one lag.
#[derive(Clone, Copy, Default)]
struct Sums {
    n: f64,
    a: f64,
    b: f64,
    aa: f64,
    bb: f64,
    ab: f64,
}

impl Sums {
    fn of<'a>(pairs: impl Iterator<Item = (Piece<'a>, Piece<'a>)>) -> Sums {
        let mut sums = Sums::default();
        for (a, b) in pairs {
            sums.n += a.values.len() as f64;
            sums.a += a.sum;
            sums.b += b.sum;
            sums.aa += a.squares;
            sums.bb += b.squares;
            sums.ab += dot(a.values, b.values);
        }
        sums
    }

    /// The correlation about the means of these very pairs. `None` where one side is constant.
    fn correlation(&self) -> Option<f64> {
        let about = |products: f64, x: f64, y: f64| products - x * y / self.n;
        let (aa, bb) = (about(self.aa, self.a, self.a), about(self.bb, self.b, self.b));
        // The squares of a piece are a difference of sums: below this there is rounding and no signal.
        let varies = aa > 1e-9 * self.aa && bb > 1e-9 * self.bb;
        let rho = about(self.ab, self.a, self.b) / (aa * bb).sqrt();
        (varies && rho.is_finite()).then(|| rho.clamp(-1.0, 1.0))
    }
}

impl Curve {
    /// `None` when no lag has a pair.
    pub(super) fn new(first: &[Segment], second: &[Segment], options: &Options) -> Option<Curve> {
        // A bound on the lags, so that no options can make the search run on.
        let most = (options.max_lag_s / options.grid_s).clamp(0.0, 20_000.0).floor();
        #[allow(clippy::cast_possible_truncation)]
        let most = if most.is_finite() { most as i64 } else { 0 };
        let sums: Vec<Sums> = (-most..=most).map(|lag| Sums::of(pairs(first, second, lag))).collect();
        let largest = sums.iter().map(|s| s.n).reduce(f64::max).filter(|n| *n > 0.0)?;
        // Three pairs lie on a line too often to count.
        let least = (options.least_overlap * largest).max(4.0);
        let values = sums.iter().map(|s| if s.n >= least { s.correlation() } else { None });
        Some(Curve {
            first_lag: -most,
            values: values.collect(),
        })
    }

    /// The correlation at a lag, where it counts.
    pub(super) fn at(&self, lag: i64) -> Option<f64> {
        let index = usize::try_from(lag - self.first_lag).ok()?;
        self.values.get(index).copied().flatten()
    }

    /// The lags that count, with their correlations.
    pub(super) fn entries(&self) -> impl Iterator<Item = (i64, f64)> + '_ {
        let lags = (self.first_lag..).zip(&self.values);
        lags.filter_map(|(lag, value)| value.map(|value| (lag, value)))
    }

    /// The lag with the largest correlation; of equal ones the first.
    pub(super) fn largest(&self) -> Option<(i64, f64)> {
        self.entries()
            .reduce(|best, next| if next.1 > best.1 { next } else { best })
    }
}
