//! What kind of coordinates positions are, by their size and by the fixes of the recording.
//!
//! Owns the ranges of the kinds. Must not judge.

use nalgebra::Vector3;
use serde::Deserialize;

use crate::math::geodesy::Geodetic;
use crate::math::utm::{utm, zone};

/// Kinds of coordinates.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) enum Kind {
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
    pub(crate) fn words(self) -> &'static str {
        match self {
            Self::Local => "local metres",
            Self::EarthCentred => "Earth-centred metres (ECEF)",
            Self::Utm => "UTM eastings and northings",
            Self::LatitudeFirst => "latitude and longitude in degrees",
            Self::LongitudeFirst => "longitude and latitude in degrees",
            Self::Far => "far away",
        }
    }

    /// Whether it is an angle.
    pub(crate) fn is_angle(self) -> bool {
        matches!(self, Self::LatitudeFirst | Self::LongitudeFirst)
    }
}

/// The kind of a median position, and whether the median of the fixes confirms it.
pub(crate) fn kind(middle: &Vector3<f64>, fix: Option<&Geodetic>, limits: &Limits) -> (Kind, bool) {
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

/// Whether a position is in metres from the Earth's centre, by its size: x and y of such positions span no level plane.
pub(crate) fn is_earth_centred(position_m: &Vector3<f64>, limits: &Limits) -> bool {
    kind(position_m, None, limits).0 == Kind::EarthCentred
}

/// Degrees, where the position holds those of the fix.
fn angle(middle: &Vector3<f64>, fix: &Geodetic, limits: &Limits) -> Option<Kind> {
    let (latitude, longitude) = (fix.latitude_rad.to_degrees(), fix.longitude_rad.to_degrees());
    // Near 0, 0 metres and degrees cannot be distinguished.
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
pub(crate) fn single_precision_step_m(size_m: f64) -> f64 {
    2f64.powf(size_m.abs().max(1.0).log2().floor() - 23.0)
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;
    use crate::rules::pages;
    use std::collections::BTreeMap;

    fn of(x: f64, y: f64, z: f64, fix: Option<(f64, f64)>) -> (Kind, bool) {
        let limits = pages::GEO03.limits(&BTreeMap::new()).unwrap();
        let fix = fix.map(|(latitude, longitude)| Geodetic::from_degrees(latitude, longitude, 500.0).unwrap());
        kind(&Vector3::new(x, y, z), fix.as_ref(), &limits)
    }

    #[test]
    fn sizes_tell_kinds_apart_without_fixes() {
        assert_eq!(of(-120.0, 900.0, 3.0, None), (Kind::Local, false));
        // Autoware's sample map is here, in a square of the military grid.
        assert_eq!(of(89_571.0, 42_301.0, 40.0, None), (Kind::Local, false));
        assert_eq!(
            of(4_197_489.0, 815_909.0, 4_717_247.0, None),
            (Kind::EarthCentred, false)
        );
        // In the north of Scotland a northing is as long as the Earth's radius.
        assert_eq!(of(500_000.0, 6_350_000.0, 100.0, None), (Kind::Utm, false));
        assert_eq!(of(3e5, -3e5, 0.0, None), (Kind::Far, false));
        assert_eq!(of(f64::INFINITY, 0.0, 0.0, None), (Kind::Far, false));
    }

    #[test]
    fn fixes_confirm_kinds() {
        assert_eq!(of(48.0, 11.0, 0.0, Some((48.0, 11.0))), (Kind::LatitudeFirst, true));
        assert_eq!(of(11.0, 48.0, 0.0, Some((48.0, 11.0))), (Kind::LongitudeFirst, true));
        assert_eq!(of(48.1, 11.0, 0.0, Some((48.0, 11.0))), (Kind::Local, false));
        assert_eq!(of(0.0, 0.01, 0.0, Some((0.0, 0.01))), (Kind::Local, false));
        // On the middle meridian of zone 32 the easting is 500 km, and 0 N has the northing 0.
        assert_eq!(of(500_100.0, 80.0, 0.0, Some((0.0, 9.0))), (Kind::Utm, true));
        assert_eq!(of(500_100.0, 80.0, 0.0, None).0, Kind::Far);
    }

    #[test]
    fn single_precision_steps_double_with_every_power_of_two() {
        // 24 bits of mantissa: 1 m steps from 2^23 m on.
        for (size, step) in [(8_388_608.0, 1.0), (8_388_607.0, 0.5), (1.0, 2f64.powi(-23))] {
            assert!((single_precision_step_m(size) - step).abs() < 1e-12, "{size}");
        }
    }
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Limits {
    pub(crate) local_m: f64,
    pub(crate) earth_least_m: f64,
    pub(crate) earth_most_m: f64,
    pub(crate) utm_least_m: f64,
    pub(crate) utm_easting_m: f64,
    pub(crate) utm_northing_m: f64,
    pub(crate) height_m: f64,
    pub(crate) near_m: f64,
    pub(crate) agree_deg: f64,
    pub(crate) least_deg: f64,
}
