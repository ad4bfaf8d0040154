//! The time lag of one rate signal behind another.
//!
//! Owns the correlation of two signals over a range of lags and the quality of its peak: significance, a runner-up, the
//! deviation of the lag, the results of parts. Gives numbers and no verdict. Must not know which clock is right.
//! Seconds; the signals may have any unit, and each its own. Source: `rules/time/sensor-time-offset.md`;
//! the deviation of the lag is that of Knapp and Carter, The generalized correlation method for
//! estimation of time delay, IEEE TASSP 24(4), 1976, for the effective count of values.

mod curve;
mod grid;
#[cfg(test)]
mod tests;
#[cfg(test)]
mod tests_recovery;

use std::f64::consts::TAU;

use super::effective::{dot, effective_count};
use curve::Curve;
use grid::Segment;

/// How two signals are sampled on one grid and compared.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Options {
    /// The step of the grid, seconds.
    pub grid_s: f64,
    /// Signals are averaged over this time about each point of the grid, seconds; one step at least. The average is that
    /// of the line through the samples, centred on the point: symmetric, so it moves no peak.
    pub smooth_s: f64,
    /// Lags are tried from minus to plus this, seconds.
    pub max_lag_s: f64,
    /// The runner-up is sought farther from the peak than this, seconds.
    pub guard_s: f64,
    /// A step between samples longer than this is a hole, and nothing is interpolated across it, seconds.
    pub hole_s: f64,
    /// A lag counts when the values that overlap at it are at least this share of those at the lag with the most.
    pub least_overlap: f64,
    /// Into how many parts of equal length the first signal is cut for a second estimate.
    pub parts: usize,
}

impl Options {
    /// For offsets of milliseconds: grid 50 ms, +-3 s, three parts (TIME09). Signals at 10 Hz or more.
    pub fn fine() -> Options {
        Options {
            grid_s: 0.05,
            smooth_s: 0.05,
            max_lag_s: 3.0,
            guard_s: 1.0,
            hole_s: 0.5,
            least_overlap: 0.5,
            parts: 3,
        }
    }

    /// For offsets of leap seconds: grid 0.2 s, smoothed over 1.2 s, +-60 s, runner-up beyond 4 s, two halves.
    pub fn wide() -> Options {
        Options {
            grid_s: 0.2,
            smooth_s: 1.2,
            max_lag_s: 60.0,
            guard_s: 4.0,
            hole_s: 2.5,
            least_overlap: 0.5,
            parts: 2,
        }
    }
}

/// The peak of a correlation over lags.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Peak {
    /// How late the second signal is relative to the first, seconds: second(t + lag) goes with first(t). Between the steps
    /// of the grid by a parabola through the peak and its neighbours.
    pub lag_s: f64,
    /// The correlation at the peak's grid point, -1..=1, about the means and with the variances of the values that
    /// overlap at that lag.
    pub rho: f64,
    /// Whether the peak is within the range and not at its end: at the end the true one may be outside.
    pub interior: bool,
    /// How many pairs of values overlap at the peak.
    pub pairs: usize,
    /// The number of independent pairs that they are worth (Bartlett).
    pub n_eff: f64,
    /// atanh(rho) sqrt(n_eff - 3): standard normal for unrelated signals at one lag. 0 for n_eff <= 3.
    pub z: f64,
    /// B, the root mean square bandwidth of what the signals share, Hz, from the curvature of the peak: noise in one
    /// signal does not count. `None` where the peak is flat or at an end.
    pub bandwidth_hz: Option<f64>,
    /// The standard deviation of the lag, seconds: sqrt((1 - rho^2) / (rho^2 n_e (2 pi B)^2)), where n_e is the effective
    /// count of the pair that makes the error: the slope of the first signal and the unexplained part of the
    /// second. With noise at 10 Hz it is within a factor of two of what simulations scatter.
    pub sigma_s: Option<f64>,
    /// The same with n_eff for n_e, as TIME09 writes it, seconds: several times more than the scatter where the noise is
    /// whiter than the signals.
    pub cautious_sigma_s: Option<f64>,
    /// The largest correlation farther from the peak than the guard. `None` when the range ends before.
    pub runner_up: Option<f64>,
    /// The smallest correlation of all and its lag on the grid, seconds: strongly negative where one signal has the
    /// opposite sign.
    pub trough: (f64, f64),
}

/// The peak of the whole and those of its parts.
#[derive(Debug, Clone, PartialEq)]
pub struct Lag {
    /// All of both signals.
    pub whole: Peak,
    /// Each part of the first signal, in the order of time, compared with all of the second. `None` where a part has nothing
    /// to compare.
    pub parts: Vec<Option<Peak>>,
    /// The correlation of the whole at each lag that counts: seconds, -1..=1.
    pub curve: Vec<[f64; 2]>,
}

