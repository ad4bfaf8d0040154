//! Radars of a drive: what stands at the roadside and other cars, with range and range rate.
//!
//! Owns where they are, and the geometry in the sensor's axes. What a driver makes of it is elsewhere.

use nalgebra::{Isometry3, Rotation3, Vector3};

use super::Drive;
use super::random::Random;

/// The sides of the squares that reflectors are laid out in, metres.
const SQUARE_M: f64 = 25.0;
/// Standard deviations of range, azimuth and elevation, and range rate: metres, radians, m/s.
const NOISE: [f64; 3] = [0.15, 0.007, 0.08];
/// Detections that a car makes.
const OF_A_CAR: u32 = 3;

/// A kind of radar.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Antenna {
    /// How far to each side it sees, degrees.
    pub sides_deg: f64,
    /// How far up and down, degrees.
    pub up_deg: f64,
    /// The farthest range, metres.
    pub reach_m: f64,
    /// Share of what could be seen that is lost in a scan.
    pub lost: f64,
    /// Reflectors that stand still, in a square of 25 m.
    pub reflectors: u32,
    /// Other cars that are met.
    pub movers: u32,
}

/// A detection.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Echo {
    /// In the sensor's axes (x forward, y left, z up), metres.
    pub place: Vector3<f64>,
    /// How fast it goes away, m/s.
    pub rate: f64,
    /// How fast it would if it stood still, m/s.
    pub still_rate: f64,
}

impl Drive {
    /// The detections of a scan at a time, of a sensor whose axes are `base_from_sensor`.
    pub fn echoes(&self, antenna: &Antenna, base_from_sensor: &Isometry3<f64>, t_s: f64, noise: f64) -> Vec<Echo> {
        let state = self.moment(t_s);
        let position = self.truth.position(t_s);
        let arm = base_from_sensor.translation.vector;
        let from = position + state.orientation * arm;
        let velocity = state.velocity + state.orientation * state.rate.cross(&arm);
        let world_from_sensor = state.orientation * base_from_sensor.rotation;
        let mut random = Random::at(self.description.seed, "radar", t_s);
        let mut echoes = Vec::new();
        let mut see = |random: &mut Random, place: Vector3<f64>, moving: Vector3<f64>| {
            let is_lost = random.between(0.0, 1.0) < antenna.lost;
            let [range_noise, angle_noise, rate_noise] = NOISE.map(|deviation| deviation * noise * random.normal());
            let up_noise = NOISE[1] * noise * random.normal();
            let seen = world_from_sensor.inverse() * (place - from);
            let (range, flat) = (seen.norm(), seen.xy().norm());
            let (azimuth, elevation) = (seen.y.atan2(seen.x), seen.z.atan2(flat));
            let is_seen = (3.0..antenna.reach_m).contains(&range)
                && azimuth.abs() < antenna.sides_deg.to_radians()
                && elevation.abs() < antenna.up_deg.to_radians();
            if is_lost || !is_seen {
                return;
            }
            let line = (place - from) / range;
            let turned = Rotation3::from_euler_angles(0.0, -elevation - up_noise, azimuth + angle_noise);
            echoes.push(Echo {
                place: turned * Vector3::x() * (range + range_noise),
                rate: (moving - velocity).dot(&line) + rate_noise,
                still_rate: -velocity.dot(&line),
            });
        };
        let reach = (antenna.reach_m / SQUARE_M).ceil() as i64;
        let number = |value: f64| (value / SQUARE_M).floor() as i64;
        for i in number(from.x) - reach..=number(from.x) + reach {
            for j in number(from.y) - reach..=number(from.y) + reach {
                let mut fixed = Random::new(self.description.seed, &format!("reflectors {i} {j}"));
                for _ in 0..antenna.reflectors {
                    let [x, y, z] = [
                        fixed.between(0.0, SQUARE_M),
                        fixed.between(0.0, SQUARE_M),
                        fixed.between(0.0, 2.0),
                    ];
                    let place = Vector3::new(i as f64 * SQUARE_M + x, j as f64 * SQUARE_M + y, position.z + z);
                    see(&mut random, place, Vector3::zeros());
                }
            }
        }
        for car in 0..antenna.movers {
            let mut fixed = Random::new(self.description.seed, &format!("car {car}"));
            let met_s = fixed.between(0.0, self.description.duration_s);
            let met = self.moment(met_s);
            let ahead = Rotation3::from_axis_angle(&Vector3::z_axis(), met.yaw);
            let side = if car % 2 == 0 { 1.0 } else { -1.0 };
            let beside = Vector3::new(fixed.between(-40.0, 60.0), side * fixed.between(3.0, 8.0), 0.5);
            let moving = ahead * Vector3::x() * (side * fixed.between(-2.0, 25.0));
            let place = self.truth.position(met_s) + ahead * beside + moving * (t_s - met_s);
            for part in 0..OF_A_CAR {
                let apart = ahead * Vector3::new(f64::from(part) * 1.5, 0.0, 0.0);
                see(&mut random, place + apart, moving);
            }
        }
        echoes
    }
}
