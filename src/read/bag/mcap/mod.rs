//! MCAP files: chunk after chunk over ordinary file reads, all of them or those that the index recommends.
//!
//! Owns the frame of records: every position is known, attachments and indexes are skipped, and nothing a file claims is
//! trusted before it is checked against the file's length. The mcap crate parses the inside of chunks. Must not know what is inside messages.
//!
//! Format: <https://mcap.dev/spec>. A file is: magic, records, a data-end record, the summary, a footer, magic; a record
//! is a kind (1 byte), a length (8 bytes, little-endian) and as many bytes.

mod channels;
mod chunk;
mod fields;
mod index;
mod notes;
mod report;

use std::fs::File;
use std::io::{BufReader, Read, Seek, SeekFrom};

use ::mcap::records::{Record, op};

use crate::source::{Place, ReadStatus, Source};

use self::channels::{Channels, KIND_ZERO};
use self::chunk::ChunkHead;
use self::index::{ChunkAt, Index};
use super::chunks::{self, MarkedChannels};
use super::inflate::Inflater;
use super::{Extent, MAX_MESSAGE, Progress, Selection, Task};

/// Bound on the uncompressed size a chunk may claim, bytes; recorders cut chunks at some megabytes.
const MAX_CHUNK: u64 = 1 << 30;
/// Chunks up to this size, bytes, are decompressed as a whole and checked before the first message is used. Larger ones,
/// and a chunk that the file's end cuts, are streamed.
const MAX_WHOLE_CHUNK: u64 = 64 << 20;
/// Bytes between two calls of the progress function.
const PROGRESS_STEP: u64 = 4 << 20;

/// Chunks of the index that are tried after a fault.
const MOST_TRIED: usize = 64;

const MAGIC_LEN: u64 = 8;
const FRAME_LEN: u64 = 9;

/// Why reading stopped before the end of the file.
struct Stop {
    /// Everything before this byte was used.
    at: u64,
    why: String,
    /// Whether messages may be missing: the fault is before the end of the data section.
    loses_messages: bool,
}

struct Pass<'a, 'v> {
    file: BufReader<File>,
    /// Position in the file.
    at: u64,
    total: u64,
    /// Everything before this byte was used.
    used: u64,
    channels: Channels<'v>,
    inflater: Inflater,
    /// Damaged chunks, after which reading continued.
    faults: Vec<Stop>,
    progress: Progress<'a>,
    last_progress: u64,
    /// Buffer for records outside chunks.
    record: Vec<u8>,
    /// Kind and place of the record in the buffer, while it has not been used.
    held: Option<(u8, u64)>,
    data_ended: bool,
    /// Messages in the file as its statistics say.
    promised: Option<u64>,
}

/// Reads an MCAP that starts with its magic; see [`super::read`].
pub(super) fn read(file: File, total: u64, task: Task<'_>) -> Extent {
    let Task {
        wanted,
        source,
        progress,
        visit,
    } = task;
    let (index, useless) = match index::read(&file, total) {
        Ok(index) => (index.unwrap_or_default(), None),
        Err(why) => (Index::default(), Some(why)),
    };
    let mut pass = Pass {
        file: BufReader::with_capacity(1 << 18, file),
        at: 0,
        total,
        used: 0,
        channels: Channels::new(visit),
        inflater: Inflater::default(),
        faults: Vec::new(),
        progress,
        last_progress: 0,
        record: Vec::new(),
        held: None,
        data_ended: false,
        promised: None,
    };
    pass.channels.totals.clone_from(&index.totals);
    pass.channels.repeated.clone_from(&index.definitions);
    let mut extent = Extent {
        truncated: false,
        whole: true,
        indexed: false,
        messages_total: index.messages,
        span_ns: index.span_ns,
    };
    let sampled = wanted.sampling.filter(|_| index.is_usable());
    if let Some(sampling) = sampled
        && let Some(chosen) = pass.choose(&index, &sampling, &wanted)
    {
        pass.noted(&index.notes);
        extent.indexed = true;
        extent.whole = false;
        extent.truncated = pass.sampled(&index, &chosen, source);
        return extent;
    }
    if let Some(order) = index.order_in_time().filter(|order| pass.is_as_indexed(&index, order)) {
        pass.noted(&index.notes);
        extent.truncated = pass.ordered(&index, &order, source);
        return extent;
    }
    let stopped = pass.seek(0).and_then(|()| pass.run(&index)).err();
    (pass.progress)(pass.used, total);
    extent.truncated = pass.report(stopped, index.messages, source);
    if let Some(why) = useless.filter(|_| source.problems.is_empty()) {
        let message = format!("the index at the end of the file cannot be used, every record was read instead: {why}");
        source.problem(ReadStatus::Read, Place::whole(source.id), message);
    }
    extent.messages_total = extent.messages_total.or(pass.promised);
    extent
}

