//! AXES: axes and conventions, measured from motion.

pub mod accel_vs_speed;
pub mod base_frame_flu;
mod bases;
pub(crate) mod causes;
pub(crate) mod diagnosis;
pub mod gnss_vs_odom_handedness;
pub mod gyro_vs_turn_sign;
mod handedness;
pub(crate) mod heading;
pub mod heading_convention;
pub mod imu_gravity_sign;
pub mod imu_units;
pub mod map_z_up;
pub mod odom_twist_frame;
pub mod orientation_vs_gravity;
mod rates;
pub(crate) mod sensors;
mod twist;
pub(crate) mod worlds;
