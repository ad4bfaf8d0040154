//! The verdict: outcomes, findings, measurements and fixes, as pure data.
//!
//! Does not know how a verdict is shown, or which rules exist.

pub mod deference;
mod finding;
pub mod judge;
mod measured;
pub mod plot;
mod units;
pub mod waiver;

use std::borrow::Cow;
use std::collections::{BTreeMap, BTreeSet};

use nalgebra::Vector3;
use serde::{Deserialize, Serialize};

use crate::source::Confidence;

pub use deference::{Deference, Explainer, RuleCode};
pub use finding::{Edit, Finding, Fix, Label, PlaceRole, PreferredPose, Safety, Severity, UNEXPLAINED};
pub use judge::{Judge, Judged};
pub use measured::{Bound, Measured};
pub use plot::Plot;
pub use units::unit_factor;
pub use waiver::Acceptance;
use waiver::FAMILY;

impl Confidence {
    /// The word used in reports.
    pub fn word(self) -> &'static str {
        match self {
            Self::Hint => "hint",
            Self::Likely => "likely",
            Self::Certain => "certain",
        }
    }
}

/// The outcome of one rule on one subject.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Outcome {
    /// Judged and found right, with a measurement.
    Pass,
    /// Judged and found wrong; there is a finding.
    Fail,
    /// Could not be judged; the reason says why.
    NotEvaluated,
    /// Found wrong, and accepted by the user.
    Waived,
    /// Found wrong, and explained by a finding of another rule.
    Explained,
    /// The rule itself crashed.
    Crashed,
}

impl Outcome {
    /// Whether the rule was evaluated: a waived row was judged before it was accepted.
    pub fn is_judged(self) -> bool {
        matches!(self, Self::Pass | Self::Fail | Self::Waived | Self::Explained)
    }

    /// The word used in reports.
    pub fn word(self) -> &'static str {
        match self {
            Self::Pass => "pass",
            Self::Fail => "fail",
            Self::NotEvaluated => "not-evaluated",
            Self::Waived => "waived",
            Self::Explained => "explained",
            Self::Crashed => "crashed",
        }
    }
}

/// Why a rule could not judge a subject.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum NotEvaluated {
    /// There is nothing of the kind that the rule checks.
    NotApplicable,
    /// An input that the rule needs is missing.
    MissingInput,
    /// The data are there, but do not suffice to decide.
    TooLittleEvidence,
    /// The input is there, but broken.
    InputBroken,
}

impl NotEvaluated {
    /// The words with which the reason begins.
    pub fn word(self) -> &'static str {
        match self {
            Self::NotApplicable => "not applicable",
            Self::MissingInput => "missing input",
            Self::TooLittleEvidence => "too little evidence",
            Self::InputBroken => "input broken",
        }
    }
}

/// One rule on one subject.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Row {
    /// Code of the rule.
    pub rule: Cow<'static, str>,
    /// Name of the rule.
    pub name: Cow<'static, str>,
    /// What was judged.
    pub subject: String,
    /// The outcome.
    pub outcome: Outcome,
    /// Why it was not evaluated, or how the rule crashed.
    pub reason: Option<String>,
    /// What was measured.
    pub measured: Vec<Measured>,
    /// Plots for people.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub plots: Vec<Plot>,
    /// Planes found in clouds, for views.
    #[serde(skip)]
    pub planes: Vec<SeenPlane>,
}

impl Row {
    /// Why it was not evaluated.
    pub fn why_not(&self) -> Option<NotEvaluated> {
        let reason = self
            .reason
            .as_deref()
            .filter(|_| self.outcome == Outcome::NotEvaluated)?;
        let kinds = [
            NotEvaluated::NotApplicable,
            NotEvaluated::MissingInput,
            NotEvaluated::TooLittleEvidence,
            NotEvaluated::InputBroken,
        ];
        kinds.into_iter().find(|kind| reason.starts_with(kind.word()))
    }

    /// Whether the rule applies.
    pub fn applies(&self) -> bool {
        self.why_not() != Some(NotEvaluated::NotApplicable)
    }
}

