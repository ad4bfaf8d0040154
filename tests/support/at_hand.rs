//! Folders of real data, and what becomes of tests that go without them or without a program: each is noted here, and the target
//! `zz_left_out`, which runs last, tells them all. What a passing test prints is lost.

use std::fs::{OpenOptions, create_dir_all};
use std::io::Write;
use std::panic::Location;
use std::path::{Path, PathBuf};

/// The notes of this run of `cargo test`, which is the parent of all its test programs.
pub fn notes() -> PathBuf {
    let program = std::env::current_exe().expect("the test program has a path");
    // `target/debug` of `target/debug/deps/suite-0123456789abcdef`.
    let build = program
        .ancestors()
        .nth(2)
        .expect("the test program lies in a build folder");
    build
        .join("left-out")
        .join(std::os::unix::process::parent_id().to_string())
}

/// Notes that the test that runs is left out, or a part of it, and why.
#[track_caller]
pub fn left_out(why: &str) {
    let place = Location::caller();
    let thread = std::thread::current();
    // With one thread only, tests run in `main`.
    let test = thread.name().filter(|name| *name != "main");
    let test = test.map_or_else(|| place.to_string(), str::to_owned);
    let path = notes();
    create_dir_all(path.parent().expect("a folder")).expect("the notes can be written");
    let file = OpenOptions::new().create(true).append(true).open(path);
    let line = format!("{why}\t{test}\n");
    file.and_then(|mut file| file.write_all(line.as_bytes()))
        .expect("the notes can be written");
}

/// The folder of real recordings: `FRAMES_LINT_BAGS`, or `../shared/bags` beside the repository. `None`, and a note, where absent.
#[track_caller]
pub fn real_bags() -> Option<PathBuf> {
    folder("FRAMES_LINT_BAGS", "../shared/bags", "real recordings")
}

/// The folder of real descriptions and calibrations: `FRAMES_LINT_CORPUS`, or `../shared/corpus` beside the repository.
#[track_caller]
pub fn corpus() -> Option<PathBuf> {
    folder(
        "FRAMES_LINT_CORPUS",
        "../shared/corpus",
        "real descriptions and calibrations",
    )
}

/// The folder of recorded packets of lidars: `FRAMES_LINT_PACKETS`, or `../shared/raw/nebula` beside the repository.
#[track_caller]
pub fn lidar_packets() -> Option<PathBuf> {
    folder(
        "FRAMES_LINT_PACKETS",
        "../shared/raw/nebula",
        "recorded packets of lidars",
    )
}

/// The folder of recordings of Ouster's sensors: `FRAMES_LINT_OUSTER`, or `../shared/raw/ouster` beside the repository.
#[track_caller]
pub fn ouster_recordings() -> Option<PathBuf> {
    folder(
        "FRAMES_LINT_OUSTER",
        "../shared/raw/ouster",
        "recordings of Ouster's sensors",
    )
}

#[track_caller]
fn folder(variable: &str, beside: &str, what: &str) -> Option<PathBuf> {
    let beside_us = || Path::new(env!("CARGO_MANIFEST_DIR")).join(beside);
    let folder = std::env::var_os(variable).map_or_else(beside_us, PathBuf::from);
    let found = folder.is_dir();
    if !found {
        left_out(&format!("no {what}: {variable} names no folder, and {beside} is none"));
    }
    found.then_some(folder)
}
