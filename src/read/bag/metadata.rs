//! `metadata.yaml`, which rosbag2 writes into the folder of a recording.
//!
//! Owns the file's layout in every version (1 to 9) and the places in its text. Must not open recordings, nor judge
//! whether the file is right.

use std::collections::BTreeMap;
use std::fmt::Write;
use std::fs::File;
use std::io::Read;
use std::path::Path;

use crate::read::calibration::document::{Kind, Node};
use crate::read::calibration::events;
use crate::read::calibration::repair::OffsetMap;
use crate::read::text;
use crate::source::Span;

/// The name of the file.
pub(in crate::read) const NAME: &str = "metadata.yaml";
/// The key by which a YAML file is recognised as one.
pub(in crate::read) const ROOT: &str = "rosbag2_bagfile_information";
/// Larger files are refused; a thousand topics in a thousand files take one megabyte.
const MAX_BYTES: u64 = 32 << 20;
/// Bound on the files of a recording.
const MAX_FILES: usize = 100_000;
/// Deepest nesting that is written back as text.
const MAX_DEPTH: usize = 4;

/// A value with its place in the text.
pub(super) type Spanned<T> = Option<(T, Span)>;

/// What the file says about a recording.
#[derive(Clone, Debug, Default)]
pub(in crate::read) struct Metadata {
    /// The text that the places point into.
    pub(super) text: String,
    /// Version of the layout.
    pub(super) version: Spanned<u64>,
    /// `sqlite3` or `mcap`.
    pub(super) storage: Spanned<String>,
    /// Compression of files or messages; empty where nothing is compressed.
    pub(super) compression_format: Spanned<String>,
    /// The files as they are named, in order.
    pub(super) files: Vec<(String, Span)>,
    /// Topics, by name.
    pub(super) topics: BTreeMap<String, TopicEntry>,
    /// Messages in all files.
    pub(super) messages: Spanned<u64>,
    /// Time of the first message, nanoseconds.
    pub(super) start_ns: Spanned<i64>,
    /// From the first message to the last one, nanoseconds.
    pub(super) duration_ns: Spanned<i64>,
    /// The distribution that recorded.
    pub(super) ros_distro: Option<String>,
    /// What the user stored in the recording besides messages.
    pub(super) custom_data: BTreeMap<String, String>,
    /// Where and why the text could not be read further.
    pub(super) fault: Option<(usize, String)>,
}

/// What the file says about a topic.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct TopicEntry {
    /// Where its name is.
    pub(super) name_at: Span,
    /// Type of the messages.
    pub(super) message_type: Spanned<String>,
    /// Offered QoS profiles, as the YAML text that older versions write.
    pub(super) offered_qos_profiles: String,
    /// Number of messages.
    pub(super) messages: Spanned<u64>,
}

impl Metadata {
    /// Reads the file at `path`. `Ok(None)` where it is YAML of another kind.
    pub(in crate::read) fn read(path: &Path) -> Result<Option<Self>, String> {
        let cannot = |error: std::io::Error| format!("cannot be opened: {error}");
        if !std::fs::metadata(path).map_err(cannot)?.is_file() {
            return Err("is not a regular file".to_owned());
        }
        let mut bytes = Vec::new();
        let file = File::open(path).map_err(cannot)?;
        file.take(MAX_BYTES + 1).read_to_end(&mut bytes).map_err(cannot)?;
        if bytes.len() as u64 > MAX_BYTES {
            return Err(format!("is larger than {} MB", MAX_BYTES >> 20));
        }
        let (text, _) = text::decode(bytes)?;
        Ok(Self::parse(text))
    }

    /// Reads the metadata that names the file at `path`, from the folder of that file.
    pub(in crate::read) fn beside(path: &Path) -> Option<Self> {
        let metadata = Self::read(&path.parent()?.join(NAME)).ok()??;
        let name = path.file_name()?;
        let names_it = |(file, _): &(String, Span)| Path::new(file).file_name() == Some(name);
        metadata.files.iter().any(names_it).then_some(metadata)
    }

