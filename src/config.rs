//! The configuration, `frames-lint.yaml`: found, read, and turned into what the world knows of it.
//!
//! Owns its keys. Must not judge. A fault in it is a fault of the call, with its place: a gate that runs on half of its
//! configuration would be green for the wrong reason.
//!
//! ```yaml
//! conventions:
//!   - topic: /ins/*                # a glob; `frame:` and `file:` as well, and all that are given must hold
//!     world: NED                   # ENU, NED, NWU
//!     body: FRD                    # FLU, FRD
//!     quaternion: {order: wxyz, algebra: hamilton}
//!     time: gps                    # utc, gps, tai
//!     fields: confirmed            # latitude, longitude, ... without a standard type are what their names say
//! dataset: KITTI                   # a published dataset, held against its own conventions
//! tables:                          # rows of one's own, in front of those of `rules/tables/`, with the same keys
//!   lidar-clouds: our-lidars.yaml  # a file beside this one, or the rows themselves
//!   lidar-imus:
//!     - {name: Ours, words: [ours], lever_mm: [1, 2, 3]}
//! aliases:                         # names that files use for a frame of the platform
//!   velodyne: [lidar, velo]
//! transforms:                      # what a statement of a file is, where the file does not say or is in doubt
//!   - {file: fast_livo.yaml, key: 'extrin_calib/extrinsic*', is: imu from lidar}
//! projections:                     # see `projections`
//!   - topic: /points
//!     range_image: {width: 1024, height: 64, fov_up_deg: 22.5, fov_down_deg: -22.5}
//! ```

mod frames;
mod projections;
mod tables;

use std::fs::File;
use std::io::Read;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use globset::{GlobBuilder, GlobMatcher};

use crate::read::calibration::document::Node;
use crate::read::calibration::events;
use crate::read::calibration::repair::OffsetMap;
use crate::read::discover::CONFIGURATION;
use crate::source::{LineIndex, Place, Source, SourceId, SourceKind, Span};
use crate::tables::Tables;
use crate::world::conventions::{
    Alias, BodyAxes, Convention, Declaration, DeclaredTransform, Fields, QuaternionAlgebra, QuaternionOrder, Scope,
    TimeScale, WorldAxes,
};
use crate::world::{Conventions, NamedDataset, Projection};

/// Bound on its size, bytes.
const MAX_BYTES: u64 = 1 << 20;

/// A configuration.
#[derive(Clone, Debug, Default)]
pub struct Config {
    /// Where it was read, for messages.
    pub path: String,
    /// Its text.
    pub text: String,
    /// What it declares; without places until [`Config::source`] gives it an identity.
    conventions: Vec<(Declaration, Span)>,
    /// What is known of devices, with the user's own rows.
    tables: Arc<Tables>,
    /// The dataset that it names, and where.
    dataset: Option<(NamedDataset, Span)>,
    projections: Vec<projections::Declared>,
    aliases: Vec<Alias>,
    transforms: Vec<DeclaredTransform>,
}

/// Why there is no configuration, with the place in words.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ConfigError(pub String);

/// The configuration that holds for these inputs: `named` by the user, or the nearest above them. `None` where there is
/// none.
pub fn find(named: Option<&Path>, inputs: &[PathBuf]) -> Result<Option<Config>, ConfigError> {
    if let Some(path) = named {
        return load(path).map(Some);
    }
    let mut found: Option<PathBuf> = None;
    for input in inputs {
        let above = nearest(input);
        match (&found, above) {
            (Some(one), Some(other)) if *one != other => {
                return Err(ConfigError(format!(
                    "`{}` and `{}` hold for different inputs of this call; check them one by one, or name one with --config",
                    one.display(),
                    other.display()
                )));
            }
            (None, Some(other)) => found = Some(other),
            _ => {}
        }
    }
    found.map(|path| load(&path)).transpose()
}

/// The nearest configuration in the input's own folder or above it.
fn nearest(input: &Path) -> Option<PathBuf> {
    let whole = std::fs::canonicalize(input).ok()?;
    whole
        .ancestors()
        .filter(|folder| folder.is_dir())
        .map(|folder| folder.join(CONFIGURATION))
        .find(|path| path.is_file())
}

