//! Several files that are one recording, read in order.
//!
//! Owns the share of each file in the sample, the running numbers of channels across files, and that every problem
//! names its file. Must not decide which files belong together.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use crate::source::{Problem, ReadStatus, Source};

use super::metadata::Metadata;
use super::numbered::numbered;
use super::{Channel, Extent, Message, RunExtension, Sampling, Selection, Task, Visit};

/// Bound on the topics that are counted.
const MAX_COUNTED: usize = 10_000;
/// Bound on the problems that are kept of one recording.
const MAX_PROBLEMS: usize = 1000;

/// What was found in all files together.
#[derive(Debug, Default)]
pub(super) struct Outcome {
    /// How far the recording was read.
    pub(super) extent: Extent,
    /// First and last log time of the messages, nanoseconds.
    pub(super) log_ns: Option<(i64, i64)>,
    /// By topic: type and messages read.
    pub(super) topics: BTreeMap<String, (String, u64)>,
    /// Messages read.
    pub(super) messages: u64,
}

/// Reads `files` one after the other into one visit.
pub(super) fn read(files: &[PathBuf], metadata: Option<&Metadata>, task: Task<'_>) -> Outcome {
    let Task {
        wanted,
        source,
        progress,
        visit,
    } = task;
    let sizes: Vec<u64> = files
        .iter()
        .map(|file| std::fs::metadata(file).map_or(0, |meta| meta.len()))
        .collect();
    let total: u64 = sizes.iter().sum();
    let sampling = wanted.sampling.filter(|sampling| total > sampling.bytes);
    let mut said = metadata.cloned();
    let mut joined = JoinedParts {
        visit,
        several: files.len() > 1,
        channels: Vec::new(),
        announced: 0,
        seam: false,
        totals: sampling.and(said.as_ref()).map(totals).unwrap_or_default(),
        outcome: Outcome::default(),
    };
    let mut extents = Vec::with_capacity(files.len());
    let (mut done, mut unreadable) = (0, 0);
    source.examined.bytes = 0;
    source.examined.messages = Some(0);
    let mut last: Option<&PathBuf> = None;
    for (file, size) in files.iter().zip(&sizes) {
        let name = name(file);
        // A file between the two is missing.
        joined.seam |= last.is_some_and(|last| is_gap(last, file));
        last = Some(file);
        joined.start(&name);
        let mut part = Source::new(source.id, name.clone(), source.kind);
        let before = done;
        let part_progress = |part: u64, _: u64| progress(before + part.min(*size), total);
        let task = Task {
            wanted: Selection {
                sampling: sampling.map(|sampling| share(&sampling, before, *size, total)),
                ..wanted
            },
            source: &mut part,
            progress: &part_progress,
            visit: &mut joined,
        };
        let extent = super::file(file, said.as_ref(), task);
        done += size;
        joined.seam = !extent.whole || part.status != ReadStatus::Read;
        unreadable += usize::from(part.status == ReadStatus::Unreadable);
        if let (Some(metadata), Some(said)) = (metadata, &mut said) {
            joined.outcome.left_of(metadata, said);
        }
        absorb(source, part, joined.several.then_some(&name));
        extents.push(extent);
    }
    source.examined.bytes_total = total;
    // One file that cannot be read does not make the others unreadable.
    if source.status == ReadStatus::Unreadable && unreadable < files.len() {
        source.status = ReadStatus::Partial;
    }
    let mut outcome = joined.outcome;
    outcome.extent = together(&extents, outcome.log_ns);
    outcome
}

/// Whether files of one recording do not follow each other by their numbers.
fn is_gap(last: &Path, file: &Path) -> bool {
    let numbers = numbered(last).zip(numbered(file));
    numbers.is_some_and(|((.., last), (.., number))| number > last + 1)
}

/// The name of a file as used in problems.
pub(super) fn name(file: &Path) -> String {
    file.file_name().map_or_else(
        || file.display().to_string(),
        |name| name.to_string_lossy().into_owned(),
    )
}

/// The part of a sampling for a file of this size, after others.
fn share(sampling: &Sampling, before: u64, size: u64, total: u64) -> Sampling {
    let portion_of = |whole: u64, size: u64| {
        let share = u128::from(whole) * u128::from(size) / u128::from(total.max(1));
        u64::try_from(share).unwrap_or(whole)
    };
    let portion = |whole: u64| portion_of(whole, size);
    // Many files have none of a few runs, but all together have them all.
    let carried = sampling.carried.map(|carried| {
        let runs = u64::from(carried.runs);
        let runs = portion_of(runs, before + size) - portion_of(runs, before);
        RunExtension {
            runs: u32::try_from(runs).unwrap_or(0),
            ..carried
        }
    });
    Sampling {
        windows: u32::try_from(portion(u64::from(sampling.windows))).unwrap_or(1).max(1),
        seconds: sampling.seconds,
        bytes: portion(sampling.bytes),
        carried,
    }
}

