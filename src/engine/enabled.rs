//! A rule that runs.

use std::collections::BTreeMap;

use crate::page::{Front, PageError};
use crate::rules::Entry;

/// A rule that runs, with its page's front matter.
pub(super) struct Enabled {
    /// The front matter of its page, without limits and references.
    pub(super) front: Front,
    /// The rule.
    pub(super) entry: &'static Entry,
    /// Whether it makes plots.
    pub(super) plots: bool,
    /// Limits of the user's own.
    pub(super) overrides: BTreeMap<String, serde_yaml::Value>,
}

impl Enabled {
    /// A rule by its entry.
    pub(super) fn new(entry: &'static Entry) -> Result<Self, PageError> {
        Ok(Self {
            front: Front::parse_head(entry.page)?,
            entry,
            plots: false,
            overrides: BTreeMap::new(),
        })
    }
}