/// How many of these rows were judged, and how many apply.
pub fn judged_of_applicable<'r>(rows: impl IntoIterator<Item = &'r Row>) -> (usize, usize) {
    rows.into_iter().fold((0, 0), |(judged, applicable), row| {
        (
            judged + usize::from(row.outcome.is_judged()),
            applicable + usize::from(row.applies()),
        )
    })
}

/// A plane that a rule found in a cloud: the points p with `normal . p = offset_m`, in the axes of the cloud.
#[derive(Clone, Debug, PartialEq)]
pub struct SeenPlane {
    /// The topic of the cloud.
    pub topic: String,
    /// When the cloud was logged, nanoseconds.
    pub log_ns: i64,
    /// Normalised, pointing up.
    pub normal: Vector3<f64>,
    /// Metres.
    pub offset_m: f64,
}

/// All outcomes and findings of a run.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Verdict {
    /// Outcomes, sorted by rule and subject.
    pub rows: Vec<Row>,
    /// Findings, sorted by severity, rule and place.
    pub findings: Vec<Finding>,
    /// Findings that are explained by others of these, sorted in the same way.
    #[serde(default)]
    pub explained: Vec<Finding>,
    /// Counts of the outcomes and findings that are not kept.
    #[serde(skip)]
    pub dropped: Tally,
}

/// Counts of outcomes and findings.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Tally {
    by_outcome: BTreeMap<Outcome, usize>,
    /// Of those not evaluated, the ones that do not apply.
    inapplicable: usize,
    /// Of those judged, the ones about the robot, not about what the user accepts.
    of_robot: usize,
    /// Findings that are not accepted, by severity, and whether they are hints.
    findings: BTreeMap<(Severity, bool), usize>,
}

impl Tally {
    fn add(&mut self, row: &Row) {
        *self.by_outcome.entry(row.outcome).or_default() += 1;
        self.inapplicable += usize::from(!row.applies());
        self.of_robot += usize::from(row.outcome.is_judged() && !row.rule.starts_with(FAMILY));
    }

    fn join(&mut self, other: &Self) {
        for (outcome, count) in &other.by_outcome {
            *self.by_outcome.entry(*outcome).or_default() += count;
        }
        self.inapplicable += other.inapplicable;
        self.of_robot += other.of_robot;
        for (kind, count) in &other.findings {
            *self.findings.entry(*kind).or_default() += count;
        }
    }

    /// How many outcomes do not apply.
    pub fn not_applicable_count(&self) -> usize {
        self.inapplicable
    }

    fn of(&self, is_one: impl Fn(Outcome) -> bool) -> usize {
        let ones = self.by_outcome.iter().filter(|(outcome, _)| is_one(**outcome));
        ones.map(|(_, count)| count).sum()
    }
}

/// Which outcomes are kept. Those that do not apply are more than all others.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum KeptOutcomes {
    /// All, and every report lists them.
    #[default]
    Listed,
    /// All, and reports for people can show them; those for machines count the ones that do not apply.
    Shown,
    /// Those that apply. The others are counted when they are judged.
    Applicable,
    /// Those that apply, until they are written.
    Unreported,
}

impl KeptOutcomes {
    /// Whether outcomes that do not apply are counted when they are judged.
    pub fn drops_inapplicable(self) -> bool {
        matches!(self, Self::Applicable | Self::Unreported)
    }
}

impl Verdict {
    /// Counts outcomes instead of keeping them.
    pub fn drop_rows(&mut self, is_dropped: impl Fn(&Row) -> bool) {
        let dropped = &mut self.dropped;
        self.rows.retain(|row| {
            let drops = is_dropped(row);
            if drops {
                dropped.add(row);
            }
            !drops
        });
    }

    /// Counts findings instead of keeping them, except the first one of each severity that is not a hint: it may decide the verdict.
    pub fn drop_findings(&mut self) {
        let dropped = &mut self.dropped;
        let mut known = BTreeSet::new();
        self.findings.retain(|finding| {
            let is_hint = finding.confidence == Confidence::Hint;
            let stays = finding.waived.is_some() || !is_hint && known.insert(finding.severity);
            if !stays {
                *dropped.findings.entry((finding.severity, is_hint)).or_default() += 1;
            }
            stays
        });
        self.explained.clear();
    }

