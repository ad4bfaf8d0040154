//! What a rule found: how bad, where, why, and what to do.

use nalgebra::Isometry3;
use serde::{Deserialize, Serialize};

use crate::source::{Confidence, Place};

use super::Measured;
use super::deference::{Deference, Explainer, RuleCode};
use super::waiver::Acceptance;

/// The relation of a contradiction that no known error explains.
pub const UNEXPLAINED: &str = "unexplained";

/// Before the configuration that would make a hint certain, in its help.
const CONFIRM: &str = " The frames were guessed from names. If they are right, confirm them in frames-lint.yaml (the finding is then certain); if not, write the right ones:\n";

/// How bad a finding is.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Severity {
    /// Worth knowing.
    Note,
    /// Probably wrong, or wrong with small effect.
    Warning,
    /// Wrong.
    Error,
}

impl Severity {
    /// The word used in reports.
    pub fn word(self) -> &'static str {
        match self {
            Self::Note => "note",
            Self::Warning => "warning",
            Self::Error => "error",
        }
    }
}

/// Whether a place is what the finding is about, or belongs to its explanation.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum PlaceRole {
    /// What the finding is about.
    Primary,
    /// Part of the explanation.
    Related,
}

/// A place with a label.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
pub struct Label {
    /// Primary or related.
    pub role: PlaceRole,
    /// Where.
    pub place: Place,
    /// A label of a few words; may be empty.
    pub note: String,
}

/// Whether a fix can be applied without review.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Safety {
    /// No program reads the file differently.
    Safe,
    /// The robot's behaviour changes.
    ChangesBehaviour,
}

/// A replacement of a span of a text.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
pub struct Edit {
    /// What is replaced: always a text span.
    pub place: Place,
    /// The new text.
    pub replacement: String,
}

/// A way to fix the fault by editing files.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
pub struct Fix {
    /// What the fix does.
    pub title: String,
    /// How safe it is.
    pub safety: Safety,
    /// The edits, all or none.
    pub edits: Vec<Edit>,
}

/// A fault that a rule found.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Finding {
    /// Code of the rule; set by the engine.
    pub rule: String,
    /// Name of the rule; set by the engine.
    pub name: String,
    /// What was judged.
    pub subject: String,
    /// How bad it is.
    pub severity: Severity,
    /// How sure it is.
    pub confidence: Confidence,
    /// The headline: what is wrong with what, and by how much, in one sentence.
    pub message: String,
    /// Evidence in sentences that is no number of `measured`; may be empty.
    #[serde(default, skip_serializing_if = "String::is_empty")]
    pub detail: String,
    /// What to do.
    pub help: String,
    /// The word of the relation dictionary that explains a difference.
    pub relation: Option<String>,
    /// Places, the primary one first. A finding without a place is a bug.
    pub places: Vec<Label>,
    /// What was measured. A finding without a number is a bug.
    pub measured: Vec<Measured>,
    /// A fix, if one is possible.
    pub fix: Option<Fix>,
    /// Set if the user accepts it: it does not count, but stays in every report.
    #[serde(default)]
    pub waived: Option<Acceptance>,
    /// Rules that explain it better if they find the same: by the subject, topic or part of a file, or by a name.
    #[serde(skip)]
    pub unless: Vec<Deference>,
    /// Findings that may explain it; see [`match_up`](super::deference::match_up).
    #[serde(skip)]
    pub explainers: Vec<Explainer>,
    /// The finding that explains it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub explained_by: Option<Explainer>,
    /// The transform that the rule considers right, if known: for views.
    #[serde(skip)]
    pub prefers: Option<PreferredPose>,
}

/// A transform that a rule considers right.
#[derive(Clone, Debug, PartialEq)]
pub struct PreferredPose {
    /// The target (parent) frame.
    pub target: String,
    /// The source (child) frame.
    pub source: String,
    /// `target_from_source`.
    pub pose: Isometry3<f64>,
}

impl Finding {
    /// The severity for formats without hints: a hint is at most a note.
    pub fn loudness(&self) -> Severity {
        if self.confidence == Confidence::Hint {
            Severity::Note
        } else {
            self.severity
        }
    }

    /// A finding at a primary place. Confidence starts at `Certain`.
    pub fn new(severity: Severity, subject: impl Into<String>, message: impl Into<String>, primary: Place) -> Self {
        Self {
            rule: String::new(),
            name: String::new(),
            subject: subject.into(),
            severity,
            confidence: Confidence::Certain,
            message: message.into(),
            detail: String::new(),
            help: String::new(),
            relation: None,
            places: vec![Label {
                role: PlaceRole::Primary,
                place: primary,
                note: String::new(),
            }],
            measured: Vec::new(),
            fix: None,
            waived: None,
            unless: Vec::new(),
            explainers: Vec::new(),
            explained_by: None,
            prefers: None,
        }
    }

    /// An error at a primary place.
    pub fn error(subject: impl Into<String>, message: impl Into<String>, primary: Place) -> Self {
        Self::new(Severity::Error, subject, message, primary)
    }

    /// A warning at a primary place.
    pub fn warning(subject: impl Into<String>, message: impl Into<String>, primary: Place) -> Self {
        Self::new(Severity::Warning, subject, message, primary)
    }

