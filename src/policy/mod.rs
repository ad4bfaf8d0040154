//! The policy: what the user weighs otherwise, accepts and demands, laid over a verdict.
//!
//! Owns what a waiver matches and when a requirement is met. Knows no file format but that of comments and of baselines, and reads no file.
//! Nothing is lost here: what is accepted stays in the verdict, marked.

pub mod baseline;
mod comments;
mod require;

use std::collections::{BTreeMap, BTreeSet};
use std::sync::Arc;

use globset::GlobMatcher;

use crate::page::{Page, names_rule};
use crate::run::Unmet;
use crate::source::{Place, Source, SourceId, Span};
use crate::verdict::deference;
use crate::verdict::waiver::{Applied, Day, Misspelt, Waiver, plain_subject};
use crate::verdict::{Finding, Outcome, Row, Severity, Verdict};
use crate::world::conventions::ends_with;

use baseline::Accepted;

/// What a rule's findings weigh.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Level {
    /// Nothing: the rule is not asked there.
    Off,
    /// This much.
    Severity(Severity),
}

impl Level {
    /// The word in a configuration.
    pub fn word(self) -> &'static str {
        match self {
            Self::Off => "off",
            Self::Severity(severity) => severity.word(),
        }
    }
}

/// A rule that weighs otherwise, everywhere or in some files.
#[derive(Clone, Debug)]
pub struct Weight {
    /// Code, name or family.
    pub rule: String,
    /// The files; all where `None`.
    pub file: Option<GlobMatcher>,
    /// What it weighs.
    pub level: Level,
    /// Where that stands, in words.
    pub origin: String,
}

/// An acceptance with what it is for.
#[derive(Clone, Debug)]
pub struct Exception {
    /// The acceptance.
    pub waiver: Waiver,
    /// What it is for.
    pub scope: Scope,
}

/// What an acceptance is for.
#[derive(Clone, Debug)]
pub enum Scope {
    /// Subjects and files; everything where both are `None`.
    Globs {
        /// Subjects, without the name of the platform.
        subject: Option<GlobMatcher>,
        /// Files, by the end of the path of any place.
        file: Option<GlobMatcher>,
    },
    /// A part of a text.
    Region(SourceId, Span),
    /// One finding of a baseline.
    Known(Box<Accepted>),
}

/// A rule that must have come to a judgement, or must not any more.
#[derive(Clone, Debug)]
pub struct Requirement {
    /// Code, name or family; of a family, every rule.
    pub rule: String,
    /// Subjects, without the name of the platform; any where `None`.
    pub subject: Option<GlobMatcher>,
    /// How far it goes.
    pub force: Force,
    /// Where that stands, in words.
    pub origin: String,
}

/// How far a requirement goes.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Force {
    /// The rule must have come to a judgement.
    Always,
    /// So it must where there is anything that the rule is about.
    IfApplicable,
    /// What stands before it is required no more, for this reason.
    Lifted(String),
}

/// The share of the checks that apply which must have been made.
#[derive(Clone, Debug, PartialEq)]
pub struct RequiredShare {
    /// From 0 to 1.
    pub share: f64,
    /// Where that stands, in words.
    pub origin: String,
}

/// Everything that is laid over a verdict.
#[derive(Clone, Debug, Default)]
pub struct Policy {
    /// In their order: what stands later overrides what stands before.
    pub weights: Vec<Weight>,
    /// Acceptances of the configuration and of a baseline.
    pub exceptions: Vec<Exception>,
    /// What must have been judged; what stands later lifts what stands before.
    pub required: Vec<Requirement>,
    /// How much must have been judged.
    pub share: Option<RequiredShare>,
}

/// What is known of a run when its verdict is held against the policy.
#[derive(Clone, Copy)]
pub struct Context<'a> {
    /// Every source, by id.
    pub sources: &'a [Arc<Source>],
    /// Labels of the platforms, where subjects open with them.
    pub platforms: &'a [String],
    /// Every rule of the tool.
    pub rules: &'a [&'static Page],
    /// Codes of the rules that were asked.
    pub asked: &'a BTreeSet<String>,
    /// The path of a source as the baseline has it, where there is one.
    pub known_as: Option<&'a dyn Fn(&Source) -> String>,
    /// Today.
    pub today: &'a Day,
    /// Whether comments in the sources accept findings.
    pub comments: bool,
}

/// What was laid over one verdict, besides the marks in it.
#[derive(Clone, Debug, Default)]
pub struct Laid {
    applied: Vec<(Applied, Scope)>,
    misspelt: Vec<Misspelt>,
    unmet: Vec<Unmet>,
}

/// What the policy has to say of a run besides the marks in its verdict.
#[derive(Clone, Debug, Default)]
pub struct Passed {
    /// What became of every acceptance.
    pub applied: Vec<Applied>,
    /// Comments to frames-lint that it does not understand.
    pub misspelt: Vec<Misspelt>,
    /// What was required and not judged.
    pub unmet: Vec<Unmet>,
}

