//! What a rule writes its judgements into.

use std::collections::BTreeMap;

use super::{Finding, Measured, NotEvaluated, Outcome, Plot, SeenPlane};

/// One judgement.
#[derive(Clone, Debug)]
pub struct Judged {
    /// What was judged.
    pub subject: String,
    /// What became of it.
    pub outcome: Outcome,
    /// Why it was not evaluated.
    pub reason: Option<String>,
    /// What was measured.
    pub measured: Vec<Measured>,
}

/// Collects the judgements of one rule.
#[derive(Clone, Debug, Default)]
pub struct Judge {
    /// Judgements in the order they were made.
    pub judged: Vec<Judged>,
    /// Findings in the order they were made.
    pub findings: Vec<Finding>,
    /// Whether nobody will look at plots.
    pub without_plots: bool,
    /// Plots by the subjects that they belong to.
    pub plots: BTreeMap<String, Vec<Plot>>,
    /// Planes by the subjects that they belong to.
    pub planes: BTreeMap<String, Vec<SeenPlane>>,
    /// Where in `judged` a subject that failed stands.
    failed: BTreeMap<String, usize>,
}

/// Subjects of one rule that plots are kept of: a recording may have thousands of topics.
const MAX_PLOTTED: usize = 64;

impl Judge {
    /// The subject was judged and is right; `measured` says by which numbers.
    pub fn pass(&mut self, subject: impl Into<String>, measured: impl IntoIterator<Item = Measured>) {
        self.judged.push(Judged {
            subject: subject.into(),
            outcome: Outcome::Pass,
            reason: None,
            measured: measured.into_iter().collect(),
        });
    }

    /// The subject was judged and is wrong. Several findings may be given for one subject.
    pub fn fail(&mut self, finding: Finding) {
        let known = self.failed.get(&finding.subject).copied();
        if let Some(judged) = known.and_then(|index| self.judged.get_mut(index)) {
            judged.measured.extend(finding.measured.iter().cloned());
        } else {
            self.failed.insert(finding.subject.clone(), self.judged.len());
            self.judged.push(Judged {
                subject: finding.subject.clone(),
                outcome: Outcome::Fail,
                reason: None,
                measured: finding.measured.clone(),
            });
        }
        self.findings.push(finding);
    }

    /// What there is to be seen of a subject, judged before or after. Made only where somebody may look at it.
    pub fn plot(&mut self, subject: &str, plot: impl FnOnce() -> Option<Plot>) {
        let has_room = self.plots.len() < MAX_PLOTTED || self.plots.contains_key(subject);
        if let Some(plot) = (has_room && !self.without_plots).then(plot).flatten() {
            self.plots.entry(subject.to_owned()).or_default().push(plot);
        }
    }

    /// Planes that were seen in the clouds of a subject. Made only where somebody may look at them.
    pub fn planes(&mut self, subject: &str, planes: impl FnOnce() -> Vec<SeenPlane>) {
        if self.planes.len() < MAX_PLOTTED && !self.without_plots {
            self.planes.insert(subject.to_owned(), planes());
        }
    }

    /// The subject could not be judged.
    pub fn not_evaluated(&mut self, subject: impl Into<String>, why: NotEvaluated, reason: impl AsRef<str>) {
        self.judged.push(Judged {
            subject: subject.into(),
            outcome: Outcome::NotEvaluated,
            reason: Some(format!("{}: {}", why.word(), reason.as_ref())),
            measured: Vec::new(),
        });
    }

    /// The rule has no question to this subject.
    pub fn not_applicable(&mut self, subject: impl Into<String>, reason: impl AsRef<str>) {
        self.not_evaluated(subject, NotEvaluated::NotApplicable, reason);
    }

    /// Something that the judgement needs is not at hand.
    pub fn missing(&mut self, subject: impl Into<String>, reason: impl AsRef<str>) {
        self.not_evaluated(subject, NotEvaluated::MissingInput, reason);
    }

    /// What was measured does not suffice.
    pub fn too_little(&mut self, subject: impl Into<String>, reason: impl AsRef<str>) {
        self.not_evaluated(subject, NotEvaluated::TooLittleEvidence, reason);
    }
}
