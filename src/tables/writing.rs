//! How calibration files of a dialect are written.

use std::sync::LazyLock;

use serde::Deserialize;

use super::table;

/// How the files of one dialect look.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Writing {
    /// The dialect's name in the table of dialects.
    pub dialect: String,
    /// The ending of its files' names.
    pub ending: String,
    /// The file; its transforms stand in the place of `{items}`.
    pub file: String,
    /// What stands between two transforms; without it a file holds one.
    #[serde(default)]
    pub join: Option<String>,
    /// The number of the first camera.
    #[serde(default)]
    pub first: u32,
    /// How each transform is written.
    pub transforms: Vec<WrittenTransform>,
}

/// How one transform is written.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct WrittenTransform {
    /// Its key, as the table of dialects has it first; what it is, its units and order stand there.
    pub key: String,
    /// `A from B`, where the table of dialects leaves that to the file.
    #[serde(default)]
    pub is: Option<String>,
    /// The text, with `{tx}`, `{qw}`, `{T}` and so on in it.
    pub write: String,
    /// The name that the file must have.
    #[serde(default)]
    pub named: Option<String>,
}

#[derive(Deserialize)]
struct File {
    rows: Vec<Writing>,
}

/// All that is known of writing. Empty where the table of ours does not read, which a test rules out.
pub fn writings() -> &'static [Writing] {
    static WRITINGS: LazyLock<Vec<Writing>> =
        LazyLock::new(|| table!("calibration-writing").map_or_else(|_| Vec::new(), |file: File| file.rows));
    &WRITINGS
}
