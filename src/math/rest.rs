//! When an IMU is at rest.
//!
//! Owns the windows in which force and rate are constant. To an IMU, a vehicle at constant speed on a smooth road is at
//! rest as well: where a speed is known, the caller checks it too. Seconds, rad/s, m/s^2.
//! Source: the limits are those of [`Options::default`].

use nalgebra::Vector3;

use super::stats::median;

/// One message: rate and specific force at one time, in the sensor's axes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Row {
    /// The time in seconds from any origin.
    pub t_s: f64,
    /// The angular rate about x, y, z, rad/s.
    pub rate_rad_s: [f64; 3],
    /// The specific force along x, y, z, m/s^2.
    pub force_m_s2: [f64; 3],
}

/// What counts as rest.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Options {
    /// The length of a window, seconds.
    pub window_s: f64,
    /// The largest standard deviation of the force along any axis within a window, m/s^2.
    pub force_sd_m_s2: f64,
    /// The largest norm of a window's mean rate, its bias removed, rad/s.
    pub rate_rad_s: f64,
    /// The largest bias per axis that a gyro is believed to have, rad/s: a steady turn about one axis looks like one.
    pub bias_rad_s: f64,
}

impl Default for Options {
    /// 0.5 s, 0.1 m/s^2 and 0.02 rad/s (chosen on real recordings of standing robots); biases up to 0.05 rad/s (3 degrees/s: consumer grade).
    fn default() -> Options {
        Options {
            window_s: 0.5,
            force_sd_m_s2: 0.1,
            rate_rad_s: 0.02,
            bias_rad_s: 0.05,
        }
    }
}

/// One window at rest.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RestWindow {
    /// The time of its first row, seconds.
    pub start_s: f64,
    /// The time of its last row, seconds.
    pub end_s: f64,
    /// The mean rate, bias included, rad/s.
    pub rate_rad_s: Vector3<f64>,
    /// The mean specific force, m/s^2.
    pub force_m_s2: Vector3<f64>,
}

/// What was found at rest.
#[derive(Debug, Clone, PartialEq)]
pub struct RestEstimate {
    /// The windows at rest, in the order of the stretches.
    pub windows: Vec<RestWindow>,
    /// How many windows were looked at.
    pub looked_at: usize,
    /// The bias that was removed, rad/s: the median per axis of the mean rates of windows whose force and rate are
    /// steady, kept within the limit. Zero without such windows.
    pub bias_rad_s: Vector3<f64>,
}

impl RestEstimate {
    /// The time at rest, seconds.
    pub fn seconds(&self) -> f64 {
        self.windows.iter().map(|w| w.end_s - w.start_s).sum()
    }

    /// The mean of the specific force over the windows at rest, m/s^2. `None` without one.
    pub fn force_m_s2(&self) -> Option<Vector3<f64>> {
        let sum: Vector3<f64> = self.windows.iter().map(|w| w.force_m_s2).sum();
        (!self.windows.is_empty()).then(|| sum / self.windows.len() as f64)
    }
}

/// Sums of one window.
#[derive(Default)]
struct Sums {
    n: f64,
    start_s: f64,
    end_s: f64,
    // About the first row: the variance of 9.81 +- 0.001 must not drown in 96.
    first: [Vector3<f64>; 2],
    sum: [Vector3<f64>; 2],
    squares: [Vector3<f64>; 2],
}

impl Sums {
    fn add(&mut self, row: &Row) {
        let values = [Vector3::from(row.rate_rad_s), Vector3::from(row.force_m_s2)];
        if self.n == 0.0 {
            self.first = values;
            self.start_s = row.t_s;
        }
        self.n += 1.0;
        self.end_s = row.t_s;
        let sums = self.sum.iter_mut().zip(&mut self.squares);
        for ((sum, squares), (value, first)) in sums.zip(values.iter().zip(&self.first)) {
            let d = value - first;
            *sum += d;
            *squares += d.component_mul(&d);
        }
    }

    /// (mean, largest standard deviation over the axes) of rate and force.
    fn moments(&self) -> [(Vector3<f64>, f64); 2] {
        let ([r, f], [r_sum, f_sum], [r_squares, f_squares]) = (self.first, self.sum, self.squares);
        [(r, r_sum, r_squares), (f, f_sum, f_squares)].map(|(first, sum, squares)| {
            let shift = sum / self.n;
            let variance = squares / self.n - shift.component_mul(&shift);
            (first + shift, variance.max().max(0.0).sqrt())
        })
    }
}

