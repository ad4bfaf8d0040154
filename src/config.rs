//! The configuration, `frames-lint.yaml`: found, read, and split into declarations about the inputs and the user's policy.
//!
//! Owns its keys. Applies no rules. An error in a configuration stops the run and names its place: a gate that runs with half
//! of its configuration could pass for the wrong reason.
//!
//! ```yaml
//! extends: ci                      # a built-in profile (ci, pre-survey, dataset-acceptance), a file, or a list of them
//! fail-on: warning                 # note, warning, error, never
//! rules:                           # see `policy`
//!   ignore: [NAME03]
//!   severity: {NAME02: error}
//! limits:
//!   CROSS02: {rotation_deg: 3 deg}
//! paths:
//!   - {file: simulation/**, ignore: [urdf]}
//! waivers:
//!   - {rule: CROSS02, subject: '*lidar*', reason: remounted on the 3rd, until: 2027-01-31, by: J. Doe}
//! require:
//!   - TREE01
//!   - {rule: AXES03, subject: '*/imu*', if: applicable}
//!   - {rule: GEO01, lifted: no satellite receiver} # no longer required, although an entry before it or an extended file requires it
//!   - {share: 0.8}                   # of the checks that apply
//!   - {detects: [imu-wxyz, {fault: yaw, smaller-than: 3 deg}]} # known mistakes that these data would have shown; `frames-lint assure --list` lists them
//! conventions:                     # see `declared`
//!   - topic: /ins/*                # a glob; `frame:` and `file:` as well; all of those given must match
//!     world: NED                   # ENU, NED, NWU
//!     body: FRD                    # FLU, FRD
//!     quaternion: {order: wxyz, algebra: hamilton}
//!     time: gps                    # utc, gps, tai
//!     fields: confirmed            # fields such as latitude in non-standard messages mean what their names say
//! dataset: KITTI                   # a published dataset, compared with its own conventions
//! tables:                          # own rows, before those of `rules/tables/`, with the same keys
//!   lidar-clouds: our-lidars.yaml  # a file beside this one, or the rows themselves
//!   lidar-imus:
//!     - {name: Ours, words: [ours], lever_mm: [1, 2, 3]}
//! aliases:                         # names that files use for a frame of the platform
//!   velodyne: [lidar, velo]
//! transforms:                      # frames of a transform whose file does not name them, or names them unclearly
//!   - {file: fast_livo.yaml, key: 'extrin_calib/extrinsic*', is: imu from lidar}
//! comments: accept                 # obey `frames-lint: allow` comments in files; refuse: ignore them (default with --config)
//! xacro: run                       # also the program `xacro`, if this file is outside of the checked paths; else own
//! projections:                     # see `projections`
//!   - topic: /points
//!     range_image: {width: 1024, height: 64, fov_up_deg: 22.5, fov_down_deg: -22.5}
//! contract:                        # see `contract`; `frames-lint init --from` writes it
//!   topics: [{topic: /imu, type: sensor_msgs/msg/Imu, rate_hz: 100, frame: imu_link}]
//!   transforms: [{parent: base_link, child: imu_link, xyz_m: [0.3, 0, 0.1], tolerance_mm: 5}]
//! ```
//!
//! Extended configurations are read first: lists are appended to, single values and entries of mappings are overridden.

mod contract;
mod declared;
mod extends;
mod frames;
mod policy;
mod projections;
mod reader;
mod required;
mod tables;

use std::fs::File;
use std::io::Read;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use globset::{Glob, GlobMatcher};

use crate::policy::{Policy, Requirement};
use crate::read::allowed::AllowedFolders;
use crate::read::discover::CONFIGURATION;
use crate::run::FailOn;
use crate::source::{Place, Source, SourceId, SourceKind, Span};
use crate::tables::Tables;
use crate::world::contract::Contract;
use crate::world::conventions::{Alias, Declaration, DeclaredTransform};
use crate::world::{Conventions, NamedDataset, Projection};

