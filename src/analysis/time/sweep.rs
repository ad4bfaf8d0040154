//! The direction in which the points of a scan sweep.

use std::f64::consts::TAU;

use nalgebra::Complex;
use serde::Deserialize;

use crate::analysis::lidar::Clouds;
use crate::tables::Sweep;
use crate::world::cloud::CloudSample;

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Limits {
    pub(crate) min_clouds: usize,
    pub(crate) min_points: usize,
    pub(crate) min_resultant: f64,
    pub(crate) min_ratio: f64,
    pub(crate) upright: f64,
    pub(crate) max_angle_steps: f64,
}

/// Whether clouds sweep opposite to the direction of their lidar, as far as the times of their points show it.
pub(crate) fn sweeps_the_other_way(clouds: &Clouds, limits: &Limits) -> bool {
    let Some(expected) = clouds.driver.and_then(|driver| driver.sweep) else {
        return false;
    };
    let samples = clouds.evidence.samples.iter();
    let sweeps: Vec<Sweep> = samples
        .filter_map(|sample| Some(sweep(clouds, sample, limits)?.0))
        .collect();
    sweeps.len() >= limits.min_clouds && sweeps.iter().all(|seen| *seen != expected)
}

/// The direction of a cloud's sweep, with the resultants of that direction and of the other one; `None` where it is not determined.
pub(crate) fn sweep(clouds: &Clouds, sample: &CloudSample, limits: &Limits) -> Option<(Sweep, f64, f64)> {
    let times = sample.times.as_ref()?;
    let (unit_s, _) = clouds.unit(times)?;
    let period_s = clouds.period_s()?;
    // Azimuth minus and plus the share of a turn: of the right direction all are alike.
    let (mut left, mut right) = (Complex::new(0.0, 0.0), Complex::new(0.0, 0.0));
    let mut count = 0;
    for point in &sample.points {
        let [x, y, _] = point.xyz;
        let share = (point.time - times.range[0]) * unit_s / period_s;
        let azimuth = Complex::new(x, y) / x.hypot(y);
        let turn = Complex::from_polar(1.0, TAU * share);
        if (azimuth * turn).is_finite() {
            left += azimuth * turn.conj();
            right += azimuth * turn;
            count += 1;
        }
    }
    let [left, right] = [left, right].map(|sum| sum.norm() / f64::from(count));
    let (best, other) = (left.max(right), left.min(right));
    let is_clear =
        sample.points.len() >= limits.min_points && best >= limits.min_resultant && best >= limits.min_ratio * other;
    let seen = if right > left {
        Sweep::Clockwise
    } else {
        Sweep::CounterClockwise
    };
    is_clear.then_some((seen, best, other))
}
