//! The odometry of a drive: a pose that begins at zero and drifts, and the twist of the child frame.

use nalgebra::{Isometry3, Rotation3, Translation3, UnitQuaternion, Vector3};

use super::covariance::{self, diagonal6, rotate6};
use super::description::{Vehicle, Wheels};
use super::errors::{self, Error, OrientedRow, rotation, slots, turn};
use super::pose::apply_position;
use super::random::series;
use super::rows::{OdometryRow, PoseRow};
use super::spline::{Integral, Spline};
use super::vehicle::MARGIN_S;
use super::{Drive, Stream};

/// Standard deviations of wheel odometry; cars and robots know nothing of height, roll and pitch.
mod real {
    /// Distances are this much too short or too long, at most and evenly: a tyre's radius.
    pub(super) const SCALE: [f64; 2] = [0.96, 1.01];
    /// Constant error of the yaw rate, rad/s.
    pub(super) const YAW_RATE_BIAS: f64 = 0.001;
    /// Wandering error of the yaw rate, forgotten in five seconds, rad/s.
    pub(super) const YAW_RATE: f64 = 0.002;
    /// White noise of the twist: ahead, m/s; aside and up are a quarter of it.
    pub(super) const LINEAR: f64 = 0.02;
    /// White noise of the twist, rad/s.
    pub(super) const ANGULAR: f64 = 0.005;
    /// What the covariance says of the pose: along and across the way, metres, and yaw, rad.
    pub(super) const POSE: [f64; 3] = [0.05, 0.02, 0.03];
}

/// Where odometry believes the vehicle to be.
#[derive(Debug)]
pub struct Drift {
    scale: f64,
    planar: bool,
    yaw_error: Spline,
    yaw_start: f64,
    path: Integral,
}

impl Drive {
    /// What odometry publishes. Its drift belongs to the drive: all streams of a drive share it.
    pub fn odometry_rows(&self, stream: &Stream) -> Vec<OdometryRow> {
        let random = &mut self.random(&stream.name);
        let noise = if self.description.odometry == Wheels::Perfect {
            0.0
        } else {
            stream.noise
        };
        let linear_noise = Vector3::new(1.0, 0.25, 0.25) * (real::LINEAR * noise);
        let angular_noise = Vector3::repeat(real::ANGULAR * noise);
        let planar = if self.planar() {
            Vector3::z()
        } else {
            Vector3::repeat(1.0)
        };
        let row = |t_s: &f64| {
            let (pose, linear, angular) = self.odometry(t_s - stream.late_s);
            let linear = linear + random.normals().component_mul(&linear_noise);
            let angular = angular + random.normals().component_mul(&angular_noise).component_mul(&planar);
            let [along, across, yaw] = real::POSE.map(|deviation| deviation * noise);
            let mut covariance = diagonal6(Vector3::new(along, across, across), Vector3::z() * yaw);
            if !stream.has(Error::CovarianceNotRotated) {
                rotate6(
                    &mut covariance,
                    &turn(pose.rotation.euler_angles().2),
                    &Rotation3::identity(),
                );
            }
            let mut row = OdometryRow {
                pose: PoseRow::new(*t_s, pose, &covariance),
                linear: linear.into(),
                angular: angular.into(),
                twist_covariance: diagonal6(linear_noise, angular_noise.component_mul(&planar)),
            };
            for covariance in [&mut row.pose.covariance, &mut row.twist_covariance] {
                *covariance = covariance.map(|value| value * stream.covariance_scale);
            }
            row.pose
                .change_world(&stream.world_from_enu.rotation.to_rotation_matrix());
            row.pose.shift(stream.world_from_enu.translation.vector);
            for error in &stream.errors {
                row.apply(*error);
            }
            row
        };
        stream.times_s.iter().map(row).collect()
    }

    /// `odom_from_base`, and the twist in the base's axes, as odometry believes them, without white noise.
    pub fn odometry(&self, t_s: f64) -> (Isometry3<f64>, Vector3<f64>, Vector3<f64>) {
        let drift = self.odometry.get_or_init(|| self.drift());
        let state = self.truth.moment(t_s);
        let [wrong, wrong_rate, _] = drift.yaw_error.jet(t_s);
        let position = drift.path.at(t_s, |t_s| self.odometry_velocity(drift, t_s));
        let odom_from_enu = turn(wrong - drift.yaw_start);
        let (orientation, angular) = if drift.planar {
            let yaw = turn(state.yaw + wrong - drift.yaw_start);
            (yaw.into(), Vector3::z() * (state.yaw_rate + wrong_rate))
        } else {
            let up = state.orientation.inverse() * Vector3::z();
            (odom_from_enu * state.orientation, state.rate + up * wrong_rate)
        };
        let orientation: UnitQuaternion<f64> = orientation;
        let linear = orientation.inverse() * self.odometry_velocity(drift, t_s);
        (
            Isometry3::from_parts(Translation3::from(position), orientation),
            linear,
            angular,
        )
    }

