//! Projections that configurations, files and messages declare: range images, grids seen from above, panoramas. As declared.
//!
//! Owns the words. Must not judge, nor know how a declaration is written.

use serde::{Deserialize, Serialize};

use crate::source::{MessageRef, Place};

/// A declared projection.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Projection {
    /// The form it is written in (`frames-lint`, `map_server`, `rangenet`, `ouster`).
    pub format: String,
    /// The path of keys to it; may be empty.
    pub label: String,
    /// A glob for the topics that it is about; without one it is for the only one that can be meant.
    pub topic: Option<String>,
    /// Its place.
    pub place: Place,
    /// What is declared.
    pub form: Form,
}

/// What is declared.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Form {
    /// A lidar's points by azimuth and elevation.
    RangeImage(RangeImage),
    /// A plane seen from above, in cells.
    Grid(Grid),
    /// An image of all directions.
    Panorama(Panorama),
}

/// A range image: columns by azimuth, rows by elevation. Values that are not declared are `None`.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct RangeImage {
    /// Columns.
    pub width: Option<u32>,
    /// Rows.
    pub height: Option<u32>,
    /// Elevation of the highest row, degrees.
    #[serde(with = "super::number::option")]
    pub fov_up_deg: Option<f64>,
    /// Elevation of the lowest row, degrees.
    #[serde(with = "super::number::option")]
    pub fov_down_deg: Option<f64>,
    /// The direction in which the azimuth grows with the column, seen from above.
    pub azimuth: Option<Sense>,
    /// How a point at the seam is handled, where the formula gives the width itself.
    pub seam: Option<Seam>,
    /// Distance from the axis of rotation to the origin of the beams, millimetres.
    #[serde(with = "super::number::option")]
    pub beam_offset_mm: Option<f64>,
}

/// A grid seen from above.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Grid {
    /// The frame of its x and y.
    pub frame: Option<String>,
    /// Side of a cell, metres.
    #[serde(with = "super::number::option")]
    pub resolution_m: Option<f64>,
    /// The position of the first cell: x, y, and the yaw if it is declared; metres and radians.
    #[serde(with = "super::number::list")]
    pub origin: Vec<f64>,
    /// Which point of the first cell is at the origin.
    pub cell: Option<Cell>,
    /// The direction of the columns.
    pub columns: Option<Axis>,
    /// The direction of the rows.
    pub rows: Option<Axis>,
    /// Whether the motion of the vehicle during a scan is compensated.
    pub ego_motion: Option<EgoMotion>,
    /// `x = a col + b row + c`, `y = d col + e row + f`: a to f.
    #[serde(with = "super::number::list")]
    pub affine: Vec<f64>,
    /// Probability from which a cell is occupied, and up to which it is free.
    #[serde(with = "super::number::list")]
    pub thresholds: Vec<f64>,
}

/// An equirectangular image.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Panorama {
    /// Columns.
    pub width: Option<u32>,
    /// Rows.
    pub height: Option<u32>,
    /// The direction in which the azimuth grows with the column, seen from above.
    pub azimuth: Option<Sense>,
}

/// A sense of rotation, seen from above.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Sense {
    /// Like compasses and most lidars.
    Clockwise,
    /// Like mathematics and REP-103.
    CounterClockwise,
}

/// How a column equal to the width is handled.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Seam {
    /// Nothing is done.
    None,
    /// The last column takes it.
    Clamp,
    /// The first column takes it.
    Wrap,
}

/// Which point of a cell is at its coordinates.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Cell {
    /// Its centre.
    Centre,
    /// Its corner of smallest x and y.
    Corner,
}

/// Whether the motion of the vehicle during a scan is compensated.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum EgoMotion {
    /// It is.
    Compensated,
    /// It is not.
    Raw,
}

/// An axis of the grid's frame, with its sign.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Axis {
    /// x.
    PlusX,
    /// Opposite to x.
    MinusX,
    /// y.
    PlusY,
    /// Opposite to y.
    MinusY,
}

macro_rules! words {
    ($type:ty { $($word:literal => $value:ident),* }) => {
        impl $type {
            /// Every value with its word.
            pub const WORDS: &'static [(&'static str, Self)] = &[$(($word, Self::$value)),*];
        }
    };
}

words!(Sense { "clockwise" => Clockwise, "counter_clockwise" => CounterClockwise });
words!(Seam { "none" => None, "clamp" => Clamp, "wrap" => Wrap });
words!(Cell { "centre" => Centre, "center" => Centre, "corner" => Corner });
words!(EgoMotion { "compensated" => Compensated, "raw" => Raw });
words!(Axis { "+x" => PlusX, "-x" => MinusX, "+y" => PlusY, "-y" => MinusY });

impl Axis {
    /// The direction in x and y.
    pub fn direction(self) -> [f64; 2] {
        match self {
            Self::PlusX => [1.0, 0.0],
            Self::MinusX => [-1.0, 0.0],
            Self::PlusY => [0.0, 1.0],
            Self::MinusY => [0.0, -1.0],
        }
    }
}

/// Different grids of one topic that are kept.
pub const MAX_GRIDS: usize = 8;

/// A grid as in a message: `nav_msgs/msg/OccupancyGrid`, `grid_map_msgs/msg/GridMap`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct GridAt {
    /// The first message that has it.
    pub at: MessageRef,
    /// How many have it.
    pub count: u64,
    /// Side of a cell, metres.
    #[serde(with = "super::number")]
    pub resolution_m: f64,
    /// Length along x and y, cells; of a `GridMap` lengths over the resolution.
    #[serde(with = "super::number::array")]
    pub cells: [f64; 2],
    /// Of the first cell's corner, or of a `GridMap`'s centre, in the header's frame, metres.
    #[serde(with = "super::number::array")]
    pub position: [f64; 3],
    /// `[x, y, z, w]` as published.
    #[serde(with = "super::number::array")]
    pub orientation: [f64; 4],
    /// Cells that follow, if the type has one list of them.
    pub data: Option<u64>,
}

/// The grids of one topic.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct GridEvidence {
    /// Messages.
    pub count: u64,
    /// The first different ones.
    pub grids: Vec<GridAt>,
    /// Messages with others.
    pub others: u64,
}