/// Adds what was read of one file to the recording's source.
fn absorb(source: &mut Source, part: Source, name: Option<&String>) {
    source.status = source.status.max(part.status);
    source.examined.bytes += part.examined.bytes;
    let messages = part.examined.messages.unwrap_or(0);
    *source.examined.messages.get_or_insert(0) += messages;
    for problem in part.problems {
        if source.problems.len() >= MAX_PROBLEMS {
            break;
        }
        let message = match name {
            Some(name) => format!("{name}: {}", problem.message),
            None => problem.message,
        };
        if source.detail.is_none() && part.status != ReadStatus::Read {
            source.detail = Some(message.clone());
        }
        source.problems.push(Problem { message, ..problem });
    }
}

/// How far several files were read, as one.
fn together(extents: &[Extent], log_ns: Option<(i64, i64)>) -> Extent {
    // A file without messages has no span of its own.
    let with_messages = extents.iter().filter(|extent| extent.messages_total != Some(0));
    let spans: Option<Vec<(i64, i64)>> = with_messages.map(|extent| extent.span_ns).collect();
    let whole = extents.iter().all(|extent| extent.whole);
    let span_ns = spans
        .filter(|_| !whole)
        .and_then(|spans| {
            spans
                .into_iter()
                .reduce(|all, one| (all.0.min(one.0), all.1.max(one.1)))
        })
        .or(log_ns.filter(|_| whole));
    Extent {
        truncated: extents.iter().any(|extent| extent.truncated),
        whole,
        indexed: !extents.is_empty() && extents.iter().all(|extent| extent.indexed),
        messages_total: extents.iter().map(|extent| extent.messages_total).sum(),
        span_ns,
    }
}

/// Messages of each topic in the whole recording.
fn totals(metadata: &Metadata) -> BTreeMap<String, Option<u64>> {
    let total = |topic: &super::metadata::TopicEntry| topic.messages.map(|(count, _)| count);
    let topics = metadata.topics.iter();
    topics
        .filter_map(|(name, topic)| Some((name.clone(), Some(total(topic)?))))
        .collect()
}

impl Outcome {
    /// Puts into `left` what the files to come hold of all that the metadata counts.
    fn left_of(&self, metadata: &Metadata, left: &mut Metadata) {
        for (name, topic) in &mut left.topics {
            let all = metadata.topics.get(name).and_then(|topic| topic.messages);
            let read = self.topics.get(name).map_or(0, |(_, read)| *read);
            topic.messages = all.map(|(count, at)| (count.saturating_sub(read), at));
        }
    }
}

/// Passes on the content of several files like that of a single one.
struct JoinedParts<'v> {
    visit: &'v mut dyn Visit,
    several: bool,
    /// Channels of this file, as they are passed on.
    channels: Vec<Channel>,
    /// Channels announced in the files before.
    announced: usize,
    /// Whether messages were skipped before the next one.
    seam: bool,
    /// Totals of the metadata by topic; `None` once passed on: they are those of the whole recording.
    totals: BTreeMap<String, Option<u64>>,
    outcome: Outcome,
}

impl JoinedParts<'_> {
    fn start(&mut self, name: &str) {
        self.announced += self.channels.len();
        self.channels.clear();
        if self.several {
            self.visit.part(name);
        }
        if self.seam {
            self.visit.seam();
        }
    }

    fn renumbered(&mut self, channel: &Channel) -> Channel {
        let total = match self.totals.get_mut(&channel.topic) {
            Some(said) => said.take(),
            None => channel.total,
        };
        Channel {
            number: self.announced + channel.number,
            total,
            ..channel.clone()
        }
    }
}

impl Visit for JoinedParts<'_> {
    fn channel(&mut self, channel: &Channel) {
        let channel = self.renumbered(channel);
        let topics = &mut self.outcome.topics;
        if topics.len() < MAX_COUNTED && !topics.contains_key(&channel.topic) {
            topics.insert(channel.topic.clone(), (channel.message_type.clone(), 0));
        }
        self.visit.channel(&channel);
        // Readers number their channels one by one.
        self.channels.push(channel);
    }

    fn message(&mut self, channel: &Channel, message: &Message<'_>) {
        if let Some((_, count)) = self.outcome.topics.get_mut(&channel.topic) {
            *count += 1;
        }
        let log_ns = message.log_ns;
        let (first, last) = self.outcome.log_ns.unwrap_or((log_ns, log_ns));
        self.outcome.log_ns = Some((first.min(log_ns), last.max(log_ns)));
        self.outcome.messages += 1;
        if let Some(channel) = self.channels.get(channel.number) {
            self.visit.message(channel, message);
        }
    }

    fn seam(&mut self) {
        self.visit.seam();
    }

    fn part(&mut self, name: &str) {
        self.visit.part(name);
    }

    fn annotation(&mut self, name: &str, fields: &BTreeMap<String, String>) {
        self.visit.annotation(name, fields);
    }
}
