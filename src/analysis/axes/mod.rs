//! Inertial sensors, headings, bases and worlds, as the data show them.

pub(crate) mod base_up;
pub(crate) mod bases;
pub(crate) mod causes;
pub(crate) mod cloud_turn;
pub(crate) mod diagnosis;
pub(crate) mod forward;
pub(crate) mod gyro_vs_track;
pub(crate) mod hand;
pub(crate) mod handedness;
pub(crate) mod heading;
pub(crate) mod imu_mounting;
pub(crate) mod plots;
pub(crate) mod push;
pub(crate) mod rates;
pub(crate) mod sensors;
pub(crate) mod turns_with;
pub(crate) mod twist;
pub(crate) mod twist_frame;
pub(crate) mod world_up;
pub(crate) mod worlds;
pub(crate) mod yaw_vs_course;
