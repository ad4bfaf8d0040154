//! Origins of local frames on the Earth, as files state them.

use serde::{Deserialize, Serialize};

use crate::source::Place;

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
