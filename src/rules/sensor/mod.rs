//! SENSOR: what drivers, devices, simulators and autopilots fix by convention.

mod clockwise;
pub mod compass_in_quaternion;
pub mod imu_shares_lidar_frame;
pub mod ins_profile;
pub mod left_handed_simulator;
pub mod mavros_frames;
mod ouster_beams;
pub mod ouster_frame;
pub mod ouster_tf_metadata;
mod yaw_zero;
