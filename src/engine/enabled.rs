//! A rule that runs.

use std::collections::BTreeMap;

use crate::page::Number;
use crate::rules::Entry;

/// A rule that runs.
pub(super) struct EnabledRule {
    /// The rule.
    pub(super) entry: &'static Entry,
    /// Whether it makes plots.
    pub(super) plots: bool,
    /// Limits set by the user.
    pub(super) overrides: BTreeMap<String, Number>,
}

impl EnabledRule {
    /// A rule by its entry.
    pub(super) fn new(entry: &'static Entry) -> Self {
        Self {
            entry,
            plots: false,
            overrides: BTreeMap::new(),
        }
    }
}
