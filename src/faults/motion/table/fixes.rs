//! Mistakes of fixes, and of origins on the Earth.

use super::super::fixes::FixChange;
use super::super::origins::OriginChange;
use super::{MIRRORED, POSITION};
use crate::faults::Fault;

/// To record for a receiver.
const WITH_ODOMETRY: &str = "odometry beside the satellite fixes, on a drive with turns";
/// To record for an origin.
const WITH_ORIGIN: &str =
    "satellite fixes and poses in `map`, or the transform `earth` -> `map`, beside the file with the origin";
/// What 10 m to the north are, degrees.
const TEN_METRES_DEG: f64 = 9e-5;

/// Every mistake.
pub(super) static FAULTS: &[Fault] = &[
    fault!(
        Fix,
        "fix-swapped",
        "Latitude and longitude are swapped.",
        FixChange::Message(|fix| std::mem::swap(&mut fix.latitude, &mut fix.longitude)),
        ["mirrored", "swapped"],
        [MIRRORED, POSITION, "swapped"],
        ["AXES07"],
        WITH_ODOMETRY
    ),
    fault!(
        Fix,
        "fix-radians",
        "Latitude and longitude are in radians where degrees are meant.",
        FixChange::Message(|fix| {
            (fix.latitude, fix.longitude) = (fix.latitude.to_radians(), fix.longitude.to_radians());
        }),
        ["radians"],
        ["radians"],
        ["GEO01", "AXES07"],
        "a second receiver, or odometry beside the satellite fixes"
    ),
    fault!(
        Fix,
        "fix-e7",
        "Latitude and longitude are integers of 1e-7 degrees where degrees are meant.",
        FixChange::Message(|fix| {
            (fix.latitude, fix.longitude) = ((fix.latitude * 1e7).round(), (fix.longitude * 1e7).round());
        }),
        ["degrees-e7"],
        ["1e-7", "1e7"],
        ["GEO01"],
        "satellite fixes"
    ),
    fault!(
        Fix,
        "fix-msl-altitude",
        "Altitudes are above mean sea level where those above the ellipsoid are meant.",
        FixChange::SeaLevel,
        ["msl-as-ellipsoidal"],
        [],
        ["GEO06"],
        "a second source of altitudes: NMEA sentences (GGA), or a receiver whose altitudes are above the ellipsoid"
    ),
    fault!(
        Fix,
        "fix-origin-moved",
        "The origin of the map, as a file states it, is 10 m off.",
        OriginChange(|[latitude, longitude]| [latitude + TEN_METRES_DEG, longitude]),
        ["origin-changed"],
        ["put the origin"],
        ["GEO07"],
        WITH_ORIGIN
    ),
    fault!(
        Fix,
        "fix-origin-swapped",
        "Latitude and longitude of the map's origin, as a file states it, are swapped.",
        OriginChange(|[latitude, longitude]| [longitude, latitude]),
        ["origin-changed", "lat-lon-swapped"],
        ["put the origin"],
        ["GEO07"],
        WITH_ORIGIN
    ),
];
