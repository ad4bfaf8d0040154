//! The IMU of a drive: orientation, turn rates and specific force, with the noise of its grade.

use nalgebra::{Rotation3, UnitQuaternion, Vector3};

use super::covariance::{self, diagonal, rotate};
use super::description::{Grade, Motion, Vehicle};
use super::errors::{self, Error, OrientedRow, frd_from_flu, mirrored, rotation, slots};
use super::random::Correlated;
use super::rows::ImuRow;
use super::{Drive, Stream};

/// How good an IMU is: standard deviations.
#[derive(Clone, Copy, Debug)]
pub struct Quality {
    /// White, each sample, rad/s.
    pub gyro: f64,
    /// Constant, each axis, rad/s.
    pub gyro_bias: f64,
    /// White, each sample, m/s².
    pub acceleration: f64,
    /// Constant, each axis, m/s².
    pub acceleration_bias: f64,
    /// Of the orientation about each axis of the world, forgotten in half a second, rad.
    pub orientation: f64,
    /// Of the yaw beyond that, forgotten in a minute, rad.
    pub yaw: f64,
    /// Of the yaw, constant (magnetic declination, mounting), rad.
    pub yaw_offset: f64,
    /// How much older the orientation is than the turn rates, seconds.
    pub orientation_lag_s: f64,
}

impl Grade {
    /// Its numbers: `tactical` and `mems` as the two IMUs that the rules were simulated with.
    pub fn quality(self) -> Quality {
        match self {
            Self::Tactical => Quality {
                gyro: 0.003,
                gyro_bias: 0.005,
                acceleration: 0.02,
                acceleration_bias: 0.02,
                orientation: 0.15_f64.to_radians(),
                yaw: 0.3_f64.to_radians(),
                yaw_offset: 0.5_f64.to_radians(),
                orientation_lag_s: 0.01,
            },
            Self::Mems => Quality {
                gyro: 0.02,
                gyro_bias: 0.02,
                acceleration: 0.1,
                acceleration_bias: 0.15,
                orientation: 1.0_f64.to_radians(),
                yaw: 1.5_f64.to_radians(),
                yaw_offset: 5.0_f64.to_radians(),
                orientation_lag_s: 0.05,
            },
            Self::Perfect => Quality {
                gyro: 0.0,
                gyro_bias: 0.0,
                acceleration: 0.0,
                acceleration_bias: 0.0,
                orientation: 0.0,
                yaw: 0.0,
                yaw_offset: 0.0,
                orientation_lag_s: 0.0,
            },
        }
    }
}

/// What motors, wheels and steps shake the IMU with while the vehicle moves: rad/s and m/s², white.
fn vibration(vehicle: Vehicle) -> (f64, f64) {
    match vehicle {
        Vehicle::Car => (0.002, 0.15),
        Vehicle::Walker => (0.01, 0.3),
        Vehicle::Drone => (0.02, 0.5),
        Vehicle::Robot => (0.005, 0.3),
    }
}

impl Drive {
    /// What an IMU publishes. Its axes are those of `base_from_sensor`, its orientation is
    /// `world_from_sensor`.
    pub fn imu_rows(&self, stream: &Stream) -> Vec<ImuRow> {
        let quality = self.description.imu.quality();
        let shaken = self.description.motion != Motion::Still && self.description.imu != Grade::Perfect;
        let (shake_gyro, shake_force) = if shaken {
            vibration(self.description.vehicle)
        } else {
            (0.0, 0.0)
        };
        let lag_s = stream.orientation_lag_s.unwrap_or(quality.orientation_lag_s);
        let mount = stream.base_from_sensor;
        let all = |value: f64| Vector3::repeat(value * stream.noise);

        let random = &mut self.random(&stream.name);
        let gyro_bias = random.normals().component_mul(&all(quality.gyro_bias));
        let force_bias = random.normals().component_mul(&all(quality.acceleration_bias));
        let yaw_offset = random.normal() * quality.yaw_offset * stream.noise;
        let mut fast = Correlated::new(all(quality.orientation), 0.5);
        let mut slow = Correlated::new(Vector3::z() * (quality.yaw * stream.noise), 60.0);
        let yaw_deviation = quality.orientation.hypot(quality.yaw).hypot(quality.yaw_offset) * stream.noise;
        let tilt_deviation = quality.orientation * stream.noise;
        let gyro_deviation = all(quality.gyro.hypot(shake_gyro));
        let force_deviation = all(quality.acceleration.hypot(shake_force));

        let row = |t_s: &f64| {
            let state = self.moment(t_s - stream.late_s);
            let shown = if lag_s > 0.0 {
                self.moment(t_s - stream.late_s - lag_s)
            } else {
                state
            };
            let wrong = fast.at(*t_s, random) + slow.at(*t_s, random) + Vector3::z() * yaw_offset;
            let orientation = UnitQuaternion::from_scaled_axis(wrong) * shown.orientation * mount.rotation;
            let sensor_from_base = mount.rotation.inverse();
            let force = self.specific_force(&state, mount.translation.vector);
            let gyro_noise = gyro_bias + random.normals().component_mul(&gyro_deviation);
            let force_noise = force_bias + random.normals().component_mul(&force_deviation);
            let mut row = ImuRow {
                t_s: *t_s,
                orientation: slots(orientation),
                orientation_covariance: diagonal(Vector3::new(tilt_deviation, tilt_deviation, yaw_deviation)),
                gyro: (sensor_from_base * state.rate + gyro_noise).into(),
                gyro_covariance: diagonal(gyro_deviation),
                acceleration: (sensor_from_base * force + force_noise).into(),
                acceleration_covariance: diagonal(force_deviation),
            };
            row.change_world(&stream.world_from_enu.rotation.to_rotation_matrix());
            for covariance in row.covariances() {
                *covariance = covariance.map(|value| value * stream.covariance_scale);
            }
            for error in &stream.errors {
                row.apply(*error, self.description.place.gravity());
            }
            row
        };
        stream.times_s.iter().map(row).collect()
    }
}

