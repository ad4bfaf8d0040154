//! The calibration of a lidar's beams, from a file. Pure data.

use serde::{Deserialize, Serialize};

use crate::source::Place;

use super::ouster::PlacedNumber;

/// The calibration of the beams of one lidar.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct BeamCalibration {
    /// Its list of beams.
    pub place: Place,
    /// `Velodyne` or `Hesai`, whose driver reads the file.
    pub maker: String,
    /// Whether the driver takes the angles as radians, else as degrees.
    pub is_radians: bool,
    /// How many beams it says that it has.
    pub stated: Option<PlacedNumber>,
    /// Metres of one unit of distance.
    pub resolution_m: Option<PlacedNumber>,
    /// The beams as they are written.
    pub beams: Vec<Beam>,
    /// The places of the first beam that lacks a number, if one does.
    pub broken: Option<Place>,
}

/// One beam.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Beam {
    /// The number of its laser or channel.
    pub id: u32,
    /// As written.
    #[serde(with = "super::number")]
    pub elevation: f64,
    /// As written.
    #[serde(with = "super::number")]
    pub azimuth: f64,
    /// Where.
    pub place: Place,
}