/// First and last log time, nanoseconds, where the summary says.
pub(super) fn span(file: &File, total: u64) -> Option<(i64, i64)> {
    index::read(file, total).ok()??.span_ns
}

impl Pass<'_, '_> {
    /// The chunks that are read, where that is less than all of them. `None` as well where the index is wrong.
    fn choose(&mut self, index: &Index, sampling: &super::Sampling, wanted: &Selection<'_>) -> Option<Vec<usize>> {
        let all: u64 = index.infos.iter().map(|info| info.bytes).sum();
        if all <= sampling.bytes {
            return None;
        }
        self.define(index).then_some(())?;
        let marked = MarkedChannels::of(wanted, |is_wanted| self.channels.wanted(is_wanted));
        let chosen = chunks::choose(&index.infos, sampling, &marked);
        if chosen.len() == index.chunks.len() {
            return None;
        }
        self.are_there(index, &chosen).then_some(chosen)
    }

    /// Whether every chunk can be read by the index, in this order.
    fn is_as_indexed(&mut self, index: &Index, order: &[usize]) -> bool {
        self.are_there(index, order) && self.define(index)
    }

    /// Takes in the schemas and channels of the index.
    fn define(&mut self, index: &Index) -> bool {
        let mut definitions = index.definitions.iter();
        definitions.all(|(kind, body)| self.channels.record(*kind, body).is_ok())
    }

    /// Whether there is a chunk of the right size at each place of the index; checked before the first message is used.
    fn are_there(&mut self, index: &Index, numbers: &[usize]) -> bool {
        numbers.iter().all(|number| {
            let (Some(chunk), Some(info)) = (index.chunks.get(*number), index.infos.get(*number)) else {
                return false;
            };
            self.chunk_at(*chunk).is_ok_and(|head| {
                head.size == info.bytes && head.size.max(head.packed) <= MAX_WHOLE_CHUNK && head.compression.is_some()
            })
        })
    }

    /// Goes to a chunk and reads its header.
    fn chunk_at(&mut self, chunk: ChunkAt) -> Result<ChunkHead, Stop> {
        self.seek(chunk.at)?;
        self.used = chunk.at;
        let (opcode, len) = self.frame()?;
        if opcode != op::CHUNK || len + FRAME_LEN != chunk.len {
            return Err(self.stop("there is no such chunk where the index says"));
        }
        self.chunk_head(len, len)
    }

    /// Reads a part of the chunks; returns whether messages may be missing among them.
    fn sampled(&mut self, index: &Index, chosen: &[usize], source: &mut Source) -> bool {
        source.examined.bytes = index.bytes + self.chosen(index, chosen, false);
        source.examined.messages = Some(self.channels.messages);
        if let Some(message) = self.damage(" of the sample") {
            let status = self.status_of_damage();
            source.problem(status, Place::whole(source.id), message);
        }
        !self.faults.is_empty()
    }

    /// Reads every chunk, in this order; returns whether messages may be missing.
    fn ordered(&mut self, index: &Index, order: &[usize], source: &mut Source) -> bool {
        self.chosen(index, order, true);
        self.used = self.total;
        self.report(None, index.messages, source)
    }

    /// Reads chunks in this order, one behind the other in time where they are `consecutive`; returns their bytes.
    fn chosen(&mut self, index: &Index, chosen: &[usize], consecutive: bool) -> u64 {
        let chunks = || {
            chosen
                .iter()
                .filter_map(|number| Some((*number, *index.chunks.get(*number)?)))
        };
        let of: u64 = chunks().map(|(_, chunk)| chunk.len).sum();
        let (mut done, mut previous) = (0, None);
        for (number, chunk) in chunks() {
            let seam = !consecutive && number > previous.map_or(0, |previous: usize| previous + 1);
            previous = Some(number);
            let result = self.chunk_at(chunk).and_then(|head| self.pack(&head, chunk.at, seam));
            self.note(result);
            done += chunk.len;
            (self.progress)(done, of);
        }
        let result = self.flush();
        self.note(result);
        of
    }