/// Reads a configuration.
pub fn load(path: &Path) -> Result<Config, ConfigError> {
    let here = std::env::current_dir().ok();
    let shown = here.and_then(|here| path.strip_prefix(here).ok()).unwrap_or(path);
    let shown = shown.display().to_string();
    let failed = |error: &dyn std::fmt::Display| ConfigError(format!("`{shown}` cannot be read: {error}"));
    let mut bytes = Vec::new();
    let file = File::open(path).map_err(|error| failed(&error))?;
    file.take(MAX_BYTES + 1)
        .read_to_end(&mut bytes)
        .map_err(|error| failed(&error))?;
    if bytes.len() as u64 > MAX_BYTES {
        return Err(failed(&format!("it has more than {MAX_BYTES} bytes")));
    }
    let text = String::from_utf8(bytes).map_err(|_| failed(&"it is not UTF-8"))?;
    parse(&shown, text, path.parent().unwrap_or(Path::new("")))
}

/// Reads a configuration from its text; files that it names are looked for from `folder`.
pub fn parse(path: &str, text: String, folder: &Path) -> Result<Config, ConfigError> {
    let mut config = {
        let reader = Reader {
            path,
            lines: LineIndex::new(&text),
            text: &text,
        };
        reader.read(folder)?
    };
    config.text = text;
    Ok(config)
}

impl Config {
    /// The configuration as a source of the run.
    pub fn source(&self, id: SourceId) -> Source {
        let mut source = Source::new(id, self.path.clone(), SourceKind::Configuration);
        source.text.clone_from(&self.text);
        source.examined.bytes = self.text.len() as u64;
        source.examined.bytes_total = self.text.len() as u64;
        source
    }

    /// What is known of devices, drivers and datasets: the user's rows, and behind them those that come with the program.
    pub fn tables(&self) -> Arc<Tables> {
        Arc::clone(&self.tables)
    }

    /// Fields in which the user's drivers of lidars have the times of points.
    pub fn time_fields(&self) -> Arc<[String]> {
        self.tables.own_time_fields().map(str::to_owned).collect()
    }

    /// The dataset that it names; with a place, where it is a source of the run.
    pub fn dataset(&self, id: Option<SourceId>) -> Option<NamedDataset> {
        let (named, span) = self.dataset.as_ref()?;
        Some(NamedDataset {
            row: Arc::clone(&named.row),
            place: id.map(|id| Place::text(id, *span)),
        })
    }

    /// What it declares; with places, where it is a source of the run.
    pub fn conventions(&self, id: Option<SourceId>) -> Conventions {
        let placed = |(declaration, span): &(Declaration, Span)| Declaration {
            place: id.map(|id| Place::text(id, *span)),
            ..declaration.clone()
        };
        let projection = |declared: &projections::Declared| {
            Some(Projection {
                format: "frames-lint".to_owned(),
                label: String::new(),
                topic: declared.topic.clone(),
                place: Place::text(id?, declared.span),
                form: declared.form.clone(),
            })
        };
        Conventions {
            declarations: self.conventions.iter().map(placed).collect(),
            projections: self.projections.iter().filter_map(projection).collect(),
            aliases: self.aliases.clone(),
            transforms: self.transforms.clone(),
        }
    }
}

/// The keys of one declaration.
const KEYS: &[&str] = &[
    "topic",
    "frame",
    "file",
    "world",
    "body",
    "quaternion",
    "time",
    "fields",
];

struct Reader<'t> {
    path: &'t str,
    text: &'t str,
    lines: LineIndex,
}

