//! ROS 1 bags, format V2.0, with chunks of every compression that ROS wrote.
//!
//! Owns one pass over a bag and the report on it. Must not know what is inside messages.
//!
//! Format: <http://wiki.ros.org/Bags/Format/2.0>. A file is: magic, bag header, then chunks each followed by the index of
//! its messages, then (at a byte that the bag header names) the connections and one info for each chunk. A recording that
//! was not closed has no such end, and names byte 0.

mod chunk;
mod connection;
mod connections;
mod index;
mod record;
mod report;
mod sample;
mod scan;
mod sink;
mod tape;

use std::fs::File;
use std::sync::Arc;

use crate::source::{Place, ReadStatus, Source};

use super::inflate::Inflater;
use super::{Extent, Progress, Task};

use connections::Connections;
use index::{Index, IndexState};
use sink::Sink;
use tape::Tape;

/// The only version that is read; all recorders since 2010 write it.
const MAGIC: &[u8] = b"#ROSBAG V2.0\n";

/// One pass over a bag.
struct Pass<'a, 'v> {
    tape: Tape,
    sink: Sink<'v>,
    inflater: Inflater,
    /// Why there is no index.
    unindexed: Option<String>,
    /// Where the data end according to the bag header, with or without an index.
    data_end: Option<u64>,
    /// Whether the records could be followed to that end without a loss.
    data_ended: bool,
    /// Records of index data whose length contradicts their count.
    odd_index_data: u64,
    /// Chunks without compression that claim another size than they have.
    lying_sizes: u64,
    progress: Progress<'a>,
    /// Position of the last call of the progress function.
    last_progress: u64,
    /// Buffer for records outside chunks.
    record: Vec<u8>,
}

/// Reads a bag of any version; see [`super::read`].
pub(super) fn read(file: File, total: u64, first: &[u8], task: Task<'_>) -> Extent {
    let Task {
        wanted,
        source,
        progress,
        visit,
    } = task;
    if !first.starts_with(MAGIC) {
        refuse_version(first, source);
        return super::NOTHING;
    }
    let mut pass = Pass {
        tape: Tape::new(file, total),
        sink: Sink::new(Connections::new(visit)),
        inflater: Inflater::default(),
        unindexed: None,
        data_end: None,
        data_ended: false,
        odd_index_data: 0,
        lying_sizes: 0,
        progress,
        last_progress: 0,
        record: Vec::new(),
    };
    match index::find(&mut pass.tape) {
        IndexState::Index(index) => pass.take(index),
        IndexState::Open => pass.unindexed = Some("the recording was not closed and has no index".to_owned()),
        IndexState::Broken { why, at } => {
            pass.unindexed = Some(format!("the index cannot be used: {why}"));
            pass.data_end = at;
        }
        IndexState::Encrypted(with) => {
            let message = format!("the bag is encrypted with `{with}`");
            let help = "decrypt it with the key it was recorded with: `rosbag decompress` or `rosbag filter`";
            let whole = Place::whole(source.id);
            source.problem_with_help(ReadStatus::Unreadable, whole, message, Some(help.to_owned()));
            return super::NOTHING;
        }
    }
    if let Some(sampling) = &wanted.sampling
        && let Some(chosen) = pass.choose(sampling, &wanted)
    {
        return pass.sample(&chosen, source);
    }
    let failure = pass.scan().err();
    (pass.progress)(total, total);
    pass.report(failure, source)
}

impl Pass<'_, '_> {
    /// Uses an index: its connections are announced before the first message.
    fn take(&mut self, index: Index) {
        self.data_end = Some(index.at);
        match self.sink.connections.announce(&index) {
            Ok(()) => self.sink.index = Some(Arc::new(index)),
            Err(why) => self.unindexed = Some(format!("the index cannot be used: {why}")),
        }
    }
}

fn refuse_version(first: &[u8], source: &mut Source) {
    let line = first.split(|byte| *byte == b'\n').next().unwrap_or_default();
    let version: String = String::from_utf8_lossy(line)
        .chars()
        .skip_while(|letter| *letter != 'V')
        .take_while(|letter| letter.is_ascii_alphanumeric() || *letter == '.')
        .take(12)
        .collect();
    let message = format!("this ROS 1 bag has version {version}; only V2.0 is read");
    let help = "convert it on a machine with ROS 1: `rosbag filter old.bag new.bag True`, or `rosbag fix` if its message \
                types have changed since";
    source.problem_with_help(
        ReadStatus::Unreadable,
        Place::whole(source.id),
        message,
        Some(help.to_owned()),
    );
}
