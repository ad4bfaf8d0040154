//! MCAP files, in one linear pass over ordinary file reads.
//!
//! Owns the frame of records, so that every position is known, attachments and indexes are stepped over and nothing a
//! file claims is believed before it is held against the file's length; the inside of a chunk is left to the mcap
//! crate. Must not know what is inside messages.
//!
//! Format: <https://mcap.dev/spec>. A file is: magic, records, a data-end record, the summary, a footer, magic; a record
//! is a kind (1 byte), a length (8 bytes, little-endian) and as many bytes.

use std::fs::File;
use std::io::{BufReader, Read};
use std::panic::{AssertUnwindSafe, catch_unwind};

use ::mcap::records::{Record, op};
use ::mcap::sans_io::{LinearReadEvent, LinearReader, LinearReaderOptions};

use crate::source::{Place, ReadStatus, Source};

use super::channels::Channels;
use super::{Extent, Progress, Visit, Wanted};

/// Bound on one record, bytes. The largest messages met in recordings are clouds and images of some ten megabytes.
const MAX_RECORD: u64 = 128 << 20;
/// Bound on the uncompressed size a chunk may claim, bytes; recorders cut chunks at some megabytes.
const MAX_CHUNK: u64 = 1 << 30;
/// Chunks up to this size, bytes, are checked against their checksum before the first message is used. Larger ones,
/// and a chunk that the file's end cuts, are streamed.
const MAX_CHECKED_CHUNK: u64 = 64 << 20;
/// Bytes between two calls of the progress function.
const PROGRESS_STEP: u64 = 4 << 20;

const MAGIC_LEN: u64 = 8;
const FRAME_LEN: u64 = 9;

/// Why reading stopped before the end of the file.
struct Stop {
    /// Everything before this byte was used.
    at: u64,
    why: String,
    /// Whether messages may be missing: the fault stands in front of the end of the data section.
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
    progress: Progress<'a>,
    told: u64,
    /// Buffer for records outside chunks.
    record: Vec<u8>,
    data_ended: bool,
    /// Messages in the file as its statistics say.
    promised: Option<u64>,
}

/// Reads an MCAP that starts with its magic; see [`super::read`].
pub(super) fn read(
    file: File,
    total: u64,
    _wanted: &Wanted<'_>,
    source: &mut Source,
    progress: Progress<'_>,
    visit: &mut dyn Visit,
) -> Extent {
    let mut pass = Pass {
        file: BufReader::with_capacity(1 << 18, file),
        at: 0,
        total,
        used: 0,
        channels: Channels::new(visit),
        progress,
        told: 0,
        record: Vec::new(),
        data_ended: false,
        promised: None,
    };
    let stopped = pass.run().err();
    (pass.progress)(pass.used, total);
    let truncated = pass.report(stopped, source);
    Extent {
        truncated,
        whole: true,
        indexed: false,
        messages_total: pass.promised,
        span_ns: None,
    }
}

impl Pass<'_, '_> {
    /// Reads record after record up to the footer and the magic behind it.
    fn run(&mut self) -> Result<(), Stop> {
        self.skip(MAGIC_LEN)?;
        loop {
            self.used = self.at;
            if self.at >= self.told + PROGRESS_STEP {
                self.told = self.at;
                (self.progress)(self.at, self.total);
            }
            if self.at >= self.total {
                return Err(self.stop("the file ends without a footer: the recording was not closed"));
            }
            let (opcode, len) = self.frame()?;
            let available = self.total - self.at;
            if opcode == op::CHUNK && !self.data_ended {
                self.chunk(len, available)?;
                continue;
            }
            if len > available {
                return Err(self.stop(format!("the file ends inside a {} record of {len} bytes", kind(opcode))));
            }
            match opcode {
                op::FOOTER => {
                    self.skip(len)?;
                    return self.end();
                }
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
                // Zeros are what a file system leaves of blocks that were never written.
                0 => return Err(self.stop("a record of kind 0, which the format does not know")),
                // Behind the data the summary repeats schemas and channels.
                op::SCHEMA | op::CHANNEL | op::MESSAGE if !self.data_ended => {
                    self.load(opcode, len)?;
                    let result = self.channels.record(opcode, &self.record);
                    result.map_err(|why| self.stop(why))?;
                }
                _ => self.skip(len)?,
            }
        }
    }

