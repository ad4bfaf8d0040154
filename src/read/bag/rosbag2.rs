//! rosbag2 folders: `metadata.yaml` and the files that it names, as one recording.
//!
//! Owns finding the files, and the messages where the metadata contradicts them. Must not know their formats.

use std::collections::BTreeSet;
use std::ffi::OsStr;
use std::path::{Path, PathBuf};

use crate::source::{Place, ReadStatus, Source, Span};

use super::kind::Container;
use super::metadata::{self, Metadata};
use super::parts::{self, Outcome};
use super::{Extent, NOTHING, Task, numbered};

/// How much the metadata's times may differ from those of the messages, nanoseconds. Recorders note the time of arrival
/// and of writing.
const MAX_TIME_DIFFERENCE_NS: u64 = 1_000_000_000;
/// The newest version of the metadata that is supported.
const LAST_VERSION: u64 = 9;
/// Topics that are named where counts differ.
const MAX_NAMED: usize = 3;

/// Files of a recording: those that exist, and those that are missing.
struct Files {
    present: Vec<PathBuf>,
    missing: Vec<(String, Span)>,
    repeated: Vec<(String, Span)>,
}

/// Reads the recording in a folder, or the one whose `metadata.yaml` is given.
pub(super) fn read(path: &Path, mut task: Task<'_>) -> Extent {
    let source = &mut *task.source;
    let folder = folder(path);
    let file = folder.join(metadata::NAME);
    let metadata = match Metadata::read(&file) {
        Ok(Some(metadata)) => Some(metadata),
        Ok(None) => None,
        Err(_) if path.is_dir() && !file.exists() => None,
        Err(why) => {
            let message = format!("{}: {why}", metadata::NAME);
            source.problem(ReadStatus::Partial, Place::whole(source.id), message);
            None
        }
    };
    let mut metadata = metadata.unwrap_or_default();
    source.text = std::mem::take(&mut metadata.text);
    let mut files = resolve(&folder, &metadata);
    before(&metadata, &files, &folder, source);
    if files.present.is_empty() && files.missing.is_empty() {
        files.present = by_name(&folder);
    }
    if files.present.is_empty() {
        let message = if files.missing.is_empty() {
            "the folder contains no recording"
        } else {
            "none of the files that `metadata.yaml` lists exists"
        };
        source.problem(ReadStatus::Unreadable, Place::whole(source.id), message);
        return NOTHING;
    }
    let mut beside = metadata.custom_data.clone();
    if let Some(distro) = &metadata.ros_distro {
        beside.insert("ros_distro".to_owned(), distro.clone());
    }
    if !beside.is_empty() {
        task.visit.annotation(metadata::ROOT, &beside);
    }
    let outcome = parts::read(&files.present, Some(&metadata), task.lent());
    let source = task.source;
    let lost = !files.missing.is_empty();
    if outcome.extent.whole && !outcome.extent.truncated && !lost {
        after(&metadata, &outcome, source);
    }
    describe(&files, source);
    Extent {
        truncated: outcome.extent.truncated || lost,
        ..outcome.extent
    }
}

/// The files that the recording of a `metadata.yaml` (or a folder) consists of, as far as they exist.
pub(in crate::read) fn files_of(path: &Path) -> Vec<PathBuf> {
    let folder = folder(path);
    let metadata = Metadata::read(&folder.join(metadata::NAME)).ok().flatten();
    let files = resolve(&folder, &metadata.unwrap_or_default());
    if files.present.is_empty() && files.missing.is_empty() {
        return by_name(&folder);
    }
    files.present
}

fn folder(path: &Path) -> PathBuf {
    if path.is_dir() {
        return path.to_path_buf();
    }
    match path.parent() {
        Some(parent) if parent != Path::new("") => parent.to_path_buf(),
        _ => PathBuf::from("."),
    }
}

