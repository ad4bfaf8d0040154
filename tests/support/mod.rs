//! What integration tests share.
//!
//! Each test binary uses a part of it, hence the allowances.

#![allow(
    dead_code,
    unused_imports,
    clippy::print_stderr,
    unreachable_pub,
    clippy::unwrap_used,
    clippy::expect_used,
    clippy::indexing_slicing,
    clippy::panic,
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    clippy::missing_panics_doc
)]

pub mod at_hand;
pub mod browser;
pub mod camera;
pub mod capture;
pub mod clouds;
pub mod contents;
pub mod damage;
pub mod deference;
pub mod dialects;
pub mod drive;
pub mod driven;
pub mod driven_world;
pub mod encode;
pub mod foxglove;
pub mod heard;
pub mod motion;
pub mod packets;
pub mod packets_ouster;
pub mod page;
pub mod point_files;
pub mod program;
pub mod radars;
pub mod raw;
pub mod reading;
pub mod recipe;
pub mod ros1;
pub mod rosbag1;
pub mod rosbag1_drive;
pub mod rosbag2;
pub mod scans;
pub mod schemas;
#[cfg(unix)]
pub mod terminal;
pub mod topic;

use std::path::{Path, PathBuf};

use frames_lint::collect::{CollectOptions, Collection, collect};
use frames_lint::engine::{self, Options};
use frames_lint::run::Run;
use frames_lint::source::{ReadStatus, Source, SourceId, SourceKind};
use frames_lint::world::FrameId;
use frames_lint::world::bag::{BagEvidence, TfEdge};

pub use at_hand::{corpus, left_out, real_bags};

/// The MCAP that a recipe describes; see [`recipe::Recipe`] for every knob. A recipe that does not parse panics with the
/// reason.
pub fn build(recipe: &str) -> Vec<u8> {
    recipe::Recipe::parse(recipe).to_mcap()
}

/// Writes the MCAP that a recipe describes.
pub fn write(recipe: &str, path: &Path) {
    std::fs::write(path, build(recipe)).expect("the MCAP is written");
}

/// Copies a platform's files to a folder, with its recipes built to recordings.
pub fn copy_platform(platform: &Path, folder: &Path) {
    for entry in std::fs::read_dir(platform).expect("the folder is readable") {
        let path = entry.expect("the folder is readable").path();
        let target = folder.join(path.file_name().unwrap());
        if path.extension().is_some_and(|ending| ending == "recipe") {
            write(&std::fs::read_to_string(&path).unwrap(), &target.with_extension("mcap"));
        } else {
            std::fs::copy(&path, &target).unwrap();
        }
    }
}

/// Collects a recording given as bytes.
pub fn collected(bytes: &[u8]) -> (Source, Collection) {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let path = folder.path().join("drive.mcap");
    std::fs::write(&path, bytes).expect("the MCAP is written");
    collected_from(&path)
}

/// Collects the recording at a path.
pub fn collected_from(path: &Path) -> (Source, Collection) {
    let mut source = Source::new(SourceId(0), path.display().to_string(), SourceKind::Mcap);
    let collected = collect(path, &CollectOptions::default(), &mut source, &|_, _| {});
    (source, collected)
}

/// Judges what lies at a path, as the program does by default.
pub fn checked(path: &Path) -> Run {
    engine::check(&Options {
        paths: vec![path.to_path_buf()],
        ..Options::default()
    })
    .unwrap()
}

/// The evidence of a recipe's recording, which must be read wholly.
pub fn evidence(recipe: &str) -> BagEvidence {
    let (source, collected) = collected(&build(recipe));
    assert_eq!(source.status, ReadStatus::Read, "{source:?}");
    assert_eq!(source.examined.bytes, source.examined.bytes_total);
    bag(&collected).clone()
}

/// The one bag of what was collected.
pub fn bag(collected: &Collection) -> &BagEvidence {
    &collected.facts.bags[0]
}

/// Evidence as it is saved: to compare with, since a NaN equals none.
pub fn written(bag: &BagEvidence) -> String {
    serde_json::to_string_pretty(bag).expect("evidence is written")
}

/// The edge between two frames as spelled.
pub fn edge<'a>(bag: &'a BagEvidence, parent: &str, child: &str) -> &'a TfEdge {
    let named = |edge: &&TfEdge| edge.parent.as_str() == parent && edge.child.as_str() == child;
    bag.tf.iter().find(named).expect("the edge is in the evidence")
}

/// Frames as words.
pub fn names<'a>(frames: impl IntoIterator<Item = &'a FrameId>) -> Vec<&'a str> {
    frames.into_iter().map(FrameId::as_str).collect()
}

/// Every file under a folder whose name holds `part`, sorted.
pub fn files(folder: &Path, part: &str) -> Vec<PathBuf> {
    let mut found = Vec::new();
    let mut folders = vec![folder.to_owned()];
    while let Some(folder) = folders.pop() {
        for entry in std::fs::read_dir(folder).expect("the folder is readable") {
            let path = entry.expect("the folder is readable").path();
            if path.is_dir() {
                folders.push(path);
            } else if path
                .file_name()
                .is_some_and(|name| name.to_string_lossy().contains(part))
            {
                found.push(path);
            }
        }
    }
    found.sort();
    found
}
