//! Several recordings in one run: each is judged with everything that belongs to its platform but without the others, and has a
//! verdict of its own, the same as if it had been checked alone. Rules that compare recordings run once more for all together.
//!
//! Owns what is kept of a judged recording, so that a run needs memory for a few of them at a time.

mod compared;
mod evidence;
mod latched;
mod whole;

use std::collections::{BTreeMap, BTreeSet};
use std::sync::{Arc, Mutex, PoisonError};

use crate::assure::Assurance;
use crate::fitness::Fitness;
use crate::policy::AppliedPolicy;
use crate::progress::Progress;
use crate::read::discover::Inputs;
use crate::rules::Kind;
use crate::run::{Recording, Run, RunUpdate};
use crate::source::{Source, SourceId, SourceKind};
use crate::verdict::waiver::plain_subject;
use crate::verdict::{Finding, Outcome, Row, Verdict};
use crate::world::{Facts, World};

use super::evidence::SavedEvidence;
use super::gather::source_id;
use super::sessions::Sessions;
use super::{
    Declarations, IdShift, Member, Platforms, ReadContext, RequirementContext, RunPolicy, Setup, UsageError, fitted,
    judge, parallel, sampling,
};
use latched::LatchedValues;
use whole::RunBuilder;

/// Several recordings, each with its verdict.
pub(super) fn check(
    setup: &Setup,
    inputs: &Inputs,
    sessions: &Sessions,
    saved: Vec<SavedEvidence>,
    listener: &mut dyn FnMut(&Run, &RunUpdate),
) -> Result<Run, UsageError> {
    let progress = Progress::new(setup.options.progress);
    let reading = ReadContext::new(inputs, setup, &progress);
    let drives = &sessions.drives;
    let mut shared = SharedFiles::read(&reading, drives);
    let declared = Declarations::all(&setup.governed, &mut shared.sources);
    let policy = RunPolicy::new(setup.options, &setup.governed, &mut shared.sources)?;
    let alone = std::mem::take(&mut shared.worlds);
    let context = JudgeContext {
        setup,
        reading,
        shared: &shared,
        declared: &declared,
        policy: &policy,
        sessions,
        beside: Mutex::default(),
    };
    let mut whole = RunBuilder::new(setup.run(shared.sources.clone(), inputs.skipped.clone()), listener);
    let recorded: BTreeSet<usize> = drives.iter().flatten().copied().collect();
    let given = (0..shared.sources.len()).filter(|number| !recorded.contains(number));
    whole.notify(given.collect(), 0, 0, None);
    let mut covered = BTreeSet::new();
    let mut left = Vec::new();
    let mut latched = LatchedValues::of(inputs, drives, !shared.members.is_empty());
    // One per core at a time: reading more of them ahead would only fill memory.
    for drives in drives.chunks(rayon::current_num_threads().max(1)) {
        for mut drive in parallel::map(drives.iter().collect(), |drive| context.judge(drive)) {
            covered.extend(drive.covered.iter().copied());
            let files: Vec<SourceId> = drive
                .covered
                .iter()
                .copied()
                .filter(|id| context.is_file(*id))
                .collect();
            left.push(latched.new_of(&files, std::mem::take(&mut drive.left)));
            let renumber = IdShift::behind(shared.sources.len(), whole.run.sources.len());
            whole.add(drive, renumber);
        }
    }
    context.judge_rest(alone, &covered, &mut whole);
    context.judge_across(left, &mut whole);
    for saved in saved {
        evidence::judge(&context, saved, &mut whole);
    }
    Ok(whole.end(&context))
}

/// Everything that is not a recording: read once, and judged with each recording.
struct SharedFiles {
    /// Every input of the run at its index, recordings still unread; then the sources extracted from other files, and the configuration.
    sources: Vec<Arc<Source>>,
    members: Vec<Member>,
    /// The platforms of the files without any recording.
    worlds: Vec<World>,
}

impl SharedFiles {
    fn read(reading: &ReadContext, drives: &[Vec<usize>]) -> Self {
        let inputs = reading.inputs;
        let recordings: BTreeSet<usize> = drives.iter().flatten().copied().collect();
        let files: Vec<usize> = (0..inputs.files.len())
            .filter(|index| !recordings.contains(index))
            .collect();
        // Files are read completely, regardless of how recordings are sampled.
        let plan = sampling::Plan::new(reading.setup.options.extent, &[]);
        let (read, members) = reading.members(&files, inputs.files.len(), &plan);
        let mut sources: Vec<Arc<Source>> = inputs
            .files
            .iter()
            .enumerate()
            .map(|(index, input)| Source::new(source_id(index), input.display.clone(), input.kind).into())
            .collect();
        put(&mut sources, read);
        let alone = Platforms::of(members.clone(), inputs);
        alone.note(&mut sources);
        Self {
            sources,
            members,
            worlds: alone.worlds,
        }
    }
}

