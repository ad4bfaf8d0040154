//! Which findings are on the page.

use std::collections::{BTreeMap, BTreeSet};

use crate::run::Run;

/// Maximum number of findings shown in full.
const FULL: usize = 150;
/// Number of findings of each rule shown in full, regardless of the findings of other rules before them.
const FULL_PER_RULE: usize = 3;
/// Maximum number of further findings shown on a line each.
const LISTED: usize = 500;

/// Which findings are on the page, by their index, so that every link has a target.
pub(super) struct ShownFindings {
    full: BTreeSet<usize>,
    listed: BTreeSet<usize>,
}

impl ShownFindings {
    pub(super) fn new(run: &Run) -> Self {
        let mut of_rule: BTreeMap<&str, usize> = BTreeMap::new();
        let (mut full, mut listed) = (BTreeSet::new(), BTreeSet::new());
        for (number, finding) in run.verdict.findings.iter().enumerate() {
            let before = of_rule.entry(&finding.rule).or_default();
            if full.len() < FULL || *before < FULL_PER_RULE {
                full.insert(number);
            } else if listed.len() < LISTED {
                listed.insert(number);
            }
            *before += 1;
        }
        Self { full, listed }
    }

    /// Whether it is shown in full.
    pub(super) fn is_full(&self, number: usize) -> bool {
        self.full.contains(&number)
    }

    /// Whether it is shown on a line.
    pub(super) fn is_listed(&self, number: usize) -> bool {
        self.listed.contains(&number)
    }

    /// Whether it can be linked to.
    pub(super) fn has(&self, number: usize) -> bool {
        self.is_full(number) || self.is_listed(number)
    }
}
