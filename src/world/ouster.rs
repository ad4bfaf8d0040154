//! The metadata of an Ouster sensor, from a file or from a topic of a recording.
//!
//! Its transforms are claims, with the same source. Pure data.

use serde::{Deserialize, Serialize};

use crate::source::Place;

/// The metadata of one sensor, of any firmware: with keys side by side, or in parts.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct OusterMetadata {
    /// The whole of them.
    pub place: Place,
    /// `prod_line`: `OS-1-128`.
    pub product: Option<String>,
    /// `image_rev`: the firmware's image.
    pub image: Option<String>,
    /// `build_rev`: the firmware.
    pub firmware: Option<String>,
    /// `prod_sn`.
    pub serial: Option<String>,
    /// `lidar_origin_to_beam_origin_mm`, millimetres.
    pub beam_origin_mm: Option<PlacedNumber>,
    /// `lidar_frame_azimuth_offset`: the angle at which the Lidar frame begins, millidegrees.
    pub azimuth_offset_mdeg: Option<PlacedNumber>,
    /// `columns_per_frame`.
    pub columns: Option<u32>,
    /// `pixels_per_column`.
    pub rows: Option<u32>,
    /// `beam_azimuth_angles`, degrees.
    pub azimuths: Option<Angles>,
    /// `beam_altitude_angles`, degrees.
    pub altitudes: Option<Angles>,
}

/// A number with its place.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct PlacedNumber {
    /// The number.
    #[serde(with = "super::number")]
    pub value: f64,
    /// Its place.
    pub place: Place,
}

/// The angles of beams.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Angles {
    /// How many there are.
    pub count: u32,
    /// How many of them are not finite numbers.
    pub broken: u32,
    /// The smallest and the largest, degrees.
    #[serde(with = "super::number::array")]
    pub range_deg: [f64; 2],
    /// Their place.
    pub place: Place,
}
