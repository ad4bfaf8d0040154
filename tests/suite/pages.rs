//! The pages of the rules and the rules' code are one: same names, same order, all sections, typed limits.

#![allow(clippy::unwrap_used, clippy::indexing_slicing, clippy::panic)]

use std::collections::{BTreeMap, BTreeSet};
use std::path::PathBuf;

use frames_lint::page::{self, Page};
use frames_lint::rules::RULES;
use frames_lint::tables::recordings;

use crate::support::files;

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

fn pages() -> Vec<&'static Page> {
    RULES.iter().map(|entry| entry.page).collect()
}

#[test]
fn limits_in_pages_and_code_are_the_same() {
    for entry in RULES {
        if let Err(error) = (entry.check_limits)(entry.page, &BTreeMap::new()) {
            panic!("{error}");
        }
        for limit in entry.page.limits {
            let is_said = !limit.unit.is_empty() && !limit.reason.is_empty();
            assert!(is_said, "{} {}", entry.page.code, limit.name);
        }
    }
}

#[test]
fn evidence_is_of_known_kinds_and_every_rule_but_those_of_the_gate_names_it() {
    for page in pages() {
        assert_eq!(page.evidence.is_empty(), page.family() == "GATE", "{}", page.code);
        for kind in page.evidence {
            assert!(recordings::is_known(kind), "{} {kind}", page.code);
        }
    }
}

#[test]
fn pages_have_every_section_in_order() {
    for page in pages() {
        let titles: Vec<_> = page::sections(page.body).iter().map(|section| section.title).collect();
        assert_eq!(titles, SECTIONS, "{}", page.code);
        assert!(!page.summary.is_empty() && !page.subject.is_empty(), "{}", page.code);
    }
}

#[test]
fn codes_and_names_are_unique_and_codes_are_in_order_within_a_family() {
    let pages = pages();
    let codes: BTreeSet<_> = pages.iter().map(|page| page.code).collect();
    let names: BTreeSet<_> = pages.iter().map(|page| page.name).collect();
    assert_eq!(codes.len(), pages.len());
    assert_eq!(names.len(), pages.len());
    for pair in pages.windows(2) {
        if pair[0].family() == pair[1].family() {
            assert!(pair[0].code < pair[1].code, "{} before {}", pair[0].code, pair[1].code);
        }
    }
}

#[test]
fn pages_and_rules_lie_where_their_names_say() {
    for page in pages() {
        let family = page.family().to_lowercase();
        let text = root().join("rules").join(&family).join(format!("{}.md", page.name));
        assert!(text.is_file(), "{}", text.display());
        let file = page.name.replace('-', "_");
        let rule = root().join("src/rules").join(&family).join(format!("{file}.rs"));
        assert!(rule.is_file(), "{}", rule.display());
    }
}

#[test]
fn no_page_is_without_a_rule() {
    let known: BTreeSet<&str> = pages().into_iter().map(|page| page.name).collect();
    for file in files(&root().join("rules"), ".md") {
        let stem = file.file_stem().unwrap().to_string_lossy().into_owned();
        assert!(
            stem == "README" || known.contains(stem.as_str()),
            "{} has no rule",
            file.display()
        );
    }
}
