//! Recordings: one interface for every container format.
//!
//! Owns the words channel and message, and the choice of the reader by a file's first bytes. Must not know what
//! is inside the messages, nor keep any of them.

mod channels;
mod kind;
mod mcap;

use std::collections::BTreeMap;
use std::fs::File;
use std::io::{Read, Seek, SeekFrom};
use std::path::Path;
use std::sync::Arc;

use crate::source::{Place, ReadStatus, Source};

pub use kind::Container;

/// Told `(bytes done, bytes in all)` while a recording is read.
pub type Progress<'a> = &'a dyn Fn(u64, u64);

/// One channel of a recording: a topic as one writer published it. A topic may have several.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Channel {
    /// Running number in this pass, from 0, in the order of first appearance.
    pub number: usize,
    /// The topic.
    pub topic: String,
    /// Type of the messages (`sensor_msgs/msg/Imu`); empty where the recording names none.
    pub message_type: String,
    /// The definition of the type; empty where the recording holds none, or none that is text.
    pub schema_text: Arc<str>,
    /// Encoding of the definition (`ros2msg`, `ros2idl`, `protobuf`, `jsonschema`); empty where there is none.
    pub schema_encoding: String,
    /// Encoding of the messages (`cdr`, `protobuf`, `json`, `ros1`).
    pub message_encoding: String,
    /// What the recorder noted of the channel; rosbag2 writes `offered_qos_profiles`.
    pub metadata: BTreeMap<String, String>,
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
    /// A channel, before its first message. Channels without messages are told too.
    fn channel(&mut self, channel: &Channel);
    /// A message of a channel told before.
    fn message(&mut self, channel: &Channel, message: &Message<'_>);
}

/// Reads a recording once, whatever its format, and says in `source` how far that went: its status, its detail, what
/// was examined and every problem. Returns whether messages may be missing at the end (or after a fault), so that
/// absence proves nothing.
pub fn read(path: &Path, source: &mut Source, progress: Progress<'_>, visit: &mut dyn Visit) -> bool {
    let whole = Place::whole(source.id);
    let (file, total) = match open(path) {
        Ok(opened) => opened,
        Err(message) => {
            source.problem(ReadStatus::Unreadable, whole, message);
            return true;
        }
    };
    source.examined.bytes_total = total;
    source.examined.messages = Some(0);
    let container = Container::of(&first_bytes(&file));
    if container == Container::Mcap {
        return mcap::read(file, total, source, progress, visit);
    }
    let (message, help) = container.refusal();
    source.problem_with_help(ReadStatus::Unreadable, whole, message, help.map(str::to_owned));
    true
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

/// The first bytes of a file, which is left rewound; fewer where it is shorter or cannot be read.
fn first_bytes(mut file: &File) -> Vec<u8> {
    let mut first = Vec::new();
    // What cannot be read is no magic; a lasting fault shows again when the file is read in earnest.
    let _ = file.take(kind::SNIFFED).read_to_end(&mut first);
    let _ = file.seek(SeekFrom::Start(0));
    first
}
