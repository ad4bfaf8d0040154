//! The key `extends` of the configuration: built-in profiles, and other files.

use std::path::{Path, PathBuf};

use crate::read::allowed::AllowedFolders;
use crate::read::calibration::document::Node;

use super::reader::Reader;
use super::{Config, ConfigError};

/// The built-in profiles, by name.
pub const PROFILES: &[(&str, &str)] = &[
    ("ci", include_str!("../../rules/profiles/ci.yaml")),
    ("pre-survey", include_str!("../../rules/profiles/pre-survey.yaml")),
    (
        "dataset-acceptance",
        include_str!("../../rules/profiles/dataset-acceptance.yaml"),
    ),
];

/// Maximum depth of files that extend one another.
const MAX_DEPTH: usize = 16;

impl Config {
    /// Appends a profile.
    pub(super) fn add_profile(&mut self, name: &str) -> Result<(), ConfigError> {
        let Some((_, text)) = PROFILES.iter().find(|(known, _)| *known == name) else {
            return Err(ConfigError(unknown(name)));
        };
        self.add(
            &format!("profile {name}"),
            (*text).to_owned(),
            Path::new(""),
            &mut Vec::new(),
        )
    }

    /// Appends what a document extends.
    pub(super) fn extend(
        &mut self,
        reader: &Reader<'_>,
        root: &Node,
        folder: &Path,
        open: &mut Vec<PathBuf>,
    ) -> Result<(), ConfigError> {
        let Some(node) = root.get("extends") else { return Ok(()) };
        let names: Vec<&Node> = node.items().map_or_else(|| vec![node], |items| items.iter().collect());
        for node in names {
            let at = node.span.start;
            let name = node.text().filter(|text| !text.is_empty());
            let name = name.ok_or_else(|| reader.error(at, "`extends` must be the name of a profile, or a file"))?;
            if PROFILES.iter().any(|(known, _)| *known == name) {
                self.add_profile(name)?;
                continue;
            }
            if !name.contains(['/', '.', '\\']) {
                return Err(reader.error(at, &unknown(name)));
            }
            let path = folder.join(name);
            guard(self.allowed.as_ref(), &path, name).map_err(|what| reader.error(at, &what))?;
            let whole = std::fs::canonicalize(&path)
                .map_err(|error| reader.error(at, &format!("`{name}` cannot be read: {error}")))?;
            if !whole.is_file() {
                return Err(reader.error(at, &format!("`{name}` is not a file")));
            }
            if open.contains(&whole) || open.len() >= MAX_DEPTH {
                return Err(reader.error(at, &format!("`{name}` extends itself")));
            }
            self.add_file(&path, open)?;
        }
        Ok(())
    }
}

/// Why a file that a configuration names is not read: it is outside of the allowed folders.
pub(super) fn guard(allowed: Option<&AllowedFolders>, path: &Path, name: &str) -> Result<(), String> {
    match allowed {
        Some(allowed) if !allowed.holds(path) => Err(format!(
            "`{name}` is outside of the repository and was not read; allow it with --outside, or pass this configuration with --config"
        )),
        _ => Ok(()),
    }
}

fn unknown(name: &str) -> String {
    let names: Vec<&str> = PROFILES.iter().map(|(name, _)| *name).collect();
    format!(
        "no profile is called `{name}`; profiles: {}; the name of a file must contain a `/` or a `.`",
        names.join(", ")
    )
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use std::fs;

    use super::super::{load, parse};
    use super::*;

    #[test]
    fn every_profile_is_a_configuration() {
        for (name, _) in PROFILES {
            let mut config = Config::default();
            config.add_profile(name).unwrap();
            assert!(config.fail_on().is_some(), "{name}");
        }
    }

    #[test]
    fn what_is_extended_comes_before_and_is_overridden() {
        let folder = tempfile::tempdir().unwrap();
        let write = |name: &str, text: &str| fs::write(folder.path().join(name), text).unwrap();
        write(
            "base.yaml",
            "fail-on: note\nrules: {ignore: [NAME01]}\naliases: {velodyne: [lidar]}\ndataset: KITTI\n",
        );
        write(
            "top.yaml",
            "extends: ./base.yaml\nfail-on: error\nrules: {ignore: [NAME02]}\naliases: {ouster: [lidar]}\n",
        );
        let config = load(&folder.path().join("top.yaml")).unwrap();
        assert_eq!(config.fail_on(), Some(crate::run::FailOn::Error));
        let ignored: Vec<&str> = config.rules().1.map(|(word, _)| word.as_str()).collect();
        assert_eq!(ignored, ["NAME01", "NAME02"]);
        let conventions = config.conventions(Some(4));
        let frame = conventions.frame_of("a.yaml", &crate::world::FrameId::new("lidar"));
        assert_eq!(frame.unwrap().as_str(), "ouster");
        let place = config.dataset(Some(4)).unwrap().place.unwrap();
        assert_eq!(place.source.0, 4);
        assert_eq!(config.sources(4).len(), 2);
    }

    #[test]
    fn circles_and_unknown_names_have_a_place() {
        let folder = tempfile::tempdir().unwrap();
        fs::write(folder.path().join("a.yaml"), "extends: ./b.yaml\n").unwrap();
        fs::write(folder.path().join("b.yaml"), "fail-on: error\nextends: ./a.yaml\n").unwrap();
        let error = load(&folder.path().join("a.yaml")).unwrap_err().0;
        assert!(
            error.contains("b.yaml:2:10") && error.contains("extends itself"),
            "{error}"
        );
        let error = parse("c.yaml", "extends: cii\n".to_owned(), Path::new(""))
            .unwrap_err()
            .0;
        assert!(
            error.starts_with("c.yaml:1:10: no profile is called `cii`; profiles: ci, pre-survey"),
            "{error}"
        );
        let error = parse("c.yaml", "extends: ./none.yaml\n".to_owned(), folder.path())
            .unwrap_err()
            .0;
        assert!(error.contains("`./none.yaml` cannot be read"), "{error}");
    }
}
