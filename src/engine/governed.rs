//! Which configuration governs what: for a platform the nearest above its recordings, else above its robots, else above its files. A
//! configuration in a deeper folder governs single files there.

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex};

use globset::GlobMatcher;

use crate::collect::CloudOptions;
use crate::config::{self, Config};
use crate::policy::Force;
use crate::read::allowed::AllowedFolders;
use crate::read::discover::Inputs;
use crate::read::input::Input;
use crate::rules::RULES;
use crate::run::FailOn;
use crate::source::{Source, SourceId, SourceKind};
use crate::tables::Tables;
use crate::verdict::waiver::Waiver;
use crate::world::World;

use super::enabled::EnabledRule;
use super::gather::source_id;
use super::plan::{self, Choice};
use super::{Options, Retention, UsageError};

/// Which configuration counts for a platform, whose files may lie under several.
const PLATFORMS: &str = "use the nearest configuration above their recordings, else above their robot";

/// A configuration, and its consequences for the platforms that it governs.
pub(super) struct Governance {
    /// `None` if there is none.
    pub(super) config: Option<Config>,
    /// The rules that run, and the limits of all.
    pub(super) choice: Choice,
    /// The folder that it governs; empty: everything.
    folder: PathBuf,
}

impl Governance {
    fn new(options: &Options, file: Option<&Path>, folder: PathBuf) -> Result<Self, UsageError> {
        let profile = options.profile.as_deref().filter(|_| !options.without_config);
        // A configuration given by the user may refer to any file.
        let is_given = options.config.as_deref() == file;
        let allowed = file.filter(|_| !is_given && !options.outside);
        let config = config::find(file, profile, allowed.map(|file| AllowedFolders::around([file])))?;
        config.as_ref().map_or(Ok(()), plan::known_mistakes)?;
        let mut choice = plan::enabled(&options.select, &options.ignore, config.as_ref())?;
        for rule in &mut choice.rules {
            rule.plots = options.sights >= Retention::Plots;
        }
        Ok(Self { config, choice, folder })
    }
}

/// The configurations of a run.
pub(super) struct Configurations {
    /// The one for everything that no other governs.
    outer: Governance,
    deeper: Vec<Governance>,
    /// For each input, by its index, the one that governs it: 0 is the outer one.
    of_input: Vec<usize>,
    /// The same for evidence documents.
    of_document: Vec<usize>,
    /// Those that govern a platform.
    in_force: Mutex<BTreeSet<usize>>,
}

impl Configurations {
    /// Finds and reads them.
    pub(super) fn new(options: &Options, inputs: &Inputs) -> Result<Self, UsageError> {
        let looks = options.config.is_none() && !options.without_config;
        let nearest = |path: &Path| config::nearest(path).filter(|_| looks);
        let mut folders: BTreeMap<&Path, Option<PathBuf>> = BTreeMap::new();
        let of_inputs = inputs.files.iter().map(|input| {
            let folder = input.path.parent().unwrap_or(Path::new(""));
            folders.entry(folder).or_insert_with(|| nearest(&input.path)).clone()
        });
        let of_inputs: Vec<Option<PathBuf>> = of_inputs.collect();
        let of_documents: Vec<Option<PathBuf>> = options.evidence.iter().map(|path| nearest(path)).collect();
        let given = options.paths.iter().map(|path| nearest(path));
        let given: BTreeSet<Option<PathBuf>> = given.chain(of_documents.iter().cloned()).collect();
        let outer = given.first().filter(|_| given.len() == 1).cloned().flatten();
        let files: BTreeSet<&PathBuf> = of_inputs.iter().chain(&of_documents).flatten().collect();
        let files: Vec<&PathBuf> = files.into_iter().filter(|file| Some(*file) != outer.as_ref()).collect();
        let number = |file: &Option<PathBuf>| {
            let known = files.iter().position(|known| Some(*known) == file.as_ref());
            known.map_or(0, |at| at + 1)
        };
        let deeper = files.iter().map(|file| {
            let folder = file.parent().map(Path::to_path_buf).unwrap_or_default();
            Governance::new(options, Some(file), folder)
        });
        let mut governed = Self {
            deeper: deeper.collect::<Result<_, _>>()?,
            outer: Governance::new(options, options.config.as_deref().or(outer.as_deref()), PathBuf::new())?,
            of_input: of_inputs.iter().map(number).collect(),
            of_document: of_documents.iter().map(number).collect(),
            in_force: Mutex::default(),
        };
        governed.nest(inputs);
        Ok(governed)
    }