    /// How many outcomes do not apply.
    pub fn not_applicable_count(&self) -> usize {
        self.dropped.inapplicable + self.rows.iter().filter(|row| !row.applies()).count()
    }

    /// How many outcomes were judged, and how many apply.
    pub fn judged_of_applicable(&self) -> (usize, usize) {
        let (judged, applicable) = judged_of_applicable(&self.rows);
        let dropped = &self.dropped;
        (
            judged + dropped.of(Outcome::is_judged),
            applicable + dropped.of(|_| true) - dropped.inapplicable,
        )
    }

    /// Whether any rule was evaluated on the inputs. A waived row was judged before it was accepted; rules about waivers do not count.
    pub fn judges_anything(&self) -> bool {
        let of_robot = |row: &Row| row.outcome.is_judged() && !row.rule.starts_with(FAMILY);
        self.dropped.of_robot > 0 || self.rows.iter().any(of_robot)
    }

    /// Whether there was any outcome.
    pub fn has_rows(&self) -> bool {
        !self.rows.is_empty() || self.dropped.of(|_| true) > 0
    }

    /// Sorts rows and findings: rows by rule and subject, findings by severity (worst first), then
    /// rule, subject, place and message.
    pub fn sort(&mut self) {
        // In two steps: of each rule the subjects are nearly in order, for platforms are judged in the order of their paths.
        self.rows.sort_by(|a, b| a.rule.cmp(&b.rule));
        for of_rule in self.rows.chunk_by_mut(|a, b| a.rule == b.rule) {
            of_rule.sort_by(|a, b| (&a.subject, a.outcome).cmp(&(&b.subject, b.outcome)));
        }
        let order = |a: &Finding, b: &Finding| {
            let by_weight = (b.severity, b.confidence).cmp(&(a.severity, a.confidence));
            by_weight.then_with(|| {
                (&a.rule, &a.subject, &a.places, &a.message).cmp(&(&b.rule, &b.subject, &b.places, &b.message))
            })
        };
        self.findings.sort_by(order);
        self.explained.sort_by(order);
    }

    /// Adds another verdict.
    pub fn extend(&mut self, other: Self) {
        if self.rows.capacity() == 0 {
            self.rows = other.rows;
        } else {
            self.rows.extend(other.rows);
        }
        self.findings.extend(other.findings);
        self.explained.extend(other.explained);
        self.dropped.join(&other.dropped);
    }

    /// Findings that are accepted.
    pub fn waived(&self) -> impl Iterator<Item = &Finding> {
        self.findings.iter().filter(|finding| finding.waived.is_some())
    }

    /// How many rows have this outcome.
    pub fn count(&self, outcome: Outcome) -> usize {
        self.dropped.of(|dropped| dropped == outcome) + self.rows.iter().filter(|row| row.outcome == outcome).count()
    }

    /// Findings that are not accepted.
    pub fn open(&self) -> impl Iterator<Item = &Finding> {
        self.findings.iter().filter(|finding| finding.waived.is_none())
    }

    /// The number of findings of this severity that are neither accepted nor hints.
    pub fn count_findings(&self, severity: Severity) -> usize {
        let is_one = |finding: &&Finding| finding.severity == severity && finding.confidence > Confidence::Hint;
        let dropped = self.dropped.findings.get(&(severity, false));
        dropped.unwrap_or(&0) + self.open().filter(is_one).count()
    }

    /// The number of hints that are not accepted.
    pub fn count_hints(&self) -> usize {
        let dropped = self.dropped.findings.iter().filter(|((_, is_hint), _)| *is_hint);
        let is_hint = |finding: &&Finding| finding.confidence == Confidence::Hint;
        dropped.map(|(_, count)| count).sum::<usize>() + self.open().filter(is_hint).count()
    }
}
