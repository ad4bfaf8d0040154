//! The README shows what the program says: the findings of its first command, held word for word.
//!
//! `UPDATE=1 cargo test --test suite readme` writes them anew.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::string_slice)]

use std::path::{Path, PathBuf};

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
    };
    terminal::render(&run, &options)
}

#[test]
fn the_first_command_says_what_the_readme_shows() {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("README.md");
    let readme = std::fs::read_to_string(&path).unwrap().replace("\r\n", "\n");
    assert!(
        readme.contains(&format!("check {FOLDER}\n")),
        "the README's first command"
    );
    let from = readme.find(BEGIN).expect("the begin marker") + BEGIN.len();
    let to = readme.find(END).expect("the end marker");
    let expected = format!("\n\n```text\n{}\n```\n\n", report().trim_end());
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
