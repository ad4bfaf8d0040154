//! Recordings: one interface for every container format.
//!
//! Owns the notions of channel and message, and the choice of the reader by a file's first bytes. Must not know what
//! is inside the messages, nor keep any of them.

mod capture;
mod chunks;
mod compressed;
mod inflate;
mod kind;
mod losses;
mod mcap;
pub(in crate::read) mod metadata;
pub(in crate::read) mod numbered;
mod osf;
mod parts;
mod rosbag1;
pub(in crate::read) mod rosbag2;
pub(in crate::read) mod split;
mod sqlite;

use std::collections::{BTreeMap, BTreeSet};
use std::fs::File;
use std::io::{Read, Seek, SeekFrom};
use std::path::{Path, PathBuf};
use std::sync::Arc;

use crate::source::{Place, ReadStatus, Source, SourceId, SourceKind};

use compressed::Inflate;
use metadata::Metadata;

pub use kind::Container;

/// Called with `(bytes done, bytes in total)` while a recording is read.
pub type Progress<'a> = &'a dyn Fn(u64, u64);

/// One channel of a recording: a topic as one writer published it. A topic may have several.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Channel {
    /// Running number in this pass, from 0, in the order of first appearance.
    pub number: usize,
    /// The topic.
    pub topic: String,
    /// Type of the messages (`sensor_msgs/msg/Imu`, `foxglove.FrameTransform`); empty where the recording names none.
    pub message_type: String,
    /// The definition of the type as recorded: text, or a binary descriptor (`protobuf`); empty where there is none.
    pub schema: Arc<[u8]>,
    /// Encoding of the definition (`ros2msg`, `ros2idl`, `ros1msg`, `protobuf`, `jsonschema`); empty where there is none.
    pub schema_encoding: String,
    /// Encoding of the messages (`cdr`, `ros1`, `protobuf`, `json`).
    pub message_encoding: String,
    /// Metadata that the recorder stored with the channel; rosbag2 writes `offered_qos_profiles`.
    pub metadata: BTreeMap<String, String>,
    /// Who wrote it, where the format knows: the node of a ROS 1 connection (`callerid`).
    pub writer: Option<String>,
    /// Whether late subscribers get the last message again: `latching=1` of ROS 1, `transient_local` of ROS 2.
    pub latched: bool,
    /// Messages of the channel in the whole recording, if its index states it.
    pub total: Option<u64>,
}

impl Channel {
    /// A channel of a file that has none: its messages are made by the reader, of a type with a definition that is built in.
    fn made(number: usize, topic: String, message_type: &str, message_encoding: &str) -> Self {
        Self {
            number,
            topic,
            message_type: message_type.to_owned(),
            schema: Arc::from([]),
            schema_encoding: String::new(),
            message_encoding: message_encoding.to_owned(),
            metadata: BTreeMap::new(),
            writer: None,
            latched: false,
            total: None,
        }
    }
}

/// One message, borrowed from the reader.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Message<'a> {
    /// Time of recording, nanoseconds; `i64::MAX` where the file's number is larger.
    pub log_ns: i64,
    /// The message's bytes.
    pub data: &'a [u8],
}

/// What takes in a recording, in one pass and in the order of the file.
pub trait Visit {
    /// A channel, before its first message. Channels without messages are announced too.
    fn channel(&mut self, channel: &Channel);
    /// A message of a channel announced before.
    fn message(&mut self, channel: &Channel, message: &Message<'_>);
    /// Messages were skipped here: the next one does not follow the last one.
    fn seam(&mut self);
    /// What follows is in this file of a recording that has several.
    fn part(&mut self, _name: &str) {}
    /// Something that the recording contains besides messages: a metadata record with its fields, or under the name
    /// `attachments` the name of an attachment with its media type. A name may come several times.
    fn annotation(&mut self, _name: &str, _fields: &BTreeMap<String, String>) {}
}

/// How a recording is sampled: runs of neighbouring chunks (or stretches of time, where a format has no chunks) spread
/// evenly over its length.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sampling {
    /// Number of runs.
    pub windows: u32,
    /// Length of a run that the rules require, seconds of log time.
    pub seconds: f64,
    /// Bound on all runs together, bytes of messages; a recording that is smaller is read wholly.
    pub bytes: u64,
    /// Runs that cover all of `seconds`, beyond the limit of `bytes`, where they contain channels that are wanted in a row.
    pub carried: Option<RunExtension>,
}

/// For messages that are compared with their neighbours, and are so large that a run of ordinary size contains none.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct RunExtension {
    /// How many of the runs are extended in this way.
    pub runs: u32,
    /// Bound on each of them, bytes of messages.
    pub bytes: u64,
}

impl Sampling {
    /// Bound on one of the runs, bytes, and the bound where it contains channels that are wanted in a row.
    fn bounds(&self, run: u32) -> (u64, u64) {
        let runs = self.windows.max(1);
        let share = self.bytes / u64::from(runs);
        let carried = self.carried.filter(|carried| {
            // Evenly spread over all runs.
            let of = |run: u64| run * u64::from(carried.runs.min(runs)) / u64::from(runs);
            of(u64::from(run)) != of(u64::from(run) + 1)
        });
        (share, carried.map_or(share, |carried| carried.bytes.max(share)))
    }
}

