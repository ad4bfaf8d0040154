//! Chunks of an MCAP: their headers, and the passing of their records to the visitor.
//!
//! Owns the bounds on what a chunk may claim. Must not know in what order chunks are read.

use std::io::Read;
use std::panic::{AssertUnwindSafe, catch_unwind};

use ::mcap::records::op;
use ::mcap::sans_io::{LinearReadEvent, LinearReader, LinearReaderOptions};

use super::super::MAX_MESSAGE;
use super::super::inflate::{Compression, PackedChunk, UnpackedChunk};
use super::channels::Channels;
use super::fields::Fields;
use super::{MAX_CHUNK, MAX_WHOLE_CHUNK, Pass, Stop};

/// The header of a chunk record, checked against the bytes available.
pub(super) struct ChunkHead {
    /// The bytes of the header as stored, after the frame.
    bytes: Vec<u8>,
    /// Bytes when decompressed.
    pub(super) size: u64,
    /// Compressed bytes.
    pub(super) packed: u64,
    checksum: u32,
    /// See [`PackedChunk::log_times`].
    log_times: Option<(u64, u64)>,
    /// `None` for one that is not supported.
    pub(super) compression: Option<Compression>,
}

impl Pass<'_, '_> {
    /// Reads one chunk, whose frame was just read.
    pub(super) fn chunk(&mut self, len: u64, available: u64) -> Result<(), Stop> {
        let start = self.used;
        let head = self.chunk_head(len, available)?;
        let is_whole = len <= available && head.size.max(head.packed) <= MAX_WHOLE_CHUNK;
        if is_whole && head.compression.is_some() {
            self.pack(&head, start, false)?;
            // Bytes after the compressed ones belong to the chunk as well.
            return self.skip(len - head.bytes.len() as u64 - head.packed);
        }
        let at = self.at;
        self.flush()?;
        (self.at, self.used) = (at, start);
        self.stream(&head, len, available)
    }

    /// Reads the header of a chunk of `len` bytes, of which `available` exist.
    pub(super) fn chunk_head(&mut self, len: u64, available: u64) -> Result<ChunkHead, Stop> {
        let complete = len <= available;
        // start, end, uncompressed size (8 bytes each), CRC, length of the name of the compression (4 bytes each)
        let mut head = [0; 32];
        if len.min(available) < 40 {
            return Err(self.stop(if complete {
                format!("a chunk of {len} bytes is shorter than its header")
            } else {
                cut(len)
            }));
        }
        self.read_exact(&mut head)?;
        let mut fields = Fields(&head);
        let wrong = |why| self.stop(why);
        let log_times = (fields.u64().map_err(wrong)?, fields.u64().map_err(wrong)?);
        let size = fields.u64().map_err(wrong)?;
        let checksum = fields.u32().map_err(wrong)?;
        let name_len = u64::from(fields.u32().map_err(wrong)?);
        if size > MAX_CHUNK {
            return Err(self.stop(format!(
                "a chunk claims {size} bytes of messages, above the limit of {MAX_CHUNK}"
            )));
        }
        if name_len > 64 {
            return Err(self.stop(format!(
                "the compression name of a chunk has {name_len} bytes; 64 are allowed"
            )));
        }
        if len.min(available) < 40 + name_len {
            return Err(self.stop(if complete {
                "a chunk is shorter than its header".to_owned()
            } else {
                cut(len)
            }));
        }
        let mut tail = vec![0; usize::try_from(name_len + 8).unwrap_or(8)];
        self.read_exact(&mut tail)?;
        let packed = tail.last_chunk().map_or(0, |size| u64::from_le_bytes(*size));
        if packed > len - 40 - name_len {
            return Err(self.stop(format!("a chunk of {len} bytes claims to hold {packed} bytes")));
        }
        let compression = match tail.split_last_chunk::<8>() {
            Some((b"", _)) => Some(Compression::None),
            Some((b"zstd", _)) => Some(Compression::Zstd),
            Some((b"lz4", _)) => Some(Compression::Lz4),
            _ => None,
        };
        Ok(ChunkHead {
            bytes: [head.as_slice(), tail.as_slice()].concat(),
            size,
            packed,
            checksum,
            log_times: Some(log_times).filter(|(_, last)| *last > 0 && checksum == 0),
            compression,
        })
    }

