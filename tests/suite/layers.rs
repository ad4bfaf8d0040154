//! Who may use whom: reads the `crate::` paths of every file and fails on an arrow that points the wrong way.

#![allow(clippy::unwrap_used)]

use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};

/// For each room of the house, the rooms it may use besides itself.
fn allowed() -> BTreeMap<&'static str, &'static [&'static str]> {
    BTreeMap::from([
        ("math", &[] as &[&str]),
        ("source", &[]),
        ("tables", &[]),
        // What is known of devices is part of a world, for the user may add to it.
        ("world", &["source", "math", "tables"]),
        ("verdict", &["source"]),
        ("page", &["source", "verdict"]),
        ("read", &["source", "world", "math", "tables"]),
        ("collect", &["source", "world", "read", "math"]),
        ("analysis", &["source", "world", "verdict", "math", "tables"]),
        (
            "advice",
            &["source", "world", "verdict", "math", "tables", "analysis", "rules"],
        ),
        (
            "rules",
            &[
                "source", "world", "verdict", "page", "math", "tables", "analysis", "advice",
            ],
        ),
        ("run", &["source", "world", "verdict", "page"]),
        (
            "report",
            &["source", "world", "verdict", "page", "run", "compare", "view", "tables"],
        ),
        ("compare", &["source", "world", "verdict", "run", "math", "tables"]),
        ("progress", &[]),
        // A fault in the configuration has a place, and the reader of documents knows places.
        (
            "config",
            &["source", "world", "read", "tables", "verdict", "run", "gate"],
        ),
        ("fix", &["source", "verdict", "run"]),
        ("gate", &["source", "world", "verdict", "page", "run"]),
        ("view", &["source", "world", "verdict", "run", "math", "tables"]),
        (
            "engine",
            &[
                "source", "world", "verdict", "page", "rules", "analysis", "read", "collect", "config", "run",
                "progress", "gate", "tables",
            ],
        ),
        ("convert", &["run", "world", "source", "tables", "math"]),
        (
            "cli",
            &[
                "engine", "report", "run", "verdict", "page", "rules", "convert", "tables", "config", "fix", "compare",
                "view",
            ],
        ),
    ])
}

fn rust_files(folder: &Path, found: &mut Vec<PathBuf>) {
    for entry in fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() {
            rust_files(&path, found);
        } else if path.extension().is_some_and(|ending| ending == "rs") {
            found.push(path);
        }
    }
}

/// The rooms named after `crate::` in a file, with line numbers. Comments count too: a doc link is an arrow for the reader.
fn used_rooms(text: &str) -> Vec<(usize, String)> {
    let mut used = Vec::new();
    for (number, line) in text.lines().enumerate() {
        let line = line.split("//").next().unwrap_or("");
        for part in line.split("crate::").skip(1) {
            let names: Vec<String> = match part.strip_prefix('{') {
                Some(list) => list.split(',').map(first_word).collect(),
                None => vec![first_word(part)],
            };
            used.extend(
                names
                    .into_iter()
                    .filter(|name| !name.is_empty())
                    .map(|name| (number + 1, name)),
            );
        }
    }
    used
}

fn first_word(text: &str) -> String {
    text.trim()
        .chars()
        .take_while(|c| c.is_alphanumeric() || *c == '_')
        .collect()
}

#[test]
fn arrows_point_one_way() {
    let src = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("src");
    let mut files = Vec::new();
    rust_files(&src, &mut files);
    files.sort();
    let allowed = allowed();
    let mut wrong = Vec::new();
    for file in files {
        let relative = file.strip_prefix(&src).unwrap();
        let first = relative
            .components()
            .next()
            .unwrap()
            .as_os_str()
            .to_string_lossy()
            .into_owned();
        let room = first.trim_end_matches(".rs").to_owned();
        if room == "lib" || room == "main" {
            continue;
        }
        let Some(may_use) = allowed.get(room.as_str()) else {
            wrong.push(format!("{}: `{room}` is no room of the house", relative.display()));
            continue;
        };
        let text = fs::read_to_string(&file).unwrap();
        let production = text.split("\nmod tests {").next().unwrap_or(&text);
        for (line, used) in used_rooms(production) {
            if used != room && !may_use.contains(&used.as_str()) {
                wrong.push(format!("{}:{line}: `{room}` uses `{used}`", relative.display()));
            }
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

#[test]
fn the_test_sees_an_arrow() {
    assert_eq!(
        used_rooms("use crate::{read, world::Claim};"),
        [(1, "read".to_owned()), (1, "world".to_owned())]
    );
    assert_eq!(
        used_rooms("// crate::read\nlet x = crate::math::f();"),
        [(2, "math".to_owned())]
    );
}

#[test]
fn only_one_file_knows_the_terminal_renderer() {
    let src = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("src");
    let mut files = Vec::new();
    rust_files(&src, &mut files);
    let knowing: Vec<String> = files
        .iter()
        .filter(|file| fs::read_to_string(file).unwrap().contains("miette::"))
        .map(|file| file.strip_prefix(&src).unwrap().display().to_string())
        .collect();
    assert_eq!(knowing, ["report/terminal/snippet.rs"]);
}
