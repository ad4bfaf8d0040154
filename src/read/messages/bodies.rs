//! The standard types that are read by their published layout, field by field.
//!
//! Owns the order of their fields. Sources: geometry_msgs, nav_msgs, sensor_msgs (common_interfaces, common_msgs),
//! geographic_msgs (geographic_info), gps_msgs and gps_common (gps_umd); the order is the same in ROS 1 and ROS 2.

use super::content::{Body, Fix, Imu, MAX_PATH, Odometry, Pose, Twist};
use super::header::Header;
use super::{Cursor, DecodeError};

/// Reads the rest of an `nav_msgs/Odometry` after its header.
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

/// Reads the rest of a `sensor_msgs/Imu` after its header.
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

/// Reads the rest of a `sensor_msgs/NavSatFix` after its header.
pub(super) fn fix<'m>(cursor: &mut Cursor<'m>) -> Result<Body<'m>, DecodeError> {
    let status = cursor.i8()?;
    let _service = cursor.u16()?;
    Ok(Body::Fix(Fix {
        status,
        latitude: cursor.f64()?,
        longitude: cursor.f64()?,
        altitude: cursor.f64()?,
        covariance: cursor.f64s()?,
        velocity: None,
    }))
}

/// Reads the rest of a `gps_msgs/GPSFix` or `gps_common/GPSFix` after its header.
pub(super) fn gps_fix<'m>(cursor: &mut Cursor<'m>) -> Result<Body<'m>, DecodeError> {
    let status = gps_status(cursor)?;
    let [latitude, longitude, altitude, track, speed, climb] = cursor.f64s()?;
    // Attitude, time, dilutions of precision and errors.
    cursor.skip_numbers(8, 19)?;
    let (sin, cos) = track.to_radians().sin_cos();
    let velocity = [speed * sin, speed * cos, climb];
    let is_known = status >= 0 && velocity.iter().all(|part| part.is_finite());
    Ok(Body::Fix(Fix {
        status,
        latitude,
        longitude,
        altitude,
        covariance: cursor.f64s()?,
        velocity: is_known.then_some(velocity),
    }))
}

/// Reads a `GPSStatus`; returns its status.
fn gps_status(cursor: &mut Cursor<'_>) -> Result<i8, DecodeError> {
    let _own = Header::read(cursor)?;
    let numbers = |cursor: &mut Cursor<'_>| {
        let count = cursor.u32()?;
        cursor.skip_numbers(4, usize::try_from(count).unwrap_or(usize::MAX))
    };
    let _used = cursor.u16()?;
    numbers(cursor)?;
    let _visible = cursor.u16()?;
    for _ in 0..4 {
        numbers(cursor)?;
    }
    let status = cursor.u16()?.cast_signed();
    cursor.skip_numbers(2, 3)?;
    Ok(i8::try_from(status).unwrap_or(if status < 0 { i8::MIN } else { i8::MAX }))
}

/// Reads a `geographic_msgs/GeoPoint`.
pub(super) fn geo_point<'m>(cursor: &mut Cursor<'m>) -> Result<Body<'m>, DecodeError> {
    let [latitude, longitude, altitude] = cursor.f64s()?;
    Ok(Body::Fix(Fix {
        status: 0,
        latitude,
        longitude,
        altitude,
        covariance: [0.0; 9],
        velocity: None,
    }))
}

/// Reads the rest of a `nav_msgs/Path` after its header. No memory is reserved for the number that a message claims.
pub(super) fn path<'m>(cursor: &mut Cursor<'m>) -> Result<Body<'m>, DecodeError> {
    let count = cursor.sequence()?;
    let every = count.div_ceil(MAX_PATH).max(1);
    let mut poses = Vec::new();
    for number in 0..count {
        let header = Header::read(cursor)?;
        if number % every != 0 {
            cursor.skip_numbers(8, 7)?;
            continue;
        }
        let pose = Pose {
            position: cursor.f64s()?,
            orientation: cursor.f64s()?,
            covariance: None,
        };
        poses.push((header.stamp_ns, pose));
    }
    Ok(Body::Path(poses))
}

/// Reads the rest of a `geometry_msgs/PoseStamped`, or of the type with covariance, after its header.
pub(super) fn pose<'m>(cursor: &mut Cursor<'m>, has_covariance: bool) -> Result<Body<'m>, DecodeError> {
    Ok(Body::Pose(Box::new(Pose {
        position: cursor.f64s()?,
        orientation: cursor.f64s()?,
        covariance: if has_covariance { Some(cursor.f64s()?) } else { None },
    })))
}

/// Reads the rest of a `geometry_msgs/TwistStamped`, or of the type with covariance, after its header.
pub(super) fn twist<'m>(cursor: &mut Cursor<'m>, has_covariance: bool) -> Result<Body<'m>, DecodeError> {
    Ok(Body::Twist(Box::new(Twist {
        linear: cursor.f64s()?,
        angular: cursor.f64s()?,
        covariance: if has_covariance { Some(cursor.f64s()?) } else { None },
    })))
}