use policy::PolicyLayer;
use reader::Reader;

pub use extends::PROFILES;
pub use policy::LimitOverride;

/// Maximum size, bytes.
const MAX_BYTES: u64 = 1 << 20;

/// A configuration: the ones that it extends, then itself.
#[derive(Clone, Debug, Default)]
pub struct Config {
    layers: Vec<Layer>,
    /// Declarations of configurations in deeper folders about the files there.
    below: Vec<Layer>,
    /// The tables of devices, with the user's own rows.
    tables: Arc<Tables>,
    /// Folders in which files that it names must be; `None`: anywhere.
    allowed: Option<AllowedFolders>,
}

/// One file, or a built-in profile.
#[derive(Clone, Debug, Default)]
struct Layer {
    /// Its index among the layers of a run.
    number: u32,
    /// Its file, for messages.
    path: String,
    text: String,
    /// What it declares; without places until it is a source.
    conventions: Vec<(Declaration, Span)>,
    /// The dataset that it names, and where.
    dataset: Option<(NamedDataset, Span)>,
    projections: Vec<projections::ProjectionDraft>,
    contract: Contract,
    aliases: Vec<Alias>,
    transforms: Vec<DeclaredTransform>,
    /// Whether the `xacro` program may be run.
    xacro: Option<bool>,
    /// Whether comments in the inputs count.
    comments: Option<bool>,
    asked: PolicyLayer,
}

/// Why a configuration cannot be used, with the place in words.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ConfigError(pub String);

/// The named profile, if any, and on top of it the file, if any. `None` if there is neither. Files that the file names must be in the
/// allowed folders, if any are given.
pub fn find(
    file: Option<&Path>,
    profile: Option<&str>,
    allowed: Option<AllowedFolders>,
) -> Result<Option<Config>, ConfigError> {
    let mut config = Config {
        allowed,
        ..Config::default()
    };
    if let Some(profile) = profile {
        config.add_profile(profile)?;
    }
    if let Some(file) = file {
        config.add_file(file, &mut Vec::new())?;
    }
    Ok((!config.layers.is_empty()).then_some(config))
}

/// The nearest configuration in the input's own folder or above it.
pub fn nearest(input: &Path) -> Option<PathBuf> {
    let whole = std::fs::canonicalize(input).ok()?;
    whole
        .ancestors()
        .map(|folder| folder.join(CONFIGURATION))
        .find(|path| path.is_file())
}

/// Reads a configuration and what it extends.
pub fn load(path: &Path) -> Result<Config, ConfigError> {
    let mut config = Config::default();
    config.add_file(path, &mut Vec::new())?;
    Ok(config)
}

/// Reads a configuration from its text; paths of files in it are relative to `folder`.
pub fn parse(path: &str, text: String, folder: &Path) -> Result<Config, ConfigError> {
    let mut config = Config::default();
    config.add(path, text, folder, &mut Vec::new())?;
    Ok(config)
}

/// A path for messages: relative to the working directory if it is below it.
pub(crate) fn shown(path: &Path) -> String {
    let here = std::env::current_dir().ok();
    let shown = here.and_then(|here| path.strip_prefix(here).ok()).unwrap_or(path);
    shown.display().to_string()
}

impl Config {
    /// Appends a file, after the ones that it extends. `open` are the files being read.
    fn add_file(&mut self, path: &Path, open: &mut Vec<PathBuf>) -> Result<(), ConfigError> {
        let shown = shown(path);
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
        open.push(std::fs::canonicalize(path).unwrap_or_else(|_| path.to_path_buf()));
        self.add(&shown, text, path.parent().unwrap_or(Path::new("")), open)?;
        open.pop();
        Ok(())
    }

