//! AXES: axes and conventions, measured from motion.

pub mod gnss_vs_odom_handedness;
mod handedness;
mod heading;
pub mod heading_convention;
pub mod odom_twist_frame;
mod twist;
