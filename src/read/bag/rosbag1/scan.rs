//! One linear pass over the records of a bag, from the top to the index or the end.
//!
//! Owns the order of the records in the file, and how reading continues after a fault. Must not know what is reported.

use std::convert::Infallible;
use std::io::{BufReader, Read as _};

use crate::read::bag::inflate::{Compression, PackedChunk};

use super::super::MAX_MESSAGE;
use super::Pass;
use super::chunk::{Chunk, damaged};
use super::index::{MAGIC_LEN, words};
use super::record::{Fault, Fields, Stream, kind, op};
use super::sink::inside;

/// Bytes between two calls of the progress function.
const PROGRESS_STEP: u64 = 4 << 20;
/// Length of the record at the top in nearly all bags: the header is padded to 4096 bytes, and two lengths precede it.
const TOP_LEN: u64 = 4104;

/// A fault in a record of the file.
struct Damage {
    why: String,
    /// Everything before this byte was used.
    used: u64,
    /// Where the record ends, as far as its frame can be trusted.
    next: Option<u64>,
}

impl Pass<'_, '_> {
    /// Reads everything. The error is one of the system.
    pub(super) fn scan(&mut self) -> Result<(), Fault> {
        // Nothing new follows the index: it was read first.
        let end = self.sink.index.as_ref().map_or(self.tape.total, |index| index.at);
        self.tape.seek_anew(MAGIC_LEN)?;
        loop {
            let at = self.tape.at;
            if Some(at) == self.data_end {
                self.flush();
                self.data_ended = self.sink.losses.is_empty();
            }
            if at >= end {
                self.flush();
                return Ok(());
            }
            if at >= self.last_progress + PROGRESS_STEP {
                self.last_progress = at;
                (self.progress)(at, self.tape.total);
            }
            if let Err(damage) = self.step(at, end)
                && !self.resume(at, end, damage)?
            {
                return Ok(());
            }
        }
    }

    /// Reads the record at `at`, and positions the tape after it.
    fn step(&mut self, at: u64, end: u64) -> Result<(), Damage> {
        let fault = |fault: Fault, next| Damage {
            why: words(fault),
            used: at,
            next,
        };
        let frame = self.tape.frame().map_err(|why| fault(why, None))?;
        let fields = frame.fields().map_err(|why| fault(why, None))?;
        let body = self.tape.at;
        let next = body + frame.len;
        let wrong = |why: String| fault(Fault::Wrong(why), Some(next));
        match fields.op() {
            op::CHUNK => return self.chunk(at, &fields, frame.len, end),
            op::INDEX_DATA => {
                let count = fields.u32("count").map_err(wrong)?;
                let next = self.behind_index_data(count, next, end);
                if next <= end {
                    return self.tape.seek(next).map_err(|why| fault(why, None));
                }
            }
            _ => {}
        }
        if next > end {
            return Err(fault(Fault::Wrong(self.beyond(&kind(fields.op()), frame.len)), None));
        }
        match fields.op() {
            // They are outside of chunks where a recorder had no time to close its last chunk.
            op::MESSAGE | op::CONNECTION => {
                if frame.len > MAX_MESSAGE {
                    let len = frame.len;
                    return Err(wrong(format!(
                        "a record of {len} bytes is above the limit of {MAX_MESSAGE}"
                    )));
                }
                self.flush();
                self.sink.connections.span_ns = None;
                let loaded = self.tape.load(&mut self.record, frame.len);
                loaded.map_err(|why| fault(why, None))?;
                self.sink.connections.record(&fields, &self.record).map_err(wrong)
            }
            op::BAG_HEADER | op::CHUNK_INFO => self.tape.seek(next).map_err(|why| fault(why, None)),
            other => Err(wrong(format!("a record has the unknown kind {}", kind(other)))),
        }
    }

    /// Where the record after index data is; the tape is before the data, and `claimed` is their end according to their
    /// record. Recorders of 2010 wrote 12 bytes for each message and a length of 20.
    fn behind_index_data(&mut self, count: u32, claimed: u64, end: u64) -> u64 {
        let counted = self.tape.at + 12 * u64::from(count);
        if counted == claimed {
            return claimed;
        }
        self.odd_index_data += 1;
        let is_sound = counted == end || counted < end && self.tape.is_record_at(counted);
        if is_sound { counted } else { claimed }
    }