    /// Whether odometry knows nothing of height, roll and pitch.
    pub fn planar(&self) -> bool {
        matches!(self.description.vehicle, Vehicle::Car | Vehicle::Robot)
    }

    fn odometry_velocity(&self, drift: &Drift, t_s: f64) -> Vector3<f64> {
        let turned = turn(drift.yaw_error.at(t_s) - drift.yaw_start) * self.truth.velocity(t_s);
        let velocity = turned * drift.scale;
        if drift.planar {
            Vector3::new(velocity.x, velocity.y, 0.0)
        } else {
            velocity
        }
    }

    fn drift(&self) -> Drift {
        let random = &mut self.random("drift of odometry");
        let (start_s, end_s, step_s) = (-MARGIN_S - 2.0, self.description.duration_s + MARGIN_S, 0.5);
        let scale = random.between(real::SCALE[0], real::SCALE[1]);
        let bias = random.normal() * real::YAW_RATE_BIAS;
        let n = ((end_s - start_s) / step_s) as usize + 10;
        let rates = series(random, n, step_s, 5.0);
        let rates: Vec<f64> = rates.iter().map(|rate| bias + real::YAW_RATE * rate).collect();
        let perfect = self.description.odometry == Wheels::Perfect;
        let mut drift = Drift {
            scale: if perfect { 1.0 } else { scale },
            planar: self.planar(),
            yaw_error: if perfect {
                Spline::constant(0.0)
            } else {
                Spline::integral(start_s, step_s, &rates).through(0.0, 0.0)
            },
            yaw_start: self.truth.moment(0.0).yaw,
            path: Integral::new(0.0, 0.0, |_| Vector3::zeros()),
        };
        drift.path = Integral::new(-MARGIN_S, end_s, |t_s| self.odometry_velocity(&drift, t_s));
        drift
    }
}

impl OdometryRow {
    /// Applies an error.
    pub fn apply(&mut self, error: Error) {
        if apply_position(&mut self.pose, error) || errors::apply(self, error) {
            return;
        }
        let [x, y, z] = self.linear;
        match error {
            Error::TwistInWorld => {
                self.linear = (rotation(self.pose.orientation) * Vector3::from(self.linear)).into();
            }
            Error::TwistCovarianceInWorld => {
                let ahead = turn(rotation(self.pose.orientation).euler_angles().2);
                rotate6(&mut self.twist_covariance, &ahead, &ahead);
            }
            Error::TwistReversed => self.linear = [-x, -y, -z],
            Error::TwistYNegated => self.linear = [x, -y, z],
            Error::TwistZNegated => self.linear = [x, y, -z],
            Error::TwistSwapped => self.linear = [y, x, z],
            Error::TwistYawNegated => self.angular[2] = -self.angular[2],
            Error::CovarianceNotRotated => {}
            _ => {
                let pose = covariance::apply6(&mut self.pose.covariance, error);
                if !covariance::apply6(&mut self.twist_covariance, error) || !pose {
                    errors::refuse("odometry", error);
                }
            }
        }
    }
}

impl OrientedRow for OdometryRow {
    fn orientation(&mut self) -> &mut [f64; 4] {
        &mut self.pose.orientation
    }

    fn change_world(&mut self, new_from_old: &Rotation3<f64>) {
        self.pose.change_world(new_from_old);
    }

    fn change_body(&mut self, old_from_new: &Rotation3<f64>) {
        self.pose.orientation = slots(rotation(self.pose.orientation) * old_from_new);
        let new_from_old = old_from_new.inverse();
        self.linear = (new_from_old * Vector3::from(self.linear)).into();
        self.angular = (new_from_old * Vector3::from(self.angular)).into();
        rotate6(&mut self.twist_covariance, &new_from_old, &new_from_old);
    }

    fn mirror(&mut self) {
        self.pose.mirror();
        let ([vx, vy, vz], [wx, wy, wz]) = (self.linear, self.angular);
        self.linear = [vx, -vy, vz];
        self.angular = [-wx, wy, -wz];
    }
}
