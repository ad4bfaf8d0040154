//! Origins of local frames on the Earth: as files state them, and as they come out of all that is known.

use serde::{Deserialize, Serialize};

use crate::math::geodesy::Geodetic;
use crate::source::{Confidence, Place, SourceId};

/// Where a file says that the origin of a local frame lies.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct EarthOrigin {
    /// The form it is written in, as the table of formats calls it (`robot_localization`, `autoware`).
    pub format: String,
    /// The path of keys to it.
    pub label: String,
    /// Degrees; `None` where the file states a projection alone.
    #[serde(with = "super::number::option_array", default)]
    pub latitude_longitude_deg: Option<[f64; 2]>,
    /// Metres; `None` where the form has none, or its reader does not use it.
    #[serde(with = "super::number::option", default)]
    pub altitude_m: Option<f64>,
    /// The fewest decimals of latitude and longitude.
    pub decimals: u32,
    /// The map's projection, where the file names it (`MGRS`, `LocalCartesianUTM`).
    pub projection: Option<String>,
    /// Where it stands.
    pub place: Place,
}

/// Where the origin of a local frame lies on the Earth, as a file or a recording has it.
#[derive(Clone, Debug)]
pub struct LocalOrigin {
    /// What puts it there, for messages.
    pub who: String,
    /// The kind of that.
    pub by: OriginSource,
    /// The recording, of what comes from one.
    pub bag: Option<SourceId>,
    /// Where it lies; at height 0 where that is not stated.
    pub at: Geodetic,
    /// Whether the height is stated.
    pub has_height: bool,
    /// How far off it may be: its digits, or the fit's deviation, metres.
    pub within_m: f64,
    /// Where the same source puts it later on, farthest off.
    pub later: Option<Geodetic>,
    /// By how much a track's axes are turned from east and north, and one deviation of that, radians.
    pub turned_rad: Option<(f64, f64)>,
    /// Where it is stated.
    pub place: Place,
    /// How sure the reading is.
    pub reading: Confidence,
}

/// What an origin comes from: the more trusted first. Statements of one recording's messages are not alternatives, files of one
/// format are.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum OriginSource {
    /// A transform from the Earth's frame.
    Transform,
    /// A topic.
    Topic,
    /// A file, in this format.
    File(String),
    /// Poses laid over fixes.
    Track,
}
