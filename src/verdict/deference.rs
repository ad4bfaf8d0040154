//! Hides findings that another finding explains better.
//!
//! A rule reports every fault that it finds, and may name the rules that explain it better. Here it is decided which are shown: a finding
//! is explained by a finding of another rule on the same thing, if that one is shown and counts at least as much. One is always shown.

use std::collections::{BTreeMap, BTreeSet};

use serde::{Deserialize, Serialize};

use crate::source::{Confidence, Place};

use super::{Finding, Label, Outcome, Verdict};

/// The code of a rule: `TREE01`. The registry of the rules makes them.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct RuleCode(&'static str);

impl RuleCode {
    /// Only for the registry.
    pub(crate) const fn new(code: &'static str) -> Self {
        Self(code)
    }

    /// As it is written.
    pub const fn as_str(self) -> &'static str {
        self.0
    }
}

impl std::fmt::Display for RuleCode {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(self.0)
    }
}

/// Rules and findings that explain a fault better.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Deference {
    /// A rule with a finding on the same subject, topic or part of a file.
    Rule(RuleCode),
    /// The same with the same relation.
    Relation(RuleCode),
    /// The same with this relation.
    With(RuleCode, &'static str),
    /// A rule with a finding that names this.
    About(RuleCode, String),
    /// The finding of the same rule on this subject, which has the same cause.
    CauseOf(String),
}

/// A finding, by the rule that made it and what was judged.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
pub struct Explainer {
    /// Code of the rule.
    pub rule: String,
    /// What was judged.
    pub subject: String,
}

impl Explainer {
    /// The reason of a row.
    pub fn words(&self) -> String {
        format!("explained by {} of {}", self.rule, self.subject)
    }
}

/// Notes for each finding which others may explain it: findings of the rules that it names on the same subject, the same topic or the
/// same part of a file. For the findings of one world.
pub fn match_up(findings: &mut [Finding]) {
    // Thousands may have one subject: the first equal one is enough.
    let mut known: BTreeMap<&str, Vec<Vec<&Finding>>> = BTreeMap::new();
    let mut numbers: BTreeMap<(&str, &str), usize> = BTreeMap::new();
    for one in findings.iter() {
        let subjects = known.entry(&one.rule).or_default();
        let number = *numbers.entry(one.key()).or_insert(subjects.len());
        match subjects.get_mut(number) {
            Some(same) => same.push(one),
            None => subjects.push(vec![one]),
        }
    }
    let matches: Vec<Vec<Explainer>> = findings
        .iter()
        .map(|finding| {
            let same = finding.unless.iter().flat_map(|unless| {
                let rule = match unless {
                    Deference::Rule(rule)
                    | Deference::Relation(rule)
                    | Deference::With(rule, _)
                    | Deference::About(rule, _) => rule.as_str(),
                    Deference::CauseOf(_) => &finding.rule,
                };
                let subjects = known.get(rule).into_iter().flatten();
                subjects.filter_map(move |others| others.iter().find(|other| is_same(finding, other, unless)))
            });
            let mut known = BTreeSet::new();
            let same = same.filter(|other| known.insert(other.key()));
            same.map(|other| other.explainer()).collect()
        })
        .collect();
    for (finding, explainers) in findings.iter_mut().zip(matches) {
        finding.explainers = explainers;
    }
}

/// Whether two findings are about the same thing.
fn is_same(finding: &Finding, other: &Finding, unless: &Deference) -> bool {
    match unless {
        Deference::Relation(_) if other.relation != finding.relation => return false,
        Deference::With(_, relation) if other.relation.as_deref() != Some(*relation) => return false,
        Deference::Rule(_) | Deference::Relation(_) | Deference::With(..) => {}
        Deference::About(_, about) => return other.subject.contains(about) || other.text().contains(about),
        // If there are several platforms, subjects begin with their names.
        Deference::CauseOf(subject) => return other.subject.ends_with(subject) && other.subject != finding.subject,
    }
    let touches = |label: &Label| finding.places.iter().any(|own| touches(&own.place, &label.place));
    finding.subject == other.subject || other.places.iter().any(touches)
}

/// Whether two places are messages of one topic, or overlapping parts of one file. TF does not count: it has many subjects.
fn touches(a: &Place, b: &Place) -> bool {
    if a.source != b.source {
        return false;
    }
    match (a.topic(), b.topic(), a.span(), b.span()) {
        (Some(a), Some(b), ..) => a == b && !matches!(a.rsplit('/').next(), Some("tf" | "tf_static")),
        (None, None, Some(a), Some(b)) => a.start < b.end && b.start < a.end,
        _ => false,
    }
}

