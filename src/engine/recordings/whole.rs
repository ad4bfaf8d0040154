//! The run as it grows, recording by recording: findings in files that all of them share are reported once.

use std::collections::BTreeSet;
use std::sync::Arc;

use crate::policy::AppliedPolicy;
use crate::run::{Recording, Run, RunUpdate};
use crate::source::{Derivation, Source};
use crate::verdict::waiver::plain_subject;
use crate::verdict::{Finding, KeptOutcomes, Label, Outcome, Row, Verdict};

use super::super::{IdShift, RunPolicy, plan};
use super::{Drive, JudgeContext, put};

/// Builds the run, recording by recording.
pub(super) struct RunBuilder<'a> {
    pub(super) run: Run,
    applied: AppliedPolicy,
    of_files: FileFindings,
    listener: &'a mut dyn FnMut(&Run, &RunUpdate),
}

/// Findings in files other than recordings: the same with every recording, reported once and for no recording.
#[derive(Default)]
struct FileFindings {
    findings: BTreeSet<(String, String, String, Vec<Label>)>,
    rows: BTreeSet<(String, String, Outcome)>,
}

impl FileFindings {
    /// The verdict of a drive without what was reported before.
    fn once(&mut self, mut verdict: Verdict, platforms: &[String], sources: &[Arc<Source>]) -> Verdict {
        let is_file = |label: &Label| {
            let source = sources.get(label.place.source.0 as usize);
            source
                .is_some_and(|source| !source.kind.is_bag() && !matches!(source.derived, Some(Derivation::Message(_))))
        };
        let key = |rule: &str, subject: &str| (rule.to_owned(), subject.to_owned());
        let (mut of_files, mut of_drive) = (BTreeSet::new(), BTreeSet::new());
        let mut is_new = |finding: &mut Finding| {
            let known = key(&finding.rule, &finding.subject);
            if !finding.places.iter().all(is_file) {
                of_drive.insert(known);
                return true;
            }
            of_files.insert(known);
            finding.subject = plain_subject(&finding.subject, platforms).to_owned();
            self.findings.insert((
                finding.rule.clone(),
                finding.subject.clone(),
                finding.message.clone(),
                finding.places.clone(),
            ))
        };
        verdict.findings.retain_mut(&mut is_new);
        verdict.explained.retain_mut(&mut is_new);
        let mut rows = Vec::with_capacity(verdict.rows.len());
        for row in verdict.rows {
            let known = key(&row.rule, &row.subject);
            if !of_files.contains(&known) {
                rows.push(row);
                continue;
            }
            let subject = plain_subject(&row.subject, platforms).to_owned();
            if self.rows.insert((row.rule.to_string(), subject.clone(), row.outcome)) {
                rows.push(Row { subject, ..row.clone() });
            }
            if of_drive.contains(&known) {
                rows.push(row);
            }
        }
        verdict.rows = rows;
        verdict
    }
}

impl<'a> RunBuilder<'a> {
    /// A run with sources only; `listener` is called with what is added to it.
    pub(super) fn new(run: Run, listener: &'a mut dyn FnMut(&Run, &RunUpdate)) -> Self {
        Self {
            run,
            applied: AppliedPolicy::default(),
            of_files: FileFindings::default(),
            listener,
        }
    }

    /// Adds a drive, with the ids of its sources in the whole run.
    pub(super) fn add(&mut self, mut drive: Drive, renumber: IdShift) {
        renumber.all(&mut drive.sources, &mut drive.verdict);
        drive.applied.renumber(|place| renumber.place(place));
        let new: Vec<usize> = drive.sources.iter().map(|source| source.id.0 as usize).collect();
        put(&mut self.run.sources, drive.sources);
        let platforms: Vec<String> = drive.worlds.iter().map(|world| world.label.clone()).collect();
        if self.run.worlds.is_empty() && renumber.is_none() {
            self.run.worlds = drive.worlds;
        }
        self.run.seen.extend(drive.seen);
        self.run
            .assure(drive.assured.into_iter().map(|(_, assurance)| assurance));
        self.run.fitness.extend(drive.fitness);
        let verdict = self.of_files.once(drive.verdict, &platforms, &self.run.sources);
        self.run.platforms.extend(platforms);
        self.take(verdict, drive.applied, new, Some(drive.recording));
    }

    /// Applies the policy to what was judged without recordings, and adds it.
    pub(super) fn apply_policy(&mut self, verdicts: Vec<(usize, Verdict)>, labels: &[String], policy: &RunPolicy) {
        let (mut verdict, applied) = policy.apply(verdicts, (&self.run.sources, labels), None);
        verdict.sort();
        self.run.platforms.extend(labels.iter().cloned());
        self.take(verdict, applied, Vec::new(), None);
    }

    fn take(&mut self, mut verdict: Verdict, applied: AppliedPolicy, new: Vec<usize>, recording: Option<Recording>) {
        let (rows, findings) = (self.run.verdict.rows.len(), self.run.verdict.findings.len());
        self.applied.join(applied);
        // Rules that compare recordings count later what was reported for one of them.
        if self.run.kept.drops_inapplicable() {
            verdict.drop_rows(|row| !row.applies() && !plan::compares(&row.rule));
        }
        self.run.verdict.extend(verdict);
        let number = recording.is_some().then_some(self.run.recordings.len());
        self.run.recordings.extend(recording);
        self.notify(new.clone(), rows, findings, number);
        // The effect of an acceptance is known when everything is judged.
        if self.run.kept == KeptOutcomes::Unreported && !self.applied.accepts() {
            for number in new {
                // Recorded descriptions: nothing else points into them.
                let is_recorded = |source: &&mut Arc<Source>| matches!(source.derived, Some(Derivation::Message(_)));
                if let Some(source) = self.run.sources.get_mut(number).filter(is_recorded) {
                    Arc::make_mut(source).text = String::new();
                }
            }
            self.run
                .verdict
                .drop_rows(|row| row.outcome != Outcome::Crashed && !plan::compares(&row.rule));
            self.run.verdict.drop_findings();
        }
    }

    /// Reports what was added since these numbers of outcomes and findings.
    pub(super) fn notify(&mut self, sources: Vec<usize>, rows: usize, findings: usize, recording: Option<usize>) {
        let grown = RunUpdate {
            sources,
            rows: rows..self.run.verdict.rows.len(),
            findings: findings..self.run.verdict.findings.len(),
            recording,
        };
        (self.listener)(&self.run, &grown);
    }

    /// The complete run.
    pub(super) fn end(mut self, context: &JudgeContext) -> Run {
        let (rows, findings) = (self.run.verdict.rows.len(), self.run.verdict.findings.len());
        context.policy.close(std::mem::take(&mut self.applied), &mut self.run);
        self.notify(Vec::new(), rows, findings, None);
        self.run.verdict.sort();
        self.run
    }
}
