//! What users read is written in the terms of the field: words that the glossary of CONTRIBUTING.md has retired stay away, and headlines are short.

#![allow(clippy::unwrap_used)]

use std::fs;
use std::path::PathBuf;

use frames_lint::engine::{self, Options};
use frames_lint::page;
use frames_lint::rules::RULES;
use tree_sitter::{Node, Parser};

use crate::cases::{cases, laid_out};
use crate::support::files;

/// Phrases that nobody reads at once.
const RETIRED: &[&str] = &[
    "at odds with",
    "blanks",
    "by its word",
    "does not speak",
    "held against",
    "in its place stands",
    "is told",
    "are told",
    "was told",
    "told by",
    "told in",
    "left by the relation",
    "looks alike",
    "mend",
    "mended",
    "of length one",
    "on its head",
    "put right",
    "slip of the pen",
    "somebody",
    "stands in",
    "tells",
    "the wrong way round",
    "to be seen",
    "turned out",
    "waits for nothing",
    "what is left",
    "where it sits",
];

/// Characters of a headline, where a name in backticks counts as no more than this many.
const LONGEST_HEADLINE: usize = 100;
const NAME: usize = 16;

fn root() -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR"))
}

/// The string literals of a program, but for those of its tests.
fn literals(node: Node<'_>, text: &str, found: &mut Vec<(usize, String)>) {
    let of = |node: Node<'_>| text.get(node.byte_range()).unwrap_or_default().to_owned();
    let is_test = node.kind() == "mod_item" && node.child_by_field_name("name").is_some_and(|name| of(name) == "tests");
    if is_test {
        return;
    }
    if node.kind().ends_with("string_literal") {
        found.push((node.start_position().row + 1, of(node)));
    }
    let mut cursor = node.walk();
    for child in node.children(&mut cursor) {
        literals(child, text, found);
    }
}

/// Lines of a document without its fenced blocks and the rows of its tables of words.
fn prose(text: &str, has_glossary: bool) -> Vec<(usize, String)> {
    let mut is_fenced = false;
    let lines = text.lines().zip(1..).filter_map(|(line, number)| {
        is_fenced ^= line.starts_with("```");
        let is_row = has_glossary && line.starts_with('|');
        (!is_fenced && !is_row).then(|| (number, line.to_owned()))
    });
    lines.collect()
}

fn holds(text: &str, phrase: &str) -> bool {
    let is_part = |c: Option<char>| c.is_some_and(|c| c.is_alphanumeric() || c == '_' || c == '{');
    text.match_indices(phrase).any(|(at, _)| {
        let (before, behind) = (
            text.get(..at).unwrap_or_default(),
            text.get(at + phrase.len()..).unwrap_or_default(),
        );
        !is_part(before.chars().next_back()) && !is_part(behind.chars().next())
    })
}

#[test]
fn retired_words_stay_out_of_what_users_read() {
    let root = root();
    let mut texts: Vec<(PathBuf, usize, String)> = Vec::new();
    let mut parser = Parser::new();
    parser.set_language(&tree_sitter_rust::LANGUAGE.into()).unwrap();
    for path in files(&root.join("src"), ".rs") {
        let is_test = path.components().any(|part| part.as_os_str() == "tests")
            || path
                .file_stem()
                .is_some_and(|stem| stem.to_string_lossy().contains("tests"));
        if is_test {
            continue;
        }
        let text = fs::read_to_string(&path).unwrap();
        let mut found = Vec::new();
        literals(parser.parse(&text, None).unwrap().root_node(), &text, &mut found);
        texts.extend(found.into_iter().map(|(line, text)| (path.clone(), line, text)));
    }
    let documents = [
        "README.md",
        "CHANGELOG.md",
        "SECURITY.md",
        "ARCHITECTURE.md",
        "CONTRIBUTING.md",
    ];
    let documents = documents.iter().map(|name| root.join(name));
    let pages = [files(&root.join("rules"), ".md"), files(&root.join("docs/src"), ".md")].concat();
    for path in documents.chain(pages) {
        let text = fs::read_to_string(&path).unwrap();
        let lines = prose(&text, path.ends_with("CONTRIBUTING.md"));
        texts.extend(lines.into_iter().map(|(line, text)| (path.clone(), line, text)));
    }
    assert!(texts.len() > 10_000, "{}", texts.len());
    let mut found = Vec::new();
    for (path, line, text) in texts {
        let text = text.to_lowercase().split_whitespace().collect::<Vec<_>>().join(" ");
        for phrase in RETIRED.iter().filter(|phrase| holds(&text, phrase)) {
            let path = path.strip_prefix(&root).unwrap().display();
            found.push(format!("{path}:{line}: \"{phrase}\" in {text}"));
        }
    }
    assert!(found.is_empty(), "{} places\n{}", found.len(), found.join("\n"));
}

/// The length of a headline that does not depend on how long the user's names are.
fn length(headline: &str) -> usize {
    let part = |(number, part): (usize, &str)| {
        let length = part.chars().count();
        if number % 2 == 1 { length.min(NAME) } else { length }
    };
    headline.split('`').enumerate().map(part).sum()
}

#[test]
fn headlines_are_one_short_sentence() {
    let mut long = Vec::new();
    let mut count = 0;
    for page in RULES.iter().map(|entry| entry.page) {
        let sections = page::sections(page.body);
        let bad = sections.iter().find(|section| section.title == "Bad").unwrap();
        for case in cases(bad) {
            let folder = laid_out(&case);
            let options = Options {
                paths: vec![folder.path().to_owned()],
                select: vec![page.code.to_owned()],
                ..Options::default()
            };
            for finding in engine::check(&options).unwrap().verdict.findings {
                count += 1;
                if length(&finding.message) > LONGEST_HEADLINE || finding.message.contains(". ") {
                    long.push(format!(
                        "{} {}: {}",
                        finding.rule,
                        length(&finding.message),
                        finding.message
                    ));
                }
            }
        }
    }
    assert!(count > RULES.len(), "{count}");
    assert!(long.is_empty(), "{} of {count}\n{}", long.len(), long.join("\n"));
}
