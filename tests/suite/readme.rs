//! The README shows what the program says, held word for word: the findings of its first command. Its other commands parse.
//!
//! `UPDATE=1 cargo test --test suite readme` writes them anew.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::string_slice)]

use std::path::{Path, PathBuf};

use frames_lint::cli::{self, Surroundings};
use frames_lint::engine::{self, Options};
use frames_lint::report::{Style, terminal};
use frames_lint::run::FailOn;

const BEGIN: &str = "<!-- finding:begin -->";
const END: &str = "<!-- finding:end -->";
const FOLDER: &str = "fixtures/first-finding";

/// The report on the folder, 100 columns wide and without colour.
fn report() -> String {
    // Tests run in the folder of the package, as the README's reader does.
    let run = engine::check(&Options {
        paths: vec![PathBuf::from(FOLDER)],
        ..Options::default()
    })
    .unwrap();
    let style = Style {
        width: Some(100),
        ..Style::PLAIN
    };
    let options = terminal::Options {
        style,
        fail_on: FailOn::Error,
        verbose: false,
        all: false,
        parts: terminal::Parts::All,
    };
    terminal::render(&run, &options)
}

/// Holds the part of the README between two markers, and these, to what the program says; writes it where that is asked for.
fn holds(begin: &str, end: &str, expected: &str) {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("README.md");
    let readme = std::fs::read_to_string(&path).unwrap().replace("\r\n", "\n");
    let from = readme.find(begin).expect("the begin marker") + begin.len();
    let to = readme.find(end).expect("the end marker");
    if std::env::var_os("UPDATE").is_some_and(|value| value == "1") {
        std::fs::write(&path, format!("{}{expected}{}", &readme[..from], &readme[to..])).unwrap();
        return;
    }
    assert_eq!(
        &readme[from..to],
        expected,
        "`UPDATE=1 cargo test --test suite readme` writes it anew"
    );
}

#[test]
fn the_readme_shows_what_the_program_says() {
    let readme = std::fs::read_to_string(Path::new(env!("CARGO_MANIFEST_DIR")).join("README.md")).unwrap();
    assert!(
        readme.contains(&format!("check {FOLDER}\n")),
        "the README's first command"
    );
    holds(BEGIN, END, &format!("\n\n```text\n{}\n```\n\n", report().trim_end()));
}

/// Calls of the program in the code of a text, up to a comment or another command.
fn calls(text: &str) -> Vec<String> {
    let mut calls = Vec::new();
    let mut is_fenced = false;
    for line in text.lines() {
        is_fenced ^= line.starts_with("```");
        let call = line.trim().trim_start_matches("$ ");
        if call.starts_with("frames-lint ") && (is_fenced || line.starts_with("    ")) {
            let call = call.split(['#', '|', '>', '&', ';']).next().unwrap_or_default();
            calls.push(call.trim().replace('\'', ""));
        }
    }
    calls
}

#[test]
fn every_call_that_is_shown_is_one() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let pages = std::fs::read_dir(root.join("docs/src")).unwrap();
    let pages = pages.map(|entry| entry.unwrap().path());
    let pages = pages.filter(|path| path.extension().is_some_and(|ending| ending == "md"));
    let mut count = 0;
    for path in pages.chain([root.join("README.md")]) {
        for call in calls(&std::fs::read_to_string(&path).unwrap()) {
            // The help is shown where everything before it was understood.
            let arguments = call.split_whitespace().chain(["--help"]).map(Into::into);
            let answer = cli::run(arguments, &mut std::io::empty(), Surroundings::detect());
            assert_eq!(answer.code, 0, "{}: `{call}`: {}", path.display(), answer.err);
            count += 1;
        }
    }
    assert!(count > 30, "{count}");
}
