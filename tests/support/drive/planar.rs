//! Planar scanners of a drive: rays in the plane of the sensor's x and y, one after the other while it moves.

use nalgebra::{Isometry3, Vector3};

use super::Drive;
use super::random::Random;
use super::scene::Scene;

/// A kind of scanner.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Fan {
    /// Rays of a scan.
    pub rays: u32,
    /// How far it sees to each side, degrees.
    pub sides_deg: f64,
    /// From one scan to the next, seconds.
    pub period_s: f64,
    /// The farthest range, metres.
    pub reach_m: f64,
    /// Standard deviation of a range, metres.
    pub noise_m: f64,
}

impl Fan {
    /// Angles of the first ray and from one to the next, counter-clockwise in the sensor's axes, radians.
    pub fn angles(&self) -> [f64; 2] {
        let side = self.sides_deg.to_radians();
        [-side, 2.0 * side / f64::from((self.rays - 1).max(1))]
    }

    /// From one ray to the next, seconds: the scanner turns on where it does not see.
    pub fn ray_s(&self) -> f64 {
        self.period_s * self.angles()[1] / std::f64::consts::TAU
    }
}

impl Drive {
    /// The ranges of a scan that begins at a time, of a sensor whose axes are `base_from_sensor`, metres; infinite where nothing came
    /// back.
    pub fn fan(&self, scene: &Scene, fan: &Fan, base_from_sensor: &Isometry3<f64>, start_s: f64) -> Vec<f64> {
        let mut random = Random::at(self.description.seed, "planar", start_s);
        let [first, step] = fan.angles();
        let ray = |ray: u32| {
            let t_s = start_s + fan.ray_s() * f64::from(ray);
            let state = self.truth.moment(t_s);
            let position = self.truth.position(t_s);
            let from = position + state.orientation * base_from_sensor.translation.vector;
            let angle = first + step * f64::from(ray);
            let direction = Vector3::new(angle.cos(), angle.sin(), 0.0);
            let in_world = state.orientation * base_from_sensor.rotation * direction;
            let normal = state.orientation * Vector3::z();
            let range = scene.range(&from, &in_world, (&position, &normal), fan.reach_m);
            range.map_or(f64::INFINITY, |range| range + fan.noise_m * random.normal())
        };
        (0..fan.rays).map(ray).collect()
    }
}
