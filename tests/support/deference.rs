//! Whether reasons point at rules that speak: with the rules ignored that found something, a run is not clean while a reason names one of
//! them.

use std::collections::BTreeSet;

use frames_lint::engine::{Options, Rules};
use frames_lint::rules::RULES;
use frames_lint::verdict::Verdict;
use frames_lint::world::World;

/// The rules that the reasons of a verdict name, each with the row that does.
fn named(verdict: &Verdict) -> Vec<(&'static str, String)> {
    let rows = verdict
        .rows
        .iter()
        .filter_map(|row| Some((row, row.reason.as_deref()?)));
    rows.flat_map(|(row, reason)| {
        let codes = RULES.iter().map(|entry| entry.code.as_str());
        let named = codes.filter(|code| reason.contains(*code) && *code != row.rule);
        let words = format!("{} of `{}`: {reason}", row.rule, row.subject);
        named.map(move |code| (code, words.clone())).collect::<Vec<_>>()
    })
    .collect()
}

/// Reasons that name a rule which judged nothing.
fn dangling(verdict: &Verdict) -> Vec<String> {
    let has_judged = |code: &str| {
        verdict
            .rows
            .iter()
            .any(|row| row.rule == code && row.outcome.is_judged())
    };
    let dangling = named(verdict).into_iter().filter(|(code, _)| !has_judged(code));
    dangling
        .map(|(code, words)| format!("{code} judged nothing: {words}"))
        .collect()
}

/// What is wrong with a world: with every rule, and without those that spoke.
pub fn faults(world: &World) -> Vec<String> {
    let verdict = Rules::select(&[]).unwrap().judge(world);
    let mut faults = dangling(&verdict);
    let spoke: BTreeSet<String> = verdict.findings.iter().map(|finding| finding.rule.clone()).collect();
    if spoke.is_empty() {
        return faults;
    }
    let options = Options {
        ignore: spoke.iter().cloned().collect(),
        without_config: true,
        ..Options::default()
    };
    let without = Rules::of(&options).unwrap().judge(world);
    faults.extend(dangling(&without));
    if without.findings.is_empty() {
        let named = named(&without).into_iter().filter(|(code, _)| spoke.contains(*code));
        faults.extend(named.map(|(code, words)| format!("clean without {code}: {words}")));
    }
    faults
}
