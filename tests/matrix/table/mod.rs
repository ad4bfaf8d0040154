//! The tables of errors, by the streams that they are put into.

macro_rules! error {
    ($name:literal, $change:expr, $words:expr, $texts:expr, $seen_by:expr) => {
        Error {
            name: $name,
            change: $change,
            words: &$words,
            texts: &$texts,
            seen_by: &$seen_by,
        }
    };
}

mod cameras;
mod fixes;
mod imu;
mod lidars;
mod poses;
mod staged;

use crate::errors::Error;

/// What a finding on a sensor says of the track that it is held against.
const MIRRORED: &str = "the track it is compared with is mirrored";

/// Every error: of inertial sensors, of poses, of fixes, and of what is staged beside them.
pub fn all() -> impl Iterator<Item = &'static Error> {
    let tables = [
        imu::ERRORS,
        poses::ERRORS,
        fixes::ERRORS,
        staged::ERRORS,
        lidars::ERRORS,
        cameras::ERRORS,
    ];
    tables.into_iter().flatten()
}
