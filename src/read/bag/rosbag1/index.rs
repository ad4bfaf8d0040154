//! The index of a ROS 1 bag: the bag header at its top, the connections and chunk infos at its end.
//!
//! Owns what the index claims, checked against the file's length and for consistency. Whether it describes the chunks
//! correctly is known only when they are read.

use std::collections::BTreeMap;

use super::super::MAX_MESSAGE;
use super::connection::{Connection, connection};
use super::record::{Fault, Fields, kind, op};
use super::tape::Tape;

/// Length of `#ROSBAG V2.0\n`.
pub(super) const MAGIC_LEN: u64 = 13;
/// Bound on the index, bytes. The largest recordings have some ten thousand chunks with some hundred connections each.
const MAX_INDEX: u64 = 256 << 20;

/// A chunk as the index describes it.
#[derive(Clone, Debug)]
pub(super) struct ChunkInfo {
    /// Byte of its record.
    pub(super) at: u64,
    /// First log time in it, nanoseconds.
    pub(super) start_ns: i64,
    /// Last log time in it, nanoseconds.
    pub(super) end_ns: i64,
    /// Messages in it, by connection.
    pub(super) counts: Box<[(u32, u32)]>,
}

/// The index.
#[derive(Clone, Debug)]
pub(super) struct Index {
    /// Its first byte: the messages end here.
    pub(super) at: u64,
    pub(super) connections: Vec<Connection>,
    /// In the order of the file.
    pub(super) chunks: Vec<ChunkInfo>,
    /// Messages in the whole recording, by connection.
    pub(super) totals: BTreeMap<u32, u64>,
}

/// What the top of the file leads to.
pub(super) enum IndexState {
    Index(Index),
    /// The recording was never closed: there is no index.
    Open,
    /// Why an existing index cannot be used, and where it should begin, if that is in the file.
    Broken {
        why: String,
        at: Option<u64>,
    },
    /// The bag is encrypted, with this.
    Encrypted(String),
}

/// Reads the bag header and the index it points to. The position of the tape is undefined afterwards.
pub(super) fn find(tape: &mut Tape) -> IndexState {
    let broken = |why, at| IndexState::Broken { why, at };
    let top = match top(tape) {
        Ok(top) => top,
        Err(fault) => return broken(format!("the bag header is damaged ({})", words(fault)), None),
    };
    if !top.encryptor.is_empty() {
        return IndexState::Encrypted(top.encryptor);
    }
    match top.index_pos {
        0 => IndexState::Open,
        at if at > tape.total => broken(format!("it should begin at byte {at}, past the end of the file"), None),
        at if at < MAGIC_LEN => broken(format!("it should begin at byte {at}, inside the magic"), None),
        at => match load(tape, &top) {
            Ok(index) => IndexState::Index(index),
            Err(why) => broken(why, Some(at)),
        },
    }
}

struct Top {
    index_pos: u64,
    conn_count: u32,
    chunk_count: u32,
    encryptor: String,
}

fn top(tape: &mut Tape) -> Result<Top, Fault> {
    tape.seek_anew(MAGIC_LEN)?;
    let frame = tape.frame()?;
    let fields = frame.fields()?;
    if fields.op() != op::BAG_HEADER {
        return Err(Fault::Wrong(format!("a {} record is in its place", kind(fields.op()))));
    }
    let read = || {
        Ok(Top {
            index_pos: fields.u64("index_pos")?,
            conn_count: fields.u32("conn_count")?,
            chunk_count: fields.u32("chunk_count")?,
            encryptor: fields.text("encryptor").unwrap_or_default(),
        })
    };
    read().map_err(Fault::Wrong)
}

