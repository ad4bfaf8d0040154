//! The engine: plan, read, judge. Connects the other modules; knows no format and no rule by name.

mod assured;
mod cloud;
mod contract;
mod enabled;
pub mod evidence;
mod fitted;
mod gather;
mod governed;
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
mod timings;

use std::collections::BTreeMap;
use std::path::PathBuf;
use std::sync::Arc;

use crate::assure::RuleRunner;
use crate::collect::CollectOptions;
use crate::config::Config;
use crate::progress::Progress;
use crate::read::allowed::AllowedFolders;
use crate::read::discover::{Inputs, discover_of};
use crate::read::messages::definition::Definitions;
use crate::run::{Run, RunUpdate};
use crate::source::Source;
use crate::tables::Tables;
use crate::verdict::Verdict;
use crate::world::{Conventions, NamedDataset, World};

use evidence::SavedEvidence;
use governed::Configurations;
use plan::Choice;
use platform::{Member, Platforms};
use policy::{RequirementContext, RunPolicy};
use renumber::IdShift;
use sessions::Sessions;
use timings::Phase;

pub use crate::read::discover::FileSelection;
pub use crate::read::xacro::own::expand as expand_xacro;
pub use crate::read::xacro::{ExpandOptions as XacroOptions, VERB as EXPAND_XACRO};
pub use cloud::cloud;
pub use contract::contract;
pub use governed::settings_of;
pub use hash::hash;
pub use options::{Options, Retention, UsageError, VerdictScope};
pub use plan::{nearest, unknown_mistake};
pub use policy::write_baseline;
pub use sampling::Extent;
pub use timings::Timings;

/// Reads the inputs, judges them, and applies what the user accepts and requires. Each of several recordings has its own verdict.
pub fn check(options: &Options) -> Result<Run, UsageError> {
    check_each(options, &mut |_, _| {})
}

/// Like [`check`], and reports results as soon as they are known, recording by recording. Every source, outcome and finding is reported
/// once.
pub fn check_each(options: &Options, listener: &mut dyn FnMut(&Run, &RunUpdate)) -> Result<Run, UsageError> {
    let inputs = inputs(options)?;
    let setup = Setup::new(options, &inputs)?;
    check_with(&setup, inputs, listener)
}

fn check_with(setup: &Setup, inputs: Inputs, listener: &mut dyn FnMut(&Run, &RunUpdate)) -> Result<Run, UsageError> {
    let options = setup.options;
    let files = setup.governed.files();
    let refused = options
        .outputs
        .refused(std::iter::empty(), files.iter().map(PathBuf::as_path));
    if let Some(why) = refused {
        return Err(UsageError(why));
    }
    let mut saved: Vec<(usize, &PathBuf)> = (0..).zip(&options.evidence).collect();
    saved.sort_by_key(|(_, path)| *path);
    let saved = saved.into_iter();
    let saved: Vec<SavedEvidence> = saved
        .map(|(number, path)| SavedEvidence {
            governed: setup.governed.of_document(number),
            ..evidence::read(path)
        })
        .collect();
    let is_one = options.verdicts == VerdictScope::One;
    let sessions = if is_one {
        Sessions::default()
    } else {
        sessions::of(&inputs)
    };
    let in_saved = |saved: &SavedEvidence| sessions::of_worlds(&saved.worlds, &saved.sources).drives.len();
    if sessions.drives.len() + saved.iter().map(in_saved).sum::<usize>() > 1 && !is_one {
        let mut run = recordings::check(setup, &inputs, &sessions, saved, listener)?;
        setup.governed.note_idle(options, &mut run.sources);
        return Ok(run);
    }
    let mut run = together(setup, inputs, saved)?;
    setup.governed.note_idle(options, &mut run.sources);
    run.verdict.sort();
    listener(&run, &RunUpdate::all(&run));
    Ok(run)
}

/// Context that is the same for everything that a run reads and judges.
struct Setup<'o> {
    options: &'o Options,
    governed: Configurations,
    definitions: Arc<Definitions>,
}

impl<'o> Setup<'o> {
    fn new(options: &'o Options, inputs: &Inputs) -> Result<Self, UsageError> {
        let configure = || Configurations::new(options, inputs);
        Ok(Self {
            options,
            definitions: options.definitions()?,
            governed: options.timings.of(Phase::Configure, "", configure)?,
        })
    }
}

