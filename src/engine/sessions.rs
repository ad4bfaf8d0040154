//! Which recordings share a verdict: those in one folder that were recorded at the same time belong to one drive; each of the others is
//! judged by itself.

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};
use std::sync::Arc;

use crate::read::bag::{self, Outline, Recording};
use crate::read::discover::Inputs;
use crate::read::input::Input;
use crate::source::{Source, SourceKind};
use crate::world::World;

use super::parallel;

/// Minimum overlap of two recordings of one drive, as a share of the shorter one.
const TOGETHER: f64 = 0.5;

/// Log times before this (September 2001) are not of a clock that several recordings share.
const EARLIEST_NS: i64 = 1_000_000_000_000_000_000;

/// The recordings of a run, by their numbers among the inputs.
#[derive(Default)]
pub(super) struct Sessions {
    /// A list for each drive, in the order of the inputs.
    pub(super) drives: Vec<Vec<usize>>,
    /// For a recording, another one of the same time near it that is judged separately, and why.
    beside: BTreeMap<usize, (usize, Separation)>,
}

impl Sessions {
    fn of(known: &[RecordingKey]) -> Self {
        let numbered = ComparisonKeys::new(known);
        // For each recording an earlier one of its drive, for the first itself; and the first near it that is judged separately, with the reason.
        let mut first: Vec<usize> = (0..known.len()).collect();
        let mut apart = vec![None; known.len()];
        for (a, b) in pairs(known) {
            match numbered.judge(a, b) {
                Some(Ok(())) => {
                    let (a, b) = (root(&first, a), root(&first, b));
                    if let Some(place) = first.get_mut(a.max(b)) {
                        *place = a.min(b);
                    }
                }
                Some(Err(why)) => {
                    for (one, other) in [(a, b), (b, a)] {
                        if let Some(place @ None) = apart.get_mut(one) {
                            *place = Some((other, why));
                        }
                    }
                }
                None => {}
            }
        }
        let mut drives: BTreeMap<usize, Vec<usize>> = BTreeMap::new();
        let mut beside = BTreeMap::new();
        for (at, (one, apart)) in known.iter().zip(apart).enumerate() {
            drives.entry(root(&first, at)).or_default().push(one.number);
            // A third recording may join two that have the same topics.
            let apart = apart.filter(|(other, _)| root(&first, *other) != root(&first, at));
            let other = apart.and_then(|(other, why)| Some((known.get(other)?.number, why)));
            beside.extend(other.map(|other| (one.number, other)));
        }
        let mut drives: Vec<Vec<usize>> = drives.into_values().collect();
        for drive in &mut drives {
            drive.sort_unstable();
        }
        drives.sort_unstable();
        Self { drives, beside }
    }

    /// The note on a recording if another one of the same time is judged separately; `path` gives the path of a recording.
    pub(super) fn note(&self, recording: usize, path: impl Fn(usize) -> Option<String>) -> Option<String> {
        let (other, why) = self.beside.get(&recording)?;
        let other = path(*other)?;
        Some(match why {
            Separation::Elsewhere => format!(
                "recorded at the same time as `{other}` and judged separately: to judge them together, put both into one folder"
            ),
            Separation::Alike => format!(
                "recorded at the same time as `{other}` with the same topics, and judged separately: a copy, or another robot"
            ),
        })
    }
}

/// Why two recordings of one time are not of one drive.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Separation {
    /// They are in neighbouring folders.
    Elsewhere,
    /// They have the same topics.
    Alike,
}

/// What determines the drive of a recording.
#[derive(Clone)]
struct RecordingKey {
    number: usize,
    folder: Folder,
    outline: Outline,
}

/// The command-line argument through which a recording was found, and its folder.
type Folder = (usize, Option<PathBuf>);

/// Topics that every part of a drive may have.
const SHARED: [&str; 7] = [
    "/tf",
    "/tf_static",
    "/clock",
    "/rosout",
    "/diagnostics",
    "/parameter_events",
    "/robot_description",
];

/// The topics of a recording that are its own.
fn own_topics(outline: &Outline) -> BTreeSet<&str> {
    let topics = outline.topics.iter().map(String::as_str);
    topics.filter(|topic| !SHARED.contains(topic)).collect()
}

/// Whether recordings with these topics have different streams: at least half of those of the one with fewer. A recording with the same
/// topics at the same time is a copy, or of another robot.
fn complete_each_other(a: &BTreeSet<&str>, b: &BTreeSet<&str>) -> bool {
    2 * a.intersection(b).count() <= a.len().min(b.len())
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
        // A recording without others in its folder and the neighbouring ones need not be opened.
        let is_near = |folder: &Folder| neighbours.get(folder).is_some_and(|count| *count > 1);
        let is_asked = input.refusal.is_none() && (is_near(&folder) || is_near(&above(&folder)));
        RecordingKey {
            number,
            folder,
            outline: if is_asked { outline(input) } else { Outline::default() },
        }
    });
    Sessions::of(&known)
}

/// The parent of a folder.
fn above((group, folder): &Folder) -> Folder {
    (*group, folder.as_deref().and_then(Path::parent).map(Path::to_path_buf))
}

/// What recordings are compared by, as numbers: sets and paths are compared once, not for each pair.
struct ComparisonKeys<'k> {
    /// For each recording, its folder, the parent of that, and its topics.
    of: Vec<(usize, usize, usize)>,
    topics: Vec<BTreeSet<&'k str>>,
}

