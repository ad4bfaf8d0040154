//! Sources and places: where every fact was read.
//!
//! Owns source identities, byte spans, places, the line index and the degrees of confidence in a fact. Must not know formats, frames or rules.

mod lines;
pub(crate) mod packages;

use std::collections::BTreeMap;
use std::path::PathBuf;

use serde::{Deserialize, Serialize};

pub use lines::{LineColumn, LineIndex};

/// How sure a statement is. `Certain` is algebra or a standard's text, `Likely` is measured with margin,
/// `Hint` is a heuristic or a name. A hint never fails a gate. Ordered from weak to strong.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Confidence {
    /// A heuristic, or only a name.
    Hint,
    /// Measured, with margin.
    Likely,
    /// Algebra, or the text of a standard.
    Certain,
}

/// Identity of one input of a run: an index into the run's list of sources.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
pub struct SourceId(pub u32);

/// What a source was recognised as.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum SourceKind {
    /// A URDF file.
    Urdf,
    /// A xacro file, expanded to URDF or read unexpanded.
    Xacro,
    /// A URDF published inside a bag on `/robot_description`.
    RobotDescription,
    /// Metadata of a sensor on a topic of a bag, such as an Ouster's on `/ouster/metadata`.
    SensorMetadata,
    /// A YAML file that may contain transforms.
    Yaml,
    /// A JSON file that may contain transforms.
    Json,
    /// A calibration in plain text: KITTI's, a matrix, an ini, info or Lua file, poses over time.
    Text,
    /// A launch file, or a script that publishes static transforms.
    Launch,
    /// Source code, whose products of transforms are checked.
    Code,
    /// An MCAP recording.
    Mcap,
    /// A ROS 1 bag.
    Rosbag1,
    /// A rosbag2 SQLite recording.
    Sqlite,
    /// A rosbag2 folder: `metadata.yaml` and the files that it names.
    Rosbag2,
    /// A capture of a network, with the packets of lidars: pcap or pcapng.
    Pcap,
    /// An OSF file: scans of Ouster's sensors.
    Osf,
    /// A point cloud: PCD, PLY, LAS or LAZ.
    Points,
    /// The configuration of frames-lint itself.
    Configuration,
    /// A file named by the user, or known by its name, that no reader handles.
    Unsupported,
}

impl SourceKind {
    /// The word used in reports.
    pub fn word(self) -> &'static str {
        match self {
            Self::Urdf => "urdf",
            Self::Xacro => "xacro",
            Self::RobotDescription => "robot-description",
            Self::SensorMetadata => "sensor-metadata",
            Self::Yaml => "yaml",
            Self::Json => "json",
            Self::Text => "text",
            Self::Launch => "launch",
            Self::Code => "code",
            Self::Mcap => "mcap",
            Self::Rosbag1 => "rosbag1",
            Self::Sqlite => "sqlite",
            Self::Rosbag2 => "rosbag2",
            Self::Pcap => "pcap",
            Self::Osf => "osf",
            Self::Points => "points",
            Self::Configuration => "configuration",
            Self::Unsupported => "unsupported",
        }
    }

    /// Whether a source of this kind is a recording.
    pub fn is_bag(self) -> bool {
        matches!(
            self,
            Self::Mcap | Self::Rosbag1 | Self::Sqlite | Self::Rosbag2 | Self::Pcap | Self::Osf
        )
    }
}

/// How much of a source could be read.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum ReadStatus {
    /// Everything that has a reader was read.
    Read,
    /// Read up to a fault; everything before it is judged.
    Partial,
    /// Nothing could be read.
    Unreadable,
}

impl ReadStatus {
    /// The word used in reports.
    pub fn word(self) -> &'static str {
        match self {
            Self::Read => "read",
            Self::Partial => "partial",
            Self::Unreadable => "unreadable",
        }
    }
}

/// A half-open range of bytes of a text.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
pub struct Span {
    /// First byte.
    pub start: usize,
    /// One past the last byte.
    pub end: usize,
}

impl Span {
    /// The span from `start` up to, not including, `end`.
    pub fn new(start: usize, end: usize) -> Self {
        Self { start, end }
    }

    /// The smallest span that covers both.
    #[must_use]
    pub fn cover(self, other: Self) -> Self {
        Self {
            start: self.start.min(other.start),
            end: self.end.max(other.end),
        }
    }
}

impl From<std::ops::Range<usize>> for Span {
    fn from(range: std::ops::Range<usize>) -> Self {
        Self::new(range.start, range.end)
    }
}