/// The windows of `options.window_s` within the stretches in which the sensor is at rest.
///
/// A window with fewer than three rows, or that covers less than half of its length, is not looked at. Rows that are not
/// finite are left out. Windows end at the end of a stretch and at a step back in time.
pub fn rest<S: AsRef<[Row]>>(stretches: &[S], options: &Options) -> RestEstimate {
    let mut windows: Vec<Sums> = Vec::new();
    for stretch in stretches {
        let mut open = Sums::default();
        for row in stretch.as_ref() {
            let values = row.rate_rad_s.iter().chain(&row.force_m_s2);
            if !row.t_s.is_finite() || values.into_iter().any(|v| !v.is_finite()) {
                continue;
            }
            if open.n > 0.0 && (row.t_s < open.end_s || row.t_s - open.start_s >= options.window_s) {
                windows.push(std::mem::take(&mut open));
            }
            open.add(row);
        }
        windows.push(open);
    }
    windows.retain(|w| w.n >= 3.0 && w.end_s - w.start_s >= 0.5 * options.window_s);
    let moments: Vec<_> = windows.iter().map(|w| (w, w.moments())).collect();
    let steady = |[(_, rate_sd), (_, force_sd)]: &[(Vector3<f64>, f64); 2]| {
        *force_sd < options.force_sd_m_s2 && *rate_sd < options.rate_rad_s
    };
    let bias_rad_s = Vector3::from_fn(|axis, _| {
        let means = moments.iter().filter(|(_, m)| steady(m));
        let rates: Vec<f64> = means
            .filter_map(|(_, [(rate, _), _])| rate.get(axis).copied())
            .collect();
        median(&rates)
            .unwrap_or(0.0)
            .clamp(-options.bias_rad_s, options.bias_rad_s)
    });
    let still = moments.iter().filter_map(|(sums, [(rate, _), (force, force_sd)])| {
        let rests = *force_sd < options.force_sd_m_s2 && (rate - bias_rad_s).norm() < options.rate_rad_s;
        rests.then_some(RestWindow {
            start_s: sums.start_s,
            end_s: sums.end_s,
            rate_rad_s: *rate,
            force_m_s2: *force,
        })
    });
    RestEstimate {
        windows: still.collect(),
        looked_at: moments.len(),
        bias_rad_s,
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;
    use crate::math::tests_support::Rng;

    /// 100 Hz, noise of 0.003 rad/s and 0.02 m/s^2, a bias, and from `from_s` to `to_s` motion: a swing about z and the road.
    fn rows(rng: &mut Rng, seconds: u32, bias: [f64; 3], moving: std::ops::Range<f64>) -> Vec<Row> {
        let rows = (0..100 * seconds).map(|i| f64::from(i) / 100.0).map(|t_s| {
            let (mut rate, mut force) = (Vector3::from(bias), Vector3::new(0.0, 0.0, 9.81));
            rate += rng.normal3() * 0.003;
            force += rng.normal3() * 0.02;
            if moving.contains(&t_s) {
                rate.z += 0.2 * t_s.sin();
                force += rng.normal3() * 0.5;
            }
            Row {
                t_s,
                rate_rad_s: rate.into(),
                force_m_s2: force.into(),
            }
        });
        rows.collect()
    }

    #[test]
    fn rest_is_found_before_and_after_motion_and_not_in_it() {
        let mut rng = Rng::new(8);
        let bias = [0.02, -0.03, 0.01];
        let found = rest(&[rows(&mut rng, 30, bias, 10.0..20.0)], &Options::default());
        assert_eq!(found.looked_at, 60);
        assert!(found.windows.len() >= 39 && found.windows.len() <= 40);
        assert!(found.windows.iter().all(|w| w.end_s < 10.0 || w.start_s >= 20.0));
        assert!((found.bias_rad_s - Vector3::from(bias)).norm() < 1e-3);
        assert!((found.force_m_s2().unwrap() - Vector3::new(0.0, 0.0, 9.81)).norm() < 5e-3);
        assert!((found.seconds() - 0.49 * found.windows.len() as f64).abs() < 1e-6);
    }

    #[test]
    fn a_steady_turn_is_no_bias_beyond_the_limit() {
        let mut rng = Rng::new(9);
        let turning = rows(&mut rng, 20, [0.0, 0.0, 0.3], 0.0..0.0);
        let found = rest(&[turning], &Options::default());
        assert!(found.windows.is_empty() && found.looked_at == 40 && found.force_m_s2().is_none());
    }

    #[test]
    fn nothing_is_found_in_nothing() {
        assert_eq!(rest::<Vec<Row>>(&[], &Options::default()).looked_at, 0);
        let row = Row {
            t_s: 0.0,
            rate_rad_s: [0.0; 3],
            force_m_s2: [0.0; 3],
        };
        // Two rows, rows without time between them, rows that are not finite.
        let nan = Row {
            rate_rad_s: [f64::NAN; 3],
            ..row
        };
        for rows in [vec![row; 2], vec![row; 9], vec![nan; 9]] {
            assert_eq!(rest(&[rows], &Options::default()).looked_at, 0);
        }
    }
}