    /// Appends a text, after the files that it extends.
    fn add(&mut self, path: &str, text: String, folder: &Path, open: &mut Vec<PathBuf>) -> Result<(), ConfigError> {
        let reader = Reader::new(path, &text);
        let root = reader.document()?;
        let mut layer = Layer {
            path: path.to_owned(),
            ..Layer::default()
        };
        if let Some(root) = root {
            reader.keys(&root, KEYS)?;
            self.extend(&reader, &root, folder, open)?;
            if let Some(node) = root.get("tables") {
                let tables = reader.tables(node, folder, (*self.tables).clone(), self.allowed.as_ref())?;
                self.tables = Arc::new(tables);
            }
            layer.conventions = reader.conventions(&root)?;
            layer.projections = reader.projections(&root)?;
            layer.contract = reader.contract(&root)?;
            layer.aliases = reader.aliases(&root)?;
            layer.transforms = reader.transforms(&root)?;
            layer.dataset = root
                .get("dataset")
                .map(|node| reader.dataset(node, &self.tables))
                .transpose()?;
            layer.xacro = reader.word(&root, "xacro", XACRO)?;
            layer.comments = reader.word(&root, "comments", COMMENTS)?;
            layer.asked = reader.asked(&root)?;
        }
        layer.text = text;
        self.layers.push(layer);
        Ok(())
    }

    /// The configuration as sources of the run, from this id on.
    pub fn sources(&self, first: u32) -> Vec<Source> {
        let source = |layer: &Layer| {
            let id = SourceId(first.saturating_add(layer.number));
            let mut source = Source::new(id, layer.path.clone(), SourceKind::Configuration);
            source.text.clone_from(&layer.text);
            source.examined.bytes = layer.text.len() as u64;
            source.examined.bytes_total = layer.text.len() as u64;
            source
        };
        self.layers.iter().map(source).collect()
    }

    /// Numbers its layers among those of a run, from this number on; the next number.
    pub fn number(&mut self, first: u32) -> u32 {
        (first..)
            .zip(&mut self.layers)
            .map(|(number, layer)| {
                layer.number = number;
                number + 1
            })
            .last()
            .unwrap_or(first)
    }

    /// Adds the declarations of a configuration in a deeper folder, for the files below `folder` (a path as in sources).
    pub fn add_below(&mut self, deeper: &Self, folder: &str) {
        self.below
            .extend(deeper.layers.iter().filter_map(|layer| layer.below(folder)));
    }

    /// The layers with their ids as sources, if they are sources.
    fn placed(&self, first: Option<u32>) -> impl DoubleEndedIterator<Item = (Option<SourceId>, &Layer)> {
        let layers = self.layers.iter().chain(&self.below);
        layers.map(move |layer| (first.map(|first| SourceId(first.saturating_add(layer.number))), layer))
    }

    /// The tables of devices, drivers and datasets: the user's rows, then the built-in ones.
    pub fn tables(&self) -> Arc<Tables> {
        Arc::clone(&self.tables)
    }

    /// Fields with the times of points, from the user's lidar drivers.
    pub fn time_fields(&self) -> Arc<[String]> {
        self.tables.own_time_fields().map(str::to_owned).collect()
    }

    /// The dataset that it names; with a place, where its layers are sources of the run from the id `first` on.
    pub fn dataset(&self, first: Option<u32>) -> Option<NamedDataset> {
        let (id, (named, span)) = self
            .placed(first)
            .rev()
            .find_map(|(id, layer)| Some((id, layer.dataset.as_ref()?)))?;
        Some(NamedDataset {
            row: Arc::clone(&named.row),
            place: id.map(|id| Place::text(id, *span)),
        })
    }