fn load(tape: &mut Tape, top: &Top) -> Result<Index, String> {
    let len = tape.total.saturating_sub(top.index_pos);
    if len > MAX_INDEX {
        return Err(format!("it has {len} bytes, above the limit of {MAX_INDEX}"));
    }
    let mut index = Index {
        at: top.index_pos,
        connections: Vec::new(),
        chunks: Vec::new(),
        totals: BTreeMap::new(),
    };
    let mut data = Vec::new();
    tape.seek_anew(top.index_pos).map_err(words)?;
    while tape.rest() > 0 {
        let begin = tape.at;
        let record = (|| {
            let frame = tape.frame()?;
            if frame.len > MAX_MESSAGE {
                return Err(Fault::Wrong(format!("a record of {} bytes", frame.len)));
            }
            tape.load(&mut data, frame.len)?;
            index.record(&frame.fields()?, &data).map_err(Fault::Wrong)
        })();
        record.map_err(|fault| format!("it is damaged at byte {begin}: {}", words(fault)))?;
    }
    index.check(top)?;
    Ok(index)
}

impl Index {
    fn record(&mut self, fields: &Fields<'_>, data: &[u8]) -> Result<(), String> {
        match fields.op() {
            op::CONNECTION => self.connections.push(connection(fields, data)?),
            op::CHUNK_INFO => {
                let count = u64::from(fields.u32("count")?);
                let (pairs, rest) = data.as_chunks::<8>();
                if pairs.len() as u64 != count || !rest.is_empty() {
                    return Err(format!("a chunk info with {count} counts in {} bytes", data.len()));
                }
                let counts: Box<[_]> = pairs
                    .iter()
                    .map(|[a, b, c, d, counts @ ..]| {
                        (u32::from_le_bytes([*a, *b, *c, *d]), u32::from_le_bytes(*counts))
                    })
                    .collect();
                for (connection, count) in &counts {
                    *self.totals.entry(*connection).or_default() += u64::from(*count);
                }
                self.chunks.push(ChunkInfo {
                    at: fields.u64("chunk_pos")?,
                    start_ns: fields.time_ns("start_time")?,
                    end_ns: fields.time_ns("end_time")?,
                    counts,
                });
            }
            other => return Err(format!("it contains a {} record", kind(other))),
        }
        Ok(())
    }

    /// Compares the index with the counts in the bag header and the file's length.
    fn check(&mut self, top: &Top) -> Result<(), String> {
        let (connections, chunks) = (self.connections.len(), self.chunks.len());
        if connections as u64 != u64::from(top.conn_count) || chunks as u64 != u64::from(top.chunk_count) {
            return Err(format!(
                "it holds {connections} connections and {chunks} chunks, but the bag header says {} and {}",
                top.conn_count, top.chunk_count
            ));
        }
        self.chunks.sort_by_key(|chunk| chunk.at);
        let mut last = MAGIC_LEN;
        for chunk in &self.chunks {
            if chunk.at <= last || chunk.at >= self.at {
                return Err(format!(
                    "it lists a chunk at byte {}, where there can be none",
                    chunk.at
                ));
            }
            last = chunk.at;
        }
        Ok(())
    }

    /// The chunk at a byte.
    pub(super) fn chunk_at(&self, at: u64) -> Option<&ChunkInfo> {
        let number = self.chunks.binary_search_by_key(&at, |chunk| chunk.at).ok()?;
        self.chunks.get(number)
    }

    /// Where the first chunk after a byte is.
    pub(super) fn next_chunk(&self, behind: u64) -> Option<u64> {
        let number = self.chunks.partition_point(|chunk| chunk.at <= behind);
        self.chunks.get(number).map(|chunk| chunk.at)
    }

    /// Messages in the whole recording.
    pub(super) fn messages(&self) -> u64 {
        self.totals.values().sum()
    }

    /// First and last log time of the whole recording, nanoseconds; `None` where it has no messages.
    pub(super) fn span_ns(&self) -> Option<(i64, i64)> {
        let spoken = || self.chunks.iter().filter(|chunk| !chunk.counts.is_empty());
        let first = spoken().map(|chunk| chunk.start_ns).min();
        let span = first.zip(spoken().map(|chunk| chunk.end_ns).max());
        span.filter(|(first, last)| first <= last)
    }
}

/// A fault in words.
pub(super) fn words(fault: Fault) -> String {
    match fault {
        Fault::Ended => "the file ends inside a record".to_owned(),
        Fault::Wrong(why) => why,
    }
}
