//! Origins of local frames on the Earth: as files state them, and as they follow from all facts.

use serde::{Deserialize, Serialize};

use crate::math::geodesy::Geodetic;
use crate::source::{Confidence, Place, SourceId};

/// The origin of a local frame, as a file states it.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct EarthOrigin {
    /// The form it is written in, by its name in the table of formats (`robot_localization`, `autoware`).
    pub format: String,
    /// The path of keys to it.
    pub label: String,
    /// Degrees; `None` if the file states a projection only.
    #[serde(with = "super::number::option_array", default)]
    pub latitude_longitude_deg: Option<[f64; 2]>,
    /// Metres; `None` if the form has none, or its reader does not use it.
    #[serde(with = "super::number::option", default)]
    pub altitude_m: Option<f64>,
    /// The fewest decimals of latitude and longitude.
    pub decimals: u32,
    /// The map's projection, where the file names it (`MGRS`, `LocalCartesianUTM`).
    pub projection: Option<String>,
    /// Its place.
    pub place: Place,
}

/// The origin of a local frame on the Earth, from a file or a recording.
#[derive(Clone, Debug)]
pub struct LocalOrigin {
    /// Its evidence, for messages.
    pub who: String,
    /// The kind of that.
    pub by: OriginSource,
    /// The recording, if it comes from one.
    pub bag: Option<SourceId>,
    /// Its position; at height 0 if the height is not stated.
    pub at: Geodetic,
    /// Whether the height is stated.
    pub has_height: bool,
    /// Its uncertainty, from its digits or the residual of the fit, metres.
    pub within_m: f64,
    /// Its farthest position later in the same source.
    pub later: Option<Geodetic>,
    /// Rotation of a track's axes from east and north, and one deviation of that, radians.
    pub turned_rad: Option<(f64, f64)>,
    /// Where it is stated.
    pub place: Place,
    /// How sure the reading is.
    pub reading: Confidence,
}

/// The evidence of an origin: the more trusted first. Statements of one recording's messages are not alternatives, files of one
/// format are.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum OriginSource {
    /// A transform from the Earth's frame.
    Transform,
    /// A topic.
    Topic,
    /// A file, in this format.
    File(String),
    /// Poses aligned with fixes.
    Track,
}