    /// Numbers the layers of all, and adds to each the declarations of those in deeper folders.
    fn nest(&mut self, inputs: &Inputs) {
        let mut next = 0;
        for config in self.each_mut().filter_map(|one| one.config.as_mut()) {
            next = config.number(next);
        }
        let deeper: Vec<(PathBuf, String, Config)> = (1..)
            .zip(&self.deeper)
            .filter_map(|(at, one)| {
                let governs = |(_, own): &(&Input, &usize)| **own == at;
                let (input, _) = inputs.files.iter().zip(&self.of_input).find(governs)?;
                Some((one.folder.clone(), shown(&one.folder, input)?, one.config.clone()?))
            })
            .collect();
        for one in self.each_mut() {
            for (folder, shown, config) in &deeper {
                if *folder != one.folder && folder.starts_with(&one.folder) {
                    one.config.get_or_insert_default().add_below(config, shown);
                }
            }
        }
    }

    fn each_mut(&mut self) -> impl Iterator<Item = &mut Governance> {
        std::iter::once(&mut self.outer).chain(&mut self.deeper)
    }

    /// The outer one.
    pub(super) fn into_outer(self) -> Governance {
        self.outer
    }

    /// All of them, by their indices.
    pub(super) fn each(&self) -> impl Iterator<Item = &Governance> {
        std::iter::once(&self.outer).chain(&self.deeper)
    }

    /// The one with this index.
    pub(super) fn at(&self, number: usize) -> &Governance {
        self.each().nth(number).unwrap_or(&self.outer)
    }

    /// The index of the one that governs a platform.
    pub(super) fn of(&self, world: &World) -> usize {
        let governs = |ids: Vec<SourceId>| {
            let own = ids.iter().filter_map(|id| self.of_input.get(id.0 as usize));
            let own: BTreeSet<&Path> = own.map(|at| self.at(*at).folder.as_path()).collect();
            // The deepest one that governs all of them.
            let counts = |(_, one): &(usize, &Governance)| own.iter().all(|folder| folder.starts_with(&one.folder));
            let all = self.each().enumerate().filter(counts);
            let deepest = all.max_by_key(|(_, one)| one.folder.components().count());
            deepest.filter(|_| !own.is_empty()).map(|(at, _)| at)
        };
        let at = governs(world.bags.iter().map(|bag| bag.source).collect())
            .or_else(|| governs(world.robots.iter().map(|robot| robot.source).collect()))
            .or_else(|| governs(world.members.clone()))
            .unwrap_or_default();
        if let Ok(mut known) = self.in_force.lock() {
            known.insert(at);
        }
        at
    }

    /// Notes on configurations which keys have no effect: in those that govern no platform, and `xacro` in one among the checked files.
    /// After all judging.
    pub(super) fn note_idle(&self, options: &Options, sources: &mut [Arc<Source>]) {
        let configs = self.each().filter_map(|one| one.config.as_ref());
        let refused = configs.filter(|config| config.runs_xacro() && !self.runs_xacro(options) && !options.xacro.run);
        let why =
            "the configuration is inside the checked paths, or governs only a part of them; use --xacro run instead";
        for config in refused {
            note(sources, config, format!("`xacro` has no effect: {why}"));
        }
        let in_force = self.in_force.lock().map(|known| known.clone()).unwrap_or_default();
        let idle = self.each().enumerate().filter(|(at, _)| !in_force.contains(at));
        let has_platforms = !in_force.is_empty();
        for (at, config) in idle.filter_map(|(at, one)| Some((at, one.config.as_ref()?))) {
            let keys: Vec<String> = config.keys_of_platforms().map(|key| format!("`{key}`")).collect();
            let why = match at {
                0 => "configurations in deeper folders govern all platforms; they can extend this one",
                _ => "the platform's recordings or description are outside of this folder",
            };
            if !keys.is_empty() && (at > 0 || has_platforms) {
                note(sources, config, format!("no effect of {}: {why}", keys.join(", ")));
            }
        }
    }

    /// The index of the one that governs an evidence document.
    pub(super) fn of_document(&self, number: usize) -> usize {
        self.of_document.get(number).copied().unwrap_or_default()
    }

