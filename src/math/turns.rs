//! Is an orientation the integral of a gyro? Turns over short windows, seen by both, under four readings.
//!
//! Owns the windows' sums and what follows from them: R2, residual, lag, gain, correlation per axis and the matrix for
//! the search of [`axis_maps`](super::axis_maps). Gives numbers and no verdict. The world frame cancels: a constant
//! turn of it is invisible here. Must not know which message held the rows. Radians, seconds.
//! Source: `rules/quat/quaternion-convention.md`.

mod sums;
#[cfg(test)]
mod tests;
#[cfg(test)]
mod tests_recovery;
mod windows;

use std::collections::{BTreeMap, BTreeSet};

use nalgebra::{Matrix3, Vector3};

use super::axis_maps::AxisSearch;
use super::readings::Reading;
use super::stats::median;
use sums::{BestLags, LagTurns, agreement, score};
use windows::{Window, WindowTurn, turned};

/// One message: an orientation and a rate of the same body at one time.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Row {
    /// The time in seconds from any origin; microseconds must be left of its 53 bits.
    pub t_s: f64,
    /// The four numbers in the slots x, y, z, w, as published; any norm but 0.
    pub slots: [f64; 4],
    /// The angular rate about the body's axes x, y, z as published: rad/s, if the publisher keeps the convention.
    pub rate_rad_s: [f64; 3],
}

/// How the rows are cut and compared.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Options {
    /// The length of a window, seconds. A window ends at the first row that is at least so far from its first, so it is
    /// never shorter than one step.
    pub window_s: f64,
    /// From the start of a window to that of the next, seconds. Shorter than `window_s`: windows overlap.
    pub hop_s: f64,
    /// The orientation may be late or early by up to this, seconds.
    pub max_lag_s: f64,
    /// The step in which lags are tried, seconds.
    pub lag_step_s: f64,
    /// The largest bias about each axis that is taken off the gyro, rad/s; 0 takes none.
    pub max_bias_rad_s: f64,
    /// A window is active when its net turn by the gyro is at least this rate, rad/s.
    pub active_rad_s: f64,
    /// A step longer than this many median steps is a hole.
    pub hole_factor: f64,
}

impl Options {
    /// Windows of this length end to end, +-150 ms in steps of 10 ms, biases up to 0.1 rad/s (five deviations of a consumer
    /// grade's), active from 2 degrees/s, holes from five steps.
    pub fn new(window_s: f64) -> Options {
        Options {
            window_s,
            hop_s: window_s,
            max_lag_s: 0.15,
            lag_step_s: 0.01,
            max_bias_rad_s: 0.1,
            active_rad_s: 2f64.to_radians(),
            hole_factor: 5.0,
        }
    }
}

/// The lags are sought in no more windows than about this, spread evenly.
const MOST_SEARCHED: usize = 500;

/// The result of the windows. Turns are rotation vectors in the body's axes: d by the orientation, g by the gyro.
#[derive(Debug, Clone, PartialEq)]
pub struct Turns {
    /// How many windows.
    pub windows: usize,
    /// How many of them are active.
    pub active: usize,
    /// The time that the windows cover, seconds.
    pub covered_s: f64,
    /// The sum of |g| over active windows, counted once where windows overlap: radians of rotation.
    pub rotation_rad: f64,
    /// The root mean square of |g - mean g| over all windows, radians: the variation that R2 needs. Steady turning has none.
    pub varying_rms_rad: f64,
    /// The root mean square of the gyro's rate about each axis over active windows, rad/s.
    pub axis_rms_rad_s: [f64; 3],
    /// The bias that was taken off the gyro, rad/s.
    pub bias_rad_s: Vector3<f64>,
    /// The median step between rows, seconds.
    pub step_s: f64,
    /// The result of each reading, in the order of [`Reading::ALL`].
    pub scores: [Score; 4],
}

/// How well one reading of the orientation agrees with the gyro, at the lag of its largest R2.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Score {
    /// The reading.
    pub reading: Reading,
    /// How late the orientation is relative to the gyro, seconds: of the lags tried, that of the largest R2.
    pub lag_s: f64,
    /// 1 - sum |e - mean e|^2 / sum |g - mean g|^2 over all windows, with e = d - g: a constant bias of the gyro falls
    /// out. 1 = perfect, 0 = no information, -3 = opposite. Not finite when the gyro's turns do not vary.
    pub r2: f64,
    /// sqrt(sum |d - g|^2 / sum |g|^2) over active windows: 0 = perfect, 1 = no information, 2 = opposite. Not finite
    /// without active windows.
    pub residual: f64,
    /// The same with no lag taken out, as the table of real recordings was measured.
    pub residual_without_lag: f64,
    /// The mean of g - d per time, rad/s, beyond [`Turns::bias_rad_s`]: the rest of the gyro's bias, where the reading is
    /// right.
    pub bias_rad_s: Vector3<f64>,
    /// The lag of all numbers that follow, seconds: of the lags tried, that at which d is best explained by s, the plain
    /// integral of the rate, with any turn or mirror of the axes and any gain. Equal to `lag_s` where the reading and
    /// the gyro's axes are right; useful where they are not.
    pub match_lag_s: f64,
    /// sum d . s / sum s . s over active windows: 1 when the units agree, 1/57.3 for a gyro in degrees/s (s does not
    /// wrap), negative when the sense is reversed. Not finite without active windows.
    pub gain: f64,
    /// sum d . s / sqrt(sum d . d sum s . s) over active windows: how reliable the gain is. -1..=1.
    pub gain_correlation: f64,
    /// The correlation of d and s about each axis over active windows, -1..=1; `None` without variation.
    pub axis_correlation: [Option<f64>; 3],
    /// The standard deviation of d - s about each axis over active windows, radians: the noise of the orientation, where
    /// the reading is right.
    pub axis_residual_rad: [f64; 3],
    /// sum g d^T over active windows, rad^2: the argument of the search for an axis map that takes g to d.
    pub cross: Matrix3<f64>,
    /// sum |g|^2 over active windows at this lag, rad^2.
    pub gyro_power: f64,
    /// sum |d|^2 over active windows, rad^2.
    pub turn_power: f64,
}

