//! The verdict: outcomes, findings, measurements and fixes, as pure data.
//!
//! Must not know how a verdict is shown, nor which rules exist.

pub mod deference;
mod finding;
pub mod judge;
mod measured;
pub mod plot;
pub mod waiver;

use nalgebra::Vector3;
use serde::{Deserialize, Serialize};

use crate::source::Confidence;

pub use deference::{Explainer, RuleCode, Unless};
pub use finding::{Edit, Finding, Fix, Label, PlaceRole, Preferred, Safety, Severity, UNEXPLAINED};
pub use judge::{Judge, Judged};
pub use measured::Measured;
pub use plot::Plot;
pub use waiver::Waived;

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

/// What became of one rule on one subject.
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
    /// Found wrong, and said by a finding of another rule.
    Explained,
    /// The rule itself broke.
    Crashed,
}

impl Outcome {
    /// Whether the rule came to a judgement: a row that is waived was judged before it was accepted.
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
    /// There is nothing of the kind the rule is about.
    NotApplicable,
    /// An input that the rule needs is not there.
    MissingInput,
    /// The data are there, but do not suffice to decide.
    TooLittleEvidence,
    /// The input is there, but broken.
    InputBroken,
}

impl NotEvaluated {
    /// The words that open the reason.
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
    pub rule: String,
    /// Name of the rule.
    pub name: String,
    /// What was judged.
    pub subject: String,
    /// What became of it.
    pub outcome: Outcome,
    /// Why it was not evaluated, or how the rule crashed.
    pub reason: Option<String>,
    /// What was measured.
    pub measured: Vec<Measured>,
    /// What people would rather look at.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub plots: Vec<Plot>,
    /// Planes that were seen in clouds, for those who look at them.
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

    /// Whether there is anything here that its rule is about.
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

/// A plane that a rule saw in a cloud: the points p with `normal . p = offset_m`, in the axes of the cloud.
#[derive(Clone, Debug, PartialEq)]
pub struct SeenPlane {
    /// The topic of the cloud.
    pub topic: String,
    /// When the cloud was logged, nanoseconds.
    pub log_ns: i64,
    /// Of length one, up.
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
    /// Findings that others of these say in their place, sorted alike.
    #[serde(default)]
    pub explained: Vec<Finding>,
    /// Outcomes that do not apply and are not among the rows any more.
    #[serde(skip)]
    pub inapplicable: usize,
}

/// What becomes of outcomes that do not apply. There are more of them than of all others.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Inapplicable {
    /// Every report lists them.
    #[default]
    Listed,
    /// Reports for people can show them; those for machines count them.
    Kept,
    /// They are counted when they are judged, and take no memory.
    Counted,
}

impl Verdict {
    /// Counts the outcomes that do not apply instead of keeping them, but for those of these rules.
    pub fn drop_not_applicable(&mut self, but_of: impl Fn(&str) -> bool) {
        let before = self.rows.len();
        self.rows.retain(|row| row.applies() || but_of(&row.rule));
        self.inapplicable += before - self.rows.len();
    }

    /// How many outcomes do not apply.
    pub fn not_applicable_count(&self) -> usize {
        self.inapplicable + self.rows.iter().filter(|row| !row.applies()).count()
    }

    /// Puts rows and findings into their order: rows by rule and subject, findings by severity (worst first), then
    /// rule, subject, place and message.
    pub fn sort(&mut self) {
        self.rows
            .sort_by(|a, b| (&a.rule, &a.subject, a.outcome).cmp(&(&b.rule, &b.subject, b.outcome)));
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
        self.rows.extend(other.rows);
        self.findings.extend(other.findings);
        self.explained.extend(other.explained);
        self.inapplicable += other.inapplicable;
    }

    /// Findings that somebody has accepted.
    pub fn waived(&self) -> impl Iterator<Item = &Finding> {
        self.findings.iter().filter(|finding| finding.waived.is_some())
    }

    /// How many rows have this outcome.
    pub fn count(&self, outcome: Outcome) -> usize {
        let counted = if outcome == Outcome::NotEvaluated {
            self.inapplicable
        } else {
            0
        };
        counted + self.rows.iter().filter(|row| row.outcome == outcome).count()
    }

    /// Findings that nobody has accepted.
    pub fn open(&self) -> impl Iterator<Item = &Finding> {
        self.findings.iter().filter(|finding| finding.waived.is_none())
    }

    /// How many findings that nobody has accepted, and that are more than hints, have this severity.
    pub fn count_findings(&self, severity: Severity) -> usize {
        let is_one = |finding: &&Finding| finding.severity == severity && finding.confidence > Confidence::Hint;
        self.open().filter(is_one).count()
    }

    /// How many findings that nobody has accepted are hints.
    pub fn count_hints(&self) -> usize {
        self.open()
            .filter(|finding| finding.confidence == Confidence::Hint)
            .count()
    }
}
