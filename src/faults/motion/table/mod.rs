//! The tables of mistakes, by the streams that have them.

mod fixes;
mod imu;
mod poses;
mod stamps;

use crate::faults::Fault;

/// What a finding on a sensor says of the track that it is held against.
const MIRRORED: &str = "the track that the IMU is compared with is mirrored";

/// What a finding on a velocity says of the position that may be wrong instead.
const POSITION: &str = "the position or the orientation of the pose is wrong";
/// What a finding on two orientations says of axes of the body.
const CONSTANT: &str = "is constant in the axes of the body";

/// To record for whatever shows in the motion of an inertial sensor.
const WITH_IMU: &str = "a minute of driving with turns, with the IMU's orientation and gyro";
/// To record for whatever shows only against the platform's motion.
const WITH_TRACK: &str = "odometry or satellite fixes beside the IMU, on a drive of a minute with turns, and with stops and starts of 0.5 m/s2 or more";
/// To record for whatever shows only in the base.
const WITH_MOUNT: &str = "the transform of the sensor on /tf_static, and the IMU's acceleration";
/// To record for whatever shows only against the Earth.
const WITH_FIXES: &str = "satellite fixes beside the poses, on a drive with turns";
/// To record for whatever shows in a pose and its twist.
const WITH_TWIST: &str = "odometry with its twist, on a drive of a minute with turns and changes of speed";

/// The tables.
pub(super) fn all() -> [&'static [Fault]; 6] {
    [
        imu::FAULTS,
        poses::FAULTS,
        poses::ON_THE_EARTH,
        poses::CORRECTIONS,
        fixes::FAULTS,
        stamps::FAULTS,
    ]
}