/// Lays a policy, and the comments in the sources, over a verdict: everything but what is required.
pub fn lay(verdict: &mut Verdict, policy: &Policy, context: &Context) -> Laid {
    verdict.recall();
    weigh(verdict, policy, context);
    let (comments, misspelt) = comments::all(context);
    let mut known = comments;
    known.extend(policy.exceptions.iter().cloned());
    let applied = accept(verdict, known, context);
    deference::settle(verdict);
    settle_rows(verdict);
    Laid {
        applied,
        misspelt,
        unmet: Vec::new(),
    }
}

impl Laid {
    /// What was required and not judged, as far as it is known.
    pub fn unmet(&self) -> &[Unmet] {
        &self.unmet
    }

    /// Whether anything is accepted, be it that nothing was found for it.
    pub fn accepts(&self) -> bool {
        !self.applied.is_empty()
    }

    /// Adds what is required and was not judged in these outcomes, nor in those of what stands beside. Where they are of one of
    /// several recordings, `recording` is its label.
    pub fn demand(
        &mut self,
        (rows, beside): (&[Row], &[Row]),
        policy: &Policy,
        recording: Option<&str>,
        context: &Context,
    ) {
        let mut unmet = require::unmet((rows, beside), &policy.required, &mut self.applied, context);
        unmet.extend(policy.share.as_ref().and_then(|share| require::too_few(rows, share)));
        for one in &mut unmet {
            one.recordings.extend(recording.map(str::to_owned));
        }
        self.unmet.extend(unmet);
    }

    /// Adds what was laid over another verdict of the same run: an acceptance is for both, and what is required of both and was judged
    /// in neither for the same reasons is told once.
    pub fn join(&mut self, other: Self) {
        let key = |one: &Applied| (one.waiver.kind, one.waiver.origin.clone(), one.waiver.rule.clone());
        let known: BTreeMap<_, usize> = (0..).zip(&self.applied).map(|(at, (one, _))| (key(one), at)).collect();
        for (one, scope) in other.applied {
            match known.get(&key(&one)).and_then(|at| self.applied.get_mut(*at)) {
                Some((known, _)) => known.matched += one.matched,
                None => self.applied.push((one, scope)),
            }
        }
        for one in other.misspelt {
            if !self.misspelt.contains(&one) {
                self.misspelt.push(one);
            }
        }
        for one in other.unmet {
            match self.unmet.iter_mut().find(|known| known.is_like(&one)) {
                Some(known) => known.recordings.extend(one.recordings),
                None => self.unmet.push(one),
            }
        }
    }

    /// Moves every place as the sources of a run are numbered.
    pub fn renumber(&mut self, place: impl Fn(&mut Place)) {
        for (one, scope) in &mut self.applied {
            place(&mut one.waiver.place);
            if let Scope::Region(source, span) = scope {
                let mut whole = Place::text(*source, *span);
                place(&mut whole);
                *source = whole.source;
            }
        }
        self.misspelt.iter_mut().for_each(|one| place(&mut one.place));
    }

    /// What is to be said when every verdict of the run is there.
    pub fn close(self, verdict: &Verdict, context: &Context) -> Passed {
        let mut applied = self.applied;
        for (one, scope) in applied.iter_mut().filter(|(one, _)| one.matched == 0) {
            one.unjudged = scope.unjudged(&one.waiver, verdict, context);
        }
        Passed {
            applied: applied.into_iter().map(|(one, _)| one).collect(),
            misspelt: self.misspelt,
            unmet: self.unmet,
        }
    }
}

impl Context<'_> {
    fn path(&self, place: &Place) -> &str {
        self.sources
            .get(place.source.0 as usize)
            .map_or("", |source| source.path.as_str())
    }

    fn primary(&self, finding: &Finding) -> &str {
        finding.places.first().map_or("", |label| self.path(&label.place))
    }
}

/// Severities, and rules that are off in some files.
fn weigh(verdict: &mut Verdict, policy: &Policy, context: &Context) {
    let mut off: BTreeMap<(String, String), String> = BTreeMap::new();
    verdict.findings.retain_mut(|finding| {
        let weight = policy.weights.iter().rev().find(|weight| {
            names_rule(&weight.rule, &finding.rule, &finding.name)
                && weight
                    .file
                    .as_ref()
                    .is_none_or(|file| ends_with(file, context.primary(finding)))
        });
        match weight {
            None => true,
            Some(Weight {
                level: Level::Severity(severity),
                ..
            }) => {
                finding.severity = *severity;
                true
            }
            Some(Weight {
                level: Level::Off,
                origin,
                ..
            }) => {
                off.insert((finding.rule.clone(), finding.subject.clone()), origin.clone());
                false
            }
        }
    });
    if off.is_empty() {
        return;
    }
    let left: BTreeSet<(&str, &str)> = verdict
        .findings
        .iter()
        .map(|f| (f.rule.as_str(), f.subject.as_str()))
        .collect();
    for row in verdict.rows.iter_mut().filter(|row| row.outcome == Outcome::Fail) {
        if let Some(origin) = off.get(&(row.rule.to_string(), row.subject.clone()))
            && !left.contains(&(&*row.rule, row.subject.as_str()))
        {
            row.outcome = Outcome::NotEvaluated;
            row.reason = Some(format!("turned off for this file ({origin})"));
            row.measured.clear();
        }
    }
}

