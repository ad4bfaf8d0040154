//! The result of one run: inputs, worlds and verdict, as pure data, with the counts and the exit code that follow from it.
//!
//! Does not know how a run is made or shown.

mod requirement;

use std::collections::{BTreeMap, BTreeSet};
use std::ops::Range;
use std::sync::Arc;

use crate::assure::Assurance;
use crate::fitness::Fitness;
use crate::page::Page;
use crate::source::{Confidence, ReadStatus, Source, SourceId};
use crate::verdict::{Finding, KeptOutcomes, Outcome, Row, Severity, Verdict};
use crate::world::World;

pub use requirement::{RequirementKind, UnmetRequirement};

/// Exit code of a clean run.
pub const EXIT_CLEAN: u8 = 0;
/// Exit code of a run with findings at or above the limit.
pub const EXIT_FINDINGS: u8 = 1;
/// Exit code of a wrong command line or configuration.
pub const EXIT_USAGE: u8 = 2;
/// Exit code of an incomplete run.
pub const EXIT_INCOMPLETE: u8 = 3;
/// Exit code of an internal error.
pub const EXIT_CRASHED: u8 = 70;

/// Everything one run read and judged.
#[derive(Clone, Debug, Default)]
pub struct Run {
    /// Every input, by id.
    pub sources: Vec<Arc<Source>>,
    /// Outcomes and findings.
    pub verdict: Verdict,
    /// One world for each platform that was read. Those of saved evidence are not among them: their sources have other ids.
    pub worlds: Vec<World>,
    /// Every platform of every verdict with the sources that it points at, those of saved evidence too; empty unless views are wanted.
    pub seen: Vec<World>,
    /// The rules that ran, in code order.
    pub rules: Vec<&'static Page>,
    /// Counts of files in folders for which no reader exists, by extension or name.
    pub skipped: BTreeMap<String, usize>,
    /// Requirements that are not met.
    pub unmet: Vec<UnmetRequirement>,
    /// Labels of the platforms, if subjects begin with them.
    pub platforms: Vec<String>,
    /// [`FailOn`] of the configuration.
    pub fail_on: Option<FailOn>,
    /// The verdict of each recording, if there are several.
    pub recordings: Vec<Recording>,
    /// What became of known mistakes, if they were tried.
    pub assurance: Option<Assurance>,
    /// Whether the recordings are fit for the calibrations that were asked for.
    pub fitness: Vec<Fitness>,
    /// Which outcomes are kept.
    pub kept: KeptOutcomes,
}

impl Run {
    /// The outcomes that reports for machines list: all, or those that apply.
    pub fn listed<'r>(&self, rows: &'r [Row]) -> impl Iterator<Item = &'r Row> {
        let all = self.kept == KeptOutcomes::Listed;
        rows.iter().filter(move |row| all || row.applies())
    }
}

/// What was added to a run: the indices of new sources, outcomes and findings.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct RunUpdate {
    /// Sources.
    pub sources: Vec<usize>,
    /// Outcomes.
    pub rows: Range<usize>,
    /// Findings.
    pub findings: Range<usize>,
    /// The recording whose verdict they are, if there are several.
    pub recording: Option<usize>,
}

impl RunUpdate {
    /// Everything that a run has.
    pub fn all(run: &Run) -> Self {
        Self {
            sources: (0..run.sources.len()).collect(),
            rows: 0..run.verdict.rows.len(),
            findings: 0..run.verdict.findings.len(),
            recording: None,
        }
    }
}

/// One recording of several, with a verdict of its own: that of the recording with everything that belongs to its platform, without
/// the other recordings.
#[derive(Clone, Debug, PartialEq)]
pub struct Recording {
    /// Its name in reports, with which its subjects begin.
    pub label: String,
    /// Its files: one, or several that were recorded at the same time.
    pub sources: Vec<SourceId>,
    /// Its counts and its verdict.
    pub summary: Summary,
    /// The exit code of a run of it alone.
    pub code: u8,
    /// The reason of the verdict: the worst finding that counts, or what was not read or evaluated.
    pub because: Option<String>,
    /// Errors and warnings that are not accepted, without hints: the worst of each rule in words, the worst first.
    pub reasons: Vec<(Severity, String)>,
}

