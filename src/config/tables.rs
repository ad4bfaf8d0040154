//! The user's own rows for the tables of devices: in the configuration, or in a file beside it.
//!
//! Finds the rows. Does not know their keys: the tables check those.

use std::fs::File;
use std::io::Read;
use std::path::Path;

use crate::read::allowed::AllowedFolders;
use crate::read::calibration::document::{Kind, Node};
use crate::tables::{RowFault, Tables};

use super::extends::guard;
use super::reader::Reader;
use super::{ConfigError, MAX_BYTES};

/// Maximum number of the user's own rows.
const MAX_ROWS: usize = 1000;

impl Reader<'_> {
    /// The tables, with the rows under `tables:` before the built-in ones.
    pub(super) fn tables(
        &self,
        node: &Node,
        folder: &Path,
        mut tables: Tables,
        allowed: Option<&AllowedFolders>,
    ) -> Result<Tables, ConfigError> {
        self.keys(node, &Tables::NAMES)?;
        for (key, value) in node.pairs() {
            let table = key.text().unwrap_or_default();
            match value.text() {
                Some(path) if !path.is_empty() => {
                    guard(allowed, &folder.join(path), path).map_err(|what| self.error(value.span.start, &what))?;
                    self.file(table, path, value, folder, &mut tables)?;
                }
                _ => self.rows(table, value, &mut tables)?,
            }
        }
        Ok(tables)
    }

    /// The rows of a file.
    fn file(&self, table: &str, path: &str, at: &Node, folder: &Path, tables: &mut Tables) -> Result<(), ConfigError> {
        let failed = |error: &str| self.error(at.span.start, &format!("`{path}` cannot be read: {error}"));
        let mut bytes = Vec::new();
        let file = File::open(folder.join(path)).map_err(|error| failed(&error.to_string()))?;
        file.take(MAX_BYTES + 1)
            .read_to_end(&mut bytes)
            .map_err(|error| failed(&error.to_string()))?;
        if bytes.len() as u64 > MAX_BYTES {
            return Err(failed(&format!("it has more than {MAX_BYTES} bytes")));
        }
        let text = String::from_utf8(bytes).map_err(|_| failed("it is not UTF-8"))?;
        let shown = Path::new(self.path).parent().unwrap_or(Path::new("")).join(path);
        let shown = shown.display().to_string();
        let inner = Reader::new(&shown, &text);
        let Some(root) = inner.document()? else {
            return Err(inner.error(0, "the file is empty: expected rows"));
        };
        if root.is_mapping() {
            inner.keys(&root, &["rows"])?;
        }
        inner.rows(table, root.get("rows").unwrap_or(&root), tables)
    }

    /// The rows of a list.
    fn rows(&self, table: &str, list: &Node, tables: &mut Tables) -> Result<(), ConfigError> {
        let items = list.items().ok_or_else(|| {
            let what = format!("`{table}` must be a list of rows, or the path of a file with them; rules/tables/{table}.yaml shows their keys");
            self.error(list.span.start, &what)
        })?;
        if items.len() > MAX_ROWS {
            return Err(self.error(list.span.start, &format!("more than {MAX_ROWS} rows")));
        }
        for item in items {
            if !item.is_mapping() {
                return Err(self.error(item.span.start, "expected a row: keys with values"));
            }
            let line = self.lines.locate(self.text, item.span.start).line;
            let added = tables.add(table, &value(item), &format!("{}:{line}", self.path));
            added.map_err(|fault| self.row_fault(table, item, &fault))?;
        }
        Ok(())
    }

    fn row_fault(&self, table: &str, row: &Node, fault: &RowFault) -> ConfigError {
        let mut at = row.span.start;
        let mut node = row;
        for key in &fault.keys {
            let Some((name, value)) = node.pair(key) else { break };
            at = name.span.start;
            node = value;
        }
        let key = fault.keys.last().map(|key| format!("`{key}`: ")).unwrap_or_default();
        self.error(at, &format!("row of `{table}`: {key}{}", fault.message))
    }
}

