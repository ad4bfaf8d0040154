//! Lidars of a drive: rays from where the sensor is at each moment, to where they end.
//!
//! Owns the geometry of the sensors, in their native axes, and the distortion by motion. What a driver makes of it is elsewhere.
//! Sources: data sheets (elevations, columns); Ouster: column m of W is measured at an encoder angle of `2 pi (1 - m / W)`.

use std::f64::consts::TAU;

use nalgebra::{Isometry3, UnitQuaternion, Vector3};

use super::Drive;
use super::random::Random;
use super::scene::{Scene, Surroundings};

/// A kind of lidar.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Scanner {
    /// Elevations of the beams, lowest and highest, degrees.
    pub elevation_deg: [f64; 2],
    /// How many beams.
    pub beams: u32,
    /// Columns of a turn, or points of each beam of a sensor that does not spin.
    pub columns: u32,
    /// Time of a scan, seconds.
    pub period_s: f64,
    /// How far to the sides a sensor sees that does not spin, degrees; `None` of one that does.
    pub sides_deg: Option<f64>,
    /// The farthest range, metres.
    pub reach_m: f64,
    /// Standard deviation of a range, metres.
    pub noise_m: f64,
    /// Share of the rays that are lost.
    pub lost: f64,
}

impl Scanner {
    /// A spinning one of so many beams: 30 degrees down to 15 degrees up, 10 Hz.
    pub fn spinning(beams: u32, columns: u32) -> Self {
        Self {
            elevation_deg: [-25.0, 15.0],
            beams,
            columns,
            period_s: 0.1,
            sides_deg: None,
            reach_m: 80.0,
            noise_m: 0.02,
            lost: 0.03,
        }
    }

    /// One that does not spin: 70 degrees across, points in no order of angle.
    pub fn solid_state() -> Self {
        Self {
            sides_deg: Some(35.0),
            ..Self::spinning(6, 600)
        }
    }
}

/// One ray.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ray {
    /// Beam, from the highest.
    pub ring: u32,
    /// Column in the order of measuring.
    pub column: u32,
    /// After the beginning of the scan, seconds.
    pub after_s: f64,
    /// Where it ended, in the sensor's axes (x forward, y left, z up), metres; `None` where nothing came back.
    pub place: Option<Vector3<f64>>,
}

impl Drive {
    /// The place around the drive.
    pub fn scene(&self, surroundings: Surroundings) -> Scene {
        let seconds = self.description.duration_s;
        Scene::around(&self.truth, 0.0..=seconds, self.description.seed, surroundings, 80.0)
    }

    /// The rays of one scan that begins at a time, of a sensor whose axes are `base_from_sensor`.
    pub fn scan(&self, scene: &Scene, scanner: &Scanner, base_from_sensor: &Isometry3<f64>, start_s: f64) -> Vec<Ray> {
        let mut random = Random::at(self.description.seed, "lidar", start_s);
        let mut rays = Vec::new();
        for column in 0..scanner.columns {
            let after_s = scanner.period_s * f64::from(column) / f64::from(scanner.columns);
            let lean = UnitQuaternion::from_axis_angle(&Vector3::x_axis(), scene.lean_rad(start_s + after_s));
            let state = self.truth.moment(start_s + after_s);
            let position = self.truth.position(start_s + after_s);
            // The ground is where the wheels are, and leans as they do.
            let normal = state.orientation * lean * Vector3::z();
            let from = position + state.orientation * base_from_sensor.translation.vector;
            for ring in 0..scanner.beams {
                let share = f64::from(ring) / f64::from((scanner.beams - 1).max(1));
                let [low, high] = scanner.elevation_deg;
                let elevation = (high + (low - high) * share).to_radians();
                // Clockwise from above, beginning at the back.
                let azimuth = match scanner.sides_deg {
                    None => TAU / 2.0 - TAU * f64::from(column) / f64::from(scanner.columns),
                    Some(sides) => random.between(-sides, sides).to_radians(),
                };
                let direction = Vector3::new(
                    elevation.cos() * azimuth.cos(),
                    elevation.cos() * azimuth.sin(),
                    elevation.sin(),
                );
                let in_world = state.orientation * base_from_sensor.rotation * direction;
                let is_lost = random.between(0.0, 1.0) < scanner.lost;
                let range = scene.range(&from, &in_world, (&position, &normal), scanner.reach_m);
                let range = range
                    .filter(|_| !is_lost)
                    .map(|range| range + scanner.noise_m * random.normal());
                rays.push(Ray {
                    ring,
                    column,
                    after_s,
                    place: range.map(|range| direction * range),
                });
            }
        }
        rays
    }
}
