//! The summary of an MCAP: what the file states about itself at its end.
//!
//! Owns reading it without trusting it: every offset and size is checked against the file before it is used.

use std::collections::{BTreeMap, BTreeSet};
use std::fs::File;
use std::io::{BufReader, Read, Seek, SeekFrom};

use ::mcap::records::{Record, op};

use super::super::MAX_MESSAGE;
use super::super::chunks::ChunkInfo;
use super::fields::Fields;
use super::{FRAME_LEN, MAGIC_LEN, MAX_CHUNK};

/// Bytes of the footer's body: start of the summary, start of its offsets, checksum.
const FOOTER_LEN: u64 = 20;
/// Bound on the chunks of an index: 1.5 TB in chunks of the usual 768 KiB.
const MAX_CHUNKS: usize = 2_000_000;

/// A chunk's record in the file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct ChunkAt {
    /// Where the record starts.
    pub(super) at: u64,
    /// Bytes of the record, its frame included.
    pub(super) len: u64,
}

/// What the summary says.
#[derive(Default)]
pub(super) struct Index {
    /// Schema and channel records, in order: kind and body.
    pub(super) definitions: Vec<(u8, Vec<u8>)>,
    /// Ids of the channels that are defined.
    channels: BTreeSet<u32>,
    /// The chunks, in the order of the file.
    pub(super) chunks: Vec<ChunkAt>,
    /// The same chunks in the form that the choice of chunks needs.
    pub(super) infos: Vec<ChunkInfo>,
    /// Messages in the file.
    pub(super) messages: Option<u64>,
    /// Messages by channel id.
    pub(super) totals: BTreeMap<u16, u64>,
    /// First and last log time, nanoseconds.
    pub(super) span_ns: Option<(i64, i64)>,
    /// Metadata records, and attachments by name and media type.
    pub(super) notes: super::notes::SummaryNotes,
    /// Bytes of the summary.
    pub(super) bytes: u64,
    /// Where it starts.
    start: u64,
}

/// Reads the summary. `Ok(None)` where the file has none; the error says why it cannot be used.
pub(super) fn read(mut file: &File, total: u64) -> Result<Option<Index>, String> {
    let tail = FRAME_LEN + FOOTER_LEN + MAGIC_LEN;
    if total < MAGIC_LEN + tail {
        return Ok(None);
    }
    let io = |error: std::io::Error| error.to_string();
    let mut footer = [0; 37];
    file.seek(SeekFrom::Start(total - tail)).map_err(io)?;
    file.read_exact(&mut footer).map_err(io)?;
    let [kind, rest @ ..] = footer;
    let Some((length, rest)) = rest.split_first_chunk::<8>() else {
        return Ok(None);
    };
    let Some((body, magic)) = rest.split_first_chunk::<20>() else {
        return Ok(None);
    };
    if kind != op::FOOTER || u64::from_le_bytes(*length) != FOOTER_LEN || magic != ::mcap::MAGIC {
        return Ok(None);
    }
    let mut fields = Fields(body);
    let (start, _, checksum) = (fields.u64()?, fields.u64()?, fields.u32()?);
    if start == 0 {
        return Ok(None);
    }
    let end = total - tail;
    if start < MAGIC_LEN || start > end {
        return Err(format!(
            "the footer places the summary at byte {start}, outside of the file"
        ));
    }
    let mut index = Index {
        bytes: end - start,
        start,
        ..Index::default()
    };
    file.seek(SeekFrom::Start(start)).map_err(io)?;
    let mut section = BufReader::with_capacity(1 << 18, file).take(end - start);
    let mut hash = crc32fast::Hasher::new();
    let mut body = Vec::new();
    while section.limit() > 0 {
        let mut frame = [0; 9];
        section.read_exact(&mut frame).map_err(io)?;
        let [kind, length @ ..] = frame;
        let length = u64::from_le_bytes(length);
        if length > section.limit() || length > MAX_MESSAGE {
            return Err(format!("a record of the summary claims {length} bytes"));
        }
        body.resize(usize::try_from(length).unwrap_or(0), 0);
        section.read_exact(&mut body).map_err(io)?;
        hash.update(&frame);
        hash.update(&body);
        index.record(kind, &body)?;
    }
    // The checksum covers the footer up to itself.
    hash.update(footer.get(..25).unwrap_or_default());
    if checksum != 0 && hash.finalize() != checksum {
        return Err("the checksum of the summary is wrong".to_owned());
    }
    index.sort()?;
    Ok(Some(index))
}

