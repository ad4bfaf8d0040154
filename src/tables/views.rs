//! What there is to be seen of rules, and where.

use std::sync::LazyLock;

use serde::Deserialize;

use super::table;

/// An entity of the views, and what to look for there.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct View {
    /// What the pages of rules call it.
    pub id: String,
    /// The entity, or that which it stands beneath: `time/inertial`; `None` where there is nothing to be seen.
    #[serde(default)]
    pub see: Option<String>,
    /// What its name, or that of an entity beneath it, holds: `points of`; empty where any will do.
    #[serde(default)]
    pub named: String,
    /// What is to be seen there, or why nothing is.
    pub what: String,
}

impl View {
    /// The entity in words, where there is one: `world/... points of ...`.
    pub fn words(&self) -> Option<String> {
        let see = self.see.as_ref()?;
        Some(match self.named.trim() {
            "" => see.clone(),
            named => format!("{see}/... {named} ..."),
        })
    }
}

/// The view that a page names.
pub fn of(id: &str) -> Option<&'static View> {
    static TABLE: LazyLock<Vec<View>> = LazyLock::new(|| table!("views").unwrap_or_default());
    TABLE.iter().find(|view| view.id == id)
}
