//! The policy: severities that the user changes, findings that the user accepts, and checks that the user requires, applied to a verdict.
//!
//! Owns what a waiver matches and when a requirement is met. Knows no file format but that of comments and of baselines, and reads no file.
//! Nothing is lost: accepted findings stay in the verdict, marked.

pub mod baseline;
mod comments;
mod detect;
mod require;

use std::collections::{BTreeMap, BTreeSet};
use std::sync::Arc;

use globset::GlobMatcher;

use crate::assure::Assurance;
use crate::page::{Page, names_rule};
use crate::run::UnmetRequirement;
use crate::source::{Place, Source, SourceId, Span};
use crate::verdict::deference;
use crate::verdict::waiver::{CommentFault, Day, Waiver, WaiverEffect, plain_subject};
use crate::verdict::{Finding, Outcome, Row, Severity, Verdict};
use crate::world::conventions::ends_with;

use baseline::AcceptedFinding;

/// The severity of a rule's findings.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Level {
    /// None: the rule does not run there.
    Off,
    /// This severity.
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

/// A rule with another severity, everywhere or in some files.
#[derive(Clone, Debug)]
pub struct Weight {
    /// Code, name or family.
    pub rule: String,
    /// The files; all where `None`.
    pub file: Option<GlobMatcher>,
    /// The severity.
    pub level: Level,
    /// Where that is written, in words.
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
    Known(Box<AcceptedFinding>),
}

/// A rule that must be evaluated, or a known mistake that must be found; or that is no longer required.
#[derive(Clone, Debug)]
pub struct Requirement {
    /// Code, name or family; of a family, every rule. Of a mistake its name, or its family: every mistake of it.
    pub rule: String,
    /// Subjects, without the name of the platform; any where `None`.
    pub subject: Option<GlobMatcher>,
    /// Its force.
    pub force: Force,
    /// The size from which on a mistake must be found, with its unit.
    pub smaller_than: Option<(f64, String)>,
    /// Where that is written, in words.
    pub origin: String,
}

/// The force of a requirement.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Force {
    /// The rule must be evaluated.
    Always,
    /// The rule must be evaluated if it is applicable.
    IfApplicable,
    /// Requirements before this one no longer apply, for this reason.
    Lifted(String),
}

/// The share of the applicable checks that must be evaluated.
#[derive(Clone, Debug, PartialEq)]
pub struct RequiredShare {
    /// From 0 to 1.
    pub share: f64,
    /// Where that is written, in words.
    pub origin: String,
}

/// Everything that is applied to a verdict.
#[derive(Clone, Debug, Default)]
pub struct Policy {
    /// In their order: later ones override earlier ones.
    pub weights: Vec<Weight>,
    /// Acceptances of the configuration and of a baseline.
    pub exceptions: Vec<Exception>,
    /// What must be evaluated; later ones lift earlier ones.
    pub required: Vec<Requirement>,
    /// Mistakes that must be found; later ones lift earlier ones.
    pub detections: Vec<Requirement>,
    /// How much must be evaluated.
    pub share: Option<RequiredShare>,
}

/// What is known of a run when the policy is applied to its verdict.
#[derive(Clone, Copy)]
pub struct Context<'a> {
    /// Every source, by id.
    pub sources: &'a [Arc<Source>],
    /// Labels of the platforms, where subjects start with them.
    pub platforms: &'a [String],
    /// Every rule of the tool.
    pub rules: &'a [&'static Page],
    /// Codes of the rules that were run.
    pub asked: &'a BTreeSet<String>,
    /// The path of a source in the baseline, where there is one.
    pub known_as: Option<&'a dyn Fn(&Source) -> String>,
    /// Today.
    pub today: &'a Day,
    /// Whether comments in the sources accept findings.
    pub comments: bool,
}

/// What was applied to one verdict, apart from the marks in it.
#[derive(Clone, Debug, Default)]
pub struct AppliedPolicy {
    applied: Vec<(WaiverEffect, Scope)>,
    misspelt: Vec<CommentFault>,
    unmet: Vec<UnmetRequirement>,
}

/// The results of the policy in a run, apart from the marks in its verdict.
#[derive(Clone, Debug, Default)]
pub struct PolicyResults {
    /// What became of every acceptance.
    pub applied: Vec<WaiverEffect>,
    /// Comments to frames-lint that have no effect.
    pub misspelt: Vec<CommentFault>,
    /// What was required and not evaluated.
    pub unmet: Vec<UnmetRequirement>,
}

/// Applies a policy, and the comments in the sources, to a verdict: everything but requirements.
pub fn apply(verdict: &mut Verdict, policy: &Policy, context: &Context) -> AppliedPolicy {
    let (exceptions, misspelt) = exceptions(policy, context);
    AppliedPolicy {
        applied: mark(verdict, (&policy.weights, exceptions), context),
        misspelt,
        unmet: Vec::new(),
    }
}