impl Index {
    /// Whether the chunks can be read by it: there are some, and every channel in them is defined.
    pub(super) fn is_usable(&self) -> bool {
        let held: BTreeSet<u32> = self.infos.iter().flat_map(|info| &info.channels).copied().collect();
        let counted = self.totals.iter().filter(|(_, count)| **count > 0);
        let counted: BTreeSet<u32> = counted.map(|(id, _)| u32::from(*id)).collect();
        // A writer without message indexes does not list the channels of its chunks.
        !counted.is_empty() && counted.is_subset(&held) && held.is_subset(&self.channels)
    }

    /// The numbers of the chunks by log time, where their order in the file is another and no two overlap: as readers by the index have them.
    pub(super) fn order_in_time(&self) -> Option<Vec<usize>> {
        let mut order: Vec<(&ChunkInfo, usize)> = self.infos.iter().zip(0..).collect();
        order.sort_by_key(|(info, _)| (info.start_ns, info.end_ns));
        let is_apart =
            |pair: &[(&ChunkInfo, usize)]| matches!(pair, [(one, _), (next, _)] if one.end_ns <= next.start_ns);
        let is_other = !order.is_sorted_by_key(|(_, number)| *number) && order.windows(2).all(is_apart);
        (is_other && self.is_usable()).then(|| order.into_iter().map(|(_, number)| number).collect())
    }

    fn record(&mut self, kind: u8, body: &[u8]) -> Result<(), String> {
        match kind {
            op::SCHEMA => self.definitions.push((kind, body.to_vec())),
            op::CHANNEL => {
                self.channels.insert(u32::from(Fields(body).u16()?));
                self.definitions.push((kind, body.to_vec()));
            }
            op::CHUNK_INDEX => self.chunk(body)?,
            op::STATISTICS => {
                let Ok(Record::Statistics(statistics)) = ::mcap::parse_record(kind, body) else {
                    return Err("the statistics cannot be parsed".to_owned());
                };
                self.messages = Some(statistics.message_count);
                self.totals = statistics.channel_message_counts;
                if statistics.message_count > 0 {
                    self.span_ns = Some((
                        signed(statistics.message_start_time),
                        signed(statistics.message_end_time),
                    ));
                }
            }
            op::METADATA_INDEX | op::ATTACHMENT_INDEX => self.notes.record(kind, body),
            _ => {}
        }
        Ok(())
    }

    /// start, end, offset, length, message index offsets (bytes, then channel and offset of each), length of the
    /// message index, name of the compression, compressed size, uncompressed size
    fn chunk(&mut self, body: &[u8]) -> Result<(), String> {
        let mut fields = Fields(body);
        let (start, end) = (fields.u64()?, fields.u64()?);
        let (at, len) = (fields.u64()?, fields.u64()?);
        let offsets = fields.u32()?;
        let mut offsets = Fields(fields.bytes(offsets)?);
        let mut channels = Vec::with_capacity(offsets.0.len() / 10);
        while !offsets.0.is_empty() {
            channels.push(u32::from(offsets.u16()?));
            offsets.u64()?;
        }
        channels.sort_unstable();
        channels.dedup();
        fields.u64()?;
        let name = fields.u32()?;
        fields.bytes(name)?;
        let (_, bytes) = (fields.u64()?, fields.u64()?);
        let inside = at >= MAGIC_LEN && at.checked_add(len).is_some_and(|end| end <= self.start);
        if !inside || bytes > MAX_CHUNK || start > end {
            return Err(format!("the index entry of the chunk at byte {at} is not valid"));
        }
        if self.chunks.len() >= MAX_CHUNKS {
            return Err(format!("the index lists more than {MAX_CHUNKS} chunks"));
        }
        self.chunks.push(ChunkAt { at, len });
        self.infos.push(ChunkInfo {
            start_ns: signed(start),
            end_ns: signed(end),
            bytes,
            channels,
        });
        Ok(())
    }

    /// Puts the chunks into the order of the file; none may overlap.
    fn sort(&mut self) -> Result<(), String> {
        let mut both: Vec<(ChunkAt, ChunkInfo)> = self.chunks.drain(..).zip(self.infos.drain(..)).collect();
        both.sort_by_key(|(chunk, _)| chunk.at);
        (self.chunks, self.infos) = both.into_iter().unzip();
        let overlap = self
            .chunks
            .iter()
            .zip(self.chunks.iter().skip(1))
            .find(|(one, next)| one.at + one.len > next.at);
        match overlap {
            Some((one, _)) => Err(format!("the index lists the chunk at byte {} twice", one.at)),
            None => Ok(()),
        }
    }
}

/// Nanoseconds as the rest of the tool counts them.
fn signed(ns: u64) -> i64 {
    i64::try_from(ns).unwrap_or(i64::MAX)
}