/// The lowest severity that fails a run. Hints never do.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum FailOn {
    /// Errors only.
    #[default]
    Error,
    /// Errors and warnings.
    Warning,
    /// Every finding.
    Note,
    /// No finding.
    Never,
}

impl FailOn {
    /// The word on the command line.
    pub fn word(self) -> &'static str {
        match self {
            Self::Error => "error",
            Self::Warning => "warning",
            Self::Note => "note",
            Self::Never => "never",
        }
    }

    /// Higher values make more findings fail.
    pub fn rank(self) -> u8 {
        match self {
            Self::Never => 0,
            Self::Error => 1,
            Self::Warning => 2,
            Self::Note => 3,
        }
    }

    /// Whether this finding fails a run: severe enough, and more than a hint.
    pub fn counts(self, finding: &Finding) -> bool {
        let from = match self {
            Self::Error => Severity::Error,
            Self::Warning => Severity::Warning,
            Self::Note => Severity::Note,
            Self::Never => return false,
        };
        finding.severity >= from && finding.confidence > Confidence::Hint && finding.waived.is_none()
    }
}

/// A run in one word.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum VerdictWord {
    /// Something was checked, all inputs were read, and no finding counts.
    Clean,
    /// At least one finding counts. Takes precedence over `Incomplete`.
    Findings,
    /// No finding counts, but an input was not read, a requirement is not met, nothing was checked, or a rule crashed.
    Incomplete,
}

impl VerdictWord {
    /// The word used in reports.
    pub fn word(self) -> &'static str {
        match self {
            Self::Clean => "clean",
            Self::Findings => "findings",
            Self::Incomplete => "incomplete",
        }
    }
}

/// The counts of a run. Hints are counted apart from the findings that may count; rows by outcome.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Summary {
    /// Findings that are errors.
    pub errors: usize,
    /// Findings that are warnings.
    pub warnings: usize,
    /// Findings that are notes.
    pub notes: usize,
    /// Hints of any severity.
    pub hints: usize,
    /// Rows that apply.
    pub applicable: usize,
    /// Of these, the rows that were judged.
    pub judged: usize,
    /// Rows judged right.
    pub passed: usize,
    /// Rows that could not be judged.
    pub not_evaluated: usize,
    /// Of these, the rows that do not apply.
    pub not_applicable: usize,
    /// Rows judged wrong all of whose findings the user accepts.
    pub waived: usize,
    /// Rows judged wrong whose findings are explained by findings of other rules.
    pub explained: usize,
    /// Rules that crashed.
    pub crashed: usize,
    /// The run in one word.
    pub verdict: VerdictWord,
}

impl Run {
    /// Adds what became of known mistakes.
    pub fn assure(&mut self, assurances: impl IntoIterator<Item = Assurance>) {
        for one in assurances {
            self.assurance.get_or_insert_default().join(one);
        }
    }

    /// Counts files for which no reader exists.
    pub fn skip(&mut self, files: BTreeMap<String, usize>) {
        for (what, count) in files {
            *self.skipped.entry(what).or_default() += count;
        }
    }

    /// Counts and verdict.
    pub fn summary(&self, fail_on: FailOn) -> Summary {
        let verdict = if self.has_counting_findings(fail_on) {
            VerdictWord::Findings
        } else if self.is_incomplete() || self.has_crashed() {
            VerdictWord::Incomplete
        } else {
            VerdictWord::Clean
        };
        let (judged, applicable) = self.verdict.judged_of_applicable();
        Summary {
            errors: self.verdict.count_findings(Severity::Error),
            warnings: self.verdict.count_findings(Severity::Warning),
            notes: self.verdict.count_findings(Severity::Note),
            hints: self.verdict.count_hints(),
            applicable,
            judged,
            passed: self.verdict.count(Outcome::Pass),
            not_evaluated: self.verdict.count(Outcome::NotEvaluated),
            not_applicable: self.verdict.not_applicable_count(),
            waived: self.verdict.count(Outcome::Waived),
            explained: self.verdict.count(Outcome::Explained),
            crashed: self.verdict.count(Outcome::Crashed),
            verdict,
        }
    }

