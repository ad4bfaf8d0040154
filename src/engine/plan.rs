//! Which rules run: selection by code, name and family.

use std::sync::Arc;

use crate::analysis::{KeptResults, Settings};
use crate::config::Config;
use crate::faults::Selection;
use crate::page::{Page, names_rule};
use crate::policy::Requirement;
use crate::rules::{Kind, RULES};
use crate::verdict::unit_factor;

use super::enabled::EnabledRule;
use super::{UsageError, limits};

/// Every rule, in the order of the registry (by code).
fn all() -> Vec<EnabledRule> {
    RULES.iter().map(EnabledRule::new).collect()
}

/// Whether a rule compares the recordings of a platform.
pub(super) fn compares(code: &str) -> bool {
    let entry = RULES.iter().find(|entry| entry.page.code == code);
    entry.is_some_and(|entry| matches!(entry.kind, Kind::Across(_)))
}

/// The rules that run, and the limits of all.
pub(super) struct Choice {
    /// The rules that run.
    pub(super) rules: Vec<EnabledRule>,
    /// The limits in force, including those of rules that do not run: estimates use them too.
    pub(super) settings: Arc<Settings>,
    /// Results that worlds judged by it may share.
    pub(super) kept: KeptResults,
}

impl Choice {
    /// The same rules and limits, without plots.
    pub(super) fn without_plots(&self) -> Self {
        let rules = self.rules.iter().map(|rule| EnabledRule {
            overrides: rule.overrides.clone(),
            ..EnabledRule::new(rule.entry)
        });
        Self {
            rules: rules.collect(),
            settings: Arc::clone(&self.settings),
            kept: KeptResults::default(),
        }
    }
}

fn settings(rules: &[EnabledRule]) -> Settings {
    let mut settings = Settings::default();
    for rule in rules {
        (rule.entry.add_limits)(&mut settings, rule.entry.page, rule.overrides.clone());
    }
    settings
}

/// The rules named by `select` without those named by `ignore`; without a selection here, that of the configuration, else all. Limits are
/// those of the configuration.
pub(super) fn enabled(select: &[String], ignore: &[String], config: Option<&Config>) -> Result<Choice, UsageError> {
    let mut all = all();
    for word in select.iter().chain(ignore) {
        if !all.iter().any(|rule| matches(rule.entry.page, word)) {
            return Err(UsageError(unknown(&all, word)));
        }
    }
    let (mut select, mut ignore) = (select.to_vec(), ignore.to_vec());
    if let Some(config) = config {
        for (word, origin) in config.named_rules() {
            if !all.iter().any(|rule| matches(rule.entry.page, word)) {
                return Err(UsageError(format!("{origin}: {}", unknown(&all, word))));
            }
        }
        for limit in config.limits() {
            limits::set(&mut all, limit)?;
        }
        let (chosen, left_out) = config.rules();
        if select.is_empty() {
            select = chosen.iter().map(|(word, _)| word.clone()).collect();
        }
        ignore.extend(left_out.map(|(word, _)| word.clone()));
    }
    let settings = Arc::new(settings(&all));
    let rules: Vec<EnabledRule> = all
        .into_iter()
        .filter(|rule| select.is_empty() || select.iter().any(|word| matches(rule.entry.page, word)))
        .filter(|rule| !ignore.iter().any(|word| matches(rule.entry.page, word)))
        .collect();
    if rules.is_empty() {
        return Err(UsageError("--select and --ignore leave no rule to run".to_owned()));
    }
    Ok(Choice {
        rules,
        settings,
        kept: KeptResults::default(),
    })
}

/// Whether a word names this rule: its code, its name or its family, in any case.
fn matches(page: &Page, word: &str) -> bool {
    names_rule(word, page.code, page.name)
}

fn unknown(all: &[EnabledRule], word: &str) -> String {
    let lower = word.to_lowercase();
    let nearest = all
        .iter()
        .flat_map(|rule| {
            [
                rule.entry.page.code.to_lowercase(),
                rule.entry.page.name.to_owned(),
                rule.entry.page.family().to_lowercase(),
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

/// Checks that the mistakes that a configuration names exist.
pub(super) fn known_mistakes(config: &Config) -> Result<(), UsageError> {
    for Requirement {
        rule: word,
        smaller_than,
        origin,
        ..
    } in config.detections()
    {
        let wrong = unknown_mistake(word).or_else(|| not_a_size(word, smaller_than.as_ref()?));
        if let Some(what) = wrong {
            return Err(UsageError(format!("{origin}: {what}")));
        }
    }
    Ok(())
}

/// What is wrong with the size of a known mistake.
fn not_a_size(word: &str, (size, unit): &(f64, String)) -> Option<String> {
    let sizes = Selection::of(&[word]).sizes;
    if sizes.is_empty() {
        return Some(format!("the mistake `{word}` has no size: leave out `smaller-than`"));
    }
    if *size <= 0.0 {
        return Some(format!("`smaller-than` must be positive, not {size}"));
    }
    let other = sizes.iter().find(|fault| unit_factor(unit, fault.unit).is_none())?;
    Some(format!(
        "the size of the mistake `{}` has the unit {}: `smaller-than: {size} {}`",
        other.name, other.unit, other.unit
    ))
}

/// What is wrong with a word that is neither the name of a known mistake nor a family of them.
pub fn unknown_mistake(word: &str) -> Option<String> {
    let known = Selection::words();
    if known.iter().any(|name| name.eq_ignore_ascii_case(word)) {
        return None;
    }
    let meant = nearest(word, &known).map_or_else(|| ";".to_owned(), |name| format!("; did you mean `{name}`?"));
    Some(format!(
        "no known mistake is called `{word}`{meant} `frames-lint assure --list` lists all"
    ))
}

/// The most similar known word, if it is similar enough.
pub fn nearest<'a>(word: &str, known: &[&'a str]) -> Option<&'a str> {
    let word = word.to_lowercase();
    known
        .iter()
        .map(|name| {
            (
                strsim::normalized_damerau_levenshtein(&word, &name.to_lowercase()),
                name,
            )
        })
        .filter(|(likeness, _)| *likeness >= 0.5)
        .max_by(|a, b| a.0.total_cmp(&b.0).then_with(|| b.1.cmp(a.1)))
        .map(|(_, name)| *name)
}
