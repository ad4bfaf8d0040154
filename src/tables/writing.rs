//! How calibration files of a dialect are written.

use std::sync::LazyLock;

use serde::Deserialize;

use super::table;

/// The form of the files of one dialect.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct FileTemplate {
    /// The dialect's name in the table of dialects.
    pub dialect: String,
    /// The ending of its files' names.
    pub ending: String,
    /// The file, with `{items}` in the place of its transforms.
    pub file: String,
    /// The separator of two transforms; without it a file has one.
    #[serde(default)]
    pub join: Option<String>,
    /// The number of the first camera.
    #[serde(default)]
    pub first: u32,
    /// How each transform is written.
    pub transforms: Vec<TransformTemplate>,
}

/// How one transform is written.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct TransformTemplate {
    /// Its key, the first one in the table of dialects, which has its meaning, units and order.
    pub key: String,
    /// `A from B`, if the table of dialects leaves that to the file.
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
    rows: Vec<FileTemplate>,
}

/// All known forms. Empty if the program's table cannot be read, which a test excludes.
pub fn writings() -> &'static [FileTemplate] {
    static WRITINGS: LazyLock<Vec<FileTemplate>> =
        LazyLock::new(|| table!("calibration-writing").map_or_else(|_| Vec::new(), |file: File| file.rows));
    &WRITINGS
}
