//! What drivers and devices fix by convention.

pub(crate) mod dataset;
pub(crate) mod lidar_turn;
pub(crate) mod ouster_look;
pub(crate) mod yaw_zero;
