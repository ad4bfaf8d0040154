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
    /// A glob for the topics that it is about; where there is none it is for the only one that can be meant.
    pub topic: Option<String>,
    /// Where it stands.
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

/// A range image: columns by azimuth, rows by elevation. What is not declared is `None`.
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
    /// The way the azimuth grows with the column, seen from above.
    pub azimuth: Option<Sense>,
    /// What becomes of a point at the seam, where the formula gives the width itself.
    pub seam: Option<Seam>,
    /// From the axis of rotation to where beams begin, millimetres.
    #[serde(with = "super::number::option")]
    pub beam_offset_mm: Option<f64>,
}

/// A grid seen from above.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Grid {
    /// The frame whose x and y it is laid on.
    pub frame: Option<String>,
    /// Side of a cell, metres.
    #[serde(with = "super::number::option")]
    pub resolution_m: Option<f64>,
    /// Where the first cell is: x, y, and where it is declared the yaw; metres and radians.
    #[serde(with = "super::number::list")]
    pub origin: Vec<f64>,
    /// What of the first cell lies at the origin.
    pub cell: Option<Cell>,
    /// Where the columns go.
    pub columns: Option<Axis>,
    /// Where the rows go.
    pub rows: Option<Axis>,
    /// Whether the motion of the vehicle during a scan is taken out.
    pub ego_motion: Option<EgoMotion>,
    /// `x = a col + b row + c`, `y = d col + e row + f`: a to f.
    #[serde(with = "super::number::list")]
    pub affine: Vec<f64>,
    /// Shares from which a cell is occupied, and up to which it is free.
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
    /// The way the azimuth grows with the column, seen from above.
    pub azimuth: Option<Sense>,
}

/// A sense of rotation, seen from above.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Sense {
    /// As compasses and most lidars.
    Clockwise,
    /// As mathematics and REP-103.
    CounterClockwise,
}

/// What becomes of a column that is the width itself.
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

/// What of a cell lies at its coordinates.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Cell {
    /// Its centre.
    Centre,
    /// Its corner of smallest x and y.
    Corner,
}

/// Whether the motion of the vehicle during a scan is taken out.
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
    /// Against x.
    MinusX,
    /// y.
    PlusY,
    /// Against y.
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

/// A grid as a message has it: `nav_msgs/msg/OccupancyGrid`, `grid_map_msgs/msg/GridMap`.
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
    /// Cells that follow, where the type has one list of them.
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
