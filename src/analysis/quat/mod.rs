//! Readings of quaternions.

pub(crate) mod by_gyro;
pub(crate) mod level;
pub(crate) mod listed;
pub(crate) mod oriented;
pub(crate) mod turned;
pub(crate) mod ways;