    /// What it declares; with places, where its layers are sources of the run from the id `first` on.
    pub fn conventions(&self, first: Option<u32>) -> Conventions {
        let mut known = Conventions::default();
        for (id, layer) in self.placed(first) {
            let placed = |(declaration, span): &(Declaration, Span)| Declaration {
                place: id.map(|id| Place::text(id, *span)),
                ..declaration.clone()
            };
            known.declarations.extend(layer.conventions.iter().map(placed));
            let projection = |declared: &projections::ProjectionDraft| {
                Some(Projection {
                    format: "frames-lint".to_owned(),
                    label: String::new(),
                    topic: declared.topic.clone(),
                    place: Place::text(id?, declared.span),
                    form: declared.form.clone(),
                })
            };
            known
                .projections
                .extend(layer.projections.iter().filter_map(projection));
            if let Some(id) = id {
                known.contract.overlay(&layer.contract, id);
            }
            known.aliases.extend(layer.aliases.iter().cloned());
            known.transforms.extend(layer.transforms.iter().cloned());
        }
        known
    }

    /// What the policy does to a verdict; `first` is the source id of its first layer.
    pub fn policy(&self, first: u32) -> Policy {
        let mut policy = Policy::default();
        for (id, layer) in self.placed(Some(first)) {
            policy.weights.extend(layer.asked.weights.iter().cloned());
            policy
                .exceptions
                .extend(id.into_iter().flat_map(|id| layer.asked.exceptions(id)));
            policy.required.extend(layer.asked.required.iter().cloned());
            policy.detections.extend(layer.asked.detections.iter().cloned());
            policy.share = layer.asked.share.clone().or(policy.share);
        }
        policy
    }

    /// The rules that run: the last `select`, and every `ignore`. Words with their places.
    pub fn rules(&self) -> (&[(String, String)], impl Iterator<Item = &(String, String)>) {
        let asked = || self.layers.iter().map(|layer| &layer.asked);
        let select = asked().rev().find_map(|asked| asked.select.as_deref());
        (select.unwrap_or_default(), asked().flat_map(|asked| &asked.ignore))
    }

    /// Every word that names rules, with its place; only the engine knows which rules exist.
    pub fn named_rules(&self) -> impl Iterator<Item = &(String, String)> {
        self.layers.iter().flat_map(|layer| &layer.asked.named)
    }

    /// The known mistakes that must be found; only the engine knows which exist.
    pub fn detections(&self) -> impl Iterator<Item = &Requirement> {
        self.layers.iter().flat_map(|layer| &layer.asked.detections)
    }

    /// Limits that differ from those of the pages.
    pub fn limits(&self) -> impl Iterator<Item = &LimitOverride> {
        self.layers.iter().flat_map(|layer| &layer.asked.limits)
    }

    /// The lowest severity that fails a run.
    pub fn fail_on(&self) -> Option<FailOn> {
        self.layers.iter().rev().find_map(|layer| layer.asked.fail_on)
    }

    /// Whether the `xacro` program may be run on the inputs.
    pub fn runs_xacro(&self) -> bool {
        self.layers.iter().rev().find_map(|layer| layer.xacro).unwrap_or(false)
    }

    /// Whether comments in the inputs accept findings, if set.
    pub fn counts_comments(&self) -> Option<bool> {
        self.layers.iter().rev().find_map(|layer| layer.comments)
    }

    /// Those of its keys that apply to whole platforms, not to single files.
    pub fn keys_of_platforms(&self) -> impl Iterator<Item = &'static str> {
        let has = |test: fn(&Layer) -> bool| self.layers.iter().any(test);
        let keys = [
            ("contract", has(|layer| !layer.contract.is_empty())),
            ("dataset", has(|layer| layer.dataset.is_some())),
            ("limits", has(|layer| !layer.asked.limits.is_empty())),
            ("projections", has(|layer| !layer.projections.is_empty())),
            (
                "require",
                has(|layer| {
                    let asked = &layer.asked;
                    !asked.required.is_empty() || !asked.detections.is_empty() || asked.share.is_some()
                }),
            ),
            ("rules: select", has(|layer| layer.asked.select.is_some())),
        ];
        keys.into_iter().filter_map(|(key, has)| has.then_some(key))
    }

    /// The last file, as it is shown.
    pub fn path(&self) -> &str {
        self.layers.last().map_or("", |layer| &layer.path)
    }
}

