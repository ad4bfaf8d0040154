//! What kind of coordinates positions are, by their size and by fixes beside them.
//!
//! Owns the ranges of the kinds. Must not judge.

use nalgebra::Vector3;

use crate::math::geodesy::Geodetic;
use crate::math::utm::{utm, zone};

use super::coordinate_kind::Limits;

/// Kinds of coordinates.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Kind {
    /// Metres from an origin nearby, or within a square of a military grid.
    Local,
    /// Metres from the Earth's centre.
    EarthCentred,
    /// Easting and northing of the UTM grid.
    Utm,
    /// Latitude and longitude, degrees, in this order.
    LatitudeFirst,
    /// Longitude and latitude, degrees, in this order.
    LongitudeFirst,
    /// Far away, and none of these.
    Far,
}

impl Kind {
    /// In words.
    pub(super) fn words(self) -> &'static str {
        match self {
            Self::Local => "local metres",
            Self::EarthCentred => "metres from the Earth's centre",
            Self::Utm => "eastings and northings of the UTM grid",
            Self::LatitudeFirst => "latitude and longitude in degrees",
            Self::LongitudeFirst => "longitude and latitude in degrees",
            Self::Far => "far away",
        }
    }

    /// Whether it is an angle.
    pub(super) fn is_angle(self) -> bool {
        matches!(self, Self::LatitudeFirst | Self::LongitudeFirst)
    }
}

/// The kind of a position in the middle of others, and whether a fix in the middle of its track confirms it.
pub(super) fn kind(middle: &Vector3<f64>, fix: Option<&Geodetic>, limits: &Limits) -> (Kind, bool) {
    if let Some(fix) = fix {
        if let Some(angle) = angle(middle, fix, limits) {
            return (angle, true);
        }
        let zones = zone(fix)
            .into_iter()
            .flat_map(|own| [own, own % 60 + 1, (own + 58) % 60 + 1]);
        let mut grids = zones.filter_map(|zone| utm(fix, Some(zone)));
        let near = |easting: f64, northing: f64| (easting - middle.x).hypot(northing - middle.y) <= limits.near_m;
        if grids.any(|grid| near(grid.easting_m, grid.northing_m)) {
            return (Kind::Utm, true);
        }
        if (fix.to_ecef() - middle).norm() <= limits.near_m {
            return (Kind::EarthCentred, true);
        }
    }
    let within = |value: f64, least: f64, most: f64| (least..=most).contains(&value);
    let is_utm = within(middle.x, limits.utm_least_m, limits.utm_easting_m)
        && within(middle.y, limits.utm_least_m, limits.utm_northing_m)
        && middle.z.abs() <= limits.height_m;
    let kind = if is_utm {
        Kind::Utm
    } else if within(middle.norm(), limits.earth_least_m, limits.earth_most_m) {
        Kind::EarthCentred
    } else if middle.x.hypot(middle.y) <= limits.local_m {
        Kind::Local
    } else {
        Kind::Far
    };
    (kind, false)
}

/// Degrees, where the position holds those of the fix.
fn angle(middle: &Vector3<f64>, fix: &Geodetic, limits: &Limits) -> Option<Kind> {
    let (latitude, longitude) = (fix.latitude_rad.to_degrees(), fix.longitude_rad.to_degrees());
    // Near 0, 0 metres and degrees are both nothing.
    if latitude.abs().max(longitude.abs()) < limits.least_deg {
        return None;
    }
    let near = |x: f64, y: f64| (middle.x - x).abs().max((middle.y - y).abs()) <= limits.agree_deg;
    if near(latitude, longitude) {
        Some(Kind::LatitudeFirst)
    } else if near(longitude, latitude) {
        Some(Kind::LongitudeFirst)
    } else {
        None
    }
}

/// The step of a single-precision number of this size, metres.
pub(super) fn single_precision_step_m(size_m: f64) -> f64 {
    2f64.powf(size_m.abs().max(1.0).log2().floor() - 23.0)
}
