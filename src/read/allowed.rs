//! The folders whose files may be read because a file that is read names them.
//!
//! Files that the user names are read from anywhere. Files that only another file names (an include, a table, a configuration that is extended)
//! are read in these folders only: that file may come from a stranger.

use std::path::{Component, Path, PathBuf};

/// Folders, whole and without links.
#[derive(Clone, Debug, Default)]
pub struct AllowedFolders {
    folders: Vec<PathBuf>,
}

impl AllowedFolders {
    /// Those around these paths: the folders themselves, those of the files, and the repositories and packages of ROS that they belong to.
    pub fn around<'p>(paths: impl IntoIterator<Item = &'p Path>) -> Self {
        let mut folders = Vec::new();
        for path in paths {
            let Ok(whole) = std::fs::canonicalize(path) else {
                continue;
            };
            let own = if whole.is_dir() { Some(&*whole) } else { whole.parent() };
            let Some(own) = own else { continue };
            for sign in [".git", "package.xml"] {
                let root = own.ancestors().find(|folder| folder.join(sign).exists());
                folders.extend(root.map(Path::to_path_buf));
            }
            folders.push(own.to_path_buf());
        }
        folders.sort();
        // A folder inside of another one follows it.
        folders.dedup_by(|later, earlier| later.starts_with(earlier));
        Self { folders }
    }

    /// Only these files and folders.
    pub fn exactly(paths: &[PathBuf]) -> Self {
        Self::default().with(paths.iter().map(PathBuf::as_path))
    }

    /// With further folders.
    #[must_use]
    pub fn with<'p>(mut self, more: impl IntoIterator<Item = &'p Path>) -> Self {
        self.folders
            .extend(more.into_iter().filter_map(|folder| std::fs::canonicalize(folder).ok()));
        self
    }

    /// All of them.
    pub fn folders(&self) -> &[PathBuf] {
        &self.folders
    }

    /// Whether a path is in one of them, with links resolved. A path that does not exist is taken as written.
    pub fn holds(&self, path: &Path) -> bool {
        let whole = std::fs::canonicalize(path).ok().or_else(|| written(path));
        whole.is_some_and(|whole| self.folders.iter().any(|folder| whole.starts_with(folder)))
    }
}

/// A path from the root, with `..` resolved.
fn written(path: &Path) -> Option<PathBuf> {
    let mut whole = PathBuf::new();
    for part in std::path::absolute(path).ok()?.components() {
        match part {
            Component::ParentDir => _ = whole.pop(),
            Component::CurDir => {}
            part => whole.push(part),
        }
    }
    Some(whole)
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;

    #[test]
    fn a_repository_is_allowed_and_what_lies_beside_it_is_not() {
        let folder = tempfile::tempdir().unwrap();
        let root = std::fs::canonicalize(folder.path()).unwrap();
        for made in ["repo/.git", "repo/robots/a", "other"] {
            std::fs::create_dir_all(root.join(made)).unwrap();
        }
        std::fs::write(root.join("other/x.yaml"), "").unwrap();
        std::fs::write(root.join("repo/y.yaml"), "").unwrap();
        let robot = root.join("repo/robots/a");
        let allowed = AllowedFolders::around([&*robot]);
        assert!(allowed.holds(&robot.join("../../y.yaml")) && allowed.holds(&root.join("repo/none.yaml")));
        for foreign in [
            "other/x.yaml",
            "other/none.yaml",
            "repo/../other/none.yaml",
            "repository",
        ] {
            assert!(!allowed.holds(&root.join(foreign)), "{foreign}");
        }
        assert!(allowed.with([&*root.join("other")]).holds(&root.join("other/x.yaml")));
        #[cfg(unix)]
        {
            std::os::unix::fs::symlink(root.join("other/x.yaml"), robot.join("link.yaml")).unwrap();
            assert!(!AllowedFolders::around([&*robot]).holds(&robot.join("link.yaml")));
        }
    }

    #[test]
    fn without_a_repository_the_folder_itself_is_allowed() {
        let folder = tempfile::tempdir().unwrap();
        let robot = folder.path().join("robot");
        std::fs::create_dir(&robot).unwrap();
        let allowed = AllowedFolders::around([&*robot]);
        assert!(allowed.holds(&robot.join("a.yaml")) && !allowed.holds(&folder.path().join("a.yaml")));
        assert!(!AllowedFolders::default().holds(&robot));
    }
}