impl Setup<'_> {
    /// An empty run of these rules.
    fn run(&self, sources: Vec<Arc<Source>>, skipped: BTreeMap<String, usize>) -> Run {
        let rules = self.governed.rules().into_iter();
        Run {
            sources,
            rules: rules.map(|rule| rule.entry.page).collect(),
            skipped,
            fail_on: self.governed.fail_on(),
            kept: self.options.outcomes,
            ..Run::default()
        }
    }

    /// What is kept of judged worlds for views, with the sources that they point at.
    fn seen(&self, worlds: &[World]) -> Vec<World> {
        match self.options.sights {
            Retention::Everything => worlds.to_vec(),
            Retention::None | Retention::Worlds | Retention::Plots => Vec::new(),
        }
    }

    /// One verdict for each world, with the index of its configuration; if there are several, subjects begin with the world's name.
    fn judge(&self, worlds: &mut [World], several: bool) -> Vec<(usize, Verdict)> {
        parallel::map(worlds.iter_mut().collect(), |world: &mut World| {
            let judged = self.judge_as(self.governed.of(world), world, several);
            // More may be read of a recording, and it is compared with others.
            let is_done = self.options.sights == Retention::None && world.bags.is_empty();
            if is_done && !self.governed.at(self.governed.of(world)).assures(self.options) {
                world.empty();
            } else {
                world.forget();
            }
            judged
        })
    }

    fn judge_as(&self, governed: usize, world: &World, several: bool) -> (usize, Verdict) {
        let label = several.then_some(world.label.as_str());
        let choice = &self.governed.at(governed).choice;
        (
            governed,
            judge::judge(world, &choice.rules, &choice.settings, label, &self.options.timings),
        )
    }
}

/// One verdict for everything.
fn together(setup: &Setup, inputs: Inputs, saved: Vec<SavedEvidence>) -> Result<Run, UsageError> {
    let others = saved.iter().map(|saved| saved.worlds.len()).sum();
    let (worlds, mut verdicts, plan) = settle(&inputs, setup, others);
    let several = worlds.len() + others > 1;
    let mut labels: Vec<String> = worlds.iter().map(|world| world.label.clone()).collect();
    let seen = setup.seen(&worlds);
    let fitness = setup.fitness(&worlds, &verdicts);
    let sources = worlds.first().map(|world| world.sources.to_vec()).unwrap_or_default();
    let mut run = setup.run(sources, inputs.skipped);
    plan.note(&mut run.sources);
    run.seen = seen;
    run.fitness = fitness;
    let (own, governed) = (worlds.len(), verdicts.iter().map(|(governed, _)| *governed));
    let mut worlds: Vec<(usize, World)> = governed.zip(worlds).collect();
    for saved in saved {
        verdicts.extend(add_saved(setup, saved, several, (&mut run, &mut labels, &mut worlds)));
    }
    if several {
        run.platforms = labels;
    }
    let policy = RunPolicy::new(setup.options, &setup.governed, &mut run.sources)?;
    let assured = setup.assure(worlds.iter().map(|(governed, world)| (*governed, world)), &policy);
    worlds.truncate(own);
    run.worlds = worlds.into_iter().map(|(_, world)| world).collect();
    run.worlds.iter_mut().for_each(|world| world.sources = Arc::default());
    let (verdict, mut applied) = policy.apply(
        verdicts,
        (&run.sources, &run.platforms),
        Some(&RequirementContext {
            assured: &assured,
            ..RequirementContext::default()
        }),
    );
    run.verdict = verdict;
    run.assure(assured.into_iter().map(|(_, assurance)| assurance));
    run.fitness = setup.fitness_of_all(std::mem::take(&mut run.fitness));
    if !several {
        run.fitness.iter_mut().for_each(|one| one.platform.clear());
    }
    applied.lack(fitted::unfit(&run.fitness), None);
    policy.close(applied, &mut run);
    if run.kept.drops_inapplicable() {
        run.verdict.drop_rows(|row| !row.applies());
    }
    Ok(run)
}