/// Puts sources at their indices; new ones at the end.
fn put(sources: &mut Vec<Arc<Source>>, read: impl IntoIterator<Item = Arc<Source>>) {
    for source in read {
        match sources.get_mut(source.id.0 as usize) {
            Some(known) => *known = source,
            None => sources.push(source),
        }
    }
}

/// Context for judging.
struct JudgeContext<'a> {
    setup: &'a Setup<'a>,
    reading: ReadContext<'a>,
    shared: &'a SharedFiles,
    /// By the indices of the configurations.
    declared: &'a [Declarations],
    policy: &'a RunPolicy<'a>,
    sessions: &'a Sessions,
    /// Verdicts of the platforms without the recording, by their sources.
    beside: Mutex<BTreeMap<Vec<SourceId>, Arc<Verdict>>>,
}

/// Recordings of one drive, judged.
struct Drive {
    recording: Recording,
    /// The recordings, and the sources extracted from them.
    sources: Vec<Arc<Source>>,
    worlds: Vec<World>,
    /// See [`Run::seen`].
    seen: Vec<World>,
    verdict: Verdict,
    applied: AppliedPolicy,
    /// The sources judged with it.
    covered: Vec<SourceId>,
    /// What became of known mistakes, by the indices of the configurations.
    assured: Vec<(usize, Assurance)>,
    /// Whether it is fit for the calibrations that were asked for.
    fitness: Vec<Fitness>,
    /// Data to compare with other recordings.
    left: Vec<(usize, Facts)>,
}