    /// Reads the bytes of a chunk whose header was just read, and passes them to the inflater.
    pub(super) fn pack(&mut self, head: &ChunkHead, start: u64, seam: bool) -> Result<(), Stop> {
        let mut data = self.inflater.buffer();
        data.resize(usize::try_from(head.packed).unwrap_or(0), 0);
        self.read_exact(&mut data)?;
        let chunk = PackedChunk {
            at: start,
            compression: head.compression.unwrap_or(Compression::None),
            size: head.size,
            checksum: head.checksum,
            log_times: head.log_times,
            seam,
            data,
        };
        let (channels, faults) = (&mut self.channels, &mut self.faults);
        self.inflater.push(chunk, &mut look(channels, faults))
    }

    /// Uses every chunk that was taken in.
    pub(super) fn flush(&mut self) -> Result<(), Stop> {
        let (channels, faults) = (&mut self.channels, &mut self.faults);
        self.inflater.finish(&mut look(channels, faults))
    }

    /// Reads a chunk, whose header was just read, through the mcap crate, piece by piece.
    fn stream(&mut self, head: &ChunkHead, len: u64, available: u64) -> Result<(), Stop> {
        let complete = len <= available;
        let mut start = vec![op::CHUNK];
        start.extend_from_slice(&len.to_le_bytes());
        start.extend_from_slice(&head.bytes);
        let limit = usize::try_from(head.size.max(head.packed).min(MAX_MESSAGE)).unwrap_or(usize::MAX);
        let options = LinearReaderOptions::default()
            .with_skip_start_magic(true)
            .with_skip_end_magic(true)
            .with_validate_chunk_crcs(true)
            .with_record_length_limit(limit);
        let fed = len.min(available) - head.bytes.len() as u64;
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
            // Everything before the cut was used.
            Ok(()) | Err(Fault::Ended) if !complete => {
                self.used = self.total;
                Err(self.stop(cut(len)))
            }
            Ok(()) | Err(Fault::Ended) => Err(self.stop("a chunk ends inside a record")),
            Err(Fault::Wrong(why)) => Err(self.stop(why)),
        }
    }
}

fn cut(len: u64) -> String {
    format!("the file ends inside a chunk of {len} bytes: the recording was cut off or not closed")
}

/// Passes on the records of chunks; damaged chunks are noted in `faults`.
fn look<'a, 'v>(
    channels: &'a mut Channels<'v>,
    faults: &'a mut Vec<Stop>,
) -> impl FnMut(&UnpackedChunk) -> Result<(), Stop> + use<'a, 'v> {
    move |chunk| {
        if chunk.seam {
            channels.seam();
        }
        let result = chunk.data.as_deref().map_err(Clone::clone);
        if let Err(why) = result.and_then(|bytes| channels.chunk(bytes, chunk.log_times)) {
            faults.push(Stop {
                at: chunk.at,
                why,
                loses_messages: true,
            });
            // The next chunk does not follow what was read of this one.
            channels.lose();
        }
        Ok(())
    }
}

enum Fault {
    /// The bytes ended inside a record or a compressed block.
    Ended,
    /// Something is wrong with the bytes.
    Wrong(String),
}

/// Feeds one chunk record to the mcap crate and passes on the records inside.
fn feed(mut reader: LinearReader, input: &mut dyn Read, channels: &mut Channels<'_>) -> Result<(), Fault> {
    loop {
        // The crate is built to fail with errors; a panic inside it must cost this file only.
        let lent = &mut reader;
        let next = AssertUnwindSafe(move || {
            let reader = lent;
            reader.next_event()
        });
        let event =
            catch_unwind(next).map_err(|_| Fault::Wrong("the mcap library crashed on this chunk".to_owned()))?;
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
