//! One mistake, put into one subject and judged.

use std::collections::BTreeSet;

use crate::faults::{Fault, Subject};
use crate::verdict::{Deference, Finding};
use crate::world::World;

use super::base::{Base, Healthy};
use super::miss::Miss;
use super::{RuleRunner, Trial, TrialOutcome};

/// A platform, with all that is found without a mistake.
pub(super) struct Platform<'w> {
    pub(super) base: Base<'w>,
    healthy: Healthy,
}

impl<'w> Platform<'w> {
    pub(super) fn new(world: &'w World, rules: &'w dyn RuleRunner) -> Self {
        Self {
            healthy: Healthy::new(rules.judge(world, &|_| true)),
            base: Base::new(world, rules),
        }
    }

    /// The rules that judge something here, and nothing on another platform.
    pub(super) fn judges_more_than(&self, other: &Self) -> BTreeSet<String> {
        let judged = |platform: &Self| -> BTreeSet<String> {
            let rows = platform
                .healthy
                .verdict
                .rows
                .iter()
                .filter(|row| row.outcome.is_judged());
            rows.map(|row| row.rule.to_string()).collect()
        };
        &judged(self) - &judged(other)
    }

    /// Puts a mistake into a subject; none if that changes nothing.
    pub(super) fn try_one(&self, fault: &'static Fault, subject: &Subject) -> Option<Trial> {
        let mut world = self.base.world.clone();
        if !fault.change.apply(&mut world, subject) {
            return None;
        }
        world.forget();
        let same = fault.change.same_as(self.base.world, subject);
        let trial = |outcome, findings: &[&Finding], miss| {
            let mut rules: Vec<String> = findings.iter().map(|finding| finding.rule.clone()).collect();
            let mut seen = BTreeSet::new();
            rules.retain(|rule| seen.insert(rule.clone()));
            Trial {
                fault,
                platform: self.base.world.label.clone(),
                subject: subject.name.clone(),
                outcome,
                rules,
                relation: findings.first().and_then(|finding| finding.relation.clone()),
                miss,
            }
        };
        // The rules that should see it, first: judging with all of them takes longer, and may only hide a finding behind another.
        let first = self.base.judge(&world, fault.seen_by);
        let healthy = self.base.healthy(fault.seen_by);
        let new = healthy.new_in(&first);
        let is_final = |finding: &&&Finding| {
            fault.is_named_by(finding, &same) && finding.unless.iter().all(|deference| is_among(deference, fault))
        };
        if let Some(named) = new.iter().find(is_final) {
            return Some(trial(TrialOutcome::Named, &[*named], None));
        }
        let altered = self.base.rules.judge(&world, &|_| true);
        let mut new = self.healthy.new_in(&altered);
        new.sort_by_key(|finding| !fault.is_named_by(finding, &same));
        if new.first().is_some_and(|finding| fault.is_named_by(finding, &same)) {
            return Some(trial(TrialOutcome::Named, &new, None));
        }
        if !new.is_empty() {
            return Some(trial(TrialOutcome::Noticed, &new, None));
        }
        let findings = self.healthy.verdict.findings.iter();
        let is_it = |finding: &&Finding| {
            fault.seen_by.has(&finding.rule) && subject.is_in(&finding.subject) && fault.is_named_by(finding, &same)
        };
        let (accepted, present): (Vec<&Finding>, Vec<&Finding>) =
            findings.filter(is_it).partition(|finding| finding.waived.is_some());
        if !present.is_empty() {
            return Some(trial(TrialOutcome::Present, &present, None));
        }
        // What the user accepts is not found.
        let accepted = accepted.first().and_then(|finding| Miss::accepted(finding));
        let miss = accepted.unwrap_or_else(|| {
            let verdicts = [&self.healthy.verdict, &altered];
            Miss::of(self.base.world, fault.seen_by, subject, verdicts, fault.record)
        });
        Some(trial(TrialOutcome::Missed, &[], Some(miss)))
    }
}

/// Whether a finding defers only to rules that should see the mistake.
fn is_among(deference: &Deference, fault: &Fault) -> bool {
    match deference {
        Deference::Rule(code) | Deference::Relation(code) | Deference::With(code, _) | Deference::About(code, _) => {
            fault.seen_by.has(code.as_str())
        }
        Deference::CauseOf(_) => true,
    }
}