/// One message of a recording.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
pub struct MessageRef {
    /// The topic the message was recorded on.
    pub topic: String,
    /// Zero-based index of the message on its topic.
    pub index: u64,
    /// Header stamp, nanoseconds of the stamp's own clock; `None` where the message carries none.
    pub stamp_ns: Option<i64>,
    /// Log time of the recording, nanoseconds.
    pub log_ns: i64,
    /// The field inside the message (`transforms[3].transform.rotation`), if one is meant.
    pub field: Option<String>,
}

/// The part of a source that a place points at.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum SourcePart {
    /// The source as a whole.
    Whole,
    /// A byte span of the source's text.
    Text(Span),
    /// A message of the recording.
    Message(Box<MessageRef>),
}

/// Where a fact was read.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
pub struct Place {
    /// The source.
    pub source: SourceId,
    /// The part of it.
    pub at: SourcePart,
}

impl Place {
    /// The source as a whole.
    pub fn whole(source: SourceId) -> Self {
        Self {
            source,
            at: SourcePart::Whole,
        }
    }

    /// A byte span of a text source.
    pub fn text(source: SourceId, span: impl Into<Span>) -> Self {
        Self {
            source,
            at: SourcePart::Text(span.into()),
        }
    }

    /// A message of a recording.
    pub fn message(source: SourceId, message: MessageRef) -> Self {
        Self {
            source,
            at: SourcePart::Message(Box::new(message)),
        }
    }

    /// A message of a recording, or the whole of it if none is known.
    pub fn of(source: SourceId, message: Option<&MessageRef>) -> Self {
        message.map_or_else(|| Self::whole(source), |message| Self::message(source, message.clone()))
    }

    /// The topic of a message.
    pub fn topic(&self) -> Option<&str> {
        match &self.at {
            SourcePart::Message(message) => Some(&message.topic),
            SourcePart::Whole | SourcePart::Text(_) => None,
        }
    }

    /// The byte span, where the place has one.
    pub fn span(&self) -> Option<Span> {
        match self.at {
            SourcePart::Text(span) => Some(span),
            _ => None,
        }
    }
}

/// A value together with the place it was read at.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
pub struct SourceValue<T> {
    /// The value as it was spelled.
    pub value: T,
    /// Its place.
    pub place: Place,
}

impl<T> SourceValue<T> {
    /// A value with its place.
    pub fn new(value: T, place: Place) -> Self {
        Self { value, place }
    }
}

/// A fault of an input that kept something from being read.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
pub struct Problem {
    /// Where reading stopped or went wrong.
    pub place: Place,
    /// What is wrong, in plain words.
    pub message: String,
    /// What to do about it.
    pub help: Option<String>,
}

/// How much of a source was examined.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Coverage {
    /// Bytes of the source that were read.
    pub bytes: u64,
    /// Size of the source in bytes.
    pub bytes_total: u64,
    /// Messages read, for recordings.
    pub messages: Option<u64>,
    /// Messages in the whole recording, if its index states it.
    pub messages_total: Option<u64>,
    /// Time covered by the windows that were read, nanoseconds of log time.
    pub time_ns: Option<i64>,
    /// Length of the whole recording, nanoseconds of log time.
    pub time_total_ns: Option<i64>,
    /// Windows that were read without a break, if only a part of the recording was read.
    pub windows: Option<u64>,
}

/// For a text out of another source: its origin.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Derivation {
    /// The text of a message of a recording.
    Message(MessageRef),
    /// The expansion of a macro file: spans count in the expanded text.
    Expansion,
    /// A file that another one includes, and that is not an input itself.
    Included,
}

/// Where a part of an expansion is written.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ExpansionPart {
    /// The part.
    pub span: Span,
    /// Where it is written: in a macro, perhaps in another file.
    pub place: Place,
}

