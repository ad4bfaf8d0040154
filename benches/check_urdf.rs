//! CPU time compared with `check_urdf` (Debian: liburdfdom-tools), on the same files, in one run.
//!
//! Files: `FRAMES_LINT_CORPUS` or `../shared/corpus` if it exists; else the robots under `fixtures/`.
//! Measured: user plus system time of the child processes, not wall time.

#![allow(clippy::print_stdout, clippy::expect_used, clippy::indexing_slicing)]

use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::time::Duration;

use nix::sys::resource::{UsageWho, getrusage};

fn main() {
    let files = urdf_files();
    let largest = files
        .iter()
        .max_by_key(|file| file.metadata().map_or(0, |meta| meta.len()))
        .cloned();
    println!("{} URDF files", files.len());
    let ours = |paths: &[PathBuf]| {
        let mut command = Command::new(env!("CARGO_BIN_EXE_frames-lint"));
        command
            .args(["check", "--format", "json", "--output", "/dev/null"])
            .args(paths)
            // Without xacro on PATH: check_urdf does not expand either.
            .env("PATH", "");
        command
    };
    report("all files, frames-lint, one process", 3, files.len(), || {
        vec![ours(&files)]
    });
    let peer = |paths: &[PathBuf]| {
        paths
            .iter()
            .map(|path| {
                let mut command = Command::new("check_urdf");
                command.arg(path);
                command
            })
            .collect::<Vec<_>>()
    };
    let has_peer = Command::new("check_urdf")
        .stdout(Stdio::null())
        .stderr(Stdio::null())
        .status()
        .is_ok();
    if has_peer {
        report("all files, check_urdf, one process a file", 3, files.len(), || {
            peer(&files)
        });
    } else {
        println!("check_urdf is not on PATH (Debian: liburdfdom-tools): nothing to compare with");
    }
    if let Some(largest) = largest {
        let largest = [largest];
        println!("largest: {}", largest[0].display());
        report("largest file, frames-lint", 20, 1, || vec![ours(&largest)]);
        if has_peer {
            report("largest file, check_urdf", 20, 1, || peer(&largest));
        }
    }
}

/// Runs the commands `runs` times and prints the best CPU time of a run, in all and per file.
fn report(what: &str, runs: usize, files: usize, commands: impl Fn() -> Vec<Command>) {
    let mut best = Duration::MAX;
    for _ in 0..runs {
        let before = children_cpu();
        for mut command in commands() {
            let _ = command
                .stdin(Stdio::null())
                .stdout(Stdio::null())
                .stderr(Stdio::null())
                .status();
        }
        best = best.min(children_cpu().saturating_sub(before));
    }
    let millis = best.as_secs_f64() * 1e3;
    println!(
        "{what}: {millis:.1} ms CPU, {:.3} ms a file",
        millis / files.max(1) as f64
    );
}

fn children_cpu() -> Duration {
    let usage = getrusage(UsageWho::RUSAGE_CHILDREN).expect("getrusage");
    let time = |t: nix::sys::time::TimeVal| {
        Duration::from_secs(t.tv_sec().unsigned_abs()) + Duration::from_micros(t.tv_usec().unsigned_abs())
    };
    time(usage.user_time()) + time(usage.system_time())
}

fn urdf_files() -> Vec<PathBuf> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let corpus = std::env::var_os("FRAMES_LINT_CORPUS").map_or_else(|| root.join("../shared/corpus"), PathBuf::from);
    let folder = if corpus.is_dir() { corpus } else { root.join("fixtures") };
    let mut files = Vec::new();
    let mut folders = vec![folder];
    while let Some(folder) = folders.pop() {
        for entry in std::fs::read_dir(folder).into_iter().flatten().flatten() {
            let path = entry.path();
            if path.is_dir() {
                folders.push(path);
            } else if path
                .extension()
                .is_some_and(|ending| ending.eq_ignore_ascii_case("urdf"))
            {
                files.push(path);
            }
        }
    }
    files.sort();
    files
}
