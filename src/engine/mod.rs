//! The engine: plan, read, judge. Ties the rooms of the house together and knows no format and no rule by name.

mod enabled;
pub mod evidence;
mod gather;
mod hash;
mod judge;
mod limits;
mod options;
mod parallel;
mod plan;
mod platform;
mod policy;
mod recordings;
mod references;
mod renumber;
mod sampling;
mod sessions;

use std::collections::BTreeMap;
use std::path::PathBuf;
use std::sync::Arc;

use crate::collect::How;
use crate::config::{self, Config};
use crate::progress::Progress;
use crate::read::discover::{Inputs, discover_of};
use crate::read::messages::definition::Definitions;
use crate::run::{Grown, RuleInfo, Run};
use crate::source::Source;
use crate::tables::Tables;
use crate::verdict::Verdict;
use crate::world::{Conventions, NamedDataset, World};

use evidence::Saved;
use plan::Choice;
use platform::{Member, Platforms};
use policy::{Demanded, RunPolicy};
use renumber::Renumber;

pub use crate::read::discover::Wanted;
pub use hash::hash;
pub use options::{Options, Sights, UsageError, Verdicts};
pub use policy::write_baseline;
pub use sampling::Extent;

/// Every rule of the tool.
pub fn rules() -> Result<Vec<RuleInfo>, UsageError> {
    Ok(plan::all()?
        .iter()
        .map(|rule| RuleInfo::new(&rule.front, rule.entry.page))
        .collect())
}

/// Reads the inputs, judges them, and lays over the verdict what the user accepts and requires. Of several recordings each has a verdict of
/// its own.
pub fn check(options: &Options) -> Result<Run, UsageError> {
    check_each(options, &mut |_, _| {})
}

/// The same, and tells what was judged as soon as it is: a recording after the other, where there are several. Every source, outcome
/// and finding is told once.
pub fn check_each(options: &Options, told: &mut dyn FnMut(&Run, &Grown)) -> Result<Run, UsageError> {
    let config = configuration(options)?;
    let mut choice = plan::enabled(&options.select, &options.ignore, config.as_ref())?;
    for rule in &mut choice.rules {
        rule.plots = options.sights >= Sights::Plots;
    }
    let setup = Setup {
        options,
        choice,
        definitions: definitions(options)?,
        config,
    };
    let inputs = inputs(options)?;
    let saved: Vec<Saved> = options.evidence.iter().map(|path| evidence::read(path)).collect();
    let is_one = options.verdicts == Verdicts::One;
    let sessions = if is_one { Vec::new() } else { sessions::of(&inputs) };
    let in_saved = |saved: &Saved| sessions::of_worlds(&saved.worlds, &saved.sources).len();
    if sessions.len() + saved.iter().map(in_saved).sum::<usize>() > 1 && !is_one {
        return recordings::check(&setup, &inputs, &sessions, saved, told);
    }
    let mut run = together(&setup, inputs, saved)?;
    run.verdict.sort();
    told(&run, &Grown::all(&run));
    Ok(run)
}

/// What is the same for everything that a run reads and judges.
struct Setup<'o> {
    options: &'o Options,
    config: Option<Config>,
    choice: Choice,
    definitions: Arc<Definitions>,
}

impl Setup<'_> {
    /// A run of these rules that has nothing yet.
    fn run(&self, sources: Vec<Source>, skipped: BTreeMap<String, usize>) -> Run {
        Run {
            sources,
            rules: self
                .choice
                .rules
                .iter()
                .map(|rule| RuleInfo::new(&rule.front, rule.entry.page))
                .collect(),
            skipped,
            fail_on: self.config.as_ref().and_then(Config::fail_on),
            ..Run::default()
        }
    }

    /// What is kept of judged worlds to be looked at, with the sources that they point at.
    fn seen(&self, worlds: &[World]) -> Vec<World> {
        match self.options.sights {
            Sights::Everything => worlds.to_vec(),
            Sights::None | Sights::Plots => Vec::new(),
        }
    }
}