    /// The tables of devices and dialects for the input with this index.
    pub(super) fn tables(&self, input: usize) -> Arc<Tables> {
        let at = self.of_input.get(input).copied().unwrap_or_default();
        self.at(at).config.as_ref().map_or_else(Arc::default, Config::tables)
    }

    /// How clouds are kept: with the fields of times from the users' lidar drivers, and with what mistakes need where they are tried.
    pub(super) fn clouds(&self, options: &Options) -> CloudOptions {
        let configs = self.each().filter_map(|one| one.config.as_ref());
        let fields: BTreeSet<String> = configs.flat_map(|config| config.time_fields().to_vec()).collect();
        CloudOptions {
            time_fields: fields.into_iter().collect(),
            has_optical: self.each().any(|one| one.assures(options)),
            ..CloudOptions::default()
        }
    }

    /// The rules that run anywhere, once each.
    pub(super) fn rules(&self) -> Vec<&EnabledRule> {
        let all = self.each().flat_map(|one| &one.choice.rules);
        let rules: BTreeMap<&str, &EnabledRule> = all.map(|rule| (rule.entry.page.code, rule)).collect();
        rules.into_values().collect()
    }

    /// The lowest severity that fails a run: that of the strictest configuration, if any.
    pub(super) fn fail_on(&self) -> Option<FailOn> {
        let governs = |(at, _): &(usize, &Governance)| {
            *at == 0 && self.deeper.is_empty() || self.of_input.contains(at) || self.of_document.contains(at)
        };
        let named = self.each().enumerate().filter(governs);
        let named: Vec<Option<FailOn>> = named.map(|(_, one)| one.config.as_ref()?.fail_on()).collect();
        let is_named = named.iter().any(Option::is_some);
        let strictest = named
            .into_iter()
            .map(Option::unwrap_or_default)
            .max_by_key(|one| one.rank());
        strictest.filter(|_| is_named)
    }

    /// Whether comments in the inputs accept findings. With --config, only if that configuration allows it: the author of the inputs may not
    /// be the one who accepts them.
    pub(super) fn counts_comments(&self, options: &Options) -> bool {
        let said = self.outer.config.as_ref().and_then(Config::counts_comments);
        said.unwrap_or(options.config.is_none())
    }

    /// Whether the `xacro` program may be run: the outer configuration allows it, and is outside of the checked paths.
    pub(super) fn runs_xacro(&self, options: &Options) -> bool {
        let config = self.outer.config.as_ref().filter(|config| config.runs_xacro());
        config.is_some_and(|config| {
            let checked = AllowedFolders::around(options.paths.iter().map(PathBuf::as_path));
            let path = Path::new(config.path());
            // A link inside a checked folder belongs to the author of that folder.
            let folder = std::path::absolute(path)
                .ok()
                .and_then(|path| path.parent().map(Path::to_path_buf));
            !checked.holds(path) && !folder.is_some_and(|folder| checked.holds(&folder))
        })
    }

    /// Their paths, including those that they extend.
    pub(super) fn files(&self) -> Vec<PathBuf> {
        let configs = self.each().filter_map(|one| one.config.as_ref());
        configs
            .flat_map(|config| config.sources(0))
            .map(|source| PathBuf::from(source.path))
            .collect()
    }

    /// Their files as sources, behind these. The id of the first.
    pub(super) fn add_sources(&self, sources: &mut Vec<Arc<Source>>) -> u32 {
        let first = source_id(sources.len()).0;
        let configs = self.each().filter_map(|one| one.config.as_ref());
        sources.extend(configs.flat_map(|config| config.sources(first)).map(Arc::new));
        first
    }
}

/// Adds a note to a configuration among the sources.
fn note(sources: &mut [Arc<Source>], config: &Config, words: String) {
    let is_it = |source: &&mut Arc<Source>| source.kind == SourceKind::Configuration && source.path == config.path();
    if let Some(source) = sources.iter_mut().find(is_it) {
        Arc::make_mut(source).notes.push(words);
    }
}