impl Reader<'_> {
    fn read(&self, folder: &Path) -> Result<Config, ConfigError> {
        let empty = Config {
            path: self.path.to_owned(),
            ..Config::default()
        };
        let Some(root) = self.document()? else {
            return Ok(empty);
        };
        self.keys(
            &root,
            &[
                "aliases",
                "conventions",
                "dataset",
                "projections",
                "tables",
                "transforms",
            ],
        )?;
        let tables = match root.get("tables") {
            Some(node) => self.tables(node, folder)?,
            None => Tables::default(),
        };
        Ok(Config {
            conventions: self.conventions(&root)?,
            projections: self.projections(&root)?,
            aliases: self.aliases(&root)?,
            transforms: self.transforms(&root)?,
            dataset: root
                .get("dataset")
                .map(|node| self.dataset(node, &tables))
                .transpose()?,
            tables: Arc::new(tables),
            ..empty
        })
    }

    /// The one document of the text; `None` where there is nothing in it.
    fn document(&self) -> Result<Option<Node>, ConfigError> {
        let documents = events::build(self.text, &OffsetMap::default());
        if let Some(fault) = &documents.fault {
            return Err(self.error(fault.at, &fault.message));
        }
        if let Some((key, span)) = documents.repeated.first() {
            return Err(self.error(span.start, &format!("`{key}` stands there twice")));
        }
        let mut roots = documents.roots.into_iter();
        let root = roots.next();
        if let Some(second) = roots.next() {
            return Err(self.error(second.span.start, "one document is expected"));
        }
        let is_nothing = |text: &str| text.is_empty() || text == "~" || text == "null";
        Ok(root.filter(|root| !root.text().is_some_and(is_nothing)))
    }

    fn dataset(&self, node: &Node, tables: &Tables) -> Result<(NamedDataset, Span), ConfigError> {
        let row = node.text().and_then(|text| tables.dataset(text));
        let row = row.ok_or_else(|| {
            let names = tables.dataset_names().join(", ");
            let what = format!(
                "`dataset` is one of {names}, not `{}`",
                node.text().unwrap_or("a list or a mapping")
            );
            self.error(node.span.start, &what)
        })?;
        Ok((NamedDataset { row, place: None }, node.span))
    }

    fn conventions(&self, root: &Node) -> Result<Vec<(Declaration, Span)>, ConfigError> {
        let Some(list) = root.get("conventions") else {
            return Ok(Vec::new());
        };
        let items = list.items().ok_or_else(|| {
            self.error(
                list.span.start,
                "`conventions` is a list: `- topic: /imu` on one line, `world: NED` below it",
            )
        })?;
        items.iter().map(|item| self.declaration(item)).collect()
    }

    fn declaration(&self, item: &Node) -> Result<(Declaration, Span), ConfigError> {
        self.keys(item, KEYS)?;
        let scope = Scope {
            topic: self.glob(item, "topic")?,
            frame: self.glob(item, "frame")?,
            file: self.glob(item, "file")?,
        };
        if scope.topic.is_none() && scope.frame.is_none() && scope.file.is_none() {
            return Err(self.error(
                item.span.start,
                "this is for nothing: `topic`, `frame` or `file` is missing",
            ));
        }
        let mut convention = Convention {
            world: self.word(item, "world", WorldAxes::WORDS)?,
            body: self.word(item, "body", BodyAxes::WORDS)?,
            time: self.word(item, "time", TimeScale::WORDS)?,
            fields: self.word(item, "fields", Fields::WORDS)?,
            ..Convention::default()
        };
        if let Some(quaternion) = item.get("quaternion") {
            self.keys(quaternion, &["order", "algebra"])?;
            convention.order = self.word(quaternion, "order", QuaternionOrder::WORDS)?;
            convention.algebra = self.word(quaternion, "algebra", QuaternionAlgebra::WORDS)?;
        }
        if convention.is_empty() {
            let what = "this declares nothing: `world`, `body`, `quaternion`, `time` or `fields` is missing";
            return Err(self.error(item.span.start, what));
        }
        let origin = format!("{}:{}", self.path, self.lines.locate(self.text, item.span.start).line);
        let declaration = Declaration {
            scope,
            convention,
            origin,
            place: None,
        };
        Ok((declaration, item.span))
    }

    /// A mapping with known keys only.
    fn keys(&self, node: &Node, known: &[&str]) -> Result<(), ConfigError> {
        let words = || format!("known keys: {}", known.join(", "));
        if !node.is_mapping() {
            return Err(self.error(
                node.span.start,
                &format!("keys with values are expected here; {}", words()),
            ));
        }
        for (key, _) in node.pairs() {
            let text = key.text().unwrap_or_default();
            if !known.contains(&text) {
                return Err(self.error(key.span.start, &format!("unknown key `{text}`; {}", words())));
            }
        }
        Ok(())
    }

    fn glob(&self, item: &Node, key: &str) -> Result<Option<GlobMatcher>, ConfigError> {
        let Some(value) = item.get(key) else { return Ok(None) };
        let text = value.text().filter(|text| !text.is_empty());
        let text =
            text.ok_or_else(|| self.error(value.span.start, &format!("`{key}` is a name, or a glob with `*`")))?;
        // A frame is compared without its slash, as tf2 does.
        let text = if key == "frame" {
            text.strip_prefix('/').unwrap_or(text)
        } else {
            text
        };
        let glob = GlobBuilder::new(text)
            .literal_separator(false)
            .build()
            .map_err(|error| self.error(value.span.start, &format!("`{key}` is no glob: {}", error.kind())))?;
        Ok(Some(glob.compile_matcher()))
    }

    fn word<T: Copy>(&self, item: &Node, key: &str, words: &[(&str, T)]) -> Result<Option<T>, ConfigError> {
        let Some(value) = item.get(key) else { return Ok(None) };
        let text = value.text().unwrap_or_default();
        let known = words.iter().find(|(word, _)| word.eq_ignore_ascii_case(text));
        known.map(|(_, value)| Some(*value)).ok_or_else(|| {
            let words: Vec<&str> = words.iter().map(|(word, _)| *word).collect();
            let what = format!("`{key}` is one of {}, not `{text}`", words.join(", "));
            self.error(value.span.start, &what)
        })
    }

    fn error(&self, at: usize, what: &str) -> ConfigError {
        let place = self.lines.locate(self.text, at);
        ConfigError(format!("{}:{}:{}: {what}", self.path, place.line, place.column))
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;

    fn fault(text: &str) -> String {
        parse("c.yaml", text.to_owned(), Path::new("")).unwrap_err().0
    }

    #[test]
    fn every_key_is_read() {
        let text = "# ours\nconventions:\n  - topic: /ins/*\n    world: ned\n    body: FRD\n    \
                    quaternion: {order: wxyz, algebra: jpl}\n    time: GPS\n  - {frame: /odom, file: '*.mcap', world: ENU}\n";
        let config = parse("c.yaml", text.to_owned(), Path::new("")).unwrap();
        let conventions = config.conventions(Some(SourceId(3)));
        let [ins, odom] = &conventions.declarations[..] else {
            panic!("two declarations")
        };
        assert_eq!(
            ins.convention.words(),
            "world NED, body FRD, quaternions in the order wxyz, quaternions of jpl, stamps in GPS"
        );
        assert_eq!(ins.origin, "c.yaml:3");
        assert!(ins.scope.topic.as_ref().unwrap().is_match("/ins/imu/data"));
        assert!(odom.scope.frame.as_ref().unwrap().is_match("odom"));
        let span = odom.place.as_ref().unwrap().span().unwrap();
        assert!(text[span.start..span.end].starts_with("{frame: /odom"));
    }

    #[test]
    fn an_empty_configuration_declares_nothing() {
        for text in ["", "# nothing\n", "conventions: []\n", "---\n"] {
            assert!(
                parse("c.yaml", text.to_owned(), Path::new(""))
                    .unwrap()
                    .conventions
                    .is_empty(),
                "{text:?}"
            );
        }
    }

    #[test]
    fn faults_have_a_place_and_say_what_is_known() {
        assert_eq!(
            fault("rules: {}\n"),
            "c.yaml:1:1: unknown key `rules`; known keys: aliases, conventions, dataset, projections, tables, transforms"
        );
        assert_eq!(
            fault("conventions:\n  - topic: /imu\n    wrold: NED\n"),
            "c.yaml:3:5: unknown key `wrold`; known keys: topic, frame, file, world, body, quaternion, time, fields"
        );
        assert_eq!(
            fault("conventions:\n  - topic: /imu\n    world: NEU\n"),
            "c.yaml:3:12: `world` is one of ENU, NED, NWU, not `NEU`"
        );
        assert!(fault("conventions:\n  - world: NED\n").contains("`topic`, `frame` or `file` is missing"));
        assert!(fault("conventions:\n  - topic: /imu\n").contains("declares nothing"));
        assert!(fault("conventions:\n  topic: /imu\n").contains("is a list"));
        assert!(fault("conventions:\n  - topic: '[a'\n    world: NED\n").contains("is no glob"));
        assert!(fault("conventions: [\n").starts_with("c.yaml:"));
        assert!(fault("a: 1\na: 2\n").contains("twice"));
    }
}