impl Score {
    /// The search for the axes of the gyro: its best map takes the gyro's rates to the orientation's body axes.
    /// `None` without active windows.
    pub fn axis_search(&self) -> Option<AxisSearch> {
        AxisSearch::new(&self.cross, self.gyro_power, self.turn_power)
    }
}

impl Turns {
    /// The result of one reading.
    pub fn score(&self, reading: Reading) -> Option<&Score> {
        self.scores.iter().find(|s| s.reading == reading)
    }
}

/// Compares the orientation of the rows with their rate, stretch by stretch: nothing is integrated across the end of a
/// stretch, a hole, a step back in time, or a row that is not finite. Rows that repeat a time are left out.
///
/// The gyro is integrated by the mid-point rule, Exp(w dt) with w the mean of the two ends of a step. Cost: rows and
/// windows. `None` when no window fits, with the lags on both sides, into any stretch.
pub fn turns<S: AsRef<[Row]>>(stretches: &[S], options: &Options) -> Option<Turns> {
    let (runs, step_s) = windows::runs(stretches, options);
    let windows = windows::windows(&runs, options, step_s);
    if windows.is_empty() {
        return None;
    }
    // A bound on the lags, so that no options can make the search run on.
    let steps = (options.max_lag_s / options.lag_step_s).clamp(0.0, 1000.0).floor();
    #[allow(clippy::cast_possible_truncation)]
    let steps = if steps.is_finite() { steps as i32 } else { 0 };
    // A few hundred windows determine the lag as well as all do.
    let nth = windows.len().div_ceil(MOST_SEARCHED);
    let mut best = Reading::ALL.map(|_| BestLags::default());
    let seconds = |lag: i32| f64::from(lag) * options.lag_step_s;
    for lag in -steps..=steps {
        let turned = turned(&runs, &windows, nth, seconds(lag));
        let of_each = agreement(windows.iter().step_by(nth), &turned);
        best.iter_mut()
            .zip(of_each)
            .for_each(|(best, at_lag)| best.offer(lag, at_lag));
    }
    let lags = best.iter().flat_map(|b| [b.lag(), b.match_lag()]).chain([0]);
    let lags: BTreeSet<i32> = lags.collect();
    let mut by_lag: BTreeMap<i32, Vec<WindowTurn>> = lags
        .into_iter()
        .map(|lag| (lag, turned(&runs, &windows, 1, seconds(lag))))
        .collect();
    let bias_rad_s = {
        let at = |best: &BestLags| (*best, by_lag.get(&best.lag()).map_or(&[][..], Vec::as_slice));
        sums::bias(&windows, &best.each_ref().map(at), options.max_bias_rad_s)
    };
    for (window, gyro) in by_lag.values_mut().flat_map(|turned| windows.iter().zip(turned)) {
        gyro.take_off(&(bias_rad_s * window.length_s()));
    }
    let at = |lag: i32| by_lag.get(&lag).map_or(&[][..], Vec::as_slice);
    let still = at(0);
    let is_active = |(w, g): (&Window, &WindowTurn)| g.turn.norm() >= options.active_rad_s * w.length_s();
    let active: Vec<bool> = windows.iter().zip(still).map(is_active).collect();
    let n = windows.len() as f64;
    let mean = still.iter().map(|g| g.turn).sum::<Vector3<f64>>() / n;
    let varying: f64 = still.iter().map(|g| (g.turn - mean).norm_squared()).sum();
    let (mut covered_s, mut rotation_rad, mut squares) = (0.0, 0.0, Vector3::zeros());
    for ((window, gyro), active) in windows.iter().zip(still).zip(&active) {
        let share = (options.hop_s.max(step_s) / window.length_s()).min(1.0);
        covered_s += share * window.length_s();
        if *active {
            let rate = gyro.turn / window.length_s();
            rotation_rad += share * gyro.turn.norm();
            squares += rate.component_mul(&rate);
        }
    }
    let count = active.iter().filter(|a| **a).count();
    Some(Turns {
        windows: windows.len(),
        active: count,
        covered_s,
        rotation_rad,
        varying_rms_rad: (varying / n).sqrt(),
        axis_rms_rad_s: squares.map(|sum| (sum / count.max(1) as f64).sqrt()).into(),
        bias_rad_s,
        step_s,
        scores: std::array::from_fn(|i| {
            let best = best.get(i).copied().unwrap_or_default();
            let lags = LagTurns {
                still,
                best: (seconds(best.lag()), at(best.lag())),
                matched: (seconds(best.match_lag()), at(best.match_lag())),
            };
            score(&windows, &active, i, &lags)
        }),
    })
}
