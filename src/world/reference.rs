//! References from one file to another that should contain a calibration.

use serde::{Deserialize, Serialize};

use crate::source::SourceValue;

/// The state of the file that a reference names.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum ReferenceState {
    /// It exists and is not empty.
    Found,
    /// It exists and is empty.
    Empty,
    /// It does not exist.
    Missing,
    /// It is on another machine, or cannot be known.
    Unknown,
}

/// A path to a calibration file, as another file states it.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
pub struct FileReference {
    /// Its key.
    pub key: String,
    /// The path as written.
    pub path: SourceValue<String>,
    /// The state of the file.
    pub state: ReferenceState,
}
