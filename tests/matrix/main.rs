//! Convention errors, put one at a time into every real recording that has the streams for it: the matrix of recordings and
//! errors.
//!
//! ```text
//! FRAMES_LINT_BAGS=folder cargo test --profile rates --test matrix -- --ignored --nocapture
//! ```
//!
//! prints the matrix, and why a cell was not evaluated. Recordings are read wholly, once; errors are put into their evidence,
//! whose rows are means of messages, number by number, so that orders, signs and units of the numbers commute with them. A
//! recording that lies beside others is judged with them, as a user gets it. What no recording at hand says (where the map lies on
//! the Earth, a lidar beside the sensor, what a lidar sees on the way of the poses, a camera in an optical frame, a simulator's name) is staged beside its evidence first, rightly, and must be passed so. `MATRIX_ONLY` is words of recordings and errors
//! that are tried, with commas between them (all).

#![allow(
    clippy::unwrap_used,
    clippy::panic,
    clippy::indexing_slicing,
    clippy::print_stdout,
    clippy::float_cmp,
    clippy::cast_possible_truncation,
    clippy::cast_possible_wrap,
    clippy::cast_sign_loss,
    clippy::format_push_string,
    unreachable_pub,
    missing_docs
)]

#[path = "../support/mod.rs"]
mod support;

mod cameras;
mod cells;
mod corrected;
mod errors;
mod lidars;
mod stages;
mod streams;
mod table;

use std::collections::BTreeMap;
use std::sync::Arc;

use cells::Cell;
use frames_lint::engine::{self, Extent, Options, Rules};
use frames_lint::faults::Family;
use frames_lint::world::World;

/// A row of the matrix: the streams of one kind of one recording.
struct Line {
    name: String,
    cells: BTreeMap<&'static str, Cell>,
}

#[test]
#[ignore = "some minutes, and a folder of recordings"]
fn errors_in_real_recordings_are_named_or_not_evaluated() {
    let folder = support::real_bags().unwrap();
    let run = engine::collect(&Options {
        paths: vec![folder],
        extent: Extent {
            full: true,
            ..Extent::default()
        },
        ..Options::default()
    })
    .unwrap();
    let only = std::env::var("MATRIX_ONLY").unwrap_or_default();
    let only: Vec<&str> = only.split(',').filter(|word| !word.is_empty()).collect();
    let rules = Rules::select(&[]).unwrap();
    let (mut lines, mut unjudged) = (Vec::new(), Vec::new());
    let sources = Arc::new(run.sources);
    for mut world in run.worlds {
        world.sources = Arc::clone(&sources);
        for told in corrected::correct(&mut world) {
            println!("fixed: {told}");
        }
        unjudged.extend(unjudged_of(&world, &rules));
        lines.extend(of_world(&world, &rules, &only));
    }
    let reasons = print(&lines);
    let bad: Vec<&String> = reasons
        .iter()
        .filter(|reason| reason.starts_with('M') || reason.starts_with('W'))
        .collect();
    assert!(bad.is_empty(), "{} cells are missed or wrong", bad.len());
    assert!(unjudged.is_empty(), "without an error: {unjudged:?}");
}

/// Findings without any error, of rules that see errors, which are not known to be true.
fn unjudged_of(world: &World, rules: &Rules) -> Vec<String> {
    if corrected::left_out(world).is_some() {
        return Vec::new();
    }
    let is_seer = |rule: &str| errors::all().any(|error| error.fault.seen_by.iter().any(|seen| seen.starts_with(rule)));
    let verdict = rules.judge(world);
    let mut unjudged = Vec::new();
    for finding in verdict.findings.iter().filter(|finding| is_seer(&finding.rule)) {
        let told = format!("{}: {} {}", world.label, finding.rule, finding.message);
        if let Some(why) = corrected::why_true(world, &finding.rule) {
            println!("without an error: {told}\n    true: {why}");
        } else {
            println!("without an error: {told}\n    not judged");
            unjudged.push(told);
        }
    }
    unjudged
}

fn of_world(world: &World, rules: &Rules, only: &[&str]) -> Vec<Line> {
    let mut lines = Vec::new();
    if let Some(why) = corrected::left_out(world) {
        println!("left out: {}: {why}", world.label);
        return lines;
    }
    for stream in streams::all(world) {
        let path = world.path(world.bags[stream.bag].source);
        let name = format!("{} {}", short(path), streams::name(&stream));
        let mut cells = BTreeMap::new();
        let judged = cells::Judged::of(world, &stream, rules);
        for error in errors::all() {
            let is_meant = |word: &&str| name.contains(*word) || error.fault.name == *word;
            if !only.is_empty() && !only.iter().any(is_meant) {
                continue;
            }
            if let Some(cell) = judged.with(error) {
                cells.insert(error.fault.name, cell);
            }
        }
        if !cells.is_empty() {
            lines.push(Line { name, cells });
        }
    }
    lines
}

/// The last two names of a path, without what all of them end in.
fn short(path: &str) -> String {
    let path = path.trim_end_matches("/metadata.yaml");
    let names: Vec<&str> = path.rsplit('/').take(2).collect();
    let stem = names[0].rsplit_once('.').map_or(names[0], |(stem, _)| stem);
    if stem.len() > 6 {
        stem.to_owned()
    } else {
        format!("{}/{stem}", names[1])
    }
}

/// Prints the matrix, a kind of stream after the other; gives the legend of what is neither named nor lacks streams.
fn print(lines: &[Line]) -> Vec<String> {
    let mut reasons = Vec::new();
    for kind in [Family::Imu, Family::Pose, Family::Fix, Family::Camera].map(Family::word) {
        let lines: Vec<&Line> = lines
            .iter()
            .filter(|line| line.name.contains(&format!(" {kind} ")))
            .collect();
        println!("\n## {kind}\n");
        for (number, line) in lines.iter().enumerate() {
            println!("{:3}  {}", number + 1, line.name);
        }
        let numbers: Vec<String> = (1..=lines.len()).map(|number| format!("{number:4}")).collect();
        println!("\n{:24}{}", "", numbers.concat());
        for error in errors::all().filter(|error| lines.iter().any(|line| line.cells.contains_key(error.fault.name))) {
            let mut row = String::new();
            for (number, line) in lines.iter().enumerate() {
                let Some(cell) = line.cells.get(error.fault.name) else {
                    row.push_str("   .");
                    continue;
                };
                let letter = cell.letter();
                row.push_str(&format!("{letter:>4}"));
                if let Some(said) = cell.said() {
                    reasons.push(format!(
                        "{letter} {} {}. {}: {said}",
                        error.fault.name,
                        number + 1,
                        line.name
                    ));
                }
            }
            println!("{:24}{row}", error.fault.name);
        }
    }
    println!(
        "\nN named; n named among others that fit as well; p found, not named; - not evaluated; M missed; W wrong; . no such stream\n"
    );
    for reason in &reasons {
        println!("{reason}");
    }
    reasons
}