    /// The exit code: 70 when a rule crashed, else 1 when a finding counts, else 3 when the run is incomplete, else 0.
    pub fn exit_code(&self, fail_on: FailOn) -> u8 {
        if self.has_crashed() {
            EXIT_CRASHED
        } else if self.has_counting_findings(fail_on) {
            EXIT_FINDINGS
        } else if self.is_incomplete() {
            EXIT_INCOMPLETE
        } else {
            EXIT_CLEAN
        }
    }

    /// The reason of the verdict, in a few words: the worst finding that counts, else what was not read or evaluated.
    pub fn because(&self, fail_on: FailOn) -> Option<String> {
        let worst = self
            .verdict
            .findings
            .iter()
            .filter(|finding| fail_on.counts(finding))
            .min_by_key(|finding| std::cmp::Reverse(finding.severity));
        let crashed = self.verdict.rows.iter().find(|row| row.outcome == Outcome::Crashed);
        if let Some(row) = crashed {
            return Some(format!("{} {} crashed (a bug in frames-lint)", row.rule, row.name));
        }
        if let Some(finding) = worst {
            return Some(reason(finding));
        }
        if let Some(source) = self.unread().next() {
            let is_only = self.sources.iter().all(|other| other.path == source.path);
            let path = if is_only {
                String::new()
            } else {
                format!("{}: ", source.path)
            };
            return Some(path + source.shortfall());
        }
        let (unfit, lacking): (Vec<&UnmetRequirement>, Vec<_>) =
            self.lacking().partition(|unmet| unmet.kind == RequirementKind::Fitness);
        if !lacking.is_empty() {
            let rules: Vec<&str> = lacking.iter().map(|unmet| unmet.rule.as_str()).collect();
            return Some(format!("required but not evaluated: {}", rules.join(", ")));
        }
        if let Some(unmet) = unfit.first() {
            return Some(format!("{} {}", unmet.rule, unmet.name));
        }
        (!self.verdict.judges_anything()).then(|| "nothing was checked".to_owned())
    }

    /// Errors and warnings that are not accepted, without hints: the worst of each rule in words, the worst first.
    pub fn reasons(&self) -> Vec<(Severity, String)> {
        let mut worst: Vec<&Finding> = self.verdict.open().collect();
        worst.retain(|finding| finding.severity >= Severity::Warning && finding.confidence > Confidence::Hint);
        worst.sort_by_key(|finding| std::cmp::Reverse(finding.severity));
        let mut known = BTreeSet::new();
        worst.retain(|finding| known.insert(&finding.rule));
        worst
            .into_iter()
            .map(|finding| (finding.severity, reason(finding)))
            .collect()
    }

    /// The exit code of commands that only read: 3 when an input could not be read in full or there is none, else 0.
    pub fn exit_code_of_reading(&self) -> u8 {
        if self.sources.is_empty() || self.unread().next().is_some() {
            EXIT_INCOMPLETE
        } else {
            EXIT_CLEAN
        }
    }

    /// Inputs that were not read, or not in full.
    pub fn unread(&self) -> impl Iterator<Item = &Source> {
        self.sources
            .iter()
            .map(AsRef::as_ref)
            .filter(|source| source.required && source.status != ReadStatus::Read)
    }

    /// Requirements that are not met, and not accepted.
    pub fn lacking(&self) -> impl Iterator<Item = &UnmetRequirement> {
        self.unmet.iter().filter(|unmet| unmet.waived.is_none())
    }

    fn is_incomplete(&self) -> bool {
        let is_open = |recording: &Recording| recording.summary.verdict == VerdictWord::Incomplete;
        !self.verdict.judges_anything()
            || self.unread().next().is_some()
            || self.lacking().next().is_some()
            || self.recordings.iter().any(is_open)
    }

    fn has_crashed(&self) -> bool {
        self.verdict.count(Outcome::Crashed) > 0
    }