    /// A note at a primary place.
    pub fn note(subject: impl Into<String>, message: impl Into<String>, primary: Place) -> Self {
        Self::new(Severity::Note, subject, message, primary)
    }

    /// Whether the headline, the detail or a cause that the help lists contains a phrase.
    pub fn says(&self, phrase: &str) -> bool {
        let mut causes = self.help.lines().filter(|line| line.starts_with('('));
        self.text().contains(phrase) || causes.any(|cause| cause.contains(phrase))
    }

    /// Headline and detail, a paragraph each.
    pub fn text(&self) -> String {
        let parts = [self.message.as_str(), self.detail.as_str()];
        parts
            .into_iter()
            .filter(|part| !part.is_empty())
            .collect::<Vec<_>>()
            .join("\n")
    }

    /// Measured with margin, not proven.
    #[must_use]
    pub fn likely(self) -> Self {
        self.confidence(Confidence::Likely)
    }

    /// A heuristic: never fails a run.
    #[must_use]
    pub fn hint(self) -> Self {
        self.confidence(Confidence::Hint)
    }

    /// Its severity in words; `hint` for hints, regardless of the severity of the rule.
    pub fn word(&self) -> &'static str {
        match self.confidence {
            Confidence::Hint => Confidence::Hint.word(),
            Confidence::Certain | Confidence::Likely => self.severity.word(),
        }
    }

    /// With at most this confidence.
    #[must_use]
    pub fn confidence(mut self, ceiling: Confidence) -> Self {
        self.confidence = self.confidence.min(ceiling);
        self
    }

    /// The label of the primary place, a few words.
    #[must_use]
    pub fn label(mut self, note: impl Into<String>) -> Self {
        if let Some(label) = self.places.first_mut() {
            label.note = note.into();
        }
        self
    }

    /// Another place that belongs to the explanation.
    #[must_use]
    pub fn related(mut self, place: Place, note: impl Into<String>) -> Self {
        self.places.push(Label {
            role: PlaceRole::Related,
            place,
            note: note.into(),
        });
        self
    }

    /// Evidence in sentences, after the headline: what was compared, what else would explain it.
    #[must_use]
    pub fn detail(mut self, sentence: impl AsRef<str>) -> Self {
        let space = if self.detail.is_empty() { "" } else { " " };
        self.detail = format!("{}{space}{}", self.detail, sentence.as_ref());
        self
    }

    /// What to do.
    #[must_use]
    pub fn help(mut self, help: impl Into<String>) -> Self {
        self.help = help.into();
        self
    }

    /// Adds to the help the configuration that would make a hint certain.
    #[must_use]
    pub fn confirm_with(mut self, keys: &str) -> Self {
        let end = if self.help.ends_with(['.', ' ']) { "" } else { "." };
        self.help = format!("{}{end}{CONFIRM}{keys}", self.help.trim_end());
        self
    }

    /// The configuration that would make it certain, where one would.
    pub fn confirmed_by(&self) -> Option<&str> {
        Some(self.help.split_once(CONFIRM)?.1)
    }

    /// Measured numbers, one or several.
    #[must_use]
    pub fn measured(mut self, measured: impl IntoIterator<Item = Measured>) -> Self {
        self.measured.extend(measured);
        self
    }

    /// The relation that explains the difference.
    #[must_use]
    pub fn relation(mut self, word: impl Into<String>) -> Self {
        self.relation = Some(word.into());
        self
    }

    /// A rule that explains it better, if it finds the same.
    #[must_use]
    pub fn unless(mut self, rule: RuleCode) -> Self {
        self.unless.push(Deference::Rule(rule));
        self
    }

    /// A rule that explains it better, if it finds the same with the same relation.
    #[must_use]
    pub fn unless_relation(mut self, rule: RuleCode) -> Self {
        self.unless.push(Deference::Relation(rule));
        self
    }

    /// A rule that explains it better, if it finds the same with this relation.
    #[must_use]
    pub fn unless_with(mut self, rule: RuleCode, relation: &'static str) -> Self {
        self.unless.push(Deference::With(rule, relation));
        self
    }

    /// A rule that explains it better, if one of its findings names `about`.
    #[must_use]
    pub fn unless_about(mut self, rule: RuleCode, about: impl Into<String>) -> Self {
        self.unless.push(Deference::About(rule, about.into()));
        self
    }

    /// A finding of the same rule on `subject` has the same cause and is shown for both.
    #[must_use]
    pub fn same_cause_as(mut self, subject: impl Into<String>) -> Self {
        self.unless.push(Deference::CauseOf(subject.into()));
        self
    }

    /// The transform that the rule considers right: `target_from_source`.
    #[must_use]
    pub fn prefers(mut self, target: impl Into<String>, source: impl Into<String>, pose: Isometry3<f64>) -> Self {
        self.prefers = Some(PreferredPose {
            target: target.into(),
            source: source.into(),
            pose,
        });
        self
    }

    /// A fix.
    #[must_use]
    pub fn fix(mut self, title: impl Into<String>, safety: Safety, edits: Vec<Edit>) -> Self {
        self.fix = Some(Fix {
            title: title.into(),
            safety,
            edits,
        });
        self
    }
}