/// A node as plain data. Unquoted scalars have the type that YAML gives them.
fn value(node: &Node) -> serde_yaml::Value {
    match &node.kind {
        Kind::Scalar { text, quoted: true } => serde_yaml::Value::String(text.to_string()),
        Kind::Scalar { text, .. } => {
            let plain = serde_yaml::from_str::<serde_yaml::Value>(text).ok();
            let is_scalar = |value: &serde_yaml::Value| !value.is_mapping() && !value.is_sequence();
            plain
                .filter(is_scalar)
                .unwrap_or_else(|| serde_yaml::Value::String(text.to_string()))
        }
        Kind::Sequence(items) => serde_yaml::Value::Sequence(items.iter().map(value).collect()),
        Kind::Mapping(pairs) => {
            let pairs = pairs.iter().map(|(key, inner)| {
                let key = key.text().unwrap_or_default().to_owned();
                (serde_yaml::Value::String(key), value(inner))
            });
            serde_yaml::Value::Mapping(pairs.collect())
        }
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::super::{Config, parse, tests::fault};
    use super::*;

    fn config(text: &str, folder: &Path) -> Result<Config, ConfigError> {
        parse("c.yaml", text.to_owned(), folder)
    }

    #[test]
    fn rows_in_the_configuration_and_in_a_file_beside_it_are_read() {
        let folder = tempfile::tempdir().unwrap();
        std::fs::write(
            folder.path().join("ours.yaml"),
            "rows:\n  - name: Ours\n    fields: {dt: uint32, beam: uint8}\n    time: {field: dt, unit_s: 1.0e-6, counts_from: header}\n",
        )
        .unwrap();
        let text = "tables:\n  lidar-clouds: ours.yaml\n  lidar-imus:\n    - {name: Ours, words: [ours], lever_mm: [1, 2, 3]}\n  datasets:\n    - {name: Town, words: [town], frames: [{names: [car], axes: FLU}]}\ndataset: town\n";
        let config = config(text, folder.path()).unwrap();
        let tables = config.tables();
        let driver = tables
            .cloud_driver([("dt", "uint32"), ("beam", "uint8")].into_iter())
            .unwrap();
        assert_eq!((driver.name.as_str(), driver.source.as_str()), ("Ours", "ours.yaml:2"));
        assert_eq!(&*config.time_fields(), ["dt".to_owned()]);
        let lever = tables.lidar_imu(&["ours".to_owned()]).unwrap();
        assert_eq!(
            (lever.lever_mm, lever.source.as_str()),
            (Some([1.0, 2.0, 3.0]), "c.yaml:4")
        );
        assert_eq!(config.dataset(None).unwrap().row.name, "Town");
    }

    #[test]
    fn faults_have_a_place() {
        assert_eq!(
            fault("tables:\n  lidars-clouds: []\n"),
            "c.yaml:2:3: unknown key `lidars-clouds`; did you mean `lidar-clouds`? known keys: lidar-clouds, lidars, ouster, lidar-imus, driver-frames, ins-drivers, \
             simulators, datasets, calibration-dialects"
        );
        let text = "tables:\n  lidar-imus:\n    - name: Ours\n      words: [ours]\n      lever_m: [0, 0, 0]\n";
        assert!(
            fault(text).starts_with("c.yaml:5:7: row of `lidar-imus`: `lever_m`: unknown field `lever_m`"),
            "{}",
            fault(text)
        );
        let text = "tables:\n  lidar-imus:\n    - {name: Ours, words: [ours], lever_mm: [a, 0, 0]}\n";
        assert!(
            fault(text).starts_with("c.yaml:3:35: row of `lidar-imus`: `lever_mm`: "),
            "{}",
            fault(text)
        );
        assert_eq!(
            fault("tables:\n  lidar-imus:\n    - {words: [ours]}\n"),
            "c.yaml:3:7: row of `lidar-imus`: missing field `name`"
        );
        assert!(fault("tables:\n  lidar-imus:\n    - {name: Ours, words: [Ours X]}\n").contains("lower-case"));
        assert!(fault("tables:\n  lidar-imus: none.yaml\n").starts_with("c.yaml:2:15: `none.yaml` cannot be read"));
        assert!(fault("tables:\n  lidar-imus: {}\n").contains("must be a list of rows"));
        assert!(fault("tables: []\n").contains("expected keys with values"));
        assert!(fault("dataset: town\n").contains("`dataset` must be one of KITTI, nuScenes, Argoverse 2"));
        let text = "tables:\n  datasets:\n    - {name: T, words: [t], frames: [{names: [car], axes: FRU}]}\n";
        assert!(fault(text).contains("right-handed"), "{}", fault(text));
    }
}
