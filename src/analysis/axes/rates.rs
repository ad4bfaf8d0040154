//! Gyro and accelerometer of a sensor compared with a track: turn rates with turn rates, specific force with changes of speed.
//!
//! Courses and speeds are means over two seconds, so the integrals of the sensor are smoothed in the same way. Must not judge.

use nalgebra::Vector3;

use crate::analysis::motion::{Course, Follower, Imu, around};
use crate::math::circular::wrapped;

/// Half the duration of a course, seconds.
const HALF_S: f64 = 1.0;
/// Interval between pairs, that of courses, seconds.
const STEP_S: f64 = 0.5;
/// Points in a mean.
const PARTS: usize = 5;
/// Longest step between two rows that is integrated over, seconds.
const MAX_STEP_S: f64 = 0.5;

/// A line through pairs of changes of the sensor and of the track.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Slope {
    /// Change of the sensor over change of the track.
    pub(crate) gain: f64,
    /// Correlation.
    pub(crate) correlation: f64,
    /// Root mean square of the track's changes per second.
    pub(crate) excitation: f64,
    /// Pairs.
    pub(crate) pairs: usize,
    /// Number of independent (not overlapping) pairs.
    pub(crate) effective: f64,
}

impl Slope {
    /// Student's t of the correlation.
    pub(crate) fn t(&self) -> f64 {
        let rest = (1.0 - self.correlation * self.correlation).max(1e-12);
        self.correlation * ((self.effective - 2.0).max(0.0) / rest).sqrt()
    }

    /// Length of the pairs together, seconds.
    pub(crate) fn seconds(&self) -> f64 {
        self.pairs as f64 * STEP_S
    }

    /// A line through the means.
    fn of(pairs: &[(f64, f64)]) -> Self {
        let count = pairs.len().max(1) as f64;
        let mean = |of: fn(&(f64, f64)) -> f64| pairs.iter().map(of).sum::<f64>() / count;
        Self::about(pairs, mean(|pair| pair.0), mean(|pair| pair.1))
    }

    /// A line through zero: a steady turn counts.
    fn through_zero(pairs: &[(f64, f64)]) -> Self {
        Self::about(pairs, 0.0, 0.0)
    }

    fn about(pairs: &[(f64, f64)], x0: f64, y0: f64) -> Self {
        let count = pairs.len().max(1) as f64;
        let (mut xx, mut xy, mut yy, mut squares) = (0.0, 0.0, 0.0, 0.0);
        for (x, y) in pairs {
            xx += (x - x0) * (x - x0);
            xy += (x - x0) * (y - y0);
            yy += (y - y0) * (y - y0);
            squares += x * x;
        }
        let ratio = |a: f64, b: f64| if b > 0.0 { a / b } else { 0.0 };
        Self {
            gain: ratio(xy, xx),
            correlation: ratio(xy, (xx * yy).sqrt()),
            excitation: (squares / count).sqrt() / (2.0 * STEP_S),
            pairs: pairs.len(),
            effective: count * STEP_S / (2.0 * HALF_S),
        }
    }
}

/// The sensor compared with the track.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Rates {
    /// Rate about the base's z axis over turn rate of the course.
    pub(crate) turning: Slope,
    /// Force along the base's x axis over change of speed.
    pub(crate) forward: Slope,
    /// Force along the base's y axis over change of speed.
    pub(crate) sideways: Slope,
}

impl Rates {
    /// Compares the sensor's integrals with the courses.
    pub(crate) fn of(integrals: &Integrals, courses: &[Vec<Course>]) -> Self {
        let mut smooth = integrals.follow();
        let (mut turning, mut forward, mut sideways) = (Vec::new(), Vec::new(), Vec::new());
        for run in courses {
            let smoothed: Vec<(&Course, Option<Vector3<f64>>)> =
                run.iter().map(|course| (course, smooth(course.t_s))).collect();
            for three in smoothed.windows(3) {
                let [(before, Some(from)), _, (after, Some(to))] = three else {
                    continue;
                };
                let changed = to - from;
                turning.push((wrapped(after.angle_rad - before.angle_rad), changed.x));
                let faster = after.speed_m_s - before.speed_m_s;
                forward.push((faster, changed.y));
                sideways.push((faster, changed.z));
            }
        }
        Self {
            turning: Slope::through_zero(&turning),
            forward: Slope::of(&forward),
            sideways: Slope::of(&sideways),
        }
    }
}

/// Integrals over time of the rate about the base's z axis, and of the force along its x and y axes.
pub(crate) struct Integrals {
    stretches: Vec<Vec<(f64, Vector3<f64>)>>,
}

impl Integrals {
    pub(crate) fn of(imu: &Imu) -> Self {
        let base_from_imu = imu.base_from_imu();
        let mut stretches = Vec::new();
        for rows in &imu.stream.stretches {
            let mut run: Vec<(f64, Vector3<f64>)> = Vec::new();
            let mut before: Option<(f64, Vector3<f64>)> = None;
            for timed in rows {
                let rate = base_from_imu * Vector3::from(timed.row.angular_velocity);
                let force = base_from_imu * Vector3::from(timed.row.linear_acceleration);
                let value = Vector3::new(rate.z, force.x, force.y);
                if !value.iter().all(|value| value.is_finite()) {
                    continue;
                }
                let known = before.replace((timed.t_s, value));
                match (known, run.last()) {
                    (Some((t_s, last)), Some((_, sum))) if timed.t_s - t_s <= MAX_STEP_S => {
                        let sum = sum + (last + value) * ((timed.t_s - t_s) / 2.0);
                        run.push((timed.t_s, sum));
                    }
                    _ => {
                        stretches.push(std::mem::take(&mut run));
                        run.push((timed.t_s, Vector3::zeros()));
                    }
                }
            }
            stretches.push(run);
        }
        stretches.retain(|run| run.len() > 1);
        Self { stretches }
    }

    /// Rotation of the base about its z axis between two times, radians; `None` if the gyro does not cover them.
    pub(crate) fn turned_rad(&self, from_s: f64, to_s: f64) -> Option<f64> {
        let covers = |run: &&Vec<(f64, Vector3<f64>)>| {
            run.first().is_some_and(|first| first.0 <= from_s) && run.last().is_some_and(|last| last.0 >= to_s)
        };
        let run = self.stretches.iter().find(covers)?;
        let at = |t_s: f64| {
            let ([before, after], share) = around(run, t_s)?;
            Some(before.1.x + (after.1.x - before.1.x) * share)
        };
        Some(at(to_s)? - at(from_s)?)
    }

    /// Means over two seconds around times that mostly increase.
    fn follow(&self) -> impl FnMut(f64) -> Option<Vector3<f64>> + '_ {
        let mut parts: Vec<_> = self
            .stretches
            .iter()
            .map(|run| (run, [(); PARTS].map(|()| Follower::new(run))))
            .collect();
        move |t_s| {
            let covers = |run: &[(f64, Vector3<f64>)]| {
                run.first().is_some_and(|first| first.0 <= t_s - HALF_S)
                    && run.last().is_some_and(|last| last.0 >= t_s + HALF_S)
            };
            let (_, followers) = parts.iter_mut().find(|(run, _)| covers(run))?;
            let mut sum = Vector3::zeros();
            for (part, follower) in (0_u8..).zip(followers) {
                sum += follower.at(t_s - HALF_S + 2.0 * HALF_S * f64::from(part) / (PARTS - 1) as f64)?;
            }
            Some(sum / PARTS as f64)
        }
    }
}
