//! Lidars of a drive: rays from where the sensor is at each moment, to where they end.
//!
//! Owns the geometry of the sensors, in their native axes, and the distortion by motion. What a driver makes of it is elsewhere.
//! Sources: data sheets (elevations, columns); Ouster: column m of W is measured at an encoder angle of `2 pi (1 - m / W)`, a beam
//! looks clockwise beside it by its `beam_azimuth_angles`, and `pixel_shift_by_row` moves its row to later columns by as much.

use std::f64::consts::TAU;

use nalgebra::{Isometry3, UnitQuaternion, Vector3};
use serde::Deserialize;

use super::Drive;
use super::random::Random;
use super::scene::{Scene, Surroundings};

/// A kind of lidar.
#[derive(Clone, Debug, PartialEq)]
pub struct Scanner {
    /// Elevation of each beam, in the order of their numbers, degrees.
    pub elevations_deg: Vec<f64>,
    /// By how much each beam looks beside the encoder's angle, clockwise from above, degrees; empty where none does.
    pub aside_deg: Vec<f64>,
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

/// The elevations of a sensor's beams.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Beams {
    /// Evenly from 15 degrees up to 25 down.
    #[default]
    Even,
    /// VLP-16: every 2 degrees from 15 to -15 (Velodyne, VLP-16 user manual).
    Vlp16,
    /// Pandar40P: dense near the horizon (Hesai, Pandar40P user manual).
    Pandar40,
    /// OS1, first generation: 33.2 degrees, evenly, four columns of beams 2.1 degrees apart (its `beam_azimuth_angles`).
    Os1,
}

impl Scanner {
    /// A spinning one of so many beams: 25 degrees down to 15 degrees up, 10 Hz.
    pub fn spinning(beams: u32, columns: u32) -> Self {
        Self::of(Beams::Even, beams, columns)
    }

    /// A spinning one with the beams of a table, so many of them where the table does not say.
    pub fn of(table: Beams, beams: u32, columns: u32) -> Self {
        let even = |high: f64, low: f64, beams: u32| -> Vec<f64> {
            let share = |ring: u32| f64::from(ring) / f64::from((beams - 1).max(1));
            (0..beams).map(|ring| high + (low - high) * share(ring)).collect()
        };
        let elevations_deg = match table {
            Beams::Even => even(15.0, -25.0, beams),
            Beams::Vlp16 => even(15.0, -15.0, 16),
            Beams::Pandar40 => {
                let parts = [
                    vec![15.0, 11.0, 8.0, 5.0, 3.0],
                    even(2.0, -6.0, 25),
                    even(-7.0, -14.0, 8),
                ];
                [parts.concat(), vec![-19.0, -25.0]].concat()
            }
            Beams::Os1 => even(16.6, -16.6, beams),
        };
        let aside_deg = match table {
            Beams::Os1 => vec![3.164, 1.055, -1.055, -3.164],
            _ => Vec::new(),
        };
        Self {
            elevations_deg,
            aside_deg,
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

    /// How many beams.
    pub fn beams(&self) -> u32 {
        u32::try_from(self.elevations_deg.len()).unwrap()
    }

    /// How far a beam looks beside the encoder's angle, clockwise, degrees.
    pub fn aside_deg(&self, ring: u32) -> f64 {
        let number = (ring as usize).checked_rem(self.aside_deg.len());
        number.map_or(0.0, |number| self.aside_deg[number])
    }

    /// By how many columns a row is moved so that columns are of one direction: later is farther clockwise.
    pub fn pixel_shift(&self, ring: u32) -> usize {
        let least = self.aside_deg.iter().copied().fold(0.0, f64::min);
        let share = (self.aside_deg(ring) - least) / 360.0;
        (share * f64::from(self.columns)).round() as usize
    }
}

/// One ray.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ray {
    /// Beam.
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
        let way = |t_s: f64| {
            let orientation = self.truth.moment(t_s).orientation;
            Isometry3::from_parts(self.truth.position(t_s).into(), orientation)
        };
        cast(&way, self.description.seed, scene, scanner, base_from_sensor, start_s)
    }
}

/// The rays of one scan that begins at a time, of a sensor on a base that goes a way (`world_from_base` at a time, z up) on the ground.
pub fn cast(
    way: &dyn Fn(f64) -> Isometry3<f64>,
    seed: u64,
    scene: &Scene,
    scanner: &Scanner,
    base_from_sensor: &Isometry3<f64>,
    start_s: f64,
) -> Vec<Ray> {
    let mut random = Random::at(seed, "lidar", start_s);
    let mut rays = Vec::new();
    for column in 0..scanner.columns {
        let after_s = scanner.period_s * f64::from(column) / f64::from(scanner.columns);
        let lean = UnitQuaternion::from_axis_angle(&Vector3::x_axis(), scene.lean_rad(start_s + after_s));
        let base = way(start_s + after_s);
        let (position, orientation) = (base.translation.vector, base.rotation);
        // The ground is where the wheels are, and leans as they do.
        let normal = orientation * lean * Vector3::z();
        let from = position + orientation * base_from_sensor.translation.vector;
        for ring in 0..scanner.beams() {
            let elevation = scanner.elevations_deg[ring as usize].to_radians();
            // Clockwise from above, beginning at the back.
            let azimuth = match scanner.sides_deg {
                None => {
                    let encoder = TAU / 2.0 - TAU * f64::from(column) / f64::from(scanner.columns);
                    encoder - scanner.aside_deg(ring).to_radians()
                }
                Some(sides) => random.between(-sides, sides).to_radians(),
            };
            let direction = Vector3::new(
                elevation.cos() * azimuth.cos(),
                elevation.cos() * azimuth.sin(),
                elevation.sin(),
            );
            let in_world = orientation * base_from_sensor.rotation * direction;
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
