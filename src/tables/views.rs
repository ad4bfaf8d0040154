//! What is visible of rules in the views, and where.

use std::sync::LazyLock;

use serde::Deserialize;

use super::table;

/// An entity of the views, and what it shows.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct View {
    /// Its name in the pages of rules.
    pub id: String,
    /// The entity, or the one above it: `time/inertial`; `None` if there is nothing visible.
    #[serde(default)]
    pub see: Option<String>,
    /// A part of its name, or of an entity below it: `points of`; empty for any name.
    #[serde(default)]
    pub named: String,
    /// What is visible there, or why nothing is.
    pub what: String,
}

impl View {
    /// The entity in words, if there is one: `world/... points of ...`.
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