/// One input: its identity, kind and read status.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Source {
    /// Identity in this run.
    pub id: SourceId,
    /// The path as shown to the user.
    pub path: String,
    /// What it was recognised as.
    pub kind: SourceKind,
    /// How much could be read.
    pub status: ReadStatus,
    /// One line on the status, if there is something to report.
    pub detail: Option<String>,
    /// What was taken from it, in words: `3 transforms, 1 origin on the Earth`; `None` if nothing was taken.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub taken: Option<String>,
    /// Parts that look like a transform, or half of one, but were not read: the keys from the root, joined by `/`.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub not_understood: Vec<SourceValue<String>>,
    /// Further notes, a line each: what it was judged with.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub notes: Vec<String>,
    /// How much was examined.
    pub examined: Coverage,
    /// The text that spans point into; empty for binary sources.
    pub text: String,
    /// Set if the text was taken from another source.
    pub derived: Option<Derivation>,
    /// What went wrong while reading.
    pub problems: Vec<Problem>,
    /// Whether failing to read it makes the run incomplete. False for files in a folder
    /// that have no reader.
    pub required: bool,
    /// The files that it was read from here; none for a text out of another source, and for saved evidence.
    #[serde(skip)]
    pub files: Vec<PathBuf>,
    /// The meshes that it names and that were found here, by their names in it.
    #[serde(skip)]
    pub meshes: BTreeMap<String, MeshFile>,
    /// Of an expansion: where its parts are written.
    #[serde(skip)]
    pub written: Vec<ExpansionPart>,
    /// SHA-256 of each of its files, only if a report needs it.
    #[serde(skip)]
    pub hashes: Vec<FileHash>,
}

/// The identity of a file.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct FileHash {
    /// Its name, without the folder.
    pub name: String,
    /// SHA-256 in hexadecimal digits; `None` if it cannot be read any more.
    pub sha256: Option<String>,
}

/// A mesh that a description names.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct MeshFile {
    /// Where it is.
    pub path: PathBuf,
    /// Its size.
    pub bytes: u64,
}

/// How many parts that were not understood are named in a line.
const MAX_NAMED: usize = 4;

impl Source {
    /// What was read and what was not understood, in a line: `3 transforms; not understood: `extrinsics/lidar``.
    pub fn understood(&self) -> Option<String> {
        let (named, more) = self.not_understood.split_at(self.not_understood.len().min(MAX_NAMED));
        let named: Vec<String> = named.iter().map(|part| format!("`{}`", part.value)).collect();
        let more = if more.is_empty() {
            String::new()
        } else {
            format!(" and {} more", more.len())
        };
        let open = (!named.is_empty()).then(|| format!("not understood: {}{more}", named.join(", ")));
        let words: Vec<String> = self.taken.iter().cloned().chain(open).collect();
        (!words.is_empty()).then(|| words.join("; "))
    }

    /// What is missing from a source that was not read, or not in full.
    pub fn shortfall(&self) -> &str {
        self.detail.as_deref().unwrap_or("could not be read in full")
    }

    /// A source that nothing has been read from yet.
    pub fn new(id: SourceId, path: impl Into<String>, kind: SourceKind) -> Self {
        Self {
            id,
            path: path.into(),
            kind,
            status: ReadStatus::Read,
            detail: None,
            taken: None,
            not_understood: Vec::new(),
            notes: Vec::new(),
            examined: Coverage::default(),
            text: String::new(),
            derived: None,
            problems: Vec::new(),
            required: true,
            files: Vec::new(),
            meshes: BTreeMap::new(),
            written: Vec::new(),
            hashes: Vec::new(),
        }
    }

    /// Where a part of an expansion is written: the smallest element, start tag or attribute around it that is known; `None` in any other
    /// text, and if nothing is known.
    pub fn written(&self, place: &Place) -> Option<Place> {
        let span = place.span()?;
        let around = self
            .written
            .iter()
            .filter(|written| written.span.start <= span.start && span.end <= written.span.end);
        let smallest = around.min_by_key(|written| written.span.end - written.span.start)?;
        Some(smallest.place.clone())
    }

    /// Records a fault at a place and lowers the status to `status` if that is worse.
    pub fn problem(&mut self, status: ReadStatus, place: Place, message: impl Into<String>) {
        self.problem_with_help(status, place, message, None);
    }

    /// [`Source::problem`] with a line on what to do.
    pub fn problem_with_help(
        &mut self,
        status: ReadStatus,
        place: Place,
        message: impl Into<String>,
        help: Option<String>,
    ) {
        let message = message.into();
        self.status = self.status.max(status);
        if self.detail.is_none() {
            self.detail = Some(message.clone());
        }
        self.problems.push(Problem { place, message, help });
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_problem_can_only_lower_the_status() {
        let id = SourceId(0);
        let mut source = Source::new(id, "a.urdf", SourceKind::Urdf);
        source.problem(ReadStatus::Unreadable, Place::whole(id), "first");
        source.problem(ReadStatus::Partial, Place::whole(id), "second");
        assert_eq!(source.status, ReadStatus::Unreadable);
        assert_eq!(source.detail.as_deref(), Some("first"));
    }
}
