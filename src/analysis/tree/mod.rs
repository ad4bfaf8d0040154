//! The frame tree over time.

pub(crate) mod corrections;
pub(crate) mod drift;
pub(crate) mod footprint;
pub(crate) mod held;
pub(crate) mod latched;
pub(crate) mod lookups;
pub(crate) mod loops;
pub(crate) mod odometry;
pub(crate) mod rate;
pub(crate) mod steps;
pub(crate) mod wheels;