/// Judges an evidence document, and adds it to a run, its sources after the existing ones.
fn add_saved(
    setup: &Setup,
    saved: SavedEvidence,
    several: bool,
    (run, labels, kept): (&mut Run, &mut Vec<String>, &mut Vec<(usize, World)>),
) -> Vec<(usize, Verdict)> {
    let SavedEvidence {
        worlds,
        sources,
        skipped,
        governed,
    } = furnished(setup, saved);
    let mut verdicts: Vec<_> = worlds
        .iter()
        .map(|world| setup.judge_as(governed, world, several))
        .collect();
    run.seen.extend(setup.seen(&worlds));
    run.fitness.extend(setup.fitness(&worlds, &verdicts));
    labels.extend(worlds.iter().map(|world| world.label.clone()));
    if setup.governed.at(governed).assures(setup.options) {
        kept.extend(worlds.into_iter().map(|world| (governed, world)));
    }
    let mut sources = Arc::unwrap_or_clone(sources);
    let renumber = IdShift::behind(0, run.sources.len());
    renumber.all(&mut sources, &mut Verdict::default());
    for (_, verdict) in &mut verdicts {
        renumber.all(&mut [], verdict);
    }
    run.sources.extend(sources);
    run.skip(skipped);
    verdicts
}

/// An evidence document whose worlds have the declarations of the configuration.
fn furnished(setup: &Setup, mut saved: SavedEvidence) -> SavedEvidence {
    let governed = saved.governed;
    saved.sources = declare(&mut saved.worlds, saved.sources, &setup.governed, |_| governed);
    saved
}

/// A choice of rules, ready to judge worlds that are in memory: saved, altered or made.
pub struct Rules(Choice);

impl Rules {
    /// The rules with these codes, names and families; all if none are given.
    pub fn select(select: &[&str]) -> Result<Self, UsageError> {
        let select: Vec<String> = select.iter().map(|word| (*word).to_owned()).collect();
        Ok(Self(plan::enabled(&select, &[], None)?))
    }

    /// The rules that run with these options, with the limits of their configuration.
    pub fn of(options: &Options) -> Result<Self, UsageError> {
        Ok(Self(
            Configurations::new(options, &Inputs::default())?.into_outer().choice,
        ))
    }

    /// Judges a world. Nothing is read.
    pub fn judge(&self, world: &World) -> Verdict {
        let mut verdict = self.0.judge(world, &|_| true);
        verdict.sort();
        verdict
    }
}

/// Reads the inputs as far as [`check`] with every rule would, and keeps no results.
pub fn collect(options: &Options) -> Result<Run, UsageError> {
    let inputs = inputs(options)?;
    let all = Options {
        without_config: true,
        profile: None,
        select: Vec::new(),
        ignore: Vec::new(),
        ..options.clone()
    };
    let setup = Setup::new(&all, &inputs)?;
    let (mut worlds, _, plan) = settle(&inputs, &setup, 0);
    let mut sources = take_sources(&mut worlds);
    plan.note(&mut sources);
    Ok(Run {
        sources,
        worlds,
        skipped: inputs.skipped,
        ..Run::default()
    })
}

/// Reads and judges until no rule lacks evidence that the recordings still contain. `others` worlds are judged together with these.
fn settle(inputs: &Inputs, setup: &Setup, others: usize) -> (Vec<World>, Vec<(usize, Verdict)>, sampling::Plan) {
    let mut plan = sampling::Plan::new(setup.options.extent, &setup.governed.rules());
    let progress = Progress::new(setup.options.progress);
    let reading = ReadContext::new(inputs, setup, &progress);
    loop {
        let mut worlds = reading.worlds(&plan);
        let several = worlds.len() + others > 1;
        let verdicts = setup.judge(&mut worlds, several);
        if !plan.widen(&worlds, &verdicts) {
            return (worlds, verdicts, plan);
        }
    }
}

/// Reads the inputs, without judging.
pub fn read(options: &Options) -> Result<Run, UsageError> {
    let inputs = inputs(options)?;
    let setup = Setup::new(options, &inputs)?;
    let progress = Progress::new(options.progress);
    let worlds = ReadContext::new(&inputs, &setup, &progress).worlds(&sampling::Plan::new(options.extent, &[]));
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
    let find = || discover_of(&options.paths, options.wanted);
    let mut inputs = options.timings.of(Phase::Find, "", find);
    let files = inputs.files.iter();
    let found = files.flat_map(|input| std::iter::once(&input.path).chain(&input.parts));
    let baseline = options.baseline.iter().filter(|path| !options.outputs.rewrite(path));
    let given = options.evidence.iter().chain(&options.config).chain(baseline);
    let refused = options
        .outputs
        .refused(found.map(PathBuf::as_path), given.map(PathBuf::as_path));
    if let Some(why) = refused {
        return Err(UsageError(why));
    }
    // Reports of an earlier run are not inputs.
    inputs.files.retain(|input| !options.outputs.contain(&input.path));
    Ok(inputs)
}

