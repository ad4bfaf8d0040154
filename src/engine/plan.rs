//! Which rules run: selection by code, name and family.

use std::sync::OnceLock;

use crate::page::{Front, PageError};
use crate::rules::{Entry, RULES};

use super::UsageError;

/// A rule that runs, with its page's front matter.
pub(super) struct Enabled {
    /// The front matter of its page, without limits and references.
    pub(super) front: Front,
    /// The rule.
    pub(super) entry: &'static Entry,
    whole: OnceLock<Result<Front, PageError>>,
}

impl Enabled {
    /// A rule by its entry.
    pub(super) fn new(entry: &'static Entry) -> Result<Self, PageError> {
        Ok(Self {
            front: Front::parse_head(entry.page)?,
            entry,
            whole: OnceLock::new(),
        })
    }

    /// The front matter with its limits, read when the rule is first asked.
    pub(super) fn whole(&self) -> Result<&Front, PageError> {
        if !self.entry.page.contains("\nlimits:") {
            return Ok(&self.front);
        }
        self.whole
            .get_or_init(|| Front::parse_limits(self.entry.page))
            .as_ref()
            .map_err(Clone::clone)
    }
}

/// Every rule of the tool, in code order of the catalogue.
pub(super) fn all() -> Result<Vec<Enabled>, UsageError> {
    RULES
        .iter()
        .map(|entry| {
            Enabled::new(entry)
                .map_err(|error| UsageError(format!("a rule's page is broken: {error}: {:.60}", entry.page)))
        })
        .collect()
}

/// The rules named by `select` (all where it is empty) without those named by `ignore`.
pub(super) fn enabled(select: &[String], ignore: &[String]) -> Result<Vec<Enabled>, UsageError> {
    let all = all()?;
    for word in select.iter().chain(ignore) {
        if !all.iter().any(|rule| matches(&rule.front, word)) {
            return Err(UsageError(unknown(&all, word)));
        }
    }
    let chosen: Vec<Enabled> = all
        .into_iter()
        .filter(|rule| select.is_empty() || select.iter().any(|word| matches(&rule.front, word)))
        .filter(|rule| !ignore.iter().any(|word| matches(&rule.front, word)))
        .collect();
    if chosen.is_empty() {
        return Err(UsageError("--select and --ignore leave no rule to run".to_owned()));
    }
    Ok(chosen)
}

/// Whether a word names this rule: its code, its name or its family, in any case.
fn matches(front: &Front, word: &str) -> bool {
    [front.code.as_str(), front.name.as_str(), front.family()]
        .iter()
        .any(|known| known.eq_ignore_ascii_case(word))
}

fn unknown(all: &[Enabled], word: &str) -> String {
    let lower = word.to_lowercase();
    let nearest = all
        .iter()
        .flat_map(|rule| {
            [
                rule.front.code.to_lowercase(),
                rule.front.name.clone(),
                rule.front.family().to_lowercase(),
            ]
        })
        .map(|known| (strsim::damerau_levenshtein(&known, &lower), known))
        .min();
    match nearest {
        Some((distance, known)) if distance <= 3 => {
            format!("no rule and no family is called `{word}`; did you mean `{known}`?")
        }
        _ => format!("no rule and no family is called `{word}`; `frames-lint rules` lists them"),
    }
}