/// The settings in force for a file, and where they are declared: names with their values.
pub fn settings_of(options: &Options, file: &Path) -> Result<Vec<(&'static str, String)>, UsageError> {
    if !file.exists() {
        return Err(UsageError(format!("`{}` does not exist", file.display())));
    }
    let looks = options.config.is_none() && !options.without_config;
    let near = config::nearest(file).filter(|_| looks);
    let one = Governance::new(options, options.config.as_deref().or(near.as_deref()), PathBuf::new())?;
    let all = RULES.len();
    let Some(config) = one.config else {
        return Ok(vec![
            ("configuration", "none".to_owned()),
            ("platforms", PLATFORMS.to_owned()),
            ("rules", format!("{} of {all}", one.choice.rules.len())),
        ]);
    };
    let files: Vec<String> = config.sources(0).into_iter().map(|source| source.path).rev().collect();
    let mut said = vec![("configuration", files.join(", which extends "))];
    // A configuration further up governs platforms that extend beyond the folder.
    let further = |file: &Path| file.parent().and_then(Path::parent).and_then(config::nearest);
    let mut above = near.as_deref().and_then(further);
    while let Some(file) = above {
        let shown = config::shown(&file);
        said.push((
            "above",
            format!("{shown}, for platforms that extend beyond this folder"),
        ));
        above = further(&file);
    }
    said.push(("platforms", PLATFORMS.to_owned()));
    said.push(("rules", format!("{} of {all}", one.choice.rules.len())));
    let (select, ignore) = config.rules();
    let named = |word: &'static str, (rule, origin): &(String, String)| (word, format!("{rule} ({origin})"));
    said.extend(select.iter().map(|rule| named("select", rule)));
    said.extend(ignore.map(|rule| named("ignore", rule)));
    said.extend(config.limits().map(|limit| {
        let (rule, name, value, unit) = (&limit.rule, &limit.name, limit.value, &limit.unit);
        ("limit", format!("{rule} {name}: {value} {unit} ({})", limit.origin))
    }));
    let files = |glob: &Option<GlobMatcher>| {
        let glob = glob.as_ref().map(|glob| format!(" in `{}`", glob.glob()));
        glob.unwrap_or_default()
    };
    let dataset = config.dataset(None);
    said.extend(dataset.map(|named| ("dataset", named.row.name.clone())));
    let conventions = config.conventions(None);
    said.extend(
        conventions
            .declarations
            .iter()
            .map(|declared| ("convention", declared.origin.clone())),
    );
    said.extend(conventions.aliases.iter().map(|alias| {
        (
            "alias",
            format!("`{}` is `{}` ({})", alias.name, alias.frame, alias.origin),
        )
    }));
    said.extend(conventions.transforms.iter().map(|one| {
        let (key, file) = (one.key.glob(), files(&one.file));
        (
            "transform",
            format!(
                "`{key}`{file} is `{}` from `{}` ({})",
                one.target, one.source, one.origin
            ),
        )
    }));
    let policy = config.policy(0);
    said.extend(policy.weights.iter().map(|weight| {
        let (rule, files, level) = (&weight.rule, files(&weight.file), weight.level.word());
        ("severity", format!("{rule}{files}: {level} ({})", weight.origin))
    }));
    said.extend(policy.exceptions.iter().map(|exception| {
        let Waiver {
            rule, about, origin, ..
        } = &exception.waiver;
        ("waiver", format!("{rule} {about} ({origin})"))
    }));
    said.extend(policy.required.iter().map(|required| {
        let subject = required.subject.as_ref().map(|glob| format!(" of `{}`", glob.glob()));
        let subject = subject.unwrap_or_default();
        let force = match &required.force {
            Force::Always => String::new(),
            Force::IfApplicable => ", if applicable".to_owned(),
            Force::Lifted(reason) => format!(" is lifted: {reason}"),
        };
        (
            "require",
            format!("{}{subject}{force} ({})", required.rule, required.origin),
        )
    }));
    said.extend(policy.share.map(|required| {
        let percent = 100.0 * required.share;
        (
            "require",
            format!("{percent} % of the applicable checks ({})", required.origin),
        )
    }));
    said.extend(config.fail_on().map(|fail_on| ("fail-on", fail_on.word().to_owned())));
    Ok(said)
}

/// A parent folder of an input, written as in the input's path.
fn shown(folder: &Path, input: &Input) -> Option<String> {
    let whole = std::fs::canonicalize(&input.path).ok()?;
    let behind = whole.strip_prefix(folder).ok()?.components().count();
    let shown = Path::new(&input.display).components();
    let before = shown.clone().count().checked_sub(behind)?;
    let folder: PathBuf = shown.take(before).collect();
    Some(folder.to_string_lossy().into_owned())
}
