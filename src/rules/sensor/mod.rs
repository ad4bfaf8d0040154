//! SENSOR: what drivers, devices, simulators and autopilots fix by convention.

mod clockwise;
pub mod compass_in_quaternion;
mod dataset_data;
pub mod dataset_profile;
mod dataset_records;
pub mod extrinsic_z180_double;
pub mod imu_shares_lidar_frame;
pub mod ins_profile;
pub mod left_handed_simulator;
pub(crate) mod lidar_turn;
pub mod mavros_frames;
pub mod native_y_forward;
mod ouster_beams;
pub mod ouster_frame;
pub mod ouster_tf_metadata;
mod twice_applied;
mod yaw_zero;
