//! Which recordings have one verdict: those of one folder that were recorded at the same time are of one drive, each of the others is by
//! itself.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use crate::read::bag::{self, Recording};
use crate::read::discover::Inputs;
use crate::read::input::Input;
use crate::source::{Source, SourceKind};
use crate::world::World;

use super::parallel;

/// Share of the shorter one that two recordings of one drive have in common.
const TOGETHER: f64 = 0.5;

/// Log times before this, in September 2001, are of no clock that several recordings share.
const EARLIEST_NS: i64 = 1_000_000_000_000_000_000;

/// The recordings of a run, by their numbers among the inputs.
#[derive(Default)]
pub(super) struct Sessions {
    /// A list for each drive, in the order of the inputs.
    pub(super) drives: Vec<Vec<usize>>,
    /// Of a recording, one that was made at the same time and lies in a folder beside its own.
    beside: BTreeMap<usize, usize>,
}

impl Sessions {
    fn of(known: Vec<Known>) -> Self {
        Self {
            beside: beside(&known),
            drives: drives(known),
        }
    }

    /// What is said of a recording where another one was made at the same time and is judged apart; `path` is where a recording is.
    pub(super) fn note(&self, recording: usize, path: impl Fn(usize) -> Option<String>) -> Option<String> {
        let other = self.beside.get(&recording)?;
        let is_of_both = |drive: &Vec<usize>| drive.contains(&recording) && drive.contains(other);
        if self.drives.iter().any(is_of_both) {
            return None;
        }
        let other = path(*other)?;
        Some(format!(
            "recorded at the same time as `{other}` in another folder, and judged without it; recordings in one folder are judged together"
        ))
    }
}

/// What tells which drive a recording is of.
#[derive(Clone)]
struct Known {
    number: usize,
    folder: Folder,
    /// First and last log time, nanoseconds, as far as anybody asks for them.
    span_ns: Option<(i64, i64)>,
}

/// The argument that a recording came with, and the folder that it stands in.
type Folder = (usize, Option<PathBuf>);

impl Known {
    fn is_with(&self, other: &Self) -> bool {
        let spans = self.span_ns.zip(other.span_ns);
        self.folder == other.folder && spans.is_some_and(|(own, its)| overlap(own, its))
    }
}

/// The recordings of the inputs.
pub(super) fn of(inputs: &Inputs) -> Sessions {
    let recordings: Vec<(usize, &Input)> = inputs
        .files
        .iter()
        .enumerate()
        .filter(|(_, input)| input.kind.is_bag())
        .collect();
    let folder_of = |input: &Input| (input.group, folder(&input.path, input.kind));
    let mut neighbours: BTreeMap<Folder, usize> = BTreeMap::new();
    for (_, input) in &recordings {
        let folder = folder_of(input);
        *neighbours.entry(above(&folder)).or_default() += 1;
        *neighbours.entry(folder).or_default() += 1;
    }
    let known = parallel::map(recordings, |(number, input)| {
        let folder = folder_of(input);
        // A recording that is alone in its folder, and in those beside it, need not be looked into.
        let is_near = |folder: &Folder| neighbours.get(folder).is_some_and(|count| *count > 1);
        let is_asked = input.refusal.is_none() && (is_near(&folder) || is_near(&above(&folder)));
        Known {
            number,
            folder,
            span_ns: is_asked.then(|| span_ns(input)).flatten(),
        }
    });
    Sessions::of(known)
}

/// The folder in which a folder stands.
fn above((group, folder): &Folder) -> Folder {
    (*group, folder.as_deref().and_then(Path::parent).map(Path::to_path_buf))
}