    fn has_counting_findings(&self, fail_on: FailOn) -> bool {
        self.verdict.findings.iter().any(|finding| fail_on.counts(finding))
    }
}

/// `TREE01 orphan-subtree: ...`.
fn reason(finding: &Finding) -> String {
    format!("{} {}: {}", finding.rule, finding.name, finding.message)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::source::{Place, SourceId, SourceKind};

    fn row(outcome: Outcome) -> Row {
        Row {
            rule: "TREE01".into(),
            name: "orphan-subtree".into(),
            subject: "x".into(),
            outcome,
            reason: None,
            measured: Vec::new(),
            plots: Vec::new(),
            planes: Vec::new(),
        }
    }

    fn run(outcomes: &[Outcome], findings: &[(Severity, Confidence)], status: ReadStatus, required: bool) -> Run {
        let id = SourceId(0);
        let mut source = Source::new(id, "a.urdf", SourceKind::Urdf);
        source.status = status;
        source.required = required;
        let findings = findings
            .iter()
            .map(|(severity, confidence)| Finding::new(*severity, "x", "m", Place::whole(id)).confidence(*confidence));
        Run {
            sources: vec![source.into()],
            verdict: Verdict {
                rows: outcomes.iter().map(|outcome| row(*outcome)).collect(),
                findings: findings.collect(),
                ..Verdict::default()
            },
            ..Run::default()
        }
    }

    /// Rows, findings, status of the input, whether it is required, `--fail-on`; exit code, verdict.
    type Line<'a> = (
        &'a [Outcome],
        &'a [(Severity, Confidence)],
        ReadStatus,
        bool,
        FailOn,
        u8,
        VerdictWord,
    );

    #[test]
    fn exit_codes_and_verdicts_follow_the_table() {
        use Confidence::{Certain, Hint, Likely};
        use FailOn::{Error, Never, Note, Warning};
        use Outcome::{Crashed, Fail, NotEvaluated, Pass, Waived};
        use ReadStatus::{Partial, Read, Unreadable};
        use Severity as S;
        use VerdictWord as V;
        let e = [(S::Error, Certain)];
        let w = [(S::Warning, Likely)];
        let n = [(S::Note, Certain)];
        let hint = [(S::Error, Hint)];
        let table: &[Line] = &[
            (&[Pass], &[], Read, true, Error, 0, V::Clean),
            (&[Pass, NotEvaluated], &[], Read, true, Error, 0, V::Clean),
            (&[Waived], &[], Read, true, Error, 0, V::Clean),
            (&[Fail], &e, Read, true, Error, 1, V::Findings),
            (&[Fail], &e, Read, true, Never, 0, V::Clean),
            (&[Fail], &w, Read, true, Error, 0, V::Clean),
            (&[Fail], &w, Read, true, Warning, 1, V::Findings),
            (&[Fail], &n, Read, true, Warning, 0, V::Clean),
            (&[Fail], &n, Read, true, Note, 1, V::Findings),
            (&[Fail], &hint, Read, true, Note, 0, V::Clean),
            (&[], &[], Read, true, Error, 3, V::Incomplete),
            (&[NotEvaluated], &[], Read, true, Never, 3, V::Incomplete),
            (&[Pass], &[], Partial, true, Error, 3, V::Incomplete),
            (&[Pass], &[], Unreadable, true, Never, 3, V::Incomplete),
            (&[Pass], &[], Unreadable, false, Error, 0, V::Clean),
            (&[Fail], &e, Unreadable, true, Error, 1, V::Findings),
            (&[Pass, Crashed], &[], Read, true, Error, 70, V::Incomplete),
            (&[Fail, Crashed], &e, Unreadable, true, Error, 70, V::Findings),
        ];
        for (index, (rows, findings, status, required, fail_on, code, word)) in table.iter().enumerate() {
            let run = run(rows, findings, *status, *required);
            assert_eq!(run.exit_code(*fail_on), *code, "exit code of line {index}");
            assert_eq!(run.summary(*fail_on).verdict, *word, "verdict of line {index}");
        }
    }
}
