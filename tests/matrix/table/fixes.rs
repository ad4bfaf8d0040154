//! Errors of fixes.

use super::MIRRORED;
use crate::errors::{Change, Error};
use crate::support::drive::errors::Error as Known;

/// How high the geoid is taken to lie above the ellipsoid, metres.
const UNDULATION_M: f64 = 30.0;

pub static ERRORS: &[Error] = &[
    error!(
        "lat/lon swapped",
        Change::Fixes(|row| row.apply(Known::Swapped, UNDULATION_M)),
        ["mirrored", "swapped"],
        [MIRRORED, "swapped"],
        ["AXES07"]
    ),
    error!(
        "radians",
        Change::Fixes(|row| row.apply(Known::Radians, UNDULATION_M)),
        ["radians"],
        ["radians"],
        ["GEO01", "AXES07"]
    ),
    error!(
        "E7",
        Change::Fixes(|row| row.apply(Known::E7, UNDULATION_M)),
        [],
        ["1e-7", "1e7"],
        ["GEO01"]
    ),
    error!(
        "MSL altitude",
        Change::Fixes(|row| row.apply(Known::Msl, UNDULATION_M)),
        ["msl-as-ellipsoidal"],
        [],
        ["GEO06"]
    ),
];
