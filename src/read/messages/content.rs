//! What a message says that matters to frames, whatever it was encoded in.

use std::borrow::Cow;

use super::header::Header;
use super::tf::Transform;

/// A message, read as far as frames are concerned.
#[derive(Clone, Debug, PartialEq)]
pub struct Content<'m> {
    /// Its header, where the type has one.
    pub header: Option<Header<'m>>,
    /// What it says beyond the header.
    pub body: Body<'m>,
}

/// What a message says beyond its header.
#[derive(Clone, Debug, PartialEq)]
pub enum Body<'m> {
    /// Nothing that is read.
    Nothing,
    /// Nothing but a child frame: the field `child_frame_id` of a type that is read by its definition.
    ChildFrame(Cow<'m, str>),
    /// Transforms. Beside a header they are a message of one transform, not TF.
    Transforms(Vec<Transform<'m>>),
    /// Pose and twist of a body.
    Odometry(Box<Odometry<'m>>),
    /// Inertial measurements.
    Imu(Box<Imu>),
    /// A satellite fix.
    Fix(Fix),
    /// A pose.
    Pose(Box<Pose>),
    /// A velocity with its covariance.
    Twist(Box<Twist>),
    /// The text of a robot description.
    Description(Cow<'m, str>),
    /// Frames that it names beyond its header's (`foxglove.SceneUpdate`).
    Frames(Vec<Cow<'m, str>>),
    /// A time that everyone should use, nanoseconds: `rosgraph_msgs/Clock`.
    Clock(i64),
}

/// `nav_msgs/msg/Odometry`, numbers as published.
#[derive(Clone, Debug, PartialEq)]
pub struct Odometry<'m> {
    /// `child_frame_id`.
    pub child: Cow<'m, str>,
    /// Metres, in the header's frame.
    pub position: [f64; 3],
    /// `[x, y, z, w]`, not normalised.
    pub orientation: [f64; 4],
    /// Row-major 6x6.
    pub pose_covariance: [f64; 36],
    /// m/s, in the child frame.
    pub linear: [f64; 3],
    /// rad/s, in the child frame.
    pub angular: [f64; 3],
    /// Row-major 6x6.
    pub twist_covariance: [f64; 36],
}

/// `sensor_msgs/msg/Imu`, numbers as published.
#[derive(Clone, Debug, PartialEq)]
pub struct Imu {
    /// `[x, y, z, w]`, not normalised.
    pub orientation: [f64; 4],
    /// Row-major 3x3.
    pub orientation_covariance: [f64; 9],
    /// rad/s.
    pub angular_velocity: [f64; 3],
    /// Row-major 3x3.
    pub angular_velocity_covariance: [f64; 9],
    /// m/s².
    pub linear_acceleration: [f64; 3],
    /// Row-major 3x3.
    pub linear_acceleration_covariance: [f64; 9],
}

/// `sensor_msgs/msg/NavSatFix` or `foxglove.LocationFix`, numbers as published.
#[derive(Clone, Debug, PartialEq)]
pub struct Fix {
    /// `NavSatStatus.status`: -1 no fix, 0 fix, 1 SBAS, 2 GBAS; 0 where the type has no such field.
    pub status: i8,
    /// Degrees.
    pub latitude: f64,
    /// Degrees.
    pub longitude: f64,
    /// Metres.
    pub altitude: f64,
    /// Row-major 3x3, m², east north up.
    pub covariance: [f64; 9],
}

/// `geometry_msgs/msg/PoseStamped` or `PoseWithCovarianceStamped`, numbers as published.
#[derive(Clone, Debug, PartialEq)]
pub struct Pose {
    /// Metres.
    pub position: [f64; 3],
    /// `[x, y, z, w]`, not normalised.
    pub orientation: [f64; 4],
    /// Row-major 6x6, where the type has one.
    pub covariance: Option<[f64; 36]>,
}

/// `geometry_msgs/msg/TwistStamped` or `TwistWithCovarianceStamped`, numbers as published.
#[derive(Clone, Debug, PartialEq)]
pub struct Twist {
    /// m/s.
    pub linear: [f64; 3],
    /// rad/s.
    pub angular: [f64; 3],
    /// Row-major 6x6, where the type has one.
    pub covariance: Option<[f64; 36]>,
}