/// Moves findings that another one explains to [`Verdict::explained`]; their rows name the explanation. May be called again whenever
/// findings have changed.
pub fn settle(verdict: &mut Verdict) {
    verdict.recall();
    if verdict.findings.iter().all(|finding| finding.explainers.is_empty()) {
        return;
    }
    let mut findings = std::mem::take(&mut verdict.findings);
    // If two explain each other, the one listed first is shown.
    findings.sort_by(|a, b| {
        weight(b)
            .cmp(&weight(a))
            .then_with(|| a.explainer().cmp(&b.explainer()))
    });
    let speakers = speakers(&findings);
    let waived: Vec<_> = findings.iter().map(|finding| finding.waived.clone()).collect();
    let explainers: Vec<_> = findings.iter().map(Finding::explainer).collect();
    for (at, (mut finding, speaker)) in findings.into_iter().zip(speakers).enumerate() {
        if speaker == at {
            verdict.findings.push(finding);
            continue;
        }
        finding.explained_by = explainers.get(speaker).cloned();
        if let (None, Some(waived)) = (&finding.waived, waived.get(speaker)) {
            finding.waived.clone_from(waived);
        }
        verdict.explained.push(finding);
    }
    settle_rows(verdict);
}

/// How much a finding counts: a hint counts as no more than a hint.
fn weight(finding: &Finding) -> (bool, super::Severity, Confidence) {
    (
        finding.confidence > Confidence::Hint,
        finding.severity,
        finding.confidence,
    )
}

/// For each finding the index of the one that explains it; its own, if none does.
fn speakers(findings: &[Finding]) -> Vec<usize> {
    let known: BTreeMap<Explainer, Vec<usize>> =
        (0..).zip(findings).fold(BTreeMap::new(), |mut known, (at, finding)| {
            known.entry(finding.explainer()).or_insert_with(Vec::new).push(at);
            known
        });
    let mut speakers: Vec<Option<usize>> = vec![None; findings.len()];
    loop {
        let mut is_changed = false;
        for (at, finding) in findings.iter().enumerate() {
            if speakers.get(at).copied().flatten().is_some() {
                continue;
            }
            let others = finding.explainers.iter().filter_map(|one| known.get(one)).flatten();
            let (mut is_open, mut speaker) = (false, None);
            for other in others.filter(|other| **other != at) {
                match speakers.get(*other).copied().flatten() {
                    None => is_open = true,
                    Some(said_by) => {
                        let counts = findings.get(said_by).is_some_and(|said| says(said, finding));
                        speaker = (counts && said_by != at).then_some(said_by);
                    }
                }
                if speaker.is_some() {
                    break;
                }
            }
            if speaker.is_some() || !is_open {
                if let Some(own) = speakers.get_mut(at) {
                    *own = Some(speaker.unwrap_or(at));
                }
                is_changed = true;
            }
        }
        if !is_changed {
            // The remaining ones explain each other in a cycle: the first is shown.
            match speakers.iter_mut().enumerate().find(|(_, speaker)| speaker.is_none()) {
                Some((at, speaker)) => *speaker = Some(at),
                None => {
                    return speakers
                        .into_iter()
                        .enumerate()
                        .map(|(at, one)| one.unwrap_or(at))
                        .collect();
                }
            }
        }
    }
}

/// Whether a finding counts at least as much as the one that it explains.
fn says(speaker: &Finding, finding: &Finding) -> bool {
    let is_hint = |finding: &Finding| finding.confidence == Confidence::Hint;
    speaker.severity >= finding.severity && (!is_hint(speaker) || is_hint(finding))
}

/// Rows whose findings are all explained name the explanation; rows whose findings are no longer explained have failed.
fn settle_rows(verdict: &mut Verdict) {
    let open: BTreeSet<(&str, &str)> = verdict.findings.iter().map(Finding::key).collect();
    let explained: BTreeMap<(&str, &str), &Finding> = verdict.explained.iter().map(|one| (one.key(), one)).collect();
    for row in verdict.rows.iter_mut().filter(|row| row.outcome == Outcome::Fail) {
        let key = (&*row.rule, row.subject.as_str());
        if let (false, Some(finding)) = (open.contains(&key), explained.get(&key)) {
            row.outcome = Outcome::Explained;
            row.reason = finding.explained_by.as_ref().map(Explainer::words);
        }
    }
}

impl Verdict {
    /// Brings back the findings that were explained, and their rows.
    pub fn recall(&mut self) {
        for mut finding in self.explained.drain(..) {
            finding.explained_by = None;
            self.findings.push(finding);
        }
        for row in self.rows.iter_mut().filter(|row| row.outcome == Outcome::Explained) {
            row.outcome = Outcome::Fail;
            row.reason = None;
        }
    }
}

impl Finding {
    fn key(&self) -> (&str, &str) {
        (&self.rule, &self.subject)
    }

    fn explainer(&self) -> Explainer {
        Explainer {
            rule: self.rule.clone(),
            subject: self.subject.clone(),
        }
    }
}
