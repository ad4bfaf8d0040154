//! Files of point clouds (PCD, PLY, LAS, LAZ): what their headers state, and measurements of points spread over the file.
//!
//! Bounded: no points are kept. Numbers are as written, in the unit of the file. Must not judge.

use serde::{Deserialize, Serialize};

use crate::source::{Place, SourceValue};

use super::cloud::PointField;

/// A file of a point cloud.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct PointFile {
    /// The file.
    pub place: Place,
    /// The format.
    pub format: PointFormat,
    /// Points by the header.
    pub stated: u64,
    /// Points that were read, spread over the file.
    pub read: u64,
    /// The fields of a point: of LAS, only x, y and z.
    pub fields: Vec<PointField>,
    /// Where the field x is declared, in a header of text.
    pub coordinates_at: Option<Place>,
    /// Measurements of the points that were read; `None` without a finite one.
    pub seen: Option<PointsSeen>,
    /// `tx ty tz qw qx qy qz` of a PCD.
    pub viewpoint: Option<SourceValue<Viewpoint>>,
    /// What only LAS and LAZ state.
    pub las: Option<LasHeader>,
    /// The coordinate reference system that the file names.
    pub crs: Option<StatedCrs>,
}

/// The format of a file of points.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum PointFormat {
    /// Of the Point Cloud Library.
    Pcd,
    /// Of Stanford.
    Ply,
    /// Of the ASPRS, also compressed (LAZ).
    Las,
}

/// Measurements of the points of a file.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct PointsSeen {
    /// Smallest x, y and z.
    #[serde(with = "super::number::array")]
    pub least: [f64; 3],
    /// Largest x, y and z.
    #[serde(with = "super::number::array")]
    pub most: [f64; 3],
    /// Whether every coordinate is a number of float32.
    pub is_single: bool,
    /// The relief along x, y and z.
    pub relief: [Relief; 3],
}

/// The surfaces of a cloud, seen along an axis.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Relief {
    /// Extent along the axis without the outer hundredths.
    #[serde(with = "super::number")]
    pub extent: f64,
    /// Share of the points near the lowest surface, of those in a cell with enough points.
    #[serde(with = "super::number")]
    pub low: f64,
    /// The same near the highest surface.
    #[serde(with = "super::number")]
    pub high: f64,
    /// Cells with enough points.
    pub cells: u32,
}

/// The pose of the sensor in the axes of the points, by a PCD: translation, and rotation as w, x, y, z.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Viewpoint {
    /// tx, ty, tz.
    #[serde(with = "super::number::array")]
    pub translation: [f64; 3],
    /// qw, qx, qy, qz.
    #[serde(with = "super::number::array")]
    pub wxyz: [f64; 4],
}

/// The header of a LAS or LAZ file: a coordinate is `whole number * scale + offset`.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct LasHeader {
    /// `[1, 4]` for 1.4.
    pub version: [u8; 2],
    /// Of x, y and z.
    #[serde(with = "super::number::array")]
    pub scale: [f64; 3],
    /// Of x, y and z.
    #[serde(with = "super::number::array")]
    pub offset: [f64; 3],
    /// Smallest coordinates, as stated.
    #[serde(with = "super::number::array")]
    pub least: [f64; 3],
    /// Largest coordinates, as stated.
    #[serde(with = "super::number::array")]
    pub most: [f64; 3],
    /// Whether times are GPS seconds minus 1e9; else seconds of the week.
    pub has_adjusted_time: bool,
    /// Year and day of the year on which it was written; zeros if unknown.
    pub created: [u16; 2],
}

/// A coordinate reference system, as a file names it.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct StatedCrs {
    /// Its name, or `EPSG:32632`.
    pub name: String,
    /// Its code in the register of EPSG.
    pub epsg: Option<u32>,
    /// The kind of its coordinates.
    pub kind: CrsKind,
    /// Metres in the unit of x and y; `None` for angles, and if the file does not state it.
    #[serde(with = "super::number::option")]
    pub unit_m: Option<f64>,
    /// Where it is stated: `GeoTIFF` or `WKT`.
    pub by: String,
}

/// The kind of coordinates.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum CrsKind {
    /// On a plane.
    Projected,
    /// Longitude and latitude.
    Geographic,
    /// From the centre of the Earth.
    Geocentric,
    /// Not known.
    Other,
}

impl StatedCrs {
    /// The UTM zone, and whether it is a northern one, by the code.
    pub fn utm(&self) -> Option<(u8, bool)> {
        let epsg = self.epsg?;
        let (zone, is_north) = match epsg {
            32601..=32660 => (epsg - 32600, true),
            32701..=32760 => (epsg - 32700, false),
            // ETRS89, NAD83.
            25828..=25838 => (epsg - 25800, true),
            26901..=26923 => (epsg - 26900, true),
            _ => return None,
        };
        Some((u8::try_from(zone).ok()?, is_north))
    }
}

impl PointsSeen {
    /// The middle between the smallest and the largest coordinates.
    pub fn middle(&self) -> [f64; 3] {
        let [least, most] = [self.least, self.most];
        [
            f64::midpoint(least[0], most[0]),
            f64::midpoint(least[1], most[1]),
            f64::midpoint(least[2], most[2]),
        ]
    }

    /// The largest coordinate without its sign.
    pub fn farthest(&self) -> f64 {
        let all = self.least.into_iter().chain(self.most);
        all.map(f64::abs).fold(0.0, f64::max)
    }
}