/// Finds the files that the metadata names. Up to version 2 the names begin with the folder's own; folders are renamed, and
/// files are compressed and decompressed by hand.
fn resolve(folder: &Path, metadata: &Metadata) -> Files {
    let mut files = Files {
        present: Vec::new(),
        missing: Vec::new(),
        repeated: Vec::new(),
    };
    let mut known = BTreeSet::new();
    for (said, span) in &metadata.files {
        let name = Path::new(said);
        let base = Path::new(name.file_name().unwrap_or(OsStr::new("")));
        let mut packed = base.as_os_str().to_owned();
        packed.push(".zstd");
        let unpacked = base
            .extension()
            .filter(|ending| *ending == "zstd")
            .and(base.file_stem());
        let candidates = [
            Some(folder.join(name)),
            folder.parent().map(|above| above.join(name)),
            Some(folder.join(base)),
            Some(folder.join(packed)),
            unpacked.map(|unpacked| folder.join(unpacked)),
        ];
        let found = candidates.into_iter().flatten().find(|candidate| candidate.is_file());
        match found {
            None => files.missing.push((said.clone(), *span)),
            Some(found) => {
                let identity = std::fs::canonicalize(&found).unwrap_or_else(|_| found.clone());
                if known.insert(identity) {
                    files.present.push(found);
                } else {
                    files.repeated.push((said.clone(), *span));
                }
            }
        }
    }
    files
}

/// The recordings in a folder whose metadata lists none: those of one name, in the order of their numbers.
fn by_name(folder: &Path) -> Vec<PathBuf> {
    let Ok(entries) = std::fs::read_dir(folder) else {
        return Vec::new();
    };
    let paths: Vec<PathBuf> = entries.flatten().map(|entry| entry.path()).collect();
    let mut numbered: Vec<_> = paths
        .iter()
        .filter_map(|path| numbered::numbered(path).map(|(stem, ending, number)| (stem, ending, number, path.clone())))
        .filter(|(_, ending, ..)| ending != ".bag")
        .collect();
    numbered.sort();
    let first = numbered
        .first()
        .map(|(stem, ending, ..)| (stem.clone(), ending.clone()));
    numbered.retain(|(stem, ending, ..)| {
        first
            .as_ref()
            .is_some_and(|first| (stem, ending) == (&first.0, &first.1))
    });
    if !numbered.is_empty() {
        return numbered.into_iter().map(|(.., path)| path).collect();
    }
    let is_one = |path: &PathBuf| {
        path.extension()
            .is_some_and(|ending| ending == "mcap" || ending == "db3")
    };
    let mut others: Vec<PathBuf> = paths.into_iter().filter(is_one).collect();
    others.sort();
    others.truncate(1);
    others
}

/// Reports what is wrong with the metadata, by itself and compared with the folder.
fn before(metadata: &Metadata, files: &Files, folder: &Path, source: &mut Source) {
    let id = source.id;
    let at = |span: Span| Place::text(id, span);
    if let Some((byte, why)) = &metadata.fault {
        let place = at(Span::new(*byte, *byte));
        source.problem(
            ReadStatus::Partial,
            place,
            format!("`metadata.yaml` could not be read further: {why}"),
        );
    }
    let format = metadata.compression_format.as_ref();
    if let Some((format, span)) = format.filter(|(format, _)| !matches!(format.as_str(), "" | "zstd")) {
        let message = format!("the recording is compressed with `{format}`; only zstd is supported");
        source.problem(ReadStatus::Read, at(*span), message);
    }
    if let Some((version, span)) = metadata.version.filter(|(version, _)| *version > LAST_VERSION) {
        let message =
            format!("version {version} of the metadata is newer than the newest supported one ({LAST_VERSION})");
        source.problem(ReadStatus::Read, at(span), message);
    }
    for (name, span) in &files.missing {
        source.problem_with_help(
            ReadStatus::Partial,
            at(*span),
            format!("`metadata.yaml` lists `{name}`, which does not exist"),
            Some("copy it into the folder, or run `ros2 bag reindex` to rewrite the metadata without it".to_owned()),
        );
    }
    for (name, span) in &files.repeated {
        source.problem(
            ReadStatus::Read,
            at(*span),
            format!("`{name}` is listed twice; it was read once"),
        );
    }
    if let Some((storage, span)) = &metadata.storage {
        let differing = files.present.iter().find_map(|file| contradicts(storage, file));
        if let Some((name, is)) = differing {
            let message = format!("the metadata says the files are `{storage}`, but `{name}` is {is}");
            source.problem(ReadStatus::Read, at(*span), message);
        }
    }
    let known: BTreeSet<_> = files.present.iter().filter_map(|file| file.file_name()).collect();
    let stems: BTreeSet<_> = files
        .present
        .iter()
        .filter_map(|file| numbered::numbered(file).map(|(stem, ending, _)| (stem, ending)))
        .collect();
    let entries = std::fs::read_dir(folder).into_iter().flatten().flatten();
    let mut unnamed: Vec<String> = entries
        .map(|entry| entry.path())
        .filter(|path| path.file_name().is_some_and(|name| !known.contains(name)))
        .filter(|path| numbered::numbered(path).is_some_and(|(stem, ending, _)| stems.contains(&(stem, ending))))
        .map(|path| parts::name(&path))
        .collect();
    unnamed.sort();
    if let Some((_, span)) = metadata.files.last().filter(|_| !unnamed.is_empty()) {
        let message = format!(
            "`{}` is in the folder but not listed here; it was not read",
            unnamed.join("`, `")
        );
        let help = "run `ros2 bag reindex` to rewrite the metadata";
        source.problem_with_help(ReadStatus::Read, at(*span), message, Some(help.to_owned()));
    }
}

