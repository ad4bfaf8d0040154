//! SENSOR: what drivers and autopilots fix by convention.

pub mod mavros_frames;
