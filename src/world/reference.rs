//! References from one file to another that should hold a calibration.

use serde::{Deserialize, Serialize};

use crate::source::Placed;

/// What became of the file that a reference names.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum ReferenceState {
    /// It is there and holds something.
    Found,
    /// It is there and empty.
    Empty,
    /// It is not there.
    Missing,
    /// It lies on another machine, or cannot be known.
    Unknown,
}

/// A path to a calibration file, as another file states it.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
pub struct FileReference {
    /// The key it stands under.
    pub key: String,
    /// The path as written.
    pub path: Placed<String>,
    /// Whether the file is there.
    pub state: ReferenceState,
}
