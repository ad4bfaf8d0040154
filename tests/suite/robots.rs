//! Healthy platforms stay silent: a car, an indoor robot and an arm, each with URDF, calibration and a recording.

#![allow(clippy::unwrap_used)]

use std::path::{Path, PathBuf};

use crate::support;
use frames_lint::run::{FailOn, Run};
use frames_lint::source::ReadStatus;
use frames_lint::verdict::Outcome;

fn fixture(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("fixtures/robots").join(name)
}

/// Copies a platform to a folder of its own, with its recipes built to recordings, and checks it.
fn check(name: &str) -> (tempfile::TempDir, Run) {
    let folder = tempfile::tempdir().unwrap();
    support::copy_platform(&fixture(name), folder.path());
    let run = support::checked(folder.path());
    (folder, run)
}

fn is_silent(name: &str) {
    let (_folder, run) = check(name);
    for source in &run.sources {
        assert_eq!(
            source.status,
            ReadStatus::Read,
            "{}: {:?}",
            source.path,
            source.problems
        );
    }
    let said: Vec<String> = run
        .verdict
        .findings
        .iter()
        .map(|finding| format!("{} {}: {}", finding.rule, finding.name, finding.message))
        .collect();
    assert!(said.is_empty(), "{name} is healthy:\n{}", said.join("\n"));
    assert_eq!(run.verdict.count(Outcome::Crashed), 0);
    assert_eq!(run.exit_code(FailOn::Note), 0);
    assert_eq!(run.worlds.len(), 1, "a folder is one platform");
    // Silence is worth something only if much was judged, across sources too.
    let passed = |rule: &str| {
        run.verdict
            .rows
            .iter()
            .filter(|row| row.rule == rule && row.outcome == Outcome::Pass)
            .count()
    };
    for rule in [
        "TREE01", "TREE07", "TREE08", "NAME01", "NAME06", "ROT05", "CROSS01", "CROSS02", "CROSS06", "TIME01", "TIME03",
        "TIME04",
    ] {
        assert!(passed(rule) > 0, "{name}: {rule} judged nothing");
    }
}

#[test]
fn the_car_is_silent() {
    is_silent("car");
}

#[test]
fn the_indoor_robot_is_silent() {
    is_silent("amr");
}

#[test]
fn the_arm_is_silent() {
    is_silent("arm");
}