impl Layer {
    /// Its declarations about files, limited to those below a folder.
    fn below(&self, folder: &str) -> Option<Self> {
        let within = |file: &mut Option<GlobMatcher>| {
            let own = file.as_ref().map_or("*", |glob| glob.glob().glob());
            let whole = format!("/{}/**/{own}", globset::escape(folder));
            *file = Some(Glob::new(&whole).ok()?.compile_matcher());
            Some(())
        };
        let mut layer = Self {
            number: self.number,
            path: self.path.clone(),
            conventions: self.conventions.clone(),
            transforms: self.transforms.clone(),
            aliases: self.aliases.clone(),
            asked: self.asked.of_files(),
            ..Self::default()
        };
        for (declaration, _) in &mut layer.conventions {
            within(&mut declaration.scope.file)?;
        }
        for transform in &mut layer.transforms {
            within(&mut transform.file)?;
        }
        for alias in &mut layer.aliases {
            within(&mut alias.file)?;
        }
        layer.asked.files().try_for_each(within)?;
        Some(layer)
    }
}

/// Values of `xacro`.
const XACRO: &[(&str, bool)] = &[("own", false), ("run", true)];

/// Values of `comments`.
const COMMENTS: &[(&str, bool)] = &[("accept", true), ("refuse", false)];

/// The keys of a configuration.
pub const KEYS: &[&str] = &[
    "aliases",
    "comments",
    "contract",
    "conventions",
    "dataset",
    "extends",
    "fail-on",
    "limits",
    "paths",
    "projections",
    "require",
    "rules",
    "tables",
    "transforms",
    "waivers",
    "xacro",
];

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;

    /// The error of a configuration.
    pub(super) fn fault(text: &str) -> String {
        parse("c.yaml", text.to_owned(), Path::new("")).unwrap_err().0
    }

    #[test]
    fn every_key_is_read() {
        let text = "# ours\nconventions:\n  - topic: /ins/*\n    world: ned\n    body: FRD\n    \
                    quaternion: {order: wxyz, algebra: jpl}\n    time: GPS\n  - {frame: /odom, file: '*.mcap', world: ENU}\n";
        let config = parse("c.yaml", text.to_owned(), Path::new("")).unwrap();
        let conventions = config.conventions(Some(3));
        let [ins, odom] = &conventions.declarations[..] else {
            panic!("two declarations")
        };
        assert_eq!(
            ins.convention.words(),
            "world NED, body FRD, quaternion order wxyz, quaternion algebra jpl, stamps in GPS"
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
                    .conventions(None)
                    .declarations
                    .is_empty(),
                "{text:?}"
            );
        }
    }

    #[test]
    fn faults_have_a_place_and_say_what_is_known() {
        assert_eq!(
            fault("rule: {}\n"),
            "c.yaml:1:1: unknown key `rule`; did you mean `rules`? known keys: aliases, comments, contract, conventions, dataset, extends, fail-on, limits, \
             paths, projections, require, rules, tables, transforms, waivers, xacro"
        );
        assert_eq!(
            fault("conventions:\n  - topic: /imu\n    wrold: NED\n"),
            "c.yaml:3:5: unknown key `wrold`; did you mean `world`? known keys: topic, frame, file, world, body, quaternion, time, fields"
        );
        assert_eq!(
            fault("conventions:\n  - topic: /imu\n    world: NEU\n"),
            "c.yaml:3:12: `world` must be one of ENU, NED, NWU, not `NEU`"
        );
        assert!(fault("conventions:\n  - world: NED\n").contains("`topic`, `frame` or `file` is missing"));
        assert!(fault("conventions:\n  - topic: /imu\n").contains("declares nothing"));
        assert!(fault("conventions:\n  topic: /imu\n").contains("must be a list"));
        assert!(fault("conventions:\n  - topic: '[a'\n    world: NED\n").contains("is not a valid glob"));
        assert!(fault("conventions: [\n").starts_with("c.yaml:"));
        assert!(fault("a: 1\na: 2\n").contains("twice"));
    }
}
