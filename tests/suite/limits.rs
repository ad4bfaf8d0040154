//! Every limit of every page counts: moved by a configuration, it moves a decision on the page's own cases.

#![allow(clippy::unwrap_used, clippy::float_cmp)]

use std::fs;

use frames_lint::engine::{Options, Rules};
use frames_lint::page::{self, Limit, Number, Page};
use frames_lint::rules::{Entry, Kind, RULES};
use frames_lint::verdict::Verdict;
use frames_lint::world::World;
use rayon::prelude::*;

use crate::cases::{cases, worlds};

/// Pages whose cases are drives with clouds: minutes of work each, done where `ALL` is set.
const COSTLY: &[&str] = &["CROSS04", "CROSS05", "SENSOR"];

/// What a limit is moved to, in its unit.
fn moved(limit: &Limit) -> Vec<f64> {
    let value = limit.value.as_f64();
    let by = [1000.0, 0.0, 0.5, 2.0, 0.001, -1.0].map(|factor| value * factor);
    let mut all: Vec<f64> = by.into_iter().chain([1.0, 1e9]).collect();
    if matches!(limit.value, Number::Whole(_)) {
        all = all.into_iter().map(f64::round).collect();
    }
    all.retain(|moved| *moved != value);
    all
}

/// What a rule decided, without the numbers.
fn decisions(verdict: &Verdict, code: &str) -> Vec<String> {
    let words = |text: &str| text.replace(|c: char| c.is_ascii_digit() || c == '.' || c == '-', "");
    let rows = verdict.rows.iter().filter(|row| row.rule == code);
    let rows = rows.map(|row| {
        format!(
            "{} {:?} {:?}",
            row.subject,
            row.outcome,
            row.reason.as_deref().map(words)
        )
    });
    let findings = verdict.findings.iter().filter(|finding| finding.rule == code);
    let findings = findings.map(|finding| {
        let (severity, confidence) = (finding.severity, finding.confidence);
        let shown: Vec<&str> = finding.measured.iter().map(|measured| measured.what.as_str()).collect();
        let (places, is_fixed) = (finding.places.len(), finding.fix.is_some());
        format!(
            "{} {severity:?} {confidence:?} {:?} {places} {is_fixed} {shown:?} {:?}",
            finding.subject, finding.relation, finding.unless
        )
    });
    rows.chain(findings).collect()
}

fn rules(select: &[String], limit: Option<String>) -> Option<Rules> {
    let folder = tempfile::tempdir().unwrap();
    let config = folder.path().join("frames-lint.yaml");
    fs::write(&config, limit.unwrap_or_default()).unwrap();
    let options = Options {
        select: select.to_vec(),
        config: Some(config),
        ..Options::default()
    };
    Rules::of(&options).ok()
}

/// The limits of a page that move nothing.
fn idle(page: &Page, select: &[String], worlds: &[World]) -> Vec<String> {
    let code = page.code;
    let usual = rules(select, None).unwrap();
    let mut asked: Vec<(u64, &World, Vec<String>)> = Vec::new();
    for world in worlds {
        let before = decisions(&usual.judge(world), code);
        // Where the rule has no question, no limit moves it.
        let has_no_question =
            |decision: &String| decision.contains("not applicable") || decision.contains("missing input");
        if !before.iter().all(has_no_question) {
            asked.push((world.bags.iter().map(|bag| bag.messages).sum(), world, before));
        }
    }
    // Those with little in them come first: one that moves is enough. By the clock the order would be another one on a busy machine.
    asked.sort_by_key(|(messages, ..)| *messages);
    let is_idle = |limit: &Limit| {
        let name = limit.name;
        let unit = if limit.unit == "1" { "" } else { limit.unit };
        // A value that the rule can't hold is refused.
        let moved: Vec<Rules> = moved(limit)
            .into_iter()
            .filter_map(|value| {
                rules(
                    select,
                    Some(format!("limits: {{{code}: {{{name}: {value} {unit}}}}}\n")),
                )
            })
            .collect();
        let is_moved = |(_, world, before): &(u64, &World, Vec<String>)| {
            moved
                .iter()
                .any(|rules| decisions(&rules.judge(world), code) != *before)
        };
        !asked.iter().any(is_moved)
    };
    let idle = page.limits.iter().filter(|limit| is_idle(limit));
    idle.map(|limit| format!("{code} {}", limit.name)).collect()
}

#[test]
fn every_limit_moves_a_decision_of_its_page() {
    let only = std::env::var("ONLY").unwrap_or_default();
    let all = std::env::var_os("ALL").is_some();
    let is_asked = |code: &str| match only.as_str() {
        "" => all || !COSTLY.iter().any(|pages| code.starts_with(pages)),
        only => only.split(',').any(|asked| code.starts_with(asked)),
    };
    let pages = RULES.iter().map(|entry| entry.page);
    let asked: Vec<&Page> = pages
        .filter(|page| is_asked(page.code) && !page.limits.is_empty())
        .collect();
    let of_page = |page: &&Page| {
        let sections = page::sections(page.body);
        let worlds: Vec<World> = sections.iter().flat_map(cases).flat_map(|case| worlds(&case)).collect();
        // A review speaks of what the other rules found.
        let is_review = |entry: &Entry| entry.code.as_str() == page.code && matches!(entry.kind, Kind::Review(_));
        let select = if RULES.iter().any(is_review) {
            Vec::new()
        } else {
            vec![page.code.to_owned()]
        };
        idle(page, &select, &worlds)
    };
    let mut idle: Vec<String> = asked.par_iter().flat_map_iter(of_page).collect();
    idle.sort();
    assert!(
        idle.is_empty(),
        "{} limits move nothing:\n{}",
        idle.len(),
        idle.join("\n")
    );
}