    /// What follows the footer: the magic, and nothing.
    fn end(&mut self) -> Result<(), Stop> {
        let mut magic = [0; 8];
        if self.total - self.at < MAGIC_LEN {
            return Err(self.stop("the file ends inside the closing magic"));
        }
        self.read_exact(&mut magic)?;
        if magic != ::mcap::MAGIC {
            return Err(self.stop("the closing magic is missing behind the footer"));
        }
        self.used = self.at;
        let rest = self.total - self.at;
        if rest > 0 {
            return Err(self.stop(format!("{rest} bytes follow the end of the recording")));
        }
        if !self.data_ended {
            return Err(self.stop("the record that ends the data is missing"));
        }
        Ok(())
    }

    /// Reads one chunk, whose frame was just read, through the mcap crate.
    fn chunk(&mut self, len: u64, available: u64) -> Result<(), Stop> {
        let complete = len <= available;
        let cut = || format!("the file ends inside a chunk of {len} bytes: the recording was cut off or not closed");
        // start, end, uncompressed size (8 bytes each), CRC, length of the name of the compression (4 bytes each)
        let mut head = [0; 32];
        if len.min(available) < 40 {
            return Err(self.stop(if complete {
                format!("a chunk of {len} bytes is too short to be one")
            } else {
                cut()
            }));
        }
        self.read_exact(&mut head)?;
        let [.., s0, s1, s2, s3, s4, s5, s6, s7, c0, c1, c2, c3, n0, n1, n2, n3] = head;
        let uncompressed = u64::from_le_bytes([s0, s1, s2, s3, s4, s5, s6, s7]);
        let checksum = u32::from_le_bytes([c0, c1, c2, c3]);
        let name_len = u64::from(u32::from_le_bytes([n0, n1, n2, n3]));
        if uncompressed > MAX_CHUNK {
            return Err(self.stop(format!(
                "a chunk claims {uncompressed} bytes of messages, above the limit of {MAX_CHUNK}"
            )));
        }
        if name_len > 64 {
            return Err(self.stop(format!("a chunk names its compression with {name_len} bytes")));
        }
        if len.min(available) < 40 + name_len {
            return Err(self.stop(if complete {
                "a chunk's header does not fit into it".to_owned()
            } else {
                cut()
            }));
        }
        let mut start = vec![op::CHUNK];
        start.extend_from_slice(&len.to_le_bytes());
        start.extend_from_slice(&head);
        let mut tail = vec![0; usize::try_from(name_len + 8).unwrap_or(8)];
        self.read_exact(&mut tail)?;
        let compressed = tail.last_chunk().map_or(0, |size| u64::from_le_bytes(*size));
        if compressed > len - 40 - name_len {
            return Err(self.stop(format!("a chunk of {len} bytes claims to hold {compressed}")));
        }
        start.extend_from_slice(&tail);

        let largest = uncompressed.max(compressed);
        let checked = complete && checksum != 0 && largest <= MAX_CHECKED_CHUNK;
        let limit = usize::try_from(largest.min(MAX_RECORD)).unwrap_or(usize::MAX);
        let options = LinearReaderOptions::default()
            .with_skip_start_magic(true)
            .with_skip_end_magic(true)
            .with_validate_chunk_crcs(true)
            .with_prevalidate_chunk_crcs(checked)
            .with_record_length_limit(limit);
        let fed = (len - 40 - name_len).min(available - 40 - name_len);
        let result = feed(
            LinearReader::new_with_options(options),
            &mut start.as_slice().chain((&mut self.file).take(fed)),
            &mut self.channels,
        );
        match result {
            Ok(()) if complete => {
                self.at += fed;
                Ok(())
            }
            // What stood before the cut was used.
            Ok(()) | Err(Fault::Ended) if !complete => {
                self.used = self.total;
                Err(self.stop(cut()))
            }
            Ok(()) | Err(Fault::Ended) => Err(self.stop("a chunk ends inside a record")),
            Err(Fault::Wrong(why)) => Err(self.stop(why)),
        }
    }

    /// The kind and the length of the next record.
    fn frame(&mut self) -> Result<(u8, u64), Stop> {
        if self.total - self.at < FRAME_LEN {
            return Err(self.stop("the file ends inside the head of a record"));
        }
        let mut frame = [0; 9];
        self.read_exact(&mut frame)?;
        let [opcode, len @ ..] = frame;
        Ok((opcode, u64::from_le_bytes(len)))
    }

