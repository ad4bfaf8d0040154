//! A world that is judged with and without mistakes.

use std::collections::BTreeMap;
use std::sync::{Arc, Mutex, PoisonError};

use crate::faults::Seers;
use crate::source::Confidence;
use crate::verdict::{Finding, Verdict};
use crate::world::World;

use super::RuleRunner;

/// A finding, whatever its numbers.
type Key = (String, String, Option<String>);

fn key(finding: &Finding) -> Key {
    (finding.rule.clone(), finding.subject.clone(), finding.relation.clone())
}

/// What is found without a mistake.
pub(super) struct Healthy {
    pub(super) verdict: Verdict,
    keys: Vec<Key>,
}

impl Healthy {
    pub(super) fn new(verdict: Verdict) -> Self {
        let keys = verdict.findings.iter().map(key).collect();
        Self { verdict, keys }
    }

    /// The findings of another verdict that are not among these; hints left out, and what the user accepts.
    pub(super) fn new_in<'v>(&self, altered: &'v Verdict) -> Vec<&'v Finding> {
        let mut known: BTreeMap<&Key, usize> = BTreeMap::new();
        for key in &self.keys {
            *known.entry(key).or_default() += 1;
        }
        let is_new = |finding: &&Finding| match known.get_mut(&key(finding)) {
            Some(count) if *count > 0 => {
                *count -= 1;
                false
            }
            _ => true,
        };
        let new = altered.findings.iter().filter(is_new);
        let counts = |finding: &&Finding| finding.confidence > Confidence::Hint && finding.waived.is_none();
        new.filter(counts).collect()
    }
}

/// A world, and what some rules find in it without a mistake.
pub(super) struct Base<'w> {
    pub(super) world: &'w World,
    pub(super) rules: &'w dyn RuleRunner,
    healthy: Mutex<BTreeMap<&'static [&'static str], Arc<Healthy>>>,
}

impl<'w> Base<'w> {
    pub(super) fn new(world: &'w World, rules: &'w dyn RuleRunner) -> Self {
        Self {
            world,
            rules,
            healthy: Mutex::default(),
        }
    }

    /// What these rules find in a world.
    pub(super) fn judge(&self, world: &World, seers: Seers) -> Verdict {
        self.rules.judge(world, &|code| seers.has(code))
    }

    /// What these rules find without a mistake; made once.
    pub(super) fn healthy(&self, seers: Seers) -> Arc<Healthy> {
        let mut known = self.healthy.lock().unwrap_or_else(PoisonError::into_inner);
        let made = known
            .entry(seers.0)
            .or_insert_with(|| Arc::new(Healthy::new(self.judge(self.world, seers))));
        Arc::clone(made)
    }
}