/// Gives worlds the declarations of the configurations, and adds these to their sources: after all others, whose ids then do not depend
/// on them.
fn declare(
    worlds: &mut [World],
    sources: Arc<Vec<Arc<Source>>>,
    governed: &Configurations,
    of: impl Fn(&World) -> usize,
) -> Arc<Vec<Arc<Source>>> {
    // Released by the worlds, the list can be extended in place.
    for world in worlds.iter_mut() {
        world.sources = Arc::default();
    }
    let mut sources = Arc::unwrap_or_clone(sources);
    let declared = Declarations::all(governed, &mut sources);
    let sources = Arc::new(sources);
    for world in worlds {
        world.sources = Arc::clone(&sources);
        if let Some(declared) = declared.get(of(world)) {
            declared.add_to(world);
        }
    }
    sources
}

/// The declarations of a configuration for the worlds that it governs.
#[derive(Default)]
struct Declarations {
    conventions: Arc<Conventions>,
    tables: Arc<Tables>,
    dataset: Option<NamedDataset>,
}

impl Declarations {
    /// For every configuration, by its index. Their files become sources after the existing ones.
    fn all(governed: &Configurations, sources: &mut Vec<Arc<Source>>) -> Vec<Self> {
        let first = governed.add_sources(sources);
        let declared = |config: &Config| Self {
            conventions: Arc::new(config.conventions(Some(first))),
            tables: config.tables(),
            dataset: config.dataset(Some(first)),
        };
        let each = governed.each();
        each.map(|one| one.config.as_ref().map(declared).unwrap_or_default())
            .collect()
    }

    fn add_to(&self, world: &mut World) {
        world.tables = Arc::clone(&self.tables);
        world.dataset.clone_from(&self.dataset);
        world.declare(Arc::clone(&self.conventions));
    }
}

/// How inputs are read.
struct ReadContext<'a> {
    inputs: &'a Inputs,
    setup: &'a Setup<'a>,
    progress: &'a Progress,
    /// How xacro files are expanded.
    xacro: XacroOptions,
}

impl<'a> ReadContext<'a> {
    fn new(inputs: &'a Inputs, setup: &'a Setup<'a>, progress: &'a Progress) -> Self {
        let options = setup.options;
        Self {
            inputs,
            setup,
            progress,
            xacro: XacroOptions {
                run: options.xacro.run || setup.governed.runs_xacro(options),
                allowed: AllowedFolders::around(options.paths.iter().map(PathBuf::as_path)),
                ..options.xacro.clone()
            },
        }
    }

    /// Reads all of the inputs.
    fn worlds(&self, plan: &sampling::Plan) -> Vec<World> {
        let every: Vec<usize> = (0..self.inputs.files.len()).collect();
        let (mut sources, members) = self.members(&every, every.len(), plan);
        let platforms = Platforms::of(members, self.inputs);
        platforms.note(&mut sources);
        let mut worlds = platforms.worlds;
        if !worlds.is_empty() {
            let governed = &self.setup.governed;
            declare(&mut worlds, Arc::new(sources), governed, |world| governed.of(world));
        }
        worlds
    }

    /// Reads these of the inputs; see [`gather::gather`].
    fn members(&self, which: &[usize], emerged_from: usize, plan: &sampling::Plan) -> (Vec<Arc<Source>>, Vec<Member>) {
        let governed = &self.setup.governed;
        let recordings = CollectOptions {
            sampling: plan.sampling(),
            definitions: Arc::clone(&self.setup.definitions),
            clouds: governed.clouds(self.setup.options),
            ..CollectOptions::default()
        };
        let readings = gather::gather(
            self.inputs,
            which,
            emerged_from,
            gather::ReadOptions {
                xacro: &self.xacro,
                recordings: &recordings,
                tables: &|input| governed.tables(input),
                timings: &self.setup.options.timings,
            },
            self.progress,
        );
        platform::members(readings, self.inputs)
    }
}

/// The sources of all worlds, moved out: texts are large, and a judged world is no longer needed.
fn take_sources(worlds: &mut [World]) -> Vec<Arc<Source>> {
    let shared = worlds
        .first()
        .map(|world| Arc::clone(&world.sources))
        .unwrap_or_default();
    for world in worlds {
        world.sources = Arc::default();
    }
    Arc::try_unwrap(shared).unwrap_or_else(|shared| shared.to_vec())
}
