//! Every limit of every page counts: moved by a configuration, it moves a decision on the page's own cases.

#![allow(clippy::unwrap_used, clippy::float_cmp)]

use std::fs;

use frames_lint::engine::{Options, Rules};
use frames_lint::page::{self, Front, Limit};
use frames_lint::rules::{Kind, RULES};
use frames_lint::verdict::Verdict;
use frames_lint::world::World;
use rayon::prelude::*;

use crate::cases::{cases, worlds};

/// What a limit is moved to, in its unit.
fn moved(limit: &Limit) -> Vec<f64> {
    let value = limit.value.as_f64().unwrap();
    let by = [1000.0, 0.0, 0.001, 0.1, 10.0, 0.5, 2.0, 0.9, 1.1, -1.0].map(|factor| value * factor);
    let mut all: Vec<f64> = by.into_iter().chain([1.0, 1e9]).collect();
    if !limit.value.is_f64() {
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
        format!("{} {severity:?} {confidence:?} {:?}", finding.subject, finding.relation)
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
    // A value that the rule can't hold is refused.
    Rules::of(&options).ok()
}

/// The limits of a page that move nothing.
fn idle(front: &Front, select: &[String], worlds: &[World]) -> Vec<String> {
    let code = front.code.as_str();
    let all = |rules: &Rules| {
        worlds
            .iter()
            .map(|world| decisions(&rules.judge(world), code))
            .collect::<Vec<_>>()
    };
    let before = all(&rules(select, None).unwrap());
    let is_idle = |name: &str, limit: &Limit| {
        let unit = if limit.unit == "1" { "" } else { &limit.unit };
        moved(limit).into_iter().all(|value| {
            let config = format!("limits: {{{code}: {{{name}: {value} {unit}}}}}\n");
            let Some(rules) = rules(select, Some(config)) else {
                return true;
            };
            let mut worlds = worlds.iter().zip(&before);
            worlds.all(|(world, before)| decisions(&rules.judge(world), code) == *before)
        })
    };
    let idle = front.limits.iter().filter(|(name, limit)| is_idle(name, limit));
    idle.map(|(name, _)| format!("{code} {name}")).collect()
}

#[test]
fn every_limit_moves_a_decision_of_its_page() {
    let only = std::env::var("ONLY").unwrap_or_default();
    let is_asked = |code: &str| only.is_empty() || only.split(',').any(|asked| code.starts_with(asked));
    let entries: Vec<_> = RULES.iter().filter(|entry| is_asked(entry.code.as_str())).collect();
    let of_page = |entry: &&&frames_lint::rules::Entry| {
        let front = Front::parse(entry.page).unwrap();
        if front.limits.is_empty() {
            return Vec::new();
        }
        let (_, body) = page::split(entry.page).unwrap();
        let sections = page::sections(body);
        let worlds: Vec<World> = sections.iter().flat_map(cases).flat_map(|case| worlds(&case)).collect();
        // A review speaks of what the other rules found.
        let select = match entry.kind {
            Kind::Review(_) => Vec::new(),
            _ => vec![front.code.clone()],
        };
        idle(&front, &select, &worlds)
    };
    let mut idle: Vec<String> = entries.par_iter().flat_map_iter(|entry| of_page(&entry)).collect();
    idle.sort();
    assert!(
        idle.is_empty(),
        "{} limits move nothing:\n{}",
        idle.len(),
        idle.join("\n")
    );
}
