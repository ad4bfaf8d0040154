//! Gyro and accelerometer of a sensor compared with a track: turn rates with turn rates, specific force with changes of speed.
//!
//! Courses and speeds are means over two seconds, so the integrals of the sensor are smoothed in the same way. Must not judge.

use nalgebra::{Matrix2, Vector2, Vector3};

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
}

impl Slope {
    /// Student's t of the correlation.
    pub(crate) fn t(&self) -> f64 {
        let rest = (1.0 - self.correlation * self.correlation).max(1e-12);
        self.correlation * ((independent(self.pairs) - 2.0).max(0.0) / rest).sqrt()
    }

    /// Length of the pairs together, seconds.
    pub(crate) fn seconds(&self) -> f64 {
        self.pairs as f64 * STEP_S
    }

    /// A line through zero: a steady turn counts.
    fn through_zero(pairs: &[(f64, f64)]) -> Self {
        let sum = |of: fn(&(f64, f64)) -> f64| pairs.iter().map(of).sum::<f64>();
        let (xx, xy, yy) = (sum(|(x, _)| x * x), sum(|(x, y)| x * y), sum(|(_, y)| y * y));
        let ratio = |a: f64, b: f64| if b > 0.0 { a / b } else { 0.0 };
        Self {
            gain: ratio(xy, xx),
            correlation: ratio(xy, (xx * yy).sqrt()),
            excitation: (xx / pairs.len().max(1) as f64).sqrt() / (2.0 * STEP_S),
            pairs: pairs.len(),
        }
    }
}

/// The number of independent (not overlapping) pairs among so many.
fn independent(pairs: usize) -> f64 {
    pairs as f64 * STEP_S / (2.0 * HALF_S)
}

/// How far the force along x and y of the base follows one kind of acceleration of the track.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct PlanarGain {
    /// Force over acceleration, along x and y, and the standard errors.
    pub(crate) gain: Vector2<f64>,
    pub(crate) error: Vector2<f64>,
    /// Root mean square of the acceleration about its mean, m/s^2.
    pub(crate) excitation: f64,
    /// Number of independent pairs.
    pub(crate) effective: f64,
}

impl PlanarGain {
    /// The gains of two kinds of acceleration, by least squares over `(accelerations, force)`: each would be noise to the other alone.
    fn of_both(rows: &[(Vector2<f64>, Vector2<f64>)]) -> [Self; 2] {
        let count = rows.len().max(1) as f64;
        let (sum_of, sum_force) = rows
            .iter()
            .fold((Vector2::zeros(), Vector2::zeros()), |(of, force), row| {
                (of + row.0, force + row.1)
            });
        let (mean_of, mean_force) = (sum_of / count, sum_force / count);
        let (mut information, mut products, mut squares) = (Matrix2::zeros(), Matrix2::zeros(), Vector2::zeros());
        for (of, force) in rows {
            let (of, force) = (of - mean_of, force - mean_force);
            information += of * of.transpose();
            products += of * force.transpose();
            squares += force.component_mul(&force);
        }
        // On a straight road there are no curves.
        let inverse = information
            .pseudo_inverse(1e-9 * information.trace())
            .unwrap_or_default();
        let gains = inverse * products;
        let effective = independent(rows.len());
        let residuals = squares - gains.component_mul(&products).row_sum().transpose();
        let of = |gain: Vector2<f64>, inverse: f64, square: f64| Self {
            gain,
            error: residuals.map(|left| (left.max(0.0) * inverse / (effective - 3.0).max(1e-3)).sqrt()),
            excitation: (square / count).sqrt() / (2.0 * STEP_S),
            effective,
        };
        let ([of_speed, of_curves], [speeding, curving]) = (inverse.diagonal().into(), information.diagonal().into());
        [
            of(gains.row(0).transpose(), of_speed, speeding),
            of(gains.row(1).transpose(), of_curves, curving),
        ]
    }

    /// The same with a sensor in another unit.
    pub(crate) fn times(self, unit: f64) -> Self {
        Self {
            gain: self.gain * unit,
            error: self.error * unit,
            ..self
        }
    }
}

/// The sensor compared with the track.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Rates {
    /// Rate about the base's z axis over turn rate of the course.
    pub(crate) turning: Slope,
    /// Force over change of speed.
    pub(crate) speeding: PlanarGain,
    /// Force over speed times turn rate of the course.
    pub(crate) curving: PlanarGain,
}

impl Rates {
    /// Compares the sensor's integrals with the courses.
    pub(crate) fn of(integrals: &Integrals, courses: &[Vec<Course>]) -> Self {
        let mut smooth = integrals.follow();
        let (mut turning, mut forces) = (Vec::new(), Vec::new());
        for run in courses {
            let smoothed: Vec<(&Course, Option<Vector3<f64>>)> =
                run.iter().map(|course| (course, smooth(course.t_s))).collect();
            for three in smoothed.windows(3) {
                let [(before, Some(from)), (middle, _), (after, Some(to))] = three else {
                    continue;
                };
                let changed = to - from;
                let turned = wrapped(after.angle_rad - before.angle_rad);
                turning.push((turned, changed.x));
                let faster = after.speed_m_s - before.speed_m_s;
                forces.push((Vector2::new(faster, middle.speed_m_s * turned), changed.yz()));
            }
        }
        let [speeding, curving] = PlanarGain::of_both(&forces);
        Self {
            turning: Slope::through_zero(&turning),
            speeding,
            curving,
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
