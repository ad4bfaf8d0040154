//! How far the direction of gravity moves in the axes of a body, compared with the rotation by its gyro: the unit of a gyro without any
//! orientation.
//!
//! The direction g of gravity, a unit vector in the axes of the body, changes by `dg/dt = g x w`. Over a short window the change is
//! regressed on `g x theta`, theta being the integral of the gyro. The slope is 1 for rad/s and pi/180 for deg/s. Rotations about the
//! vertical do not count. Must not know which message held the rows.

use nalgebra::Vector3;

/// One window of rows of a gyro, rad/s by definition, and an accelerometer, any unit, in the same axes: `(seconds, gyro, force)`.
pub type TiltRow = (f64, Vector3<f64>, Vector3<f64>);

/// Share of a window at each of its ends over which the force is averaged.
const END: f64 = 0.2;
/// How far a force may be from its median magnitude, as a share: what is farther is no gravity.
const STEADY: f64 = 0.15;

/// The rotation of gravity compared with that of the gyro.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Tilting {
    /// Rotation of gravity over rotation by the gyro.
    pub gain: f64,
    /// Correlation of the two, by the components of all windows.
    pub correlation: f64,
    /// Windows that count.
    pub windows: usize,
    /// Root of the sum of squared rotations of gravity, radians: those that the gyro does not explain, too.
    pub turned_rad: f64,
    /// The largest angle between the directions of gravity in two windows, about, radians. What exceeds twice the angle whose cosine is
    /// one over 1 plus the tolerance of its magnitude, 60 degrees, is no acceleration of a vehicle.
    pub range_rad: f64,
}

impl Tilting {
    /// Of windows that last about half a second; `None` without any whose force is that of gravity.
    pub fn of(windows: &[Vec<TiltRow>], median_force: f64) -> Option<Self> {
        let (mut xx, mut xy, mut yy) = (0.0, 0.0, 0.0);
        let changes: Vec<_> = windows
            .iter()
            .filter_map(|window| change(window, median_force))
            .collect();
        let farthest = |from: &Vector3<f64>| {
            let to = changes.iter().map(|(to, ..)| *to);
            to.max_by(|a, b| from.angle(a).total_cmp(&from.angle(b)))
        };
        let ends = changes.first().and_then(|(first, ..)| {
            let one = farthest(first)?;
            Some((one, farthest(&one)?))
        });
        for (_, by_gravity, by_gyro) in &changes {
            xx += by_gyro.norm_squared();
            xy += by_gyro.dot(by_gravity);
            yy += by_gravity.norm_squared();
        }
        let found = Self {
            gain: xy / xx,
            correlation: xy / (xx * yy).sqrt(),
            windows: changes.len(),
            turned_rad: yy.sqrt(),
            range_rad: ends.map_or(0.0, |(one, other)| one.angle(&other)),
        };
        (found.gain.is_finite() && found.correlation.is_finite()).then_some(found)
    }

    /// Student's t of the correlation: two numbers of each window are free.
    pub fn t(&self) -> f64 {
        let rest = (1.0 - self.correlation * self.correlation).max(1e-12);
        self.correlation * ((2.0 * self.windows as f64 - 1.0).max(0.0) / rest).sqrt()
    }
}

