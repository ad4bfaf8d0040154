//! Dialects: programs and datasets whose calibration files are known.

use serde::Deserialize;

use super::dataset::QuaternionWord;
use super::rows::Row;

/// What is known about the files of one program.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Dialect {
    /// One word.
    pub name: String,
    /// How a file of it is named in a sentence.
    pub says: String,
    /// Keys by which a file is recognised: one of these lines must match.
    pub marks: Vec<String>,
    /// The values of its keys.
    pub transforms: Vec<KeyedTransform>,
    /// Whether the reader's source was checked, or files of one sensor were compared.
    pub verified: bool,
    /// The source.
    #[serde(default)]
    pub source: String,
}

/// A transform under a key.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct KeyedTransform {
    /// The key, or the keys of its parts.
    pub keys: Vec<String>,
    /// `A from B`: takes points of B to points of A.
    #[serde(default)]
    pub is: Option<String>,
    /// Whether the key itself states that.
    #[serde(default)]
    pub as_named: bool,
    /// The unit of lengths.
    #[serde(default)]
    pub length: Length,
    /// The unit of angles.
    #[serde(default)]
    pub angle: Angle,
    /// The order of a bare list of four.
    #[serde(default)]
    pub quaternion: Option<QuaternionWord>,
    /// Whether a list holds several 4x4, whose bottom rows are flags.
    #[serde(default)]
    pub packed: bool,
    /// Whether the texts under `@` keys are names of the platform's frames, and not the program's own.
    #[serde(default)]
    pub stated: bool,
    /// Why the direction is a hint.
    #[serde(default)]
    pub doubt: Option<String>,
    /// Why the file does not state the algebra of a quaternion.
    #[serde(default)]
    pub algebra_doubt: Option<String>,
}

/// A unit of lengths.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize)]
pub enum Length {
    /// Metres.
    #[default]
    #[serde(rename = "m")]
    Metres,
    /// Millimetres.
    #[serde(rename = "mm")]
    Millimetres,
}

/// A unit of angles.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize)]
pub enum Angle {
    /// Radians.
    #[default]
    #[serde(rename = "rad")]
    Radians,
    /// Degrees.
    #[serde(rename = "deg")]
    Degrees,
}

impl Row for Dialect {
    fn source_mut(&mut self) -> &mut String {
        &mut self.source
    }

    fn fault(&self) -> Option<(&'static str, &'static str)> {
        let has_keys = |keys: &[String]| !keys.is_empty() && keys.iter().all(|key| !key.trim().is_empty());
        if !has_keys(&self.marks) {
            return Some(("marks", "at least one path of keys is required"));
        }
        let is_well = |keyed: &KeyedTransform| {
            let frames = keyed.is.as_ref().is_none_or(|is| is.split_once(" from ").is_some());
            has_keys(&keyed.keys) && frames
        };
        let all_well = self.transforms.iter().all(is_well);
        (!all_well).then_some(("transforms", "`keys`, and `is: A from B`, are required"))
    }
}