impl ImuRow {
    /// Applies an error. Only a row that still tells its orientation can lose the place's gravity.
    pub fn apply(&mut self, error: Error, gravity: f64) {
        if errors::apply(self, error) {
            return;
        }
        match error {
            Error::Frd => self.turn_vectors(&frd_from_flu()),
            Error::DegS => self.gyro = self.gyro.map(f64::to_degrees),
            Error::GyroNegated => self.gyro = self.gyro.map(|rate| -rate),
            Error::NoOrientation => {
                self.orientation = [0.0, 0.0, 0.0, 1.0];
                self.orientation_covariance[0] = -1.0;
            }
            Error::GyroMissing => self.gyro = [0.0; 3],
            Error::CmS2 => self.acceleration = self.acceleration.map(|force| force * 100.0),
            Error::G => self.acceleration = self.acceleration.map(|force| force / 9.806_65),
            Error::AccelYNegated => self.acceleration[1] = -self.acceleration[1],
            Error::AccelSwapped => self.acceleration.swap(0, 1),
            Error::GravitySign => self.acceleration = self.acceleration.map(|force| -force),
            Error::GravityRemoved => {
                let up = rotation(self.orientation).inverse() * Vector3::z() * gravity;
                self.acceleration = (Vector3::from(self.acceleration) - up).into();
            }
            Error::CovarianceDegrees => {
                for covariance in [&mut self.orientation_covariance, &mut self.gyro_covariance] {
                    *covariance = covariance.map(|value| value * 1.0_f64.to_degrees().powi(2));
                }
            }
            _ => {
                let applied = self
                    .covariances()
                    .map(|covariance| covariance::apply(covariance, error));
                if applied != [true; 3] {
                    errors::refuse("imu", error);
                }
            }
        }
    }

    fn covariances(&mut self) -> [&mut [f64; 9]; 3] {
        [
            &mut self.orientation_covariance,
            &mut self.gyro_covariance,
            &mut self.acceleration_covariance,
        ]
    }

    fn turn_vectors(&mut self, new_from_old: &Rotation3<f64>) {
        self.gyro = (new_from_old * Vector3::from(self.gyro)).into();
        self.acceleration = (new_from_old * Vector3::from(self.acceleration)).into();
        rotate(&mut self.gyro_covariance, new_from_old);
        rotate(&mut self.acceleration_covariance, new_from_old);
    }
}

impl OrientedRow for ImuRow {
    fn orientation(&mut self) -> &mut [f64; 4] {
        &mut self.orientation
    }

    fn change_world(&mut self, new_from_old: &Rotation3<f64>) {
        self.orientation = slots(new_from_old * rotation(self.orientation));
        rotate(&mut self.orientation_covariance, new_from_old);
    }

    fn change_body(&mut self, old_from_new: &Rotation3<f64>) {
        self.orientation = slots(rotation(self.orientation) * old_from_new);
        self.turn_vectors(&old_from_new.inverse());
    }

    fn mirror(&mut self) {
        self.orientation = mirrored(self.orientation);
        let ([wx, wy, wz], [fx, fy, fz]) = (self.gyro, self.acceleration);
        self.gyro = [-wx, wy, -wz];
        self.acceleration = [fx, -fy, fz];
    }
}