/// What is wanted of a recording.
#[derive(Clone, Copy)]
pub struct Selection<'a> {
    /// Everything where `None`.
    pub sampling: Option<Sampling>,
    /// Channels that are read outside of the runs too, as far as the index makes it cheap; of every other channel, the
    /// first messages and some more over the length are read.
    pub throughout: &'a dyn Fn(&Channel) -> bool,
    /// Channels whose messages are compared with the next ones: [`Sampling::carried`] is for them.
    pub in_a_row: &'a dyn Fn(&Channel) -> bool,
}

impl Selection<'_> {
    /// Every message.
    pub const ALL: Self = Self {
        sampling: None,
        throughout: &|_| true,
        in_a_row: &|_| false,
    };
}

/// The input of a reader besides the file.
struct Task<'a> {
    wanted: Selection<'a>,
    /// Receives how far reading went.
    source: &'a mut Source,
    progress: Progress<'a>,
    /// Receives what is found.
    visit: &'a mut dyn Visit,
}

impl Task<'_> {
    /// The same task, borrowed.
    fn lent(&mut self) -> Task<'_> {
        Task {
            wanted: self.wanted,
            source: self.source,
            progress: self.progress,
            visit: self.visit,
        }
    }
}

/// How far a recording was read, and how far it extends.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Extent {
    /// Whether messages may be missing at the end, or after a fault, so that the absence of a message proves nothing.
    pub truncated: bool,
    /// Whether every message was read that the file holds (before a fault).
    pub whole: bool,
    /// Whether the file has an index that was used.
    pub indexed: bool,
    /// Messages in the whole recording, if its index states it.
    pub messages_total: Option<u64>,
    /// First and last log time of the whole recording, nanoseconds, if its index states it.
    pub span_ns: Option<(i64, i64)>,
}

/// What is read as one recording.
#[derive(Clone, Copy, Debug)]
pub struct Recording<'a> {
    /// A file, a rosbag2 folder or its `metadata.yaml`.
    pub path: &'a Path,
    /// The files of a split recording in order, where that is known from their names; empty otherwise.
    pub parts: &'a [PathBuf],
}

/// Bound on one message, and on a record that is not a chunk, bytes. The largest messages in recordings are clouds and
/// images of some ten megabytes.
const MAX_MESSAGE: u64 = 128 << 20;

/// The extent of a file that could not be read at all.
const NOTHING: Extent = Extent {
    truncated: true,
    whole: false,
    indexed: false,
    messages_total: None,
    span_ns: None,
};

/// Reads a recording of any format once, and notes in `source` how far that went: its status, its detail, what
/// was examined and every problem.
pub fn read(
    recording: &Recording<'_>,
    wanted: &Selection<'_>,
    source: &mut Source,
    progress: Progress<'_>,
    visit: &mut dyn Visit,
) -> Extent {
    let path = recording.path;
    let mut task = Task {
        wanted: *wanted,
        source,
        progress,
        visit,
    };
    if !recording.parts.is_empty() {
        return split::read(recording.parts, task);
    }
    let is_metadata = path.file_name().is_some_and(|name| name == metadata::NAME);
    if is_metadata || path.is_dir() {
        return rosbag2::read(path, task);
    }
    let metadata = Metadata::beside(path);
    let extent = file(path, metadata.as_ref(), task.lent());
    if let Some(files) = metadata.map(|metadata| metadata.files.len()).filter(|files| *files > 1) {
        let detail =
            format!("one of the {files} files that the `metadata.yaml` next to it lists; the others were not read");
        task.source.detail.get_or_insert(detail);
    }
    extent
}

/// What a recording is, without its messages.
#[derive(Clone, Debug, Default)]
pub struct Outline {
    /// First and last log time, nanoseconds.
    pub span_ns: Option<(i64, i64)>,
    /// Its topics.
    pub topics: BTreeSet<String>,
}

impl Visit for Outline {
    fn channel(&mut self, channel: &Channel) {
        self.topics.insert(channel.topic.clone());
    }
    fn message(&mut self, _channel: &Channel, message: &Message<'_>) {
        let (first, last) = self.span_ns.unwrap_or((message.log_ns, message.log_ns));
        self.span_ns = Some((first.min(message.log_ns), last.max(message.log_ns)));
    }
    fn seam(&mut self) {}
}

/// The outline of a recording, from its index where it has one.
pub fn outline(recording: &Recording<'_>) -> Outline {
    let wanted = Selection {
        sampling: Some(Sampling {
            windows: 1,
            seconds: 0.0,
            bytes: 0,
            carried: None,
        }),
        throughout: &|_| false,
        in_a_row: &|_| false,
    };
    let mut outline = Outline::default();
    let mut nowhere = Source::new(SourceId(0), "", SourceKind::Unsupported);
    let extent = read(recording, &wanted, &mut nowhere, &|_, _| {}, &mut outline);
    outline.span_ns = extent.span_ns.or(outline.span_ns);
    outline
}