    /// Reads the chunk whose frame was just read, or passes it to the inflater.
    fn chunk(&mut self, at: u64, fields: &Fields<'_>, len: u64, end: u64) -> Result<(), Damage> {
        let body = self.tape.at;
        let next = body + len;
        let damage = |why: String| Damage {
            why,
            used: at,
            next: Some(next),
        };
        // A chunk that runs over the next one has a wrong length, if there really is a next one.
        let behind = self.sink.index.as_ref().and_then(|index| index.next_chunk(at));
        let overrun = behind.filter(|behind| (body..next).contains(behind) && self.tape.is_chunk_at(*behind));
        let end = overrun.unwrap_or(end);
        let chunk = Chunk::of(fields, len).map_err(damage)?;
        let is_open = chunk.is_open() && next < end && !self.tape.is_record_at(next);
        if is_open || next > end {
            // Everything before the cut is used.
            let result = self.stream(at, &chunk, end - body);
            let mut why = if is_open {
                "the last chunk was not closed".to_owned()
            } else {
                self.beyond("chunk", len)
            };
            if let Err(Fault::Wrong(inside)) = result {
                why = format!("{why}; {inside}");
            }
            let used = if self.sink.index.is_some() { at } else { end };
            return Err(Damage { why, used, next: None });
        }
        if !chunk.is_held() {
            let unpacked = self.stream(at, &chunk, len).map_err(|fault| damage(inside(fault)))?;
            self.hold(&chunk, unpacked).map_err(damage)?;
            return self.tape.seek_anew(next).map_err(|fault| damage(words(fault)));
        }
        self.pack(at, &chunk, false).map_err(|fault| damage(words(fault)))
    }

    /// Passes a chunk, whose frame was just read and which is complete, to the inflater.
    pub(super) fn pack(&mut self, at: u64, chunk: &Chunk, seam: bool) -> Result<(), Fault> {
        let mut data = self.inflater.buffer();
        self.tape.load(&mut data, chunk.len)?;
        let mut size = chunk.size;
        if chunk.compression == Compression::None {
            // This claim is not used for decompression, so a wrong one does no harm.
            self.lying_sizes += u64::from(size != chunk.len);
            size = chunk.len;
        }
        let packed = PackedChunk {
            at,
            compression: chunk.compression,
            size,
            checksum: 0,
            log_times: None,
            seam,
            data,
        };
        self.sink.ends.push_back(self.tape.at);
        let sink = &mut self.sink;
        let Ok(()) = self.inflater.push(packed, &mut |chunk| {
            sink.chunk(chunk);
            Ok::<(), Infallible>(())
        });
        Ok(())
    }

    /// Uses every chunk that was passed to the inflater.
    pub(super) fn flush(&mut self) {
        let sink = &mut self.sink;
        let Ok(()) = self.inflater.finish(&mut |chunk| {
            sink.chunk(chunk);
            Ok::<(), Infallible>(())
        });
    }

    /// Compares the size of a streamed chunk with what it claims.
    fn hold(&mut self, chunk: &Chunk, unpacked: u64) -> Result<(), String> {
        if chunk.compression != Compression::None {
            return chunk.held_against(unpacked);
        }
        self.lying_sizes += u64::from(unpacked != chunk.size);
        Ok(())
    }

    /// Reads the records of a chunk that is not kept in memory; `packed` is the length of what exists of it. Returns the
    /// number of decompressed bytes. The position of the tape is undefined afterwards.
    fn stream(&mut self, at: u64, chunk: &Chunk, packed: u64) -> Result<u64, Fault> {
        self.flush();
        self.sink.expect(at);
        let decoder = chunk.decoder(self.tape.bytes(packed));
        let decoder = decoder.map_err(|error| Fault::Wrong(damaged(error)))?;
        let limit = chunk.limit();
        let mut stream = Stream::new(BufReader::new(decoder).take(limit));
        while let Some((fields, data)) = stream.next()? {
            self.sink.connections.record(&fields, data).map_err(Fault::Wrong)?;
        }
        Ok(limit - stream.into_inner().limit())
    }

    /// Continues after a fault, if there is a place to continue at.
    fn resume(&mut self, at: u64, end: u64, damage: Damage) -> Result<bool, Fault> {
        let mut is_sound = |next: &u64| *next == end || *next < end && self.tape.is_record_at(*next);
        let mut to = damage.next.filter(&mut is_sound);
        if to.is_none() && at == MAGIC_LEN {
            to = Some(MAGIC_LEN + TOP_LEN).filter(&mut is_sound);
        }
        if to.is_none()
            && let Some(index) = &self.sink.index
        {
            let mut behind = at;
            while let Some(chunk) = index.next_chunk(behind) {
                if self.tape.is_chunk_at(chunk) {
                    to = Some(chunk);
                    break;
                }
                behind = chunk;
            }
            if to.is_none() && self.only_zeros(at, end)? {
                self.tape.seek_anew(end)?;
                return Ok(true);
            }
        }
        self.flush();
        self.sink.lose(damage.used, to, damage.why);
        if let Some(to) = to {
            self.tape.seek_anew(to)?;
        }
        Ok(to.is_some())
    }

    /// Whether there is nothing but zeros between two bytes: some writers leave room before the index.
    fn only_zeros(&mut self, from: u64, to: u64) -> Result<bool, Fault> {
        self.tape.seek_anew(from)?;
        let mut gap = BufReader::new(self.tape.bytes(to - from)).bytes();
        Ok(gap.all(|byte| byte.is_ok_and(|byte| byte == 0)))
    }

    /// The message about a record that is longer than the space for it.
    fn beyond(&self, what: &str, len: u64) -> String {
        if self.sink.index.is_some() {
            return format!("a {what} of {len} bytes overlaps what the index lists after it");
        }
        format!("the file ends inside a {what} of {len} bytes: the recording was cut off or not closed")
    }
}
