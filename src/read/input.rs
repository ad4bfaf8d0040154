//! A file of a run, and the ending of its name.

use std::path::{Path, PathBuf};

use crate::source::SourceKind;

/// One file of a run.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Input {
    /// Where it is.
    pub path: PathBuf,
    /// The path as shown to the user.
    pub display: String,
    /// What it was recognised as.
    pub kind: SourceKind,
    /// The files of a recording that has several, in order, `path` among them; for a rosbag2 folder, of which `path` is the
    /// `metadata.yaml`, the files that it names.
    pub parts: Vec<PathBuf>,
    /// Why it cannot be read at all, if that is known before reading.
    pub refusal: Option<String>,
    /// Which argument it came from: files of one folder belong together; loose files share a group.
    pub group: usize,
    /// The folder given as argument, or the file's own folder.
    pub root: PathBuf,
    /// Whether failing to read it makes the run incomplete.
    pub required: bool,
}

/// The ending of a file's name, in lower case; `launch.py`, `launch.xml` and `bag.active` count as one.
pub(super) fn ending(path: &Path) -> String {
    let name = path
        .file_name()
        .map(|name| name.to_string_lossy().to_lowercase())
        .unwrap_or_default();
    for double in [
        "launch.py",
        "launch.xml",
        "bag.active",
        "mcap.zstd",
        "db3.zstd",
        "bag.zstd",
        "mcap.zst",
        "db3.zst",
        "bag.zst",
    ] {
        if name.ends_with(&format!(".{double}")) {
            return double.to_owned();
        }
    }
    name.rsplit_once('.')
        .map_or_else(|| "(no ending)".to_owned(), |(_, ending)| ending.to_owned())
}
