//! What the configuration requires of a run, and is not met.

use crate::fitness::{Condition, Fitness, FitnessWord};
use crate::verdict::Acceptance;

/// What is required.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum RequirementKind {
    /// That a rule is evaluated.
    Rule,
    /// That a share of the checks is evaluated.
    Share,
    /// That a known mistake would be found.
    Detection,
    /// That a recording is fit for a calibration.
    Fitness,
}

/// A requirement that is not met: a rule that had to be evaluated and was not, too few evaluated checks, a known mistake that would not
/// have been found, or a recording that is not shown to be fit for a calibration.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct UnmetRequirement {
    /// What is required.
    pub kind: RequirementKind,
    /// Code of the rule, the name of the mistake, or the kind of calibration; `share` if a share of the checks is required.
    pub rule: String,
    /// The name of the rule, or the sentence of the mistake.
    pub name: String,
    /// The glob of required subjects; `None`: any subject.
    pub subject: Option<String>,
    /// Why it was not evaluated.
    pub why: Vec<String>,
    /// What to record or to add, so that it can.
    pub record: Option<String>,
    /// Where it is required, in words: `frames-lint.yaml:4`.
    pub origin: String,
    /// The labels of the recordings for which it is required, if each has a verdict of its own.
    pub recordings: Vec<String>,
    /// Set if the user accepts that it was not evaluated.
    pub waived: Option<Acceptance>,
}

/// Maximum number of recordings named with a requirement that is not met.
const MAX_NAMED: usize = 5;

impl UnmetRequirement {
    /// That this is not shown to be fit; `None` if it is.
    pub fn of_fitness(fitness: &Fitness) -> Option<Self> {
        let verdict = fitness.verdict();
        let why = |condition: &Condition| {
            let reason = condition.reason.as_deref().unwrap_or(condition.state.word());
            format!("{}: {}: {reason}", fitness.subject, condition.name)
        };
        let mut record: Vec<&str> = fitness
            .lacking()
            .filter_map(|condition| condition.record.as_deref())
            .collect();
        record.dedup();
        (verdict != FitnessWord::Fit).then(|| Self {
            kind: RequirementKind::Fitness,
            rule: fitness.calibration.word().to_owned(),
            name: format!("calibration: {}", verdict.word()),
            subject: None,
            why: fitness.lacking().map(why).collect(),
            record: (!record.is_empty()).then(|| record.join("; ")),
            origin: "--for".to_owned(),
            recordings: Vec::new(),
            waived: None,
        })
    }

    /// Why it was not evaluated, and in which recordings, if there are several.
    pub fn reasons(&self) -> Vec<String> {
        let mut reasons = self.why.clone();
        let (named, more) = self.recordings.split_at(self.recordings.len().min(MAX_NAMED));
        match (named, more) {
            ([], _) => {}
            (named, []) => reasons.push(format!("in {}", named.join(", "))),
            (named, more) => reasons.push(format!("in {} and {} more", named.join(", "), more.len())),
        }
        reasons
    }

    /// What is wrong, in one line: `TREE01 is required but was not evaluated: ...`.
    pub fn words(&self) -> String {
        let what = match self.kind {
            RequirementKind::Share => "too few checks were evaluated".to_owned(),
            RequirementKind::Rule => format!("{} is required but was not evaluated", self.rule),
            RequirementKind::Detection => format!("the mistake {} would not have been found", self.rule),
            RequirementKind::Fitness => format!("{} {}", self.rule, self.name),
        };
        format!("{what}: {}", self.reason())
    }

    /// Why it is not met, in one line.
    pub fn reason(&self) -> String {
        self.reasons().join("; ")
    }

    /// Whether `other` is the same requirement, possibly for other recordings.
    pub fn is_like(&self, other: &Self) -> bool {
        (&self.rule, &self.subject, &self.why, &self.waived) == (&other.rule, &other.subject, &other.why, &other.waived)
    }
}
