//! What there is to be seen of each rule, and where.

use std::sync::OnceLock;

use serde::Deserialize;

#[derive(Debug, Default, Deserialize)]
#[serde(deny_unknown_fields)]
struct Table {
    rows: Vec<View>,
    nothing: Vec<Nothing>,
}

/// An entity of the views, and what to look for there.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct View {
    /// The entity, or that which it stands beneath: `time/inertial`.
    pub see: String,
    /// What its name, or that of an entity beneath it, holds: `points of`; empty where any will do.
    #[serde(default)]
    pub named: String,
    /// What is to be seen there.
    pub what: String,
    rules: Vec<String>,
}

impl View {
    /// The entity in words: `world/... points of ...`.
    pub fn words(&self) -> String {
        match self.named.trim() {
            "" => self.see.clone(),
            named => format!("{}/... {named} ...", self.see),
        }
    }
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct Nothing {
    because: String,
    rules: Vec<String>,
}

fn table() -> &'static Table {
    static TABLE: OnceLock<Table> = OnceLock::new();
    TABLE.get_or_init(|| serde_yaml::from_str(include_str!("../../rules/tables/views.yaml")).unwrap_or_default())
}

/// Where to look for what a rule judges; `None` where that stands nowhere.
pub fn of(code: &str) -> Option<&'static View> {
    table()
        .rows
        .iter()
        .find(|row| row.rules.iter().any(|rule| rule == code))
}

/// Why there is nothing to be seen of a rule, where that is so.
pub fn nothing(code: &str) -> Option<&'static str> {
    let row = table()
        .nothing
        .iter()
        .find(|row| row.rules.iter().any(|rule| rule == code));
    row.map(|row| row.because.as_str())
}