/// Of recordings with a time, the first one of a neighbouring folder that was made at the same time.
fn beside(known: &[Known]) -> BTreeMap<usize, usize> {
    let mut timed: Vec<(&Known, (i64, i64))> = known.iter().filter_map(|one| Some((one, one.span_ns?))).collect();
    timed.sort_by_key(|(one, span)| (span.0, one.number));
    let mut beside = BTreeMap::new();
    for (at, (one, span)) in timed.iter().enumerate() {
        let later = timed.iter().skip(at + 1).take_while(|(_, other)| other.0 <= span.1);
        for (other, its) in later {
            let is_near = one.folder != other.folder && above(&one.folder) == above(&other.folder);
            if is_near && overlap(*span, *its) {
                beside.entry(one.number).or_insert(other.number);
                beside.entry(other.number).or_insert(one.number);
            }
        }
    }
    beside
}

/// The same for the recordings of saved worlds: the numbers of their sources.
pub(super) fn of_worlds(worlds: &[World], sources: &[Source]) -> Sessions {
    let bags = worlds.iter().flat_map(|world| &world.bags);
    let known = bags.filter_map(|bag| {
        let source = sources.get(bag.source.0 as usize)?;
        Some(Known {
            number: bag.source.0 as usize,
            folder: (0, folder(Path::new(&source.path), source.kind)),
            span_ns: bag.share.span_ns.or(bag.start_ns.zip(bag.end_ns)),
        })
    });
    Sessions::of(known.collect())
}

fn drives(known: Vec<Known>) -> Vec<Vec<usize>> {
    let mut drives: Vec<Vec<Known>> = Vec::new();
    for recording in known {
        let is_of = |drive: &Vec<Known>| drive.iter().any(|other| recording.is_with(other));
        let (joined, apart): (Vec<_>, Vec<_>) = drives.into_iter().partition(is_of);
        let drive = joined.into_iter().flatten().chain([recording]).collect();
        drives = apart;
        drives.push(drive);
    }
    let numbers = |drive: Vec<Known>| {
        let mut numbers: Vec<usize> = drive.iter().map(|one| one.number).collect();
        numbers.sort_unstable();
        numbers
    };
    let mut drives: Vec<Vec<usize>> = drives.into_iter().map(numbers).collect();
    drives.sort_unstable();
    drives
}

fn span_ns(input: &Input) -> Option<(i64, i64)> {
    bag::span_ns(&Recording {
        path: &input.path,
        // A rosbag2 folder's metadata names its files itself.
        parts: if input.kind == SourceKind::Rosbag2 {
            &[]
        } else {
            &input.parts
        },
    })
}

/// The folder that a recording stands in; that of a rosbag2 is the one around its own.
fn folder(path: &Path, kind: SourceKind) -> Option<PathBuf> {
    let own = path.parent()?;
    let folder = if kind == SourceKind::Rosbag2 {
        own.parent()?
    } else {
        own
    };
    Some(folder.to_path_buf())
}

fn overlap(a: (i64, i64), b: (i64, i64)) -> bool {
    let length = |(first, last): (i64, i64)| last.saturating_sub(first) as f64;
    let common = length((a.0.max(b.0), a.1.min(b.1)));
    // The clock of a simulation begins anew each time.
    let is_on_clock = a.0.min(b.0) >= EARLIEST_NS;
    is_on_clock && common > 0.0 && common >= TOGETHER * length(a).min(length(b))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn recordings_are_of_one_drive_where_half_of_the_shorter_lies_in_the_other() {
        let later = |(first, last)| (EARLIEST_NS + first, EARLIEST_NS + last);
        let overlap = |a, b| overlap(later(a), later(b)) && overlap(later(b), later(a));
        assert!(overlap((0, 100), (10, 90)));
        assert!(overlap((0, 100), (50, 150)));
        assert!(!overlap((0, 100), (60, 160)));
        assert!(!overlap((0, 100), (100, 200)));
        assert!(!overlap((0, 100), (200, 300)));
        assert!(!overlap((0, 0), (0, 0)));
    }

    #[test]
    fn drives_of_a_simulation_are_not_joined_by_a_clock_that_begins_anew() {
        assert!(!overlap((0, 100), (0, 100)));
    }
}