impl<'k> ComparisonKeys<'k> {
    fn new(known: &'k [RecordingKey]) -> Self {
        let mut folders: BTreeMap<Folder, usize> = BTreeMap::new();
        let mut topics: BTreeMap<BTreeSet<&str>, usize> = BTreeMap::new();
        let mut of = Vec::with_capacity(known.len());
        for one in known {
            let [own, above] = [one.folder.clone(), above(&one.folder)].map(|folder| {
                let next = folders.len();
                *folders.entry(folder).or_insert(next)
            });
            let next = topics.len();
            of.push((own, above, *topics.entry(own_topics(&one.outline)).or_insert(next)));
        }
        let mut topics: Vec<(usize, BTreeSet<&str>)> = topics.into_iter().map(|(set, at)| (at, set)).collect();
        topics.sort_unstable();
        Self {
            of,
            topics: topics.into_iter().map(|(_, set)| set).collect(),
        }
    }

    /// Whether two recordings of one time are of one drive, or why not; `None` if they are unrelated.
    fn judge(&self, a: usize, b: usize) -> Option<Result<(), Separation>> {
        let ((own, own_above, topics), (its, its_above, its_topics)) = (*self.of.get(a)?, *self.of.get(b)?);
        if own != its {
            return (own_above == its_above).then_some(Err(Separation::Elsewhere));
        }
        let (topics, its_topics) = (self.topics.get(topics)?, self.topics.get(its_topics)?);
        // Equal numbers are equal sets: no comparison needed.
        let are_one = std::ptr::eq(topics, its_topics) && !topics.is_empty();
        let is_complete = !are_one && complete_each_other(topics, its_topics);
        Some(if is_complete { Ok(()) } else { Err(Separation::Alike) })
    }
}

/// Pairs of recordings of one time, by their places in the list, in a fixed order.
fn pairs(known: &[RecordingKey]) -> impl Iterator<Item = (usize, usize)> {
    let spans = known.iter().enumerate();
    let mut timed: Vec<(usize, (i64, i64))> = spans.filter_map(|(at, one)| Some((at, one.outline.span_ns?))).collect();
    timed.sort_by_key(|(at, span)| (span.0, *at));
    (0..timed.len()).flat_map(move |first| {
        let (at, span) = timed.get(first).copied().unwrap_or_default();
        let later = timed.get(first + 1..).unwrap_or_default();
        let later = later.iter().take_while(move |(_, its)| its.0 <= span.1);
        let with = later.filter(move |(_, its)| overlap(span, *its));
        with.map(move |(other, _)| (at, *other)).collect::<Vec<_>>()
    })
}

/// The same for the recordings of saved worlds: the numbers of their sources.
pub(super) fn of_worlds(worlds: &[World], sources: &[Arc<Source>]) -> Sessions {
    let bags = worlds.iter().flat_map(|world| &world.bags);
    let known = bags.filter_map(|bag| {
        let source = sources.get(bag.source.0 as usize)?;
        Some(RecordingKey {
            number: bag.source.0 as usize,
            folder: (0, folder(Path::new(&source.path), source.kind)),
            outline: Outline {
                span_ns: bag.share.span_ns.or(bag.start_ns.zip(bag.end_ns)),
                topics: bag.topics.keys().cloned().collect(),
            },
        })
    });
    Sessions::of(&known.collect::<Vec<_>>())
}

/// The first recording of the drive that one is of, so far.
fn root(first: &[usize], mut at: usize) -> usize {
    while let Some(before) = first.get(at).filter(|before| **before != at) {
        at = *before;
    }
    at
}

fn outline(input: &Input) -> Outline {
    bag::outline(&Recording {
        path: &input.path,
        // A rosbag2 folder's metadata names its files itself.
        parts: if input.kind == SourceKind::Rosbag2 {
            &[]
        } else {
            &input.parts
        },
    })
}

/// The folder of a recording; for a rosbag2 the one that contains its own.
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
    // The clock of a simulation starts again each time.
    let is_on_clock = a.0.min(b.0) >= EARLIEST_NS;
    is_on_clock && common > 0.0 && common >= TOGETHER * length(a).min(length(b))
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, clippy::indexing_slicing)]
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
    fn copies_are_judged_apart_and_what_completes_each_other_together() {
        let known = |number: usize, topics: &[&str]| RecordingKey {
            number,
            folder: (1, Some(PathBuf::from("drive"))),
            outline: Outline {
                span_ns: Some((EARLIEST_NS, EARLIEST_NS + 100)),
                topics: topics.iter().map(|topic| (*topic).to_owned()).collect(),
            },
        };
        let all = [
            known(0, &["/tf", "/points", "/scan"]),
            known(1, &["/tf", "/imu", "/fix", "/odom"]),
            known(2, &["/tf", "/points", "/scan"]),
            known(3, &["/tf"]),
        ];
        let sessions = Sessions::of(&all[..2]);
        assert_eq!(sessions.drives, [[0, 1]]);
        assert!(sessions.beside.is_empty());
        let copies = Sessions::of(&[all[0].clone(), all[2].clone()]);
        assert_eq!(copies.drives, [[0], [2]]);
        assert_eq!(copies.beside[&2], (0, Separation::Alike));
        assert!(
            copies
                .note(0, |other| Some(format!("{other}.mcap")))
                .unwrap()
                .contains("`2.mcap` with the same topics")
        );
        assert_eq!(Sessions::of(&[all[0].clone(), all[3].clone()]).drives, [[0, 3]]);
        // Both copies complete the second: all are together, and no note is written.
        let joined = Sessions::of(&all[..3]);
        assert_eq!(joined.drives, [[0, 1, 2]]);
        assert!(joined.beside.is_empty());
    }

    #[test]
    fn drives_of_a_simulation_are_not_joined_by_a_clock_that_begins_anew() {
        assert!(!overlap((0, 100), (0, 100)));
    }
}
