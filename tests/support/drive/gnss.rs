//! The GNSS receiver of a drive: fixes and velocities of its antenna.

use nalgebra::{UnitQuaternion, Vector3};

use super::covariance::{self, diagonal, diagonal6, rotate, rotate6};
use super::description::Gnss;
use super::errors::{self, Error, ned_from_enu, slots};
use super::random::Wander;
use super::rows::{FixRow, PoseRow, VelocityRow};
use super::{Drive, Stream};

/// How good a receiver is: standard deviations.
#[derive(Clone, Copy, Debug)]
pub struct Quality {
    /// East and north, forgotten in `tau_s`, metres; up is twice as bad.
    pub correlated: f64,
    /// Its time constant, seconds.
    pub tau_s: f64,
    /// White, metres; up is twice as bad.
    pub white: f64,
    /// Of the velocity, white, m/s; up is twice as bad.
    pub velocity: f64,
    /// Of the heading between two antennas, white, rad.
    pub heading: f64,
    /// `NavSatStatus.status`.
    pub status: i8,
}

impl Gnss {
    /// Its numbers.
    pub fn quality(self) -> Quality {
        match self {
            Self::Rtk => Quality {
                correlated: 0.012,
                tau_s: 30.0,
                white: 0.006,
                velocity: 0.05,
                heading: 0.2_f64.to_radians(),
                status: 2,
            },
            Self::Single => Quality {
                correlated: 1.5,
                tau_s: 60.0,
                white: 0.15,
                velocity: 0.15,
                heading: 0.5_f64.to_radians(),
                status: 0,
            },
            Self::Perfect => Quality {
                correlated: 0.0,
                tau_s: 1.0,
                white: 0.0,
                velocity: 0.0,
                heading: 0.0,
                status: 2,
            },
        }
    }
}

/// East, north and up of a deviation.
fn spread(deviation: f64) -> Vector3<f64> {
    Vector3::new(deviation, deviation, 2.0 * deviation)
}

impl Drive {
    /// What a receiver publishes as its position.
    pub fn fix_rows(&self, stream: &Stream) -> Vec<FixRow> {
        let quality = self.description.gnss.quality();
        let random = &mut self.random(&stream.name);
        let slow = Wander::new(
            random,
            spread(quality.correlated * stream.noise),
            quality.tau_s,
            self.known_s(),
        );
        let white = spread(quality.white * stream.noise);
        let deviation = spread(quality.correlated.hypot(quality.white) * stream.noise);
        let row = |t_s: &f64| {
            let then_s = t_s - stream.late_s;
            let state = self.at(then_s);
            let antenna = state.position + state.orientation * stream.base_from_sensor.translation.vector;
            let wrong = slow.at(then_s) + self.normals_at(&stream.name, then_s).component_mul(&white);
            let place = self.description.place.of_enu(antenna + wrong);
            let mut row = FixRow {
                t_s: *t_s,
                latitude: place.latitude,
                longitude: place.longitude,
                altitude: place.altitude,
                status: quality.status,
                covariance: diagonal(deviation).map(|value| value * stream.covariance_scale),
            };
            for error in &stream.errors {
                row.apply(*error, self.description.undulation_m);
            }
            row
        };
        stream.times_s.iter().map(row).collect()
    }

    /// What a receiver publishes as its velocity.
    pub fn velocity_rows(&self, stream: &Stream) -> Vec<VelocityRow> {
        let quality = self.description.gnss.quality();
        let name = format!("{} velocity", stream.name);
        let deviation = spread(quality.velocity * stream.noise);
        let row = |t_s: &f64| {
            let then_s = t_s - stream.late_s;
            let state = self.moment(then_s);
            let arm = stream.base_from_sensor.translation.vector;
            let wrong = self.normals_at(&name, then_s).component_mul(&deviation);
            let mut velocity = state.velocity + state.orientation * state.rate.cross(&arm) + wrong;
            let mut covariance = diagonal6(deviation, Vector3::zeros()).map(|value| value * stream.covariance_scale);
            for error in &stream.errors {
                match error {
                    Error::NedFrd | Error::NedWorld => {
                        velocity = ned_from_enu() * velocity;
                        rotate6(&mut covariance, &ned_from_enu(), &ned_from_enu());
                    }
                    Error::SwapXy => velocity = Vector3::new(velocity.y, velocity.x, velocity.z),
                    Error::TwistInBody => velocity = state.orientation.inverse() * velocity,
                    Error::TwistReversed => velocity = -velocity,
                    _ if covariance::apply6(&mut covariance, *error) => {}
                    _ => errors::refuse("gnss_velocity", *error),
                }
            }
            VelocityRow {
                t_s: *t_s,
                linear: velocity.into(),
                covariance,
            }
        };
        stream.times_s.iter().map(row).collect()
    }

    /// The heading between two antennas, as an orientation that is level: rows without a position.
    pub fn heading_rows(&self, stream: &Stream) -> Vec<PoseRow> {
        let deviation = self.description.gnss.quality().heading * stream.noise;
        let name = format!("{} heading", stream.name);
        let row = |t_s: &f64| {
            let then_s = t_s - stream.late_s;
            let yaw = self.moment(then_s).yaw + self.normals_at(&name, then_s).x * deviation;
            let level = UnitQuaternion::from_euler_angles(0.0, 0.0, yaw);
            let mut row = PoseRow {
                t_s: *t_s,
                position: [0.0; 3],
                orientation: slots(stream.world_from_enu.rotation * level * stream.base_from_sensor.rotation),
                covariance: diagonal6(Vector3::zeros(), Vector3::z() * deviation),
            };
            for error in &stream.errors {
                if !errors::apply(&mut row, *error) {
                    errors::refuse("heading", *error);
                }
            }
            row
        };
        stream.times_s.iter().map(row).collect()
    }
}

impl FixRow {
    /// Applies an error, at a place where the geoid is this high.
    pub fn apply(&mut self, error: Error, undulation_m: f64) {
        let both = |row: &mut Self, change: fn(f64) -> f64| {
            (row.latitude, row.longitude) = (change(row.latitude), change(row.longitude));
        };
        match error {
            Error::Swapped => std::mem::swap(&mut self.latitude, &mut self.longitude),
            Error::Msl => self.altitude -= undulation_m,
            Error::Radians => both(self, f64::to_radians),
            Error::E7 => both(self, |degrees| (degrees * 1e7).round()),
            Error::Float32 => both(self, |degrees| f64::from(degrees as f32)),
            Error::NedFrd => rotate(&mut self.covariance, &ned_from_enu()),
            _ if covariance::apply(&mut self.covariance, error) => {}
            _ => errors::refuse("fix", error),
        }
    }
}