/// One verdict for everything.
fn together(setup: &Setup, inputs: Inputs, saved: Vec<Saved>) -> Result<Run, UsageError> {
    let others = saved.iter().map(|saved| saved.worlds.len()).sum();
    let (mut worlds, verdicts) = settle(
        &inputs,
        setup.options,
        setup.config.as_ref(),
        (&setup.choice, &setup.definitions),
        others,
    );
    let several = worlds.len() + others > 1;
    let mut labels: Vec<String> = worlds.iter().map(|world| world.label.clone()).collect();
    let seen = setup.seen(&worlds);
    let mut run = setup.run(take_sources(&mut worlds), inputs.skipped);
    run.seen = seen;
    run.verdict = merged(verdicts);
    run.worlds = worlds;
    for saved in saved {
        labels.extend(add_saved(setup, saved, several, &mut run));
    }
    if several {
        run.platforms = labels;
    }
    let policy = RunPolicy::new(
        setup.options,
        setup.config.as_ref(),
        &setup.choice.rules,
        &mut run.sources,
    )?;
    let mut laid = policy.lay(&mut run.verdict, &run.sources, &run.platforms);
    let demanded = Demanded {
        rows: &run.verdict.rows,
        beside: &[],
        recording: None,
    };
    policy.demand(&mut laid, &demanded, &run.platforms);
    policy.close(laid, &mut run, &setup.choice.rules);
    Ok(run)
}

/// Judges a document of evidence, and adds it to a run: its sources behind those that are there. Returns the names of its platforms.
fn add_saved(setup: &Setup, saved: Saved, several: bool, run: &mut Run) -> Vec<String> {
    let Saved {
        worlds,
        sources,
        skipped,
    } = furnished(setup, saved);
    let mut verdict = merged(judge_all(&worlds, &setup.choice, several));
    run.seen.extend(setup.seen(&worlds));
    let labels = worlds.into_iter().map(|world| world.label).collect();
    let mut sources = Arc::unwrap_or_clone(sources);
    Renumber::behind(0, run.sources.len()).all(&mut sources, &mut verdict);
    run.sources.extend(sources);
    run.verdict.extend(verdict);
    run.skip(skipped);
    labels
}

/// A document of evidence whose worlds know what the configuration declares.
fn furnished(setup: &Setup, mut saved: Saved) -> Saved {
    if let Some(config) = &setup.config {
        saved.sources = add_config(&mut saved.worlds, saved.sources, config);
    }
    saved
}

/// A choice of rules, ready to judge worlds that are in memory: saved, altered or made.
pub struct Rules(Choice);

impl Rules {
    /// The rules with these codes, names and families; all where there are none.
    pub fn select(select: &[&str]) -> Result<Self, UsageError> {
        let select: Vec<String> = select.iter().map(|word| (*word).to_owned()).collect();
        Ok(Self(plan::enabled(&select, &[], None)?))
    }

    /// The rules that run with these options, with the limits of their configuration.
    pub fn of(options: &Options) -> Result<Self, UsageError> {
        let config = configuration(options)?;
        Ok(Self(plan::enabled(&options.select, &options.ignore, config.as_ref())?))
    }

    /// What the rules say of a world. Nothing is read, and nothing is asked for again.
    pub fn judge(&self, world: &World) -> Verdict {
        let mut verdict = judge::judge(world, &self.0.rules, &self.0.settings, None);
        verdict.sort();
        verdict
    }
}