impl JudgeContext<'_> {
    /// Whether a source is not a recording, and not extracted from one.
    fn is_file(&self, id: SourceId) -> bool {
        let source = self.shared.sources.get(id.0 as usize);
        source.is_some_and(|source| !source.kind.is_bag())
    }

    fn judge(&self, recordings: &[usize]) -> Drive {
        let mut plan = sampling::Plan::new(self.setup.options.extent, &self.setup.governed.rules());
        loop {
            let (mut own, members) = self.reading.members(recordings, self.shared.sources.len(), &plan);
            let members = self.shared.members.iter().cloned().chain(members);
            let platforms = Platforms::of(members.collect(), self.reading.inputs);
            platforms.note(&mut own);
            self.note(recordings, &mut own);
            let mut sources = self.shared.sources.clone();
            put(&mut sources, own.clone());
            let sources = Arc::new(sources);
            let from = self.shared.sources.len();
            let mut worlds = platforms.worlds;
            self.furnish(&mut worlds, &sources);
            let is_own = |id: &SourceId| recordings.contains(&(id.0 as usize)) || id.0 as usize >= from;
            let (mut worlds, others): (Vec<World>, Vec<World>) =
                worlds.into_iter().partition(|world| world.members.iter().any(is_own));
            let label = name(recordings, &mut worlds, &sources);
            let verdicts = self.setup.judge(&mut worlds, true);
            if !plan.widen(&worlds, &verdicts) {
                let mut drive = self.drive(label, recordings, (worlds, &others), verdicts);
                drive.left = drive.worlds.iter().flat_map(|world| self.compared(world)).collect();
                plan.note(&mut own);
                drive.sources = own;
                return drive;
            }
        }
    }

    /// Notes on recordings which others of the same time are judged separately.
    fn note(&self, recordings: &[usize], sources: &mut [Arc<Source>]) {
        let path = |other: usize| Some(self.shared.sources.get(other)?.path.clone());
        for number in recordings {
            let own = sources.iter_mut().find(|source| source.id == source_id(*number));
            if let Some((own, note)) = own.zip(self.sessions.note(*number, path)) {
                Arc::make_mut(own).notes.push(note);
            }
        }
    }

    /// Gives worlds their sources and the declarations of the configuration.
    fn furnish(&self, worlds: &mut [World], sources: &Arc<Vec<Arc<Source>>>) {
        for world in worlds {
            world.sources = Arc::clone(sources);
            if let Some(declared) = self.declared.get(self.setup.governed.of(world)) {
                declared.add_to(world);
            }
        }
    }

    fn drive(
        &self,
        label: String,
        recordings: &[usize],
        (mut worlds, others): (Vec<World>, &[World]),
        verdicts: Vec<(usize, Verdict)>,
    ) -> Drive {
        let platforms: Vec<String> = worlds.iter().map(|world| world.label.clone()).collect();
        let sources = worlds
            .first()
            .map(|world| Arc::clone(&world.sources))
            .unwrap_or_default();
        let judged = verdicts.iter().map(|(governed, _)| *governed).zip(&worlds);
        let assured = self.setup.assure(judged, self.policy);
        let mut fitness = self.setup.fitness_of_all(self.setup.fitness(&worlds, &verdicts));
        for one in &mut fitness {
            one.platform.clone_from(&label);
        }
        let demanded = RequirementContext {
            beside: &self.beside(others),
            recording: Some(&label),
            assured: &assured,
        };
        let (mut verdict, mut applied) = self.policy.apply(verdicts, (&sources, &platforms), Some(&demanded));
        applied.lack(fitted::unfit(&fitness), Some(&label));
        verdict.sort();
        let covered: Vec<SourceId> = worlds.iter().flat_map(|world| world.members.iter().copied()).collect();
        let read = covered.iter().filter_map(|id| sources.get(id.0 as usize));
        let ids = recordings.iter().map(|index| source_id(*index)).collect();
        let recording = self.recording((label, ids), read, &mut verdict, &applied);
        let seen = self.setup.seen(&worlds);
        for world in &mut worlds {
            world.sources = Arc::default();
        }
        Drive {
            recording,
            sources: Vec::new(),
            worlds,
            seen,
            verdict,
            applied,
            covered,
            assured,
            fitness,
            left: Vec::new(),
        }
    }

    /// The result of a run of these sources alone, with this verdict.
    fn recording<'s>(
        &self,
        (label, sources): (String, Vec<SourceId>),
        read: impl Iterator<Item = &'s Arc<Source>>,
        verdict: &mut Verdict,
        applied: &AppliedPolicy,
    ) -> Recording {
        let light = |source: &Arc<Source>| Source {
            status: source.status,
            detail: source.detail.clone(),
            required: source.required,
            ..Source::new(source.id, source.path.clone(), source.kind)
        };
        let run = Run {
            sources: read.map(light).map(Arc::new).collect(),
            verdict: std::mem::take(verdict),
            unmet: applied.unmet().to_vec(),
            ..Run::default()
        };
        let configured = self.setup.governed.fail_on();
        let fail_on = self.setup.options.fail_on.or(configured).unwrap_or_default();
        let recording = Recording {
            label,
            sources,
            summary: run.summary(fail_on),
            code: run.exit_code(fail_on),
            because: run.because(fail_on),
            reasons: run.reasons(),
        };
        *verdict = run.verdict;
        recording
    }

    /// Outcomes of platforms beside a recording, if a requirement may be met there.
    fn beside(&self, others: &[World]) -> Vec<Row> {
        if others.is_empty() || !self.policy.demands() {
            return Vec::new();
        }
        let known = |members: &[SourceId]| {
            let beside = self.beside.lock().unwrap_or_else(PoisonError::into_inner);
            beside.get(members).cloned()
        };
        let judged = parallel::map(others.iter().collect(), |world| {
            known(&world.members).unwrap_or_else(|| {
                let (_, verdict) = self.setup.judge_as(self.setup.governed.of(world), world, true);
                let verdict = Arc::new(verdict);
                let mut beside = self.beside.lock().unwrap_or_else(PoisonError::into_inner);
                beside.insert(world.members.clone(), Arc::clone(&verdict));
                verdict
            })
        });
        judged.iter().flat_map(|verdict| verdict.rows.iter().cloned()).collect()
    }

    /// Files that do not belong to the platform of any recording.
    fn judge_rest(&self, mut worlds: Vec<World>, covered: &BTreeSet<SourceId>, whole: &mut RunBuilder) {
        let is_left = |id: &SourceId| !covered.contains(id);
        worlds.retain(|world| world.members.iter().any(is_left));
        if worlds.is_empty() {
            return;
        }
        let sources = Arc::new(self.shared.sources.clone());
        self.furnish(&mut worlds, &sources);
        let verdicts = self.setup.judge(&mut worlds, true);
        whole.run.seen.extend(self.setup.seen(&worlds));
        let judged = verdicts.iter().map(|(governed, _)| *governed).zip(&worlds);
        let assured = self.setup.assure(judged, self.policy).into_iter();
        whole.run.assure(assured.map(|(_, assurance)| assurance));
        let labels: Vec<String> = worlds.iter().map(|world| world.label.clone()).collect();
        whole.apply_policy(verdicts, &labels, self.policy);
    }

    /// Runs the rules that compare the recordings of a platform; omits what was already reported for one of them.
    fn judge_across(&self, left: Vec<Vec<(usize, Facts)>>, whole: &mut RunBuilder) {
        let drives: Vec<Vec<usize>> = left
            .iter()
            .map(|left| left.iter().map(|(recording, _)| *recording).collect())
            .collect();
        let mut members = self.shared.members.clone();
        for (recording, facts) in left.into_iter().flatten() {
            let input = self.reading.inputs.files.get(recording);
            let read = input.zip(whole.run.sources.get(recording));
            members.extend(read.map(|(input, source)| Member::new(source, facts, input)));
        }
        let mut worlds = Platforms::of(members, self.reading.inputs).worlds;
        let sources = Arc::new(std::mem::take(&mut whole.run.sources));
        self.furnish(&mut worlds, &sources);
        let compared = self.compare(&worlds, &drives, whole, |world| self.setup.governed.of(world));
        drop(worlds);
        whole.run.sources = Arc::unwrap_or_clone(sources);
        let (verdicts, labels) = compared;
        whole.apply_policy(verdicts, &labels, self.policy);
    }

    /// Verdicts of the rules that compare recordings on platforms with several drives, with the indices of their configurations and their names.
    fn compare(
        &self,
        worlds: &[World],
        drives: &[Vec<usize>],
        whole: &RunBuilder,
        governed: impl Fn(&World) -> usize,
    ) -> (Vec<(usize, Verdict)>, Vec<String>) {
        let drive_of: BTreeMap<usize, usize> = (0..)
            .zip(drives)
            .flat_map(|(drive, recordings)| recordings.iter().map(move |recording| (*recording, drive)))
            .collect();
        let are_several = |ids: &mut dyn Iterator<Item = SourceId>| {
            let drives: BTreeSet<&usize> = ids.filter_map(|id| drive_of.get(&(id.0 as usize))).collect();
            drives.len() > 1
        };
        let worlds: Vec<(usize, &World)> = worlds
            .iter()
            .filter(|world| are_several(&mut world.members.iter().copied()))
            .map(|world| (governed(world), world))
            .collect();
        let labels: Vec<String> = worlds.iter().map(|(_, world)| world.label.clone()).collect();
        let mut verdicts = parallel::map(worlds, |(governed, world)| {
            let choice = &self.setup.governed.at(governed).choice;
            let rules = choice
                .rules
                .iter()
                .filter(|rule| matches!(rule.entry.kind, Kind::Across(_)));
            let timings = &self.setup.options.timings;
            let verdict = judge::judge(world, rules, &choice.settings, Some(&world.label), timings);
            (governed, verdict)
        });
        let before = &whole.run;
        let key = |row: &Row, platforms: &[String]| {
            let subject = plain_subject(&row.subject, platforms);
            (row.rule.clone(), subject.to_owned())
        };
        let known: BTreeSet<_> = before
            .verdict
            .rows
            .iter()
            .map(|row| key(row, &before.platforms))
            .collect();
        let compares = |finding: &Finding| are_several(&mut finding.places.iter().map(|label| label.place.source));
        for (_, verdict) in &mut verdicts {
            verdict.findings.retain(compares);
            verdict.explained.retain(compares);
            let found: BTreeSet<(&str, &str)> = verdict
                .findings
                .iter()
                .chain(&verdict.explained)
                .map(|finding| (finding.rule.as_str(), finding.subject.as_str()))
                .collect();
            verdict.rows.retain(|row| match row.outcome {
                Outcome::Fail | Outcome::Explained => found.contains(&(&*row.rule, row.subject.as_str())),
                _ => !known.contains(&key(row, &labels)),
            });
        }
        (verdicts, labels)
    }
}

/// Names worlds after their recordings; returns the name of all of them.
fn name(recordings: &[usize], worlds: &mut [World], sources: &[Arc<Source>]) -> String {
    let path = |id: usize| {
        let source = sources.get(id)?;
        // A rosbag2 is its folder.
        let is_folder = source.kind == SourceKind::Rosbag2;
        let folder = source.path.strip_suffix("/metadata.yaml").filter(|_| is_folder);
        Some(folder.unwrap_or(&source.path))
    };
    let are_several = worlds.len() > 1;
    for world in worlds {
        let own = world.members.iter().map(|id| id.0 as usize);
        let names: Vec<&str> = own.filter(|id| recordings.contains(id)).filter_map(path).collect();
        let name = names.join(" + ");
        world.label = match &world.label {
            platform if are_several => format!("{name} with {platform}"),
            _ => name,
        };
    }
    let names: Vec<&str> = recordings.iter().filter_map(|id| path(*id)).collect();
    names.join(" + ")
}
