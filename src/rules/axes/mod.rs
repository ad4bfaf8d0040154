//! AXES: axes and conventions, measured from motion.

pub mod odom_twist_frame;
mod twist;
