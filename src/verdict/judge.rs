//! Collects the judgements of a rule.

use std::collections::BTreeMap;

use super::{Finding, Measured, NotEvaluated, Outcome, Plot, SeenPlane};

/// One judgement.
#[derive(Clone, Debug)]
pub struct Judged {
    /// What was judged.
    pub subject: String,
    /// The outcome.
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
    /// Whether plots are not needed.
    pub without_plots: bool,
    /// Plots by the subjects that they belong to.
    pub plots: BTreeMap<String, Vec<Plot>>,
    /// Planes by the subjects that they belong to.
    pub planes: BTreeMap<String, Vec<SeenPlane>>,
    /// The index in `judged` of a subject that failed.
    failed: BTreeMap<String, usize>,
    /// Number of findings that the last one counts and that are not kept.
    unlisted: usize,
}

/// Maximum number of subjects of a rule with plots: a recording may have thousands of topics.
const MAX_PLOTTED: usize = 64;

/// Maximum number of findings kept of one rule on one platform: each takes some kilobytes. Further ones are counted in one more finding.
const MOST_FINDINGS: usize = 5000;

/// Subject of the finding that counts others.
const UNLISTED: &str = "findings that are not listed";

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
        if self.findings.len() >= MOST_FINDINGS {
            self.count(finding);
        } else {
            self.keep(finding);
        }
    }

    /// Counts a finding that is not kept, in one finding after those kept. Its severity and confidence are the highest of those counted.
    fn count(&mut self, mut finding: Finding) {
        self.unlisted += 1;
        if self.unlisted == 1 {
            finding.relation = None;
            finding.fix = None;
            finding.unless.clear();
            finding.explainers.clear();
            finding.prefers = None;
            "fix the listed findings, and check again".clone_into(&mut finding.help);
            finding.places.truncate(1);
            UNLISTED.clone_into(&mut finding.subject);
            self.keep(finding);
        } else if let Some(last) = self.findings.last_mut() {
            let weight = |finding: &Finding| (finding.loudness(), finding.confidence);
            if weight(&finding) > weight(last) {
                (last.severity, last.confidence) = (finding.severity, finding.confidence);
            }
        }
        let measured = vec![Measured::count(UNLISTED, self.unlisted)];
        if let Some(last) = self.findings.last_mut() {
            last.message = format!(
                "{} more findings of this rule are not listed (at most {MOST_FINDINGS} per platform)",
                self.unlisted
            );
            last.measured.clone_from(&measured);
        }
        let row = self.failed.get(UNLISTED).and_then(|row| self.judged.get_mut(*row));
        if let Some(row) = row {
            row.measured = measured;
        }
    }

    fn keep(&mut self, finding: Finding) {
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

    /// A plot of a subject, judged before or after. Made only if plots are needed.
    pub fn plot(&mut self, subject: &str, plot: impl FnOnce() -> Option<Plot>) {
        let has_room = self.plots.len() < MAX_PLOTTED || self.plots.contains_key(subject);
        if let Some(plot) = (has_room && !self.without_plots).then(plot).flatten() {
            self.plots.entry(subject.to_owned()).or_default().push(plot);
        }
    }

    /// Planes found in the clouds of a subject. Made only if plots are needed.
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

    /// The rule does not apply to this subject.
    pub fn not_applicable(&mut self, subject: impl Into<String>, reason: impl AsRef<str>) {
        self.not_evaluated(subject, NotEvaluated::NotApplicable, reason);
    }

    /// An input that the judgement needs is missing.
    pub fn missing(&mut self, subject: impl Into<String>, reason: impl AsRef<str>) {
        self.not_evaluated(subject, NotEvaluated::MissingInput, reason);
    }

    /// The data do not suffice to decide.
    pub fn too_little(&mut self, subject: impl Into<String>, reason: impl AsRef<str>) {
        self.not_evaluated(subject, NotEvaluated::TooLittleEvidence, reason);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::source::{Confidence, Place, SourceId};
    use crate::verdict::Severity;

    #[test]
    fn findings_behind_the_most_that_are_kept_are_counted() {
        let mut judge = Judge::default();
        let place = Place::whole(SourceId(0));
        for number in 0..MOST_FINDINGS + 7 {
            let mut finding = Finding::new(Severity::Warning, format!("link {number}"), "wrong", place.clone());
            finding.confidence = Confidence::Likely;
            if number == MOST_FINDINGS + 3 {
                finding.severity = Severity::Error;
            }
            judge.fail(finding);
        }
        assert_eq!(
            (judge.findings.len(), judge.judged.len()),
            (MOST_FINDINGS + 1, MOST_FINDINGS + 1)
        );
        let last = judge.findings.last().unwrap();
        assert!(
            last.message.starts_with("7 more findings of this rule"),
            "{}",
            last.message
        );
        assert_eq!((last.severity, last.confidence), (Severity::Error, Confidence::Likely));
        // Hints make no finding that is sure.
        judge.fail(Finding::new(Severity::Error, "a guess", "wrong", place).hint());
        let last = judge.findings.last().unwrap();
        assert_eq!(last.confidence, Confidence::Likely);
        assert_eq!(last.measured, [Measured::count(UNLISTED, 8)]);
        assert_eq!(judge.judged.last().unwrap().measured, last.measured);
        assert_eq!(judge.judged.last().unwrap().outcome, Outcome::Fail);
    }
}