    fn note(&mut self, result: Result<(), Stop>) {
        if let Err(stop) = result {
            self.faults.push(stop);
            // The next chunk does not follow what was read of this one.
            self.channels.lose();
        }
    }

    /// Reads record after record up to the footer and the magic after it. Where the records cannot be followed any more, reading continues
    /// with the next chunk of the index.
    fn run(&mut self, index: &Index) -> Result<(), Stop> {
        self.skip(MAGIC_LEN)?;
        loop {
            let result = self.records(index);
            // What was read before the fault is used first.
            self.flush()?;
            let Err(stop) = result else { return self.end() };
            match self.next_chunk(index, self.used) {
                Some(next) if !self.data_ended => self.go_on(stop, next)?,
                _ => return Err(stop),
            }
        }
    }

    /// Skips a damaged part, up to a byte after it.
    fn go_on(&mut self, stop: Stop, at: u64) -> Result<(), Stop> {
        self.flush()?;
        self.note(Err(stop));
        self.seek(at)
    }

    /// The first chunk of the index after a byte that really exists.
    fn next_chunk(&mut self, index: &Index, behind: u64) -> Option<u64> {
        let from = index.chunks.partition_point(|chunk| chunk.at <= behind);
        let chunks = index.chunks.get(from..)?.iter().take(MOST_TRIED);
        let there = self.at;
        let mut found = None;
        for chunk in chunks {
            let frame = self.seek(chunk.at).and_then(|()| self.frame());
            if frame.is_ok_and(|(opcode, len)| opcode == op::CHUNK && len.saturating_add(FRAME_LEN) == chunk.len) {
                found = Some(chunk.at);
                break;
            }
        }
        self.seek(there).ok()?;
        found
    }

    fn records(&mut self, index: &Index) -> Result<(), Stop> {
        self.held = None;
        loop {
            self.used = self.at;
            if self.at >= self.last_progress + PROGRESS_STEP {
                self.last_progress = self.at;
                (self.progress)(self.at, self.total);
            }
            if self.at >= self.total {
                self.take_held()?;
                return Err(self.stop("the file ends without a footer: the recording was not closed"));
            }
            let (opcode, len) = match self.frame() {
                Err(stop) => return self.take_held().and(Err(stop)),
                Ok(frame) => frame,
            };
            let available = self.total - self.at;
            let (at, end) = (self.used, self.at.saturating_add(len));
            let known = index.chunks.partition_point(|chunk| chunk.at <= at);
            let is_crossed = index.chunks.get(known).is_some_and(|chunk| chunk.at < end);
            if is_crossed && !self.data_ended && self.next_chunk(index, at).is_some_and(|next| next < end) {
                let kind = kind(opcode);
                return Err(self.stop(format!("a {kind} record of {len} bytes reaches into the next chunk")));
            }
            if opcode == 0 {
                return Err(self.stop(KIND_ZERO));
            }
            if len <= available || len <= MAX_CHUNK {
                self.take_held()?;
            }
            if opcode == op::CHUNK && !self.data_ended {
                match self.chunk(len, available) {
                    Err(stop) if len <= available => self.go_on(stop, end)?,
                    result => result?,
                }
                continue;
            }
            if len > available {
                return Err(self.stop(format!("the file ends inside a {} record of {len} bytes", kind(opcode))));
            }
            match opcode {
                op::FOOTER => return self.skip(len),
                op::STATISTICS => {
                    self.load(opcode, len)?;
                    if let Ok(Record::Statistics(statistics)) = ::mcap::parse_record(opcode, &self.record) {
                        self.promised = Some(statistics.message_count);
                    }
                }
                op::DATA_END => {
                    self.skip(len)?;
                    self.data_ended = true;
                }
                // After the data the summary repeats schemas and channels.
                op::SCHEMA | op::CHANNEL | op::MESSAGE if !self.data_ended => {
                    self.load(opcode, len)?;
                    self.held = Some((opcode, at));
                }
                op::METADATA | op::ATTACHMENT if !self.data_ended => self.note_here(opcode, len)?,
                _ => self.skip(len)?,
            }
        }
    }