    /// Reads a text. `None` where it is YAML of another kind.
    pub(super) fn parse(text: String) -> Option<Self> {
        let bom = text.len() - text.trim_start_matches('\u{feff}').len();
        let documents = events::build(text.get(bom..).unwrap_or_default(), &OffsetMap::starting_at(bom));
        let fault = documents.fault.map(|fault| (fault.at, fault.message));
        let Some(root) = documents.roots.iter().find_map(|root| root.get(ROOT)) else {
            // A text that ends before its first value is still recognised by its first line.
            let is_one = fault.is_some() && text.lines().any(|line| line.starts_with(ROOT));
            return is_one.then(|| Self {
                text,
                fault,
                ..Self::default()
            });
        };
        let mut said = Self {
            version: placed(root, "version", number),
            storage: placed(root, "storage_identifier", string),
            compression_format: placed(root, "compression_format", string),
            messages: placed(root, "message_count", number),
            start_ns: within(root, "starting_time", "nanoseconds_since_epoch"),
            duration_ns: within(root, "duration", "nanoseconds"),
            ros_distro: root.get("ros_distro").and_then(string).filter(|name| !name.is_empty()),
            fault,
            ..Self::default()
        };
        let files = root
            .get("relative_file_paths")
            .and_then(Node::items)
            .unwrap_or_default();
        said.files = files
            .iter()
            .filter_map(|file| Some((string(file).filter(|name| !name.is_empty())?, file.span)))
            .take(MAX_FILES)
            .collect();
        let topics = root.get("topics_with_message_count").and_then(Node::items);
        for entry in topics.unwrap_or_default() {
            if let Some((name, topic)) = topic(entry) {
                said.topics.insert(name, topic);
            }
        }
        for (key, value) in root.get("custom_data").map(Node::pairs).unwrap_or_default() {
            if let (Some(key), Some(value)) = (key.text(), value.text()) {
                said.custom_data.insert(key.to_owned(), value.to_owned());
            }
        }
        said.text = text;
        Some(said)
    }
}

fn topic(entry: &Node) -> Option<(String, TopicEntry)> {
    let about = entry.get("topic_metadata")?;
    let name = about.get("name")?;
    let topic = TopicEntry {
        name_at: name.span,
        message_type: placed(about, "type", string),
        offered_qos_profiles: about.get("offered_qos_profiles").map(profiles).unwrap_or_default(),
        messages: placed(entry, "message_count", number),
    };
    Some((name.text()?.to_owned(), topic))
}

/// QoS profiles: YAML inside of a text up to version 8, a list since.
fn profiles(node: &Node) -> String {
    let mut text = String::new();
    match &node.kind {
        Kind::Scalar { text: inner, .. } => text.push_str(inner),
        Kind::Sequence(profiles) => {
            for profile in profiles {
                let start = text.len();
                lines(profile, 1, &mut text);
                // The first line of an item carries the dash.
                if text.len() > start {
                    text.replace_range(start..start + 2, "- ");
                }
            }
        }
        Kind::Mapping(_) => {}
    }
    text
}

/// Writes a mapping as block YAML, two spaces a level.
fn lines(node: &Node, depth: usize, out: &mut String) {
    for (key, value) in node.pairs() {
        let Some(key) = key.text() else { continue };
        let indent = "  ".repeat(depth);
        match value.text() {
            Some(value) => {
                let _ = writeln!(out, "{indent}{key}: {value}");
            }
            None if depth < MAX_DEPTH => {
                let _ = writeln!(out, "{indent}{key}:");
                lines(value, depth + 1, out);
            }
            None => {}
        }
    }
}

fn placed<T>(node: &Node, key: &str, read: impl Fn(&Node) -> Option<T>) -> Spanned<T> {
    let value = node.get(key)?;
    Some((read(value)?, value.span))
}

fn within(node: &Node, key: &str, inner: &str) -> Spanned<i64> {
    placed(node.get(key)?, inner, |value| value.text()?.parse().ok())
}

fn string(node: &Node) -> Option<String> {
    node.text().map(|text| text.trim().to_owned())
}

fn number(node: &Node) -> Option<u64> {
    node.text()?.trim().parse().ok()
}
