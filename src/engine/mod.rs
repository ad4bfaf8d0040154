//! The engine: plan, read, judge. Ties the rooms of the house together and knows no format and no rule by name.

pub mod evidence;
mod gate;
mod gather;
mod hash;
mod judge;
mod limits;
mod parallel;
mod plan;
mod platform;
mod references;
mod sampling;

use std::fmt;
use std::path::PathBuf;
use std::sync::Arc;

use crate::collect::How;
use crate::config::{self, Config, ConfigError};
use crate::progress::Progress;
use crate::read::discover::{Inputs, discover_of};
use crate::read::messages::definition::Definitions;
use crate::run::{RuleInfo, Run};
use crate::source::Source;
use crate::verdict::Verdict;
use crate::verdict::waiver::Day;
use crate::world::World;

use evidence::Saved;
use plan::Enabled;

pub use crate::read::discover::Wanted;
pub use gate::write_baseline;
pub use hash::hash;
pub use sampling::Extent;

/// What the user asked for.
#[derive(Clone, Debug, Default)]
pub struct Options {
    /// Files and folders.
    pub paths: Vec<PathBuf>,
    /// Documents of evidence, judged beside the paths.
    pub evidence: Vec<PathBuf>,
    /// Which files of the folders are read.
    pub wanted: Wanted,
    /// Codes, names and families of the rules to run; all where empty.
    pub select: Vec<String>,
    /// Codes, names and families of the rules to leave out.
    pub ignore: Vec<String>,
    /// Arguments handed to xacro (`name:=value`).
    pub xacro_args: Vec<String>,
    /// The configuration that [`check`] uses; the nearest above the inputs where `None`.
    pub config: Option<PathBuf>,
    /// Whether no configuration is looked for.
    pub without_config: bool,
    /// A profile of the tool that the configuration stands on.
    pub profile: Option<String>,
    /// A baseline: its findings are accepted.
    pub baseline: Option<PathBuf>,
    /// The day on which waivers must still hold; this one in UTC where `None`.
    pub today: Option<Day>,
    /// How much of recordings is read.
    pub extent: Extent,
    /// Folders with definitions of messages, for recordings that carry none.
    pub msg_paths: Vec<PathBuf>,
    /// Whether to draw a progress bar on a terminal.
    pub progress: bool,
}

/// A call that cannot be carried out as it was made.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct UsageError(pub String);

impl fmt::Display for UsageError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.0)
    }
}

impl std::error::Error for UsageError {}

impl From<ConfigError> for UsageError {
    fn from(error: ConfigError) -> Self {
        Self(error.0)
    }
}

/// Every rule of the tool.
pub fn rules() -> Result<Vec<RuleInfo>, UsageError> {
    Ok(plan::all()?
        .iter()
        .map(|rule| RuleInfo::new(&rule.front, rule.entry.page))
        .collect())
}

/// Reads the inputs, judges them, and lays over the verdict what the user asks of the gate.
pub fn check(options: &Options) -> Result<Run, UsageError> {
    let config = configuration(options)?;
    let rules = plan::enabled(&options.select, &options.ignore, config.as_ref())?;
    let inputs = inputs(options)?;
    let saved: Vec<Saved> = options.evidence.iter().map(|path| evidence::read(path)).collect();
    let others = saved.iter().map(|saved| saved.worlds.len()).sum();
    let (mut worlds, verdicts) = settle(&inputs, options, config.as_ref(), &rules, others)?;
    let mut verdict = merged(verdicts);
    let several = worlds.len() + others > 1;
    let mut labels: Vec<String> = worlds.iter().map(|world| world.label.clone()).collect();
    let mut sources = take_sources(&mut worlds);
    let mut skipped = inputs.skipped;
    for Saved {
        worlds: mut known,
        sources: mut read,
        skipped: met,
    } in saved
    {
        if let Some(config) = &config {
            read = add_config(&mut known, read, config);
        }
        labels.extend(known.iter().map(|world| world.label.clone()));
        let mut part = merged(judge_all(&known, &rules, several));
        drop(known);
        let mut read = Arc::unwrap_or_clone(read);
        evidence::shift(&mut read, &mut part, sources.len());
        sources.extend(read);
        verdict.rows.extend(part.rows);
        verdict.findings.extend(part.findings);
        for (what, count) in met {
            *skipped.entry(what).or_default() += count;
        }
    }
    if !several {
        labels.clear();
    }
    let mut run = Run {
        sources,
        verdict,
        worlds,
        rules: rules
            .iter()
            .map(|rule| RuleInfo::new(&rule.front, rule.entry.page))
            .collect(),
        skipped,
        fail_on: config.as_ref().and_then(Config::fail_on),
        ..Run::default()
    };
    gate::pass(&mut run, options, config.as_ref(), &rules, &labels)?;
    run.verdict.sort();
    Ok(run)
}

/// A choice of rules, ready to judge worlds that are in memory: saved, altered or made.
pub struct Rules(Vec<Enabled>);

impl Rules {
    /// The rules with these codes, names and families; all where there are none.
    pub fn select(select: &[&str]) -> Result<Self, UsageError> {
        let select: Vec<String> = select.iter().map(|word| (*word).to_owned()).collect();
        Ok(Self(plan::enabled(&select, &[], None)?))
    }

    /// What the rules say of a world. Nothing is read, and nothing is asked for again.
    pub fn judge(&self, world: &World) -> Verdict {
        let mut verdict = judge::judge(world, &self.0, None);
        verdict.sort();
        verdict
    }
}

