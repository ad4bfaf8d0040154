//! Runs last, by its name, and tells which tests were left out for want of data or programs. It never fails.

#![allow(clippy::expect_used, clippy::print_stdout, dead_code, unreachable_pub)]

#[path = "support/at_hand.rs"]
mod at_hand;

use std::collections::{BTreeMap, BTreeSet};

fn main() {
    if std::env::args().any(|argument| argument == "--list") {
        return;
    }
    let path = at_hand::notes();
    let notes = std::fs::read_to_string(&path).unwrap_or_default();
    let mut reasons: BTreeMap<&str, BTreeSet<&str>> = BTreeMap::new();
    for (why, test) in notes.lines().filter_map(|line| line.split_once('\t')) {
        reasons.entry(why).or_default().insert(test);
    }
    let tests: BTreeSet<&&str> = reasons.values().flatten().collect();
    match tests.len() {
        0 => println!("\nNo test was left out."),
        count => println!("\nTests left out for want of data or programs, wholly or in part: {count}"),
    }
    for (why, tests) in &reasons {
        println!("  {}: {why}", tests.len());
        for test in tests {
            println!("      {test}");
        }
    }
    // Another run may have a parent of the same number.
    let _ = std::fs::remove_file(path);
}