/// What a file is, if its kind of storage contradicts the metadata.
fn contradicts(storage: &str, file: &Path) -> Option<(String, &'static str)> {
    let (opened, _) = super::open(file).ok()?;
    let is = match Container::of(&super::first_bytes(&opened)) {
        Container::Mcap if storage == "sqlite3" => "an MCAP file",
        Container::Sqlite if storage == "mcap" => "an SQLite database",
        Container::Rosbag1 => "a ROS 1 bag",
        _ => return None,
    };
    Some((parts::name(file), is))
}

/// Reports where the metadata differs from the content of the files, which were read completely.
fn after(metadata: &Metadata, outcome: &Outcome, source: &mut Source) {
    let id = source.id;
    let mut say = |status, span, message: String| source.problem(status, Place::text(id, span), message);
    for (name, said) in &metadata.topics {
        let Some((is, _)) = outcome.topics.get(name) else {
            if said.messages.is_some_and(|(count, _)| count > 0) {
                let message =
                    format!("the metadata lists messages on `{name}`, but the files do not contain this topic");
                say(ReadStatus::Partial, said.name_at, message);
            }
            continue;
        };
        let differing = said.message_type.as_ref();
        if let Some((said, span)) = differing.filter(|(said, _)| !is.is_empty() && !said.is_empty() && said != is) {
            let message = format!("`{name}` has type `{said}` in the metadata, but `{is}` in the files");
            say(ReadStatus::Read, *span, message);
        }
    }
    if let Some((count, span)) = metadata.messages.filter(|(count, _)| *count != outcome.messages) {
        let read = outcome.messages;
        let differing: Vec<String> = metadata
            .topics
            .iter()
            .filter_map(|(name, said)| Some((name, said.messages?.0, outcome.topics.get(name)?.1)))
            .filter(|(_, said, read)| said != read)
            .take(MAX_NAMED)
            .map(|(name, said, read)| format!("`{name}`: {read} of {said}"))
            .collect();
        let mut message = format!("the metadata counts {count} messages, but the files hold {read}");
        if !differing.is_empty() {
            message = format!("{message} ({})", differing.join(", "));
        }
        let status = if count > read {
            ReadStatus::Partial
        } else {
            ReadStatus::Read
        };
        say(status, span, message);
    }
    let Some((first, last)) = outcome.log_ns else { return };
    if let Some((said, span)) = metadata.start_ns.filter(|(said, _)| differs(*said, first)) {
        let seconds = (said.saturating_sub(first)) as f64 / 1e9;
        let message = format!("the start time in the metadata differs from the first message's time by {seconds:.3} s");
        say(ReadStatus::Read, span, message);
    }
    let length = last.saturating_sub(first);
    if let Some((said, span)) = metadata.duration_ns.filter(|(said, _)| differs(*said, length)) {
        let (said, is) = (said as f64 / 1e9, length as f64 / 1e9);
        let message =
            format!("the recording lasts {said:.3} s according to the metadata, but its messages span {is:.3} s");
        say(ReadStatus::Read, span, message);
    }
}

fn differs(said: i64, is: i64) -> bool {
    said.abs_diff(is) > MAX_TIME_DIFFERENCE_NS
}

/// One line on a recording of several files, where nothing went wrong.
fn describe(files: &Files, source: &mut Source) {
    if source.detail.is_none() && files.present.len() > 1 {
        source.detail = Some(format!("{} files read as one recording", files.present.len()));
    }
}
