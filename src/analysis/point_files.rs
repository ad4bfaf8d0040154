//! Files of points, as rules judge them: with their names, and compared with origins on the Earth.
//!
//! Owns the comparison with a UTM grid. Must not judge.

use crate::analysis::Estimates;
use crate::math::geodesy::Geodetic;
use crate::math::utm;
use crate::world::point_file::PointsSeen;
use crate::world::{EarthOrigin, PointFile};

/// A file of points with its names.
pub(crate) struct NamedPoints<'w> {
    pub(crate) file: &'w PointFile,
    path: &'w str,
}

impl<'w> NamedPoints<'w> {
    /// Every file of a world.
    pub(crate) fn all(world: &'w Estimates) -> impl Iterator<Item = Self> {
        let of = |file: &'w PointFile| Self {
            file,
            path: world.path(file.place.source),
        };
        world.point_files.iter().map(of)
    }

    /// The name of the file without its folder, for headlines.
    pub(crate) fn name(&self) -> &'w str {
        self.path.rsplit(['/', '\\']).next().unwrap_or(self.path)
    }

    /// The subject of a judgement.
    pub(crate) fn subject(&self, part: &str) -> String {
        format!("{part} of `{}`", self.path)
    }
}

/// The distance from the middle of the points to an origin on the UTM grid of a zone, metres.
pub(crate) fn utm_distance_m(seen: &PointsSeen, origin: &Geodetic, (zone, is_north): (u8, bool)) -> Option<f64> {
    let [x, y, _] = seen.middle();
    let grid = utm::utm(origin, Some(zone))?;
    // Of an origin on the other hemisphere, the northing as this one counts it.
    let shift = match (grid.is_north, is_north) {
        (true, false) => 1e7,
        (false, true) => -1e7,
        _ => 0.0,
    };
    Some((grid.easting_m - x).hypot(grid.northing_m + shift - y))
}

/// The position of an origin, if it has one.
pub(crate) fn position(origin: &EarthOrigin) -> Option<Geodetic> {
    let [latitude, longitude] = origin.latitude_longitude_deg?;
    Geodetic::from_degrees(latitude, longitude, origin.altitude_m.unwrap_or_default())
}
