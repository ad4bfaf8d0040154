//! Which mistakes would these data have shown?
//!
//! Every known mistake is put into every subject that can have it, in a copy of what was read, and the copy is judged with the rules of
//! the run. Nothing altered reaches the run itself. Does not know which rules or mistakes exist, nor how rules are run.

mod base;
mod miss;
mod parts;
mod sizes;
mod trial;

use std::collections::{BTreeMap, BTreeSet};
use std::sync::atomic::{AtomicU64, Ordering};

use rayon::prelude::*;

use crate::faults::{Fault, Selection, SizedFault, Subject};
use crate::progress::Progress;
use crate::verdict::Verdict;
use crate::world::World;

pub use miss::Miss;
pub use sizes::{FoundSize, SmallestError};
use trial::Platform;

/// What became of a mistake.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum TrialOutcome {
    /// No new finding shows it.
    Missed,
    /// A new finding shows it, and does not name it.
    Noticed,
    /// A new finding names it.
    Named,
    /// The data already have the finding that would name it.
    Present,
}

impl TrialOutcome {
    /// The word used in reports.
    pub fn word(self) -> &'static str {
        match self {
            Self::Missed => "missed",
            Self::Noticed => "noticed",
            Self::Named => "named",
            Self::Present => "present",
        }
    }
}

/// Runs the rules that judge a platform.
pub trait RuleRunner: Sync {
    /// Judges a world with those of the rules whose code is wanted.
    fn judge(&self, world: &World, is_wanted: &dyn Fn(&str) -> bool) -> Verdict;
}

/// One mistake, put into one subject.
#[derive(Clone, Debug)]
pub struct Trial {
    /// The mistake.
    pub fault: &'static Fault,
    /// The name of the platform.
    pub platform: String,
    /// The name of the subject.
    pub subject: String,
    /// What became of it.
    pub outcome: TrialOutcome,
    /// The rules with a new finding; the one that names it first.
    pub rules: Vec<String>,
    /// The relation of the first of these findings.
    pub relation: Option<String>,
    /// If it was missed: why, and what would show it.
    pub miss: Option<Miss>,
}

/// The trials of a run.
#[derive(Clone, Debug, Default)]
pub struct Assurance {
    /// One for each mistake and subject, in the order of the platforms, the mistakes and the subjects.
    pub trials: Vec<Trial>,
    /// The smallest errors, in the order of the platforms, the mistakes and the subjects.
    pub smallest: Vec<SmallestError>,
    /// The mistakes that were looked for, in the order of the catalogue.
    pub faults: Vec<&'static Fault>,
    /// Subjects that were not tried, because there are too many, by the names of the mistakes.
    pub omitted: BTreeMap<&'static str, usize>,
    /// Rules that judge nothing without some part of the drive, if that was tried.
    pub unsteady: BTreeSet<String>,
}

impl Assurance {
    /// The number of trials with this outcome.
    pub fn count(&self, outcome: TrialOutcome) -> usize {
        self.trials.iter().filter(|trial| trial.outcome == outcome).count()
    }

    /// The mistakes that nothing in the data can have.
    pub fn inapplicable(&self) -> Vec<&'static Fault> {
        let tried: BTreeSet<&str> = self.trials.iter().map(|trial| trial.fault.name).collect();
        let faults = self.faults.iter().copied();
        faults.filter(|fault| !tried.contains(fault.name)).collect()
    }

    /// Adds the trials of another platform.
    pub fn join(&mut self, other: Self) {
        self.trials.extend(other.trials);
        self.smallest.extend(other.smallest);
        self.unsteady.extend(other.unsteady);
        for fault in other.faults {
            if !self.faults.iter().any(|known| known.name == fault.name) {
                self.faults.push(fault);
            }
        }
        for (name, count) in other.omitted {
            *self.omitted.entry(name).or_default() += count;
        }
    }
}

/// Tries these mistakes on a platform.
pub fn assure(world: &World, rules: &dyn RuleRunner, selection: &Selection, progress: &Progress) -> Assurance {
    let platform = Platform::new(world, rules);
    let mut omitted = BTreeMap::new();
    let mut first_of = |name: &'static str, subjects: Vec<Subject>, most: usize| {
        if subjects.len() > most {
            omitted.insert(name, subjects.len() - most);
        }
        subjects.into_iter().take(most)
    };
    let mut pairs: Vec<(&'static Fault, Subject)> = Vec::new();
    let most = most_subjects(world, selection.faults.len());
    for fault in &selection.faults {
        let subjects = first_of(fault.name, fault.change.subjects(world), most);
        pairs.extend(subjects.map(|subject| (*fault, subject)));
    }
    let mut searches: Vec<(&'static SizedFault, Subject)> = Vec::new();
    let most = most_subjects(world, selection.sizes.len() * sizes::COPIES);
    for fault in &selection.sizes {
        let subjects = first_of(fault.name, fault.subjects(world), most);
        searches.extend(subjects.map(|subject| (*fault, subject)));
    }
    let parts = if selection.is_steady {
        parts::without_parts(world)
    } else {
        Vec::new()
    };
    let shorter: Vec<Platform> = parts.iter().step_by(2).map(|part| Platform::new(part, rules)).collect();
    let task = progress.start(&world.label, (pairs.len() + searches.len()) as u64);
    let done = AtomicU64::new(0);
    let step = || task.update(done.fetch_add(1, Ordering::Relaxed) + 1);
    let tried: Vec<Option<Trial>> = pairs
        .into_par_iter()
        .map(|(fault, subject)| {
            let trial = platform.try_one(fault, &subject)?;
            step();
            Some(held(trial, &subject, &shorter))
        })
        .collect();
    Assurance {
        trials: tried.into_iter().flatten().collect(),
        smallest: sizes::smallest(&platform.base, searches, &step),
        faults: selection.faults.clone(),
        omitted,
        unsteady: shorter
            .iter()
            .flat_map(|other| platform.judges_more_than(other))
            .collect(),
    }
}

/// A trial, missed if it is missed without some part of the drive.
fn held(trial: Trial, subject: &Subject, shorter: &[Platform]) -> Trial {
    if !matches!(trial.outcome, TrialOutcome::Named | TrialOutcome::Noticed) {
        return trial;
    }
    let mut again = shorter
        .iter()
        .filter_map(|platform| platform.try_one(trial.fault, subject));
    let missed = again.find(|other| other.outcome == TrialOutcome::Missed);
    missed.unwrap_or(trial)
}

/// How many subjects each of so many mistakes is tried on. Not a time: results do not depend on the load of the machine.
fn most_subjects(world: &World, faults: usize) -> usize {
    let edges: usize = world.bags.iter().map(|bag| bag.tf.len() + bag.topics.len()).sum();
    let facts = LEAST_FACTS + world.claims.len() + edges;
    (MOST_WORK / facts / faults.max(1)).max(LEAST_SUBJECTS)
}

/// Facts that are judged in all copies of a platform together.
const MOST_WORK: usize = 4_000_000;
/// What judging a small platform costs, in facts.
const LEAST_FACTS: usize = 50;
/// Subjects of each mistake that are always tried.
const LEAST_SUBJECTS: usize = 1;