/// Marks what is accepted. Every acceptance that is for a finding is told so, though the first one marks it.
fn accept(verdict: &mut Verdict, exceptions: Vec<Exception>, context: &Context) -> Vec<(Applied, Scope)> {
    let mut applied: Vec<(Applied, Scope)> = exceptions
        .into_iter()
        .map(|Exception { waiver, scope }| {
            let run_out = waiver.until.as_ref().filter(|until| *until < context.today);
            let expired_days = run_out.map(|until| context.today.days_since(until));
            let applied = Applied {
                waiver,
                matched: 0,
                expired_days,
                unjudged: None,
            };
            (applied, scope)
        })
        .collect();
    for finding in &mut verdict.findings {
        for (one, scope) in &mut applied {
            if !names_rule(&one.waiver.rule, &finding.rule, &finding.name)
                || !scope.holds(finding, one.matched, context)
            {
                continue;
            }
            // A baseline has one entry for each of several like findings: an entry that marks nothing stays for the next.
            if matches!(scope, Scope::Known(_)) && finding.waived.is_some() {
                continue;
            }
            one.matched += 1;
            if finding.waived.is_none() && one.expired_days.is_none() {
                finding.waived = Some(one.waiver.waived());
            }
        }
    }
    applied
}

impl Scope {
    fn holds(&self, finding: &Finding, matched: usize, context: &Context) -> bool {
        match self {
            Self::Globs { subject, file } => {
                subject
                    .as_ref()
                    .is_none_or(|glob| glob.is_match(plain_subject(&finding.subject, context.platforms)))
                    && file.as_ref().is_none_or(|glob| {
                        finding
                            .places
                            .iter()
                            .any(|label| ends_with(glob, context.path(&label.place)))
                    })
            }
            Self::Region(source, region) => finding.places.iter().any(|label| {
                label.place.source == *source
                    && label
                        .place
                        .span()
                        .is_none_or(|span| span.start < region.end && region.start < span.end.max(span.start + 1))
            }),
            Self::Known(accepted) => matched < accepted.count && accepted.is(finding, context),
        }
    }

    /// Why it can't be said that nothing is left to accept: the rule was not asked, or could not judge.
    fn unjudged(&self, waiver: &Waiver, verdict: &Verdict, context: &Context) -> Option<String> {
        let mut asked = context
            .rules
            .iter()
            .filter(|rule| names_rule(&waiver.rule, rule.code, rule.name))
            .filter(|rule| context.asked.contains(rule.code))
            .peekable();
        if asked.peek().is_none() {
            return Some(format!("{} was not asked in this run", waiver.rule));
        }
        if let Self::Known(accepted) = self
            && verdict.findings.iter().any(|finding| accepted.was(finding, context))
        {
            return Some("what it accepts has grown, and counts as new".to_owned());
        }
        let meant = |subject: &str| {
            let subject = plain_subject(subject, context.platforms);
            match self {
                Self::Globs { subject: glob, .. } => glob.as_ref().is_none_or(|glob| glob.is_match(subject)),
                Self::Known(accepted) => accepted.identity.subject == subject,
                Self::Region(..) => true,
            }
        };
        let codes: BTreeSet<&str> = asked.map(|rule| rule.code).collect();
        let rows = || verdict.rows.iter().filter(|row| codes.contains(&*row.rule));
        if rows().any(|row| row.outcome.is_judged() && meant(&row.subject)) {
            return None;
        }
        // Of a rule that judged other subjects, this one is no more: that is nothing left to accept.
        let reason = rows()
            .find(|row| !row.outcome.is_judged() && meant(&row.subject))
            .or_else(|| {
                rows()
                    .find(|row| !row.outcome.is_judged())
                    .filter(|_| !rows().any(|row| row.outcome.is_judged()))
            });
        reason.map(|row| row.reason.clone().unwrap_or_else(|| row.outcome.word().to_owned()))
    }
}

/// Rows all of whose findings are accepted are no failures.
fn settle_rows(verdict: &mut Verdict) {
    let mut found: BTreeMap<(&str, &str), (bool, Option<String>)> = BTreeMap::new();
    for finding in &verdict.findings {
        let (is_open, words) = found.entry((&finding.rule, &finding.subject)).or_default();
        match &finding.waived {
            None => *is_open = true,
            Some(waived) => {
                words.get_or_insert_with(|| waived.words());
            }
        }
    }
    for row in verdict.rows.iter_mut().filter(|row| row.outcome == Outcome::Fail) {
        if let Some((false, Some(words))) = found.get(&(&*row.rule, row.subject.as_str())) {
            row.outcome = Outcome::Waived;
            row.reason = Some(words.clone());
        }
    }
}
