//! Whether the mesh files that a robot refers to exist.
//!
//! Owns the ways a URDF names a file. Checks only whether a file exists; never opens one.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use crate::source::MeshFile;

/// Where meshes are searched.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct MeshLookup {
    /// The folder of the URDF; `None` for a text without one (out of a recording).
    pub base_dir: Option<PathBuf>,
    /// Folders of the packages in the input, by package name.
    pub packages: BTreeMap<String, PathBuf>,
}

impl MeshLookup {
    /// Whether the file exists; `None` if that cannot be decided: a package outside of the input, a scheme that
    /// names no file, a path that was not expanded.
    pub fn found(&self, filename: &str) -> Option<bool> {
        self.path(filename).map(|path| path.is_file())
    }

    /// The file, if it exists.
    pub fn file(&self, filename: &str) -> Option<MeshFile> {
        let path = self.path(filename)?;
        let bytes = path.metadata().ok()?.len();
        Some(MeshFile { path, bytes })
    }

    /// Where the file should be; `None` where that cannot be decided.
    pub fn path(&self, filename: &str) -> Option<PathBuf> {
        let filename = filename.trim();
        if filename.contains("$(") || filename.contains("${") {
            return None;
        }
        for scheme in ["package://", "model://"] {
            if let Some(rest) = filename.strip_prefix(scheme) {
                let (package, path) = rest.split_once('/').unwrap_or((rest, ""));
                return self.package(package).map(|folder| folder.join(path));
            }
        }
        let path = match filename.split_once("://") {
            Some(("file", path)) => path,
            Some(_) => return None,
            None => filename,
        };
        let windows = path.get(1..2) == Some(":");
        if windows {
            return None;
        }
        let path = Path::new(path);
        if path.is_absolute() {
            return Some(path.to_path_buf());
        }
        Some(self.base_dir.as_ref()?.join(path))
    }

    /// The folder of a package: in the input, or a folder of that name around the URDF.
    fn package(&self, name: &str) -> Option<&Path> {
        if name.is_empty() {
            return None;
        }
        self.packages.get(name).map(PathBuf::as_path).or_else(|| {
            let base = self.base_dir.as_ref()?;
            base.ancestors()
                .find(|folder| folder.file_name().is_some_and(|last| last == name))
        })
    }
}
