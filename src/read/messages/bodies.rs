//! The standard types that are read by their published layout, field by field.
//!
//! Owns the order of their fields. Sources: geometry_msgs, nav_msgs, sensor_msgs (common_interfaces, common_msgs),
//! rosgraph_msgs (rcl_interfaces, ros_comm_msgs); the order is the same in ROS 1 and ROS 2.

use super::content::{Body, Fix, Imu, Odometry, Pose, Twist};
use super::{Cursor, DecodeError};

/// Reads the rest of an `nav_msgs/Odometry` behind its header.
pub(super) fn odometry<'m>(cursor: &mut Cursor<'m>) -> Result<Body<'m>, DecodeError> {
    Ok(Body::Odometry(Box::new(Odometry {
        child: cursor.name()?.into(),
        position: cursor.f64s()?,
        orientation: cursor.f64s()?,
        pose_covariance: cursor.f64s()?,
        linear: cursor.f64s()?,
        angular: cursor.f64s()?,
        twist_covariance: cursor.f64s()?,
    })))
}

/// Reads the rest of a `sensor_msgs/Imu` behind its header.
pub(super) fn imu<'m>(cursor: &mut Cursor<'m>) -> Result<Body<'m>, DecodeError> {
    Ok(Body::Imu(Box::new(Imu {
        orientation: cursor.f64s()?,
        orientation_covariance: cursor.f64s()?,
        angular_velocity: cursor.f64s()?,
        angular_velocity_covariance: cursor.f64s()?,
        linear_acceleration: cursor.f64s()?,
        linear_acceleration_covariance: cursor.f64s()?,
    })))
}

/// Reads the rest of a `sensor_msgs/NavSatFix` behind its header.
pub(super) fn fix<'m>(cursor: &mut Cursor<'m>) -> Result<Body<'m>, DecodeError> {
    let status = cursor.i8()?;
    let _service = cursor.u16()?;
    Ok(Body::Fix(Fix {
        status,
        latitude: cursor.f64()?,
        longitude: cursor.f64()?,
        altitude: cursor.f64()?,
        covariance: cursor.f64s()?,
    }))
}

/// Reads the rest of a `geometry_msgs/PoseStamped`, or of the type with covariance, behind its header.
pub(super) fn pose<'m>(cursor: &mut Cursor<'m>, has_covariance: bool) -> Result<Body<'m>, DecodeError> {
    Ok(Body::Pose(Box::new(Pose {
        position: cursor.f64s()?,
        orientation: cursor.f64s()?,
        covariance: if has_covariance { Some(cursor.f64s()?) } else { None },
    })))
}

/// Reads the rest of a `geometry_msgs/TwistStamped`, or of the type with covariance, behind its header.
pub(super) fn twist<'m>(cursor: &mut Cursor<'m>, has_covariance: bool) -> Result<Body<'m>, DecodeError> {
    Ok(Body::Twist(Box::new(Twist {
        linear: cursor.f64s()?,
        angular: cursor.f64s()?,
        covariance: if has_covariance { Some(cursor.f64s()?) } else { None },
    })))
}