/// Everything that is accepted, in comments of the sources and in a policy; and what is wrong with the comments.
pub fn exceptions(policy: &Policy, context: &Context) -> (Vec<Exception>, Vec<CommentFault>) {
    let (mut known, misspelt) = comments::all(context);
    known.extend(policy.exceptions.iter().cloned());
    (known, misspelt)
}

/// Marks in a verdict what is changed and accepted.
pub fn mark(
    verdict: &mut Verdict,
    (weights, exceptions): (&[Weight], Vec<Exception>),
    context: &Context,
) -> Vec<(WaiverEffect, Scope)> {
    verdict.recall();
    weigh(verdict, weights, context);
    let applied = accept(verdict, exceptions, context);
    deference::settle(verdict);
    settle_rows(verdict);
    applied
}

impl AppliedPolicy {
    /// What was required and not evaluated, as far as it is known.
    pub fn unmet(&self) -> &[UnmetRequirement] {
        &self.unmet
    }

    /// Whether anything is accepted, also without a matching finding.
    pub fn accepts(&self) -> bool {
        !self.applied.is_empty()
    }

    /// Adds what is required and was not evaluated in these outcomes or in those of `beside`, and the mistakes that had to be found in these
    /// trials and were not. If they are of one of several recordings, `recording` is its label.
    pub fn demand(
        &mut self,
        ((rows, beside), assured): ((&[Row], &[Row]), &[&Assurance]),
        policy: &Policy,
        recording: Option<&str>,
        context: &Context,
    ) {
        let mut unmet = require::unmet((rows, beside), &policy.required, &mut self.applied, context);
        unmet.extend(detect::undetected(assured, &policy.detections));
        unmet.extend(policy.share.as_ref().and_then(|share| require::too_few(rows, share)));
        self.lack(unmet, recording);
    }

    /// Adds requirements that are not met. If they are of one of several recordings, `recording` is its label.
    pub fn lack(&mut self, unmet: impl IntoIterator<Item = UnmetRequirement>, recording: Option<&str>) {
        for mut one in unmet {
            one.recordings.extend(recording.map(str::to_owned));
            self.unmet.push(one);
        }
    }

    /// Adds what was applied to another verdict of the same run: an acceptance is for both, and what is required of both and was
    /// evaluated in neither for the same reasons is reported once.
    pub fn join(&mut self, other: Self) {
        let key = |one: &WaiverEffect| (one.waiver.kind, one.waiver.origin.clone(), one.waiver.rule.clone());
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

    /// The results when all verdicts of the run are complete.
    pub fn close(self, verdict: &Verdict, context: &Context) -> PolicyResults {
        let mut applied = self.applied;
        for (one, scope) in applied.iter_mut().filter(|(one, _)| one.matched == 0) {
            one.unjudged = scope.unjudged(&one.waiver, verdict, context);
        }
        PolicyResults {
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
fn weigh(verdict: &mut Verdict, weights: &[Weight], context: &Context) {
    let mut off: BTreeMap<(String, String), String> = BTreeMap::new();
    verdict.findings.retain_mut(|finding| {
        let weight = weights.iter().rev().find(|weight| {
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
            row.reason = Some(format!("off for this file ({origin})"));
            row.measured.clear();
        }
    }
}

/// Marks what is accepted. Every acceptance of a finding counts it, although the first one marks it.
fn accept(verdict: &mut Verdict, exceptions: Vec<Exception>, context: &Context) -> Vec<(WaiverEffect, Scope)> {
    let mut applied: Vec<(WaiverEffect, Scope)> = exceptions
        .into_iter()
        .map(|Exception { waiver, scope }| {
            let run_out = waiver.until.as_ref().filter(|until| *until < context.today);
            let expired_days = run_out.map(|until| context.today.days_since(until));
            let applied = WaiverEffect {
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
            // A baseline has one entry for each of several equal findings: an entry that marks nothing remains for the next.
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

    /// Why it is unknown whether there is anything to accept: the rule was not run, or could not be evaluated.
    fn unjudged(&self, waiver: &Waiver, verdict: &Verdict, context: &Context) -> Option<String> {
        let mut asked = context
            .rules
            .iter()
            .filter(|rule| names_rule(&waiver.rule, rule.code, rule.name))
            .filter(|rule| context.asked.contains(rule.code))
            .peekable();
        if asked.peek().is_none() {
            return Some(format!("{} was not run", waiver.rule));
        }
        if let Self::Known(accepted) = self
            && verdict.findings.iter().any(|finding| accepted.was(finding, context))
        {
            return Some("the finding that it accepts has become worse, and counts as new".to_owned());
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
        // If the rule judged other subjects, this one no longer exists: there is nothing to accept.
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

/// Rows whose findings are all accepted are no failures.
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
