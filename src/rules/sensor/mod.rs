//! SENSOR: what drivers and autopilots fix by convention.

mod clockwise;
pub mod compass_in_quaternion;
pub mod mavros_frames;
mod yaw_zero;