/// Gravity's direction at the end of a window, its change, and that which the gyro predicts.
fn change(window: &[TiltRow], median_force: f64) -> Option<(Vector3<f64>, Vector3<f64>, Vector3<f64>)> {
    let (first, last) = (window.first()?, window.last()?);
    let length_s = last.0 - first.0;
    let mean = |rows: Vec<&TiltRow>| {
        let count = rows.len() as f64;
        let t_s = rows.iter().map(|row| row.0).sum::<f64>() / count;
        let force = rows.iter().map(|row| row.2).sum::<Vector3<f64>>() / count;
        let is_gravity = (force.norm() / median_force - 1.0).abs() <= STEADY;
        is_gravity.then(|| (t_s, force.normalize()))
    };
    let (from_s, from) = mean(window.iter().filter(|row| row.0 <= first.0 + END * length_s).collect())?;
    let (to_s, to) = mean(window.iter().filter(|row| row.0 >= last.0 - END * length_s).collect())?;
    let rate = window.iter().map(|row| row.1).sum::<Vector3<f64>>() / window.len() as f64;
    Some((to, to - from, ((from + to) / 2.0).cross(&(rate * (to_s - from_s)))))
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use nalgebra::UnitQuaternion;

    use super::*;
    use crate::math::tests_support::Rng;

    /// Windows of half a second at 100 Hz of a body that rotates at a rate of its own in each; the gyro in a unit, the force with noise.
    fn windows(
        rng: &mut Rng,
        per_rad_s: f64,
        noise_m_s2: f64,
        rate: impl Fn(&mut Rng) -> Vector3<f64>,
    ) -> Vec<Vec<TiltRow>> {
        let mut world_from_body = UnitQuaternion::identity();
        let mut of_one = |rng: &mut Rng| {
            let rate = rate(rng);
            let row = |k: u32| {
                world_from_body *= UnitQuaternion::from_scaled_axis(rate * 0.01);
                let force = world_from_body.inverse() * (Vector3::z() * 9.81) + rng.normal3() * noise_m_s2;
                (f64::from(k) * 0.01, rate * per_rad_s, force)
            };
            (0..51).map(row).collect()
        };
        (0..60).map(|_| of_one(rng)).collect()
    }

    #[test]
    fn the_slope_is_the_unit_of_the_gyro() {
        let mut rng = Rng::new(5);
        for per_rad_s in [1.0, 1f64.to_degrees(), 1f64.to_radians()] {
            for noise in [0.0, 1.0] {
                let made = windows(&mut rng, per_rad_s, noise, |rng| rng.in_ball(1.0));
                let found = Tilting::of(&made, 9.81).unwrap();
                let gain = found.gain * per_rad_s;
                // Four standard errors; without noise that of the mean rate.
                let error = if noise > 0.0 { 4.0 / found.t() } else { 0.02 };
                assert!((gain - 1.0).abs() < error, "{per_rad_s} {noise}: {found:?}");
                assert!(found.correlation > 0.9 && found.t() > 10.0, "{noise}: {found:?}");
            }
        }
    }

    #[test]
    fn rotation_about_the_vertical_and_noise_show_nothing() {
        let mut rng = Rng::new(6);
        let yaw = windows(&mut rng, 1.0, 0.5, |rng| Vector3::z() * rng.range(-1.0, 1.0));
        assert!(Tilting::of(&yaw, 9.81).unwrap().correlation.abs() < 0.5);
        let still = windows(&mut rng, 1.0, 0.5, |_| Vector3::zeros());
        assert_eq!(Tilting::of(&still, 9.81), None, "the gyro reads zero");
        let falling = windows(&mut rng, 1.0, 0.5, |rng| rng.in_ball(1.0));
        assert_eq!(Tilting::of(&falling, 1.0), None, "no force is that of gravity");
        assert_eq!(Tilting::of(&[], 9.81), None);
    }

    /// A stiff vehicle that speeds up and brakes: its force turns by as many degrees as a gyro in deg/s says rad. Only the range tells.
    #[test]
    fn an_acceleration_stays_within_the_range_that_vehicles_have() {
        let made = (0..60).map(|window: u32| {
            let row = |k: u32| {
                let t_s = f64::from(window) * 0.5 + f64::from(k) * 0.01;
                let force = Vector3::new(5.0 * t_s.sin(), 0.0, 9.81);
                // 1/57 of the angle of the force, in deg/s.
                let rate = -(5.0 * t_s.cos() / 9.81) / 57.3 * 57.3;
                (t_s, Vector3::new(0.0, rate, 0.0), force)
            };
            (0..51).map(row).collect()
        });
        let found = Tilting::of(&made.collect::<Vec<_>>(), 9.81).unwrap();
        assert!(found.correlation.abs() > 0.9, "{found:?}");
        assert!((0.8..60f64.to_radians()).contains(&found.range_rad), "{found:?}");
        let mut rng = Rng::new(7);
        let tumbling = windows(&mut rng, 1.0, 0.5, |rng| rng.in_ball(2.0));
        assert!(Tilting::of(&tumbling, 9.81).unwrap().range_rad > 70f64.to_radians());
    }
}