/// Reads one file. `metadata` is what the recording's `metadata.yaml` says, where there is one.
fn file(path: &Path, metadata: Option<&Metadata>, task: Task<'_>) -> Extent {
    let source = task.source;
    let (file, total) = match open(path) {
        Ok(opened) => opened,
        Err(message) => {
            source.problem(ReadStatus::Unreadable, Place::whole(source.id), message);
            return NOTHING;
        }
    };
    let mut inflate = Inflate::new(task.visit);
    let task = Task {
        wanted: task.wanted,
        source: &mut *source,
        progress: task.progress,
        visit: &mut inflate,
    };
    let mut extent = if Container::of(&first_bytes(&file)) == Container::Zstd {
        packed(file, total, metadata, task)
    } else {
        plain(path, (file, total), metadata, task)
    };
    extent.truncated |= inflate.report(source);
    extent
}

/// Reads a file that is compressed as a whole: through a temporary file, since formats are read by their index.
fn packed(file: File, total: u64, metadata: Option<&Metadata>, mut task: Task<'_>) -> Extent {
    let source = &mut *task.source;
    let whole = Place::whole(source.id);
    source.examined.bytes_total = total;
    source.examined.messages = Some(0);
    let opened =
        compressed::unpack(file, total, task.progress).and_then(|unpacked| Ok((open(unpacked.file.path())?, unpacked)));
    let (inner, unpacked) = match opened {
        Ok(opened) => opened,
        Err(why) => {
            source.problem(ReadStatus::Unreadable, whole, why);
            return NOTHING;
        }
    };
    let truncated = unpacked.fault.is_some();
    if let Some(fault) = &unpacked.fault {
        source.problem(ReadStatus::Partial, whole.clone(), fault.clone());
    }
    let container = Container::of(&first_bytes(&inner.0));
    if !container.is_read() {
        let why = "the file is compressed with zstd but contains no recording".to_owned();
        source.problem(ReadStatus::Unreadable, whole, why);
        return NOTHING;
    }
    let quiet = Task {
        progress: &|_, _| {},
        ..task.lent()
    };
    let extent = plain(unpacked.file.path(), inner, metadata, quiet);
    let source = task.source;
    // The examined bytes are those of the compressed file, the one that the user knows.
    let share = source.examined.bytes as f64 / unpacked.size.max(1) as f64;
    source.examined.bytes_total = total;
    source.examined.bytes = if share >= 1.0 && !truncated {
        total
    } else {
        portion(total, share.min(1.0))
    };
    Extent {
        truncated: extent.truncated || truncated,
        ..extent
    }
}

/// This share of a number of bytes.
#[allow(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "a share of a size is no larger than the size, and not negative"
)]
fn portion(bytes: u64, share: f64) -> u64 {
    (bytes as f64 * share.clamp(0.0, 1.0)) as u64
}

/// Reads a file by its first bytes.
fn plain(path: &Path, (file, total): (File, u64), metadata: Option<&Metadata>, task: Task<'_>) -> Extent {
    let source = &mut *task.source;
    source.examined.bytes_total = total;
    source.examined.messages = Some(0);
    let first = first_bytes(&file);
    let container = Container::of(&first);
    match container {
        Container::Mcap => return mcap::read(file, total, task),
        Container::Rosbag1 => return rosbag1::read(file, total, &first, task),
        Container::Sqlite => return sqlite::read(path, total, metadata, task),
        Container::Capture => return capture::read(file, total, task),
        Container::Osf => return osf::read(file, total, task),
        _ => {}
    }
    let (message, help) = container.refusal(source.kind);
    source.problem_with_help(
        ReadStatus::Unreadable,
        Place::whole(source.id),
        message,
        help.map(str::to_owned),
    );
    NOTHING
}

/// First and last log time of a file, nanoseconds, if its index states it. `Err` where it is not a recording.
fn span(path: &Path) -> Result<Option<(i64, i64)>, String> {
    let (file, total) = open(path)?;
    match Container::of(&first_bytes(&file)) {
        Container::Mcap => Ok(mcap::span(&file, total)),
        Container::Sqlite => Ok(sqlite::span(path, total)),
        Container::Rosbag1 => Ok(split::rosbag1_span(&file, total)),
        _ => Err("not a recording".to_owned()),
    }
}

/// Opens a regular file. Pipes and devices are refused before opening: they may block for ever or never end.
fn open(path: &Path) -> Result<(File, u64), String> {
    let cannot = |error: std::io::Error| format!("cannot be opened: {error}");
    let metadata = std::fs::metadata(path).map_err(cannot)?;
    if !metadata.is_file() {
        return Err("is not a regular file".to_owned());
    }
    Ok((File::open(path).map_err(cannot)?, metadata.len()))
}

/// The first bytes of a file, which is rewound; fewer if it is shorter or cannot be read.
fn first_bytes(mut file: &File) -> Vec<u8> {
    let mut first = Vec::new();
    // What cannot be read is not a magic; a lasting fault appears again when the whole file is read.
    let _ = file.take(kind::SNIFFED).read_to_end(&mut first);
    let _ = file.seek(SeekFrom::Start(0));
    first
}
