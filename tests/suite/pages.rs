//! The pages of the rules and the rules' code are one: same names, same order, all sections, typed limits.

#![allow(clippy::unwrap_used, clippy::indexing_slicing, clippy::panic)]

use std::collections::BTreeSet;
use std::fs;
use std::path::{Path, PathBuf};

use frames_lint::page::{self, Front};
use frames_lint::rules::RULES;
use frames_lint::tables::recordings;

const SECTIONS: &[&str] = &[
    "What it checks",
    "Why it matters",
    "How it decides",
    "Bad",
    "Good",
    "Not evaluated",
    "How to fix",
    "Not covered",
];

fn root() -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR"))
}

fn fronts() -> Vec<Front> {
    RULES.iter().map(|entry| Front::parse(entry.page).unwrap()).collect()
}

#[test]
fn limits_in_pages_and_code_are_the_same() {
    for entry in RULES {
        let front = Front::parse(entry.page).unwrap();
        if let Err(error) = (entry.check_limits)(&front) {
            panic!("{error}");
        }
        for (name, limit) in &front.limits {
            assert!(
                !limit.unit.is_empty() && !limit.reason.is_empty(),
                "{} {name}",
                front.code
            );
        }
    }
}

#[test]
fn evidence_is_of_known_kinds_and_every_rule_but_those_of_the_gate_names_it() {
    for front in fronts() {
        assert_eq!(front.evidence.is_empty(), front.family() == "GATE", "{}", front.code);
        for kind in &front.evidence {
            assert!(recordings::is_known(kind), "{} {kind}", front.code);
        }
    }
}

#[test]
fn the_head_of_a_page_is_its_front_matter_without_limits_and_references() {
    for entry in RULES {
        let whole = Front::parse(entry.page).unwrap();
        let head = Front::parse_head(entry.page).unwrap();
        let without = Front {
            evidence: head.evidence.clone(),
            limits: head.limits.clone(),
            references: head.references.clone(),
            ..whole
        };
        assert!(head.limits.is_empty() && head.references.is_empty());
        let values = |front: Front| -> Vec<_> {
            let limits = front.limits.into_iter();
            limits.map(|(name, limit)| (name, limit.value)).collect()
        };
        assert_eq!(
            values(Front::parse_limits(entry.page).unwrap()),
            values(Front::parse(entry.page).unwrap())
        );
        assert_eq!(head, without);
    }
}

#[test]
fn pages_have_every_section_in_order() {
    for entry in RULES {
        let front = Front::parse(entry.page).unwrap();
        let (_, body) = page::split(entry.page).unwrap();
        let titles: Vec<_> = page::sections(body).iter().map(|section| section.title).collect();
        assert_eq!(titles, SECTIONS, "{}", front.code);
        assert!(!front.summary.is_empty() && !front.subject.is_empty(), "{}", front.code);
    }
}

#[test]
fn codes_and_names_are_unique_and_codes_are_in_order_within_a_family() {
    let fronts = fronts();
    let codes: BTreeSet<_> = fronts.iter().map(|front| &front.code).collect();
    let names: BTreeSet<_> = fronts.iter().map(|front| &front.name).collect();
    assert_eq!(codes.len(), fronts.len());
    assert_eq!(names.len(), fronts.len());
    for pair in fronts.windows(2) {
        if pair[0].family() == pair[1].family() {
            assert!(pair[0].code < pair[1].code, "{} before {}", pair[0].code, pair[1].code);
        }
    }
}

#[test]
fn pages_and_rules_lie_where_their_names_say() {
    for front in fronts() {
        let family = front.family().to_lowercase();
        let page = root().join("rules").join(&family).join(format!("{}.md", front.name));
        assert!(page.is_file(), "{}", page.display());
        let file = front.name.replace('-', "_");
        let rule = root().join("src/rules").join(&family).join(format!("{file}.rs"));
        assert!(rule.is_file(), "{}", rule.display());
    }
}

#[test]
fn no_page_is_without_a_rule() {
    let known: BTreeSet<String> = fronts().into_iter().map(|front| front.name).collect();
    for file in markdown_files(&root().join("rules")) {
        let stem = file.file_stem().unwrap().to_string_lossy().into_owned();
        assert!(
            stem == "README" || known.contains(&stem),
            "{} has no rule",
            file.display()
        );
    }
}

fn markdown_files(folder: &Path) -> Vec<PathBuf> {
    let mut found = Vec::new();
    for entry in fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() {
            found.extend(markdown_files(&path));
        } else if path.extension().is_some_and(|ending| ending == "md") {
            found.push(path);
        }
    }
    found
}
