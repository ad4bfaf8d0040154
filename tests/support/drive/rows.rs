//! What streams of a drive publish, as published: a row for each message.

/// An inertial measurement (`sensor_msgs/Imu`).
#[derive(Clone, Debug, PartialEq)]
pub struct ImuRow {
    /// Stamp, seconds after the start.
    pub t_s: f64,
    /// The four slots `x y z w`.
    pub orientation: [f64; 4],
    /// Row-major.
    pub orientation_covariance: [f64; 9],
    /// rad/s.
    pub gyro: [f64; 3],
    /// Row-major.
    pub gyro_covariance: [f64; 9],
    /// m/s².
    pub acceleration: [f64; 3],
    /// Row-major.
    pub acceleration_covariance: [f64; 9],
}

/// A satellite fix (`sensor_msgs/NavSatFix`).
#[derive(Clone, Debug, PartialEq)]
pub struct FixRow {
    /// Stamp, seconds after the start.
    pub t_s: f64,
    /// Degrees.
    pub latitude: f64,
    /// Degrees.
    pub longitude: f64,
    /// Metres above the ellipsoid.
    pub altitude: f64,
    /// `NavSatStatus.status`.
    pub status: i8,
    /// Row-major, east north up.
    pub covariance: [f64; 9],
}

/// A velocity (`geometry_msgs/TwistStamped`).
#[derive(Clone, Debug, PartialEq)]
pub struct VelocityRow {
    /// Stamp, seconds after the start.
    pub t_s: f64,
    /// m/s, ENU.
    pub linear: [f64; 3],
    /// Row-major; the last three rows are zero.
    pub covariance: [f64; 36],
}

/// A pose in a world frame (`geometry_msgs/PoseStamped`, a transform of TF). A heading has no position.
#[derive(Clone, Debug, PartialEq)]
pub struct PoseRow {
    /// Stamp, seconds after the start.
    pub t_s: f64,
    /// Metres.
    pub position: [f64; 3],
    /// The four slots `x y z w`.
    pub orientation: [f64; 4],
    /// Row-major: x, y, z, then rotations about the world's axes.
    pub covariance: [f64; 36],
}

/// Odometry (`nav_msgs/Odometry`).
#[derive(Clone, Debug, PartialEq)]
pub struct OdometryRow {
    /// Stamp, and `world_from_child`.
    pub pose: PoseRow,
    /// m/s, in the child frame.
    pub linear: [f64; 3],
    /// rad/s, in the child frame.
    pub angular: [f64; 3],
    /// Row-major.
    pub twist_covariance: [f64; 36],
}
