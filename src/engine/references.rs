//! Finds out whether the calibration files that other files refer to exist.

use std::fs;
use std::path::Path;

use crate::world::{FileReference, ReferenceState};

/// Sets the state of each reference. Relative paths are relative to the folder of the file that states them; an absolute path that does
/// not exist may belong to another machine, so its state is unknown.
pub(super) fn resolve(references: &mut [FileReference], folder: &Path) {
    for reference in references {
        let path = Path::new(&reference.path.value);
        let is_absolute = path.is_absolute() || reference.path.value.starts_with('~');
        reference.state = match fs::metadata(folder.join(path)) {
            Ok(meta) if meta.is_file() && meta.len() == 0 => ReferenceState::Empty,
            Ok(meta) if meta.is_file() => ReferenceState::Found,
            _ if is_absolute => ReferenceState::Unknown,
            _ => ReferenceState::Missing,
        };
    }
}