impl Lag {
    /// The largest difference between the lags of parts, seconds. `None` when a part has none, or with fewer than two.
    pub fn spread_s(&self) -> Option<f64> {
        let lags: Option<Vec<f64>> = self.parts.iter().map(|p| p.map(|p| p.lag_s)).collect();
        let lags = lags.filter(|lags| lags.len() > 1)?;
        let (low, high) = (
            lags.iter().copied().reduce(f64::min)?,
            lags.iter().copied().reduce(f64::max)?,
        );
        Some(high - low)
    }
}

/// The lag of the second signal behind the first; each is a list of stretches of `(time in s, value)`.
///
/// Samples that are not finite, holes, steps back in time and ends of stretches cut a signal, and nothing is averaged
/// across a cut. Cost: points of the grid times lags, twice. `None` when no lag has overlap, or a signal is constant.
pub fn lag<A, B>(first: &[A], second: &[B], options: &Options) -> Option<Lag>
where
    A: AsRef<[(f64, f64)]>,
    B: AsRef<[(f64, f64)]>,
{
    let origin_s = grid::origin(first)?;
    let first = grid::segments(first, options, origin_s);
    let second = grid::segments(second, options, origin_s);
    let curve = Curve::new(&first, &second, options)?;
    let whole = peak(&curve, &first, &second, options)?;
    let of_part = |part: &Vec<Segment>| peak(&Curve::new(part, &second, options)?, part, &second, options);
    Some(Lag {
        whole,
        parts: grid::parts(&first, options.parts).iter().map(of_part).collect(),
        curve: curve
            .entries()
            .map(|(lag, rho)| [lag as f64 * options.grid_s, rho])
            .collect(),
    })
}

fn peak(curve: &Curve, first: &[Segment], second: &[Segment], options: &Options) -> Option<Peak> {
    let (at, rho) = curve.largest()?;
    let step_s = options.grid_s;
    let seconds = |lag: i64| lag as f64 * step_s;
    let (mut lag_s, mut bandwidth_hz) = (seconds(at), None);
    let neighbours = curve.at(at - 1).zip(curve.at(at + 1));
    if let Some((before, after)) = neighbours {
        let bend = 2.0 * rho - before - after;
        if bend > 0.0 {
            lag_s += step_s * ((after - before) / (2.0 * bend)).clamp(-0.5, 0.5);
            if rho > 0.0 {
                bandwidth_hz = Some((bend / rho).sqrt() / step_s / TAU);
            }
        }
    }
    let pairs: Vec<_> = grid::pairs(first, second, at)
        .map(|(a, b)| (a.values, b.values))
        .collect();
    let n_eff = effective_count(&pairs)?;
    let scatter = (1.0 - rho * rho).max(0.0).sqrt() / rho.abs();
    let sigma = |count: f64| bandwidth_hz.map(|b| scatter / (count.sqrt() * TAU * b));
    let guard = curve
        .entries()
        .filter(|(lag, _)| seconds(lag - at).abs() > options.guard_s);
    let (trough_at, trough) = curve.entries().min_by(|a, b| a.1.total_cmp(&b.1))?;
    Some(Peak {
        lag_s,
        rho,
        interior: neighbours.is_some(),
        pairs: pairs.iter().map(|(a, _)| a.len()).sum(),
        n_eff,
        // A perfect correlation is not infinitely significant: the clamp is that of rounding.
        z: rho.clamp(-1.0 + 1e-12, 1.0 - 1e-12).atanh() * (n_eff - 3.0).max(0.0).sqrt(),
        bandwidth_hz,
        // Without an error left there is nothing to count.
        sigma_s: sigma(error_count(&pairs).unwrap_or(n_eff)),
        cautious_sigma_s: sigma(n_eff),
        runner_up: guard.map(|(_, rho)| rho).reduce(f64::max),
        trough: (trough, seconds(trough_at)),
    })
}

/// The effective count of (slope of the first signal, unexplained part of the second).
fn error_count(pairs: &[(&[f64], &[f64])]) -> Option<f64> {
    let (ab, aa) = pairs
        .iter()
        .fold((0.0, 0.0), |(ab, aa), (a, b)| (ab + dot(a, b), aa + dot(a, a)));
    let gain = ab / aa;
    let errors = pairs.iter().map(|(a, b)| {
        let slopes: Vec<f64> = a
            .iter()
            .zip(a.iter().skip(2))
            .map(|(before, after)| after - before)
            .collect();
        let rests: Vec<f64> = a.iter().zip(*b).skip(1).map(|(a, b)| b - gain * a).collect();
        (slopes, rests)
    });
    effective_count(&errors.collect::<Vec<_>>())
}
