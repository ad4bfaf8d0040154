//! AXES: axes and conventions, measured from motion.

pub mod accel_vs_speed;
pub mod base_frame_flu;
mod bases;
pub(crate) mod causes;
pub mod cloud_mirror;
pub(crate) mod diagnosis;
pub mod gnss_vs_odom_handedness;
pub mod ground_z;
pub mod gyro_vs_turn_sign;
mod handedness;
pub(crate) mod heading;
pub mod heading_convention;
pub mod imu_gravity_sign;
pub mod imu_units;
pub mod lidar_forward_axis;
pub mod map_z_up;
pub mod odom_twist_frame;
pub mod orientation_vs_gravity;
mod plots;
pub mod radar_doppler;
pub(crate) mod rates;
pub(crate) mod sensors;
mod twist;
pub mod up_axis_flip;
pub(crate) mod worlds;