/// Reads the inputs as far as [`check`] with every rule would, and keeps no judgement.
pub fn collect(options: &Options) -> Result<Run, UsageError> {
    let inputs = inputs(options)?;
    let (mut worlds, _) = settle(&inputs, options, None, &plan::all()?, 0)?;
    Ok(Run {
        sources: take_sources(&mut worlds),
        worlds,
        skipped: inputs.skipped,
        ..Run::default()
    })
}

/// Reads and judges until no rule lacks evidence that may still be had. `others` worlds are judged beside these.
fn settle(
    inputs: &Inputs,
    options: &Options,
    config: Option<&Config>,
    rules: &[Enabled],
    others: usize,
) -> Result<(Vec<World>, Vec<Verdict>), UsageError> {
    let definitions = definitions(options)?;
    let mut plan = sampling::Plan::new(options.extent, rules);
    loop {
        let worlds = worlds(inputs, options, config, &definitions, &plan);
        let verdicts = judge_all(&worlds, rules, worlds.len() + others > 1);
        if !plan.widen(&worlds, &verdicts) {
            return Ok((worlds, verdicts));
        }
    }
}

/// One verdict for each world; subjects say which where there are several.
fn judge_all(worlds: &[World], rules: &[Enabled], several: bool) -> Vec<Verdict> {
    parallel::map(worlds.iter().collect(), |world| {
        judge::judge(world, rules, several.then_some(world.label.as_str()))
    })
}

fn merged(verdicts: Vec<Verdict>) -> Verdict {
    let mut verdict = Verdict::default();
    for part in verdicts {
        verdict.rows.extend(part.rows);
        verdict.findings.extend(part.findings);
    }
    verdict
}

/// Reads the inputs and judges nothing.
pub fn read(options: &Options) -> Result<Run, UsageError> {
    let inputs = inputs(options)?;
    let definitions = definitions(options)?;
    let config = configuration(options)?;
    let worlds = worlds(
        &inputs,
        options,
        config.as_ref(),
        &definitions,
        &sampling::Plan::new(options.extent, &[]),
    );
    Ok(Run {
        sources: worlds.first().map(|world| world.sources.to_vec()).unwrap_or_default(),
        worlds,
        skipped: inputs.skipped,
        ..Run::default()
    })
}

fn inputs(options: &Options) -> Result<Inputs, UsageError> {
    if options.paths.is_empty() && options.evidence.is_empty() {
        return Err(UsageError("no path was given".to_owned()));
    }
    Ok(discover_of(&options.paths, options.wanted))
}

fn definitions(options: &Options) -> Result<Arc<Definitions>, UsageError> {
    let mut definitions = Definitions::builtin();
    for folder in &options.msg_paths {
        definitions
            .add_folder(folder)
            .map_err(|what| UsageError(format!("--msg-path: {what}")))?;
    }
    Ok(Arc::new(definitions))
}

/// The configuration that holds for the inputs, evidence among them.
fn configuration(options: &Options) -> Result<Option<Config>, UsageError> {
    if options.without_config {
        return Ok(None);
    }
    let inputs: Vec<PathBuf> = options.paths.iter().chain(&options.evidence).cloned().collect();
    Ok(config::find(
        options.config.as_deref(),
        options.profile.as_deref(),
        &inputs,
    )?)
}

/// Tells the worlds what the configuration declares, and adds it to their sources: behind all others, so that their
/// numbers do not depend on it.
fn add_config(worlds: &mut [World], sources: Arc<Vec<Source>>, config: &Config) -> Arc<Vec<Source>> {
    // Let go by the worlds, the list can be added to where it is.
    for world in worlds.iter_mut() {
        world.sources = Arc::default();
    }
    let mut sources = Arc::unwrap_or_clone(sources);
    let id = u32::try_from(sources.len()).ok();
    sources.extend(id.into_iter().flat_map(|id| config.sources(id)));
    let (sources, conventions) = (Arc::new(sources), Arc::new(config.conventions(id)));
    for world in worlds {
        world.sources = Arc::clone(&sources);
        world.tables = config.tables();
        world.dataset = config.dataset(id);
        world.declare(Arc::clone(&conventions));
    }
    sources
}

fn worlds(
    inputs: &Inputs,
    options: &Options,
    config: Option<&Config>,
    definitions: &Arc<Definitions>,
    plan: &sampling::Plan,
) -> Vec<World> {
    let progress = Progress::new(options.progress);
    let how = How {
        sampling: plan.sampling(),
        definitions: Arc::clone(definitions),
        time_fields: config.map(Config::time_fields).unwrap_or_default(),
        ..How::default()
    };
    let tables = config.map_or_else(Arc::default, Config::tables);
    let readings = gather::gather(inputs, &options.xacro_args, &how, tables.dialects(), &progress);
    let mut worlds = platform::platforms(readings, inputs);
    if let (Some(config), Some(first)) = (config, worlds.first()) {
        let sources = Arc::clone(&first.sources);
        add_config(&mut worlds, sources, config);
    }
    worlds
}

/// The sources of all worlds, moved out: texts are large, and a judged world is looked at no more.
fn take_sources(worlds: &mut [World]) -> Vec<Source> {
    let shared = worlds
        .first()
        .map(|world| Arc::clone(&world.sources))
        .unwrap_or_default();
    for world in worlds {
        world.sources = Arc::default();
    }
    Arc::try_unwrap(shared).unwrap_or_else(|shared| shared.to_vec())
}