/// Reads the inputs as far as [`check`] with every rule would, and keeps no judgement.
pub fn collect(options: &Options) -> Result<Run, UsageError> {
    let inputs = inputs(options)?;
    let (mut worlds, _) = settle(&inputs, options, None, (&Choice::all()?, &definitions(options)?), 0);
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
    (choice, definitions): (&Choice, &Arc<Definitions>),
    others: usize,
) -> (Vec<World>, Vec<Verdict>) {
    let mut plan = sampling::Plan::new(options.extent, &choice.rules);
    loop {
        let worlds = worlds(inputs, options, config, definitions, &plan);
        let verdicts = judge_all(&worlds, choice, worlds.len() + others > 1);
        if !plan.widen(&worlds, &verdicts) {
            return (worlds, verdicts);
        }
    }
}

/// One verdict for each world; subjects say which where there are several.
fn judge_all(worlds: &[World], choice: &Choice, several: bool) -> Vec<Verdict> {
    parallel::map(worlds.iter().collect(), |world| {
        let label = several.then_some(world.label.as_str());
        judge::judge(world, &choice.rules, &choice.settings, label)
    })
}

fn merged(verdicts: Vec<Verdict>) -> Verdict {
    let mut verdict = Verdict::default();
    for part in verdicts {
        verdict.extend(part);
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
    let declared = Declared::new(config, &mut sources);
    let sources = Arc::new(sources);
    for world in worlds {
        world.sources = Arc::clone(&sources);
        declared.tell(world);
    }
    sources
}

/// What a configuration declares of every world.
struct Declared {
    conventions: Arc<Conventions>,
    tables: Arc<Tables>,
    dataset: Option<NamedDataset>,
}

impl Declared {
    /// Adds the configuration to the sources.
    fn new(config: &Config, sources: &mut Vec<Source>) -> Self {
        let id = u32::try_from(sources.len()).ok();
        sources.extend(id.into_iter().flat_map(|id| config.sources(id)));
        Self {
            conventions: Arc::new(config.conventions(id)),
            tables: config.tables(),
            dataset: config.dataset(id),
        }
    }

    fn tell(&self, world: &mut World) {
        world.tables = Arc::clone(&self.tables);
        world.dataset.clone_from(&self.dataset);
        world.declare(Arc::clone(&self.conventions));
    }
}

fn worlds(
    inputs: &Inputs,
    options: &Options,
    config: Option<&Config>,
    definitions: &Arc<Definitions>,
    plan: &sampling::Plan,
) -> Vec<World> {
    let progress = Progress::new(options.progress);
    let reading = Reading {
        inputs,
        options,
        config,
        definitions,
        progress: &progress,
    };
    let every: Vec<usize> = (0..inputs.files.len()).collect();
    let (mut sources, members) = reading.members(&every, inputs.files.len(), plan);
    let platforms = Platforms::of(members, inputs);
    platforms.note(&mut sources);
    let sources = Arc::new(sources);
    let mut worlds = platforms.worlds;
    for world in &mut worlds {
        world.sources = Arc::clone(&sources);
    }
    if let (Some(config), false) = (config, worlds.is_empty()) {
        add_config(&mut worlds, sources, config);
    }
    worlds
}

/// How inputs are read.
struct Reading<'a> {
    inputs: &'a Inputs,
    options: &'a Options,
    config: Option<&'a Config>,
    definitions: &'a Arc<Definitions>,
    progress: &'a Progress,
}

impl Reading<'_> {
    /// Reads these of the inputs; see [`gather::gather`].
    fn members(&self, which: &[usize], emerged_from: usize, plan: &sampling::Plan) -> (Vec<Source>, Vec<Member>) {
        let how = How {
            sampling: plan.sampling(),
            definitions: Arc::clone(self.definitions),
            time_fields: self.config.map(Config::time_fields).unwrap_or_default(),
            ..How::default()
        };
        let tables = self.config.map_or_else(Arc::default, Config::tables);
        let xacro_args = &self.options.xacro_args;
        let readings = gather::gather(
            self.inputs,
            which,
            emerged_from,
            xacro_args,
            &how,
            tables.dialects(),
            self.progress,
        );
        platform::members(readings, self.inputs)
    }
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
