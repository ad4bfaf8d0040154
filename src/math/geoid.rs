//! The geoid: the height of mean sea level above the ellipsoid.
//!
//! Owns one number of a place, from the crate `egm96` (coefficients of degree 360 in the program, no file, 2 MB).
//! Must not know which datum a height claims. Source: Lemoine and others, The development of the joint NASA GSFC and
//! NIMA geopotential model EGM96, NASA/TP-1998-206861.

use super::geodesy::Geodetic;

/// The geoid undulation N of EGM96 at a place, metres: height above the ellipsoid = height above mean sea level + N.
/// -107 to +86; right to about half a metre, less in high mountains. Costs about a millisecond. `None` for a place that
/// is not finite or beyond a pole.
pub fn undulation_m(place: &Geodetic) -> Option<f64> {
    let (lat, lon) = (place.latitude_rad.to_degrees(), place.longitude_rad.to_degrees());
    let sound = lat.abs() <= 90.0 && lon.is_finite();
    let undulation = sound.then(|| egm96::egm96_compute_altitude_offset(lat, lon))?;
    undulation.is_finite().then_some(undulation)
}