    /// Uses the record that was loaded last, if there is one. This happens only when the next one begins correctly: lost or changed bytes
    /// are in the record before the fault.
    fn take_held(&mut self) -> Result<(), Stop> {
        let Some((opcode, start)) = self.held.take() else {
            return Ok(());
        };
        // Chunks that are still being decompressed come first.
        let (at, used) = (self.at, self.used);
        self.flush()?;
        (self.at, self.used) = (at, used);
        let result = self.channels.record(opcode, &self.record);
        result.map_err(|why| Stop {
            at: start,
            ..self.stop(why)
        })
    }

    /// What follows the footer: the magic, and nothing else.
    fn end(&mut self) -> Result<(), Stop> {
        let mut magic = [0; 8];
        if self.total - self.at < MAGIC_LEN {
            return Err(self.stop("the file ends inside the closing magic"));
        }
        self.read_exact(&mut magic)?;
        if magic != ::mcap::MAGIC {
            return Err(self.stop("the closing magic is missing after the footer"));
        }
        self.used = self.at;
        let rest = self.total - self.at;
        if rest > 0 {
            return Err(self.stop(format!("{rest} bytes follow the end of the recording")));
        }
        if !self.data_ended {
            return Err(self.stop("the data end record is missing"));
        }
        Ok(())
    }

    /// The kind and the length of the next record.
    fn frame(&mut self) -> Result<(u8, u64), Stop> {
        if self.total - self.at < FRAME_LEN {
            return Err(self.stop("the file ends inside the header of a record"));
        }
        let mut frame = [0; 9];
        self.read_exact(&mut frame)?;
        let [opcode, len @ ..] = frame;
        Ok((opcode, u64::from_le_bytes(len)))
    }

    /// Loads the body of a record into `self.record`.
    fn load(&mut self, opcode: u8, len: u64) -> Result<(), Stop> {
        if len > MAX_MESSAGE {
            return Err(self.stop(format!(
                "a {} record of {len} bytes is above the limit of {MAX_MESSAGE}",
                kind(opcode)
            )));
        }
        let mut record = std::mem::take(&mut self.record);
        record.resize(usize::try_from(len).unwrap_or(0), 0);
        self.read_exact(&mut record)?;
        self.record = record;
        Ok(())
    }

    fn read_exact(&mut self, buffer: &mut [u8]) -> Result<(), Stop> {
        self.file
            .read_exact(buffer)
            .map_err(|error| self.stop(error.to_string()))?;
        self.at += buffer.len() as u64;
        Ok(())
    }

    /// Skips bytes that are known to exist.
    fn skip(&mut self, len: u64) -> Result<(), Stop> {
        let offset = i64::try_from(len).unwrap_or(i64::MAX);
        self.file
            .seek_relative(offset)
            .map_err(|error| self.stop(error.to_string()))?;
        self.at += len;
        Ok(())
    }

    fn seek(&mut self, at: u64) -> Result<(), Stop> {
        self.file
            .seek(SeekFrom::Start(at))
            .map_err(|error| self.stop(error.to_string()))?;
        self.at = at;
        Ok(())
    }

    fn stop(&self, why: impl Into<String>) -> Stop {
        Stop {
            at: self.used,
            why: why.into(),
            loses_messages: !self.data_ended,
        }
    }
}

/// The name of a kind of record.
fn kind(opcode: u8) -> String {
    let name = match opcode {
        op::HEADER => "header",
        op::FOOTER => "footer",
        op::SCHEMA => "schema",
        op::CHANNEL => "channel",
        op::MESSAGE => "message",
        op::CHUNK => "chunk",
        op::MESSAGE_INDEX => "message index",
        op::CHUNK_INDEX => "chunk index",
        op::ATTACHMENT => "attachment",
        op::ATTACHMENT_INDEX => "attachment index",
        op::STATISTICS => "statistics",
        op::METADATA => "metadata",
        op::METADATA_INDEX => "metadata index",
        op::SUMMARY_OFFSET => "summary offset",
        op::DATA_END => "data end",
        other => return format!("{other:#04x}"),
    };
    name.to_owned()
}
