//! Which mistakes would these data have shown?
//!
//! Every known mistake is put into every subject that can have it, in a copy of what was read, and the copy is judged with the rules of
//! the run. Nothing altered reaches the run itself. Does not know which rules or mistakes exist, nor how rules are run.

use std::collections::{BTreeMap, BTreeSet};
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Arc, Mutex, PoisonError};

use rayon::prelude::*;

use crate::faults::{Fault, Subject};
use crate::progress::Progress;
use crate::source::Confidence;
use crate::verdict::{Deference, Finding, Measured, Outcome, Row, Verdict};
use crate::world::World;

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
    /// If it was missed: what the rules that should see it say.
    pub reason: Option<String>,
}

/// The trials of a run.
#[derive(Clone, Debug, Default)]
pub struct Assurance {
    /// One for each mistake and subject, in the order of the platforms, the mistakes and the subjects.
    pub trials: Vec<Trial>,
    /// The mistakes that were looked for, in the order of the catalogue.
    pub faults: Vec<&'static Fault>,
    /// Subjects that were not tried, because there are too many, by the names of the mistakes.
    pub omitted: BTreeMap<&'static str, usize>,
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
pub fn assure(world: &World, rules: &dyn RuleRunner, faults: &[&'static Fault], progress: &Progress) -> Assurance {
    let platform = Platform::new(world, rules);
    let mut omitted = BTreeMap::new();
    let mut pairs: Vec<(&'static Fault, Subject)> = Vec::new();
    let most = most_subjects(world, faults.len());
    for fault in faults {
        let subjects = fault.change.subjects(world);
        if subjects.len() > most {
            omitted.insert(fault.name, subjects.len() - most);
        }
        pairs.extend(subjects.into_iter().take(most).map(|subject| (*fault, subject)));
    }
    let task = progress.start(&world.label, pairs.len() as u64);
    let done = AtomicU64::new(0);
    let tried: Vec<Option<Trial>> = pairs
        .into_par_iter()
        .map(|(fault, subject)| {
            let trial = platform.try_one(fault, &subject);
            task.update(done.fetch_add(1, Ordering::Relaxed) + 1);
            trial
        })
        .collect();
    Assurance {
        trials: tried.into_iter().flatten().collect(),
        faults: faults.to_vec(),
        omitted,
    }
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

/// A finding, whatever its numbers.
type Key = (String, String, Option<String>);

fn key(finding: &Finding) -> Key {
    (finding.rule.clone(), finding.subject.clone(), finding.relation.clone())
}

/// A platform, and what is found without a mistake.
struct Platform<'w> {
    world: &'w World,
    rules: &'w dyn RuleRunner,
    healthy: Verdict,
    healthy_keys: Vec<Key>,
    /// What these rules alone find without a mistake.
    healthy_of: Mutex<BTreeMap<Vec<&'static str>, Arc<Vec<Key>>>>,
}

impl<'w> Platform<'w> {
    fn new(world: &'w World, rules: &'w dyn RuleRunner) -> Self {
        let healthy = rules.judge(world, &|_| true);
        Self {
            world,
            rules,
            healthy_keys: healthy.findings.iter().map(key).collect(),
            healthy,
            healthy_of: Mutex::default(),
        }
    }

    /// Puts a mistake into a subject; none if that changes nothing.
    fn try_one(&self, fault: &'static Fault, subject: &Subject) -> Option<Trial> {
        let mut world = self.world.clone();
        if !fault.change.apply(&mut world, subject) {
            return None;
        }
        world.forget();
        let same = fault.change.same_as(self.world, subject);
        let trial = |outcome, findings: &[&Finding], reason| {
            let mut rules: Vec<String> = findings.iter().map(|finding| finding.rule.clone()).collect();
            let mut seen = BTreeSet::new();
            rules.retain(|rule| seen.insert(rule.clone()));
            Trial {
                fault,
                platform: self.world.label.clone(),
                subject: subject.name.clone(),
                outcome,
                rules,
                relation: findings.first().and_then(|finding| finding.relation.clone()),
                reason,
            }
        };
        // The rules that should see it, first: judging with all of them takes longer, and may only hide a finding behind another.
        let first = self.rules.judge(&world, &|code| fault.seers().any(|seer| seer == code));
        let new = new_findings(&self.healthy_of(fault), &first);
        let is_final = |finding: &&&Finding| {
            fault.is_named_by(finding, &same) && finding.unless.iter().all(|deference| is_among(deference, fault))
        };
        if let Some(named) = new.iter().find(is_final) {
            return Some(trial(TrialOutcome::Named, &[*named], None));
        }
        let altered = self.rules.judge(&world, &|_| true);
        let mut new = new_findings(&self.healthy_keys, &altered);
        new.retain(|finding| finding.confidence > Confidence::Hint);
        new.sort_by_key(|finding| !fault.is_named_by(finding, &same));
        if new.first().is_some_and(|finding| fault.is_named_by(finding, &same)) {
            return Some(trial(TrialOutcome::Named, &new, None));
        }
        if !new.is_empty() {
            return Some(trial(TrialOutcome::Noticed, &new, None));
        }
        let findings = self.healthy.findings.iter();
        let is_it = |finding: &&Finding| {
            let is_seer = fault.seers().any(|seer| seer == finding.rule);
            is_seer && subject.is_in(&finding.subject) && fault.is_named_by(finding, &same)
        };
        let present = findings.filter(is_it);
        let present: Vec<&Finding> = present.collect();
        if !present.is_empty() {
            return Some(trial(TrialOutcome::Present, &present, None));
        }
        Some(trial(TrialOutcome::Missed, &[], Some(reason(fault, subject, &altered))))
    }

    /// What the rules that should see a mistake find without it.
    fn healthy_of(&self, fault: &Fault) -> Arc<Vec<Key>> {
        let seers: Vec<&'static str> = fault.seers().collect();
        let mut known = self.healthy_of.lock().unwrap_or_else(PoisonError::into_inner);
        let made = known.entry(seers).or_insert_with(|| {
            let verdict = self
                .rules
                .judge(self.world, &|code| fault.seers().any(|seer| seer == code));
            Arc::new(verdict.findings.iter().map(key).collect())
        });
        Arc::clone(made)
    }
}

/// Whether a finding defers only to rules that should see the mistake.
fn is_among(deference: &Deference, fault: &Fault) -> bool {
    match deference {
        Deference::Rule(code) | Deference::Relation(code) | Deference::About(code, _) => {
            fault.seers().any(|seer| seer == code.as_str())
        }
        Deference::CauseOf(_) => true,
    }
}

/// Findings that are not among those without the mistake.
fn new_findings<'v>(healthy: &[Key], altered: &'v Verdict) -> Vec<&'v Finding> {
    let mut known: BTreeMap<&Key, usize> = BTreeMap::new();
    for key in healthy {
        *known.entry(key).or_default() += 1;
    }
    let is_new = |finding: &&Finding| match known.get_mut(&key(finding)) {
        Some(count) if *count > 0 => {
            *count -= 1;
            false
        }
        _ => true,
    };
    altered.findings.iter().filter(is_new).collect()
}

/// Why a mistake was missed: what the first of the rules that should see it, and that has a row about the subject, says; else what the
/// first of them says about the platform.
fn reason(fault: &Fault, subject: &Subject, altered: &Verdict) -> String {
    let mut rows: Vec<&Row> = altered.rows.iter().filter(|row| fault.is_seen_in(row)).collect();
    let position = |row: &Row| fault.seers().position(|seer| seer == row.rule);
    rows.sort_by_key(|row| (position(row), row.outcome != Outcome::Pass));
    let first = fault.seers().next().unwrap_or_default();
    let is_judged = |row: &&&Row| row.outcome != Outcome::Crashed;
    let of_platform = |row: &&&Row| row.rule == first && row.subject == "platform";
    let mut candidates = rows
        .iter()
        .filter(|row| subject.is_in(&row.subject))
        .chain(rows.iter().filter(of_platform))
        .filter(is_judged);
    match candidates.next() {
        Some(row) if row.outcome == Outcome::Pass => {
            let measured: Vec<String> = row.measured.iter().take(3).map(in_words).collect();
            format!("{} passes {}: {}", row.rule, row.subject, measured.join(", "))
        }
        Some(row) if row.outcome == Outcome::Fail => {
            format!(
                "{} fails {} without the mistake, too: correct that first",
                row.rule, row.subject
            )
        }
        Some(row) if row.subject == "platform" => {
            let reason = row.reason.as_deref().unwrap_or_default();
            format!(
                "{}: {}",
                row.rule,
                reason.strip_prefix("not applicable: ").unwrap_or(reason)
            )
        }
        Some(row) => format!(
            "{} of {}: {}",
            row.rule,
            row.subject,
            row.reason.as_deref().unwrap_or_default()
        ),
        None => format!("{first} judged nothing about it"),
    }
}

fn in_words(measured: &Measured) -> String {
    format!("{} {:.3} {}", measured.what, measured.value, measured.unit)
}