    /// Loads the body of a record into `self.record`.
    fn load(&mut self, opcode: u8, len: u64) -> Result<(), Stop> {
        if len > MAX_RECORD {
            return Err(self.stop(format!(
                "a {} record of {len} bytes is above the limit of {MAX_RECORD}",
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

    /// Steps over bytes that are known to be there.
    fn skip(&mut self, len: u64) -> Result<(), Stop> {
        let offset = i64::try_from(len).unwrap_or(i64::MAX);
        self.file
            .seek_relative(offset)
            .map_err(|error| self.stop(error.to_string()))?;
        self.at += len;
        Ok(())
    }

    fn stop(&self, why: impl Into<String>) -> Stop {
        Stop {
            at: self.used,
            why: why.into(),
            loses_messages: !self.data_ended,
        }
    }

    /// Writes down how far reading went; returns whether messages may be missing.
    fn report(&self, stopped: Option<Stop>, source: &mut Source) -> bool {
        let read = self.channels.messages;
        source.examined.bytes = self.used;
        source.examined.messages = Some(read);
        let whole = Place::whole(source.id);
        let mut missing = false;
        if let Some(Stop {
            at,
            why,
            loses_messages,
        }) = stopped
        {
            missing = loses_messages;
            let percent = 100.0 * at as f64 / self.total.max(1) as f64;
            // Where no message was met there is nothing to judge.
            let status = if read == 0 {
                ReadStatus::Unreadable
            } else {
                ReadStatus::Partial
            };
            let message = format!("read up to byte {at} ({percent:.1} %): {why}");
            let help = "`mcap recover` writes what is readable into a closed file; record again if the end matters";
            source.problem_with_help(status, whole.clone(), message, Some(help.to_owned()));
        } else if let Some(promised) = self
            .promised
            .filter(|promised| *promised != read + self.channels.orphans)
        {
            missing = promised > read;
            let message = format!("{read} messages were read, but the file's statistics say {promised}");
            source.problem(ReadStatus::Partial, whole.clone(), message);
        }
        if self.channels.orphans > 0 {
            let orphans = self.channels.orphans;
            let message = format!("{orphans} messages belong to channels that the file does not define");
            source.problem(ReadStatus::Partial, whole.clone(), message);
            missing = true;
        }
        if self.channels.redefined > 0 {
            let message = format!("{} channel ids are defined twice, differently", self.channels.redefined);
            source.problem(ReadStatus::Read, whole, message);
        }
        if read == 0 && source.detail.is_none() {
            source.detail = Some("no messages".to_owned());
        }
        missing
    }
}

enum Fault {
    /// The bytes ended inside a record or a compressed block.
    Ended,
    /// Something is wrong with the bytes.
    Wrong(String),
}

/// Feeds one chunk record to the mcap crate and hands on the records inside.
fn feed(mut reader: LinearReader, input: &mut dyn Read, channels: &mut Channels<'_>) -> Result<(), Fault> {
    loop {
        // The crate is built to fail with errors; a panic inside it must cost this file only.
        let lent = &mut reader;
        let next = AssertUnwindSafe(move || {
            let reader = lent;
            reader.next_event()
        });
        let event =
            catch_unwind(next).map_err(|_| Fault::Wrong("the mcap library broke down on this chunk".to_owned()))?;
        match event {
            None => return Ok(()),
            Some(Ok(LinearReadEvent::Record { data, opcode })) => {
                channels.record(opcode, data).map_err(Fault::Wrong)?;
            }
            Some(Ok(LinearReadEvent::ReadRequest(wanted))) => {
                let read = loop {
                    match input.read(reader.insert(wanted)) {
                        Err(error) if error.kind() == std::io::ErrorKind::Interrupted => {}
                        result => break result,
                    }
                };
                reader.notify_read(read.map_err(|error| Fault::Wrong(error.to_string()))?);
            }
            Some(Err(::mcap::McapError::UnexpectedEof)) => return Err(Fault::Ended),
            Some(Err(error)) => return Err(Fault::Wrong(format!("a chunk is damaged: {error}"))),
        }
    }
}

/// What a kind of record is called.
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
