//! Which files of a run are one recording: those that a `metadata.yaml` lists, and those that continue each other.
//!
//! Owns the joining of inputs. Must not read messages.

use std::collections::{BTreeMap, BTreeSet};
use std::path::PathBuf;

use crate::source::SourceKind;

use super::bag::{numbered, rosbag2, split};
use super::input::Input;

/// Makes one input of the files of each recording.
pub(super) fn join(files: &mut Vec<Input>) {
    folders(files);
    splits(files);
}

/// Removes files that are read with their rosbag2 folder.
fn folders(files: &mut Vec<Input>) {
    let mut named = BTreeSet::new();
    for input in files.iter_mut().filter(|input| input.kind == SourceKind::Rosbag2) {
        input.parts = rosbag2::files_of(&input.path);
        named.extend(input.parts.iter().filter_map(|part| std::fs::canonicalize(part).ok()));
    }
    if named.is_empty() {
        return;
    }
    files.retain(|input| {
        let is_part = || std::fs::canonicalize(&input.path).is_ok_and(|path| named.contains(&path));
        input.kind == SourceKind::Rosbag2 || !is_part()
    });
}

/// Where a file of a split recording belongs: its group, folder, name and ending.
type Row = (usize, PathBuf, String, String);

/// Joins the files of split recordings that no metadata names.
fn splits(files: &mut Vec<Input>) {
    let mut rows: BTreeMap<Row, Vec<(u64, PathBuf)>> = BTreeMap::new();
    for input in files.iter().filter(|input| is_file_of_one(input)) {
        if let Some((stem, ending, number)) = numbered::numbered(&input.path) {
            let folder = input.path.parent().map(PathBuf::from).unwrap_or_default();
            let row = rows.entry((input.group, folder, stem, ending)).or_default();
            row.push((number, input.path.clone()));
        }
    }
    let mut first_of: BTreeMap<PathBuf, Vec<PathBuf>> = BTreeMap::new();
    let mut later = BTreeSet::new();
    for mut row in rows.into_values().filter(|row| row.len() > 1) {
        row.sort();
        for run in split::runs(&row).into_iter().filter(|run| run.len() > 1) {
            if let Some((first, others)) = run.split_first() {
                later.extend(others.iter().cloned());
                first_of.insert(first.clone(), run.clone());
            }
        }
    }
    files.retain(|input| !later.contains(&input.path));
    for input in files {
        if let Some(parts) = first_of.remove(&input.path) {
            input.parts = parts;
        }
    }
}

fn is_file_of_one(input: &Input) -> bool {
    input.kind.is_bag() && input.kind != SourceKind::Rosbag2 && input.refusal.is_none()
}
