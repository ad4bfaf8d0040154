//! The inside of a chunk: its compression, and how much it may hold.
//!
//! Owns the bounds on what a chunk may claim. Must not know the file, nor what the records inside mean.

use std::io::{self, Read};

use crate::read::bag::inflate::{Compression, bz2_reader};

use super::record::Fields;

/// Bound on the uncompressed size a chunk may claim, bytes; recorders cut chunks at some hundred kilobytes.
const MAX_CHUNK: u64 = 1 << 30;
/// Chunks up to this size, bytes, are decompressed and checked against their checksums before the first message is used.
/// Larger ones, and a chunk that the file's end cuts, are streamed.
const MAX_HELD: u64 = 64 << 20;

/// What a chunk's record says about it.
#[derive(Clone, Copy, Debug)]
pub(super) struct Chunk {
    pub(super) compression: Compression,
    /// Bytes after decompression, as claimed.
    pub(super) size: u64,
    /// Bytes in the file, as claimed.
    pub(super) len: u64,
}

impl Chunk {
    /// Reads a chunk's header; `len` is the length of its data. The error says why it is not read.
    pub(super) fn of(fields: &Fields<'_>, len: u64) -> Result<Self, String> {
        let compression = match fields.get("compression").unwrap_or_default() {
            b"none" => Compression::None,
            b"bz2" => Compression::Bz2,
            b"lz4" => Compression::Lz4,
            other => {
                let name = String::from_utf8_lossy(other.get(..other.len().min(40)).unwrap_or_default());
                return Err(format!("a chunk is compressed with `{name}`, which is not supported"));
            }
        };
        let size = u64::from(fields.u32("size")?);
        let chunk = Self { compression, size, len };
        if chunk.largest() > MAX_CHUNK {
            return Err(format!(
                "a chunk claims {} bytes of messages, above the limit of {MAX_CHUNK}",
                chunk.largest()
            ));
        }
        Ok(chunk)
    }

    /// Whether the chunk may be held in memory.
    pub(super) fn is_held(&self) -> bool {
        self.largest() <= MAX_HELD
    }

    /// Whether this is the header that a recorder writes when it begins a chunk, and completes when it closes it.
    pub(super) fn is_open(&self) -> bool {
        self.size == 0 && self.len == 0 && self.compression != Compression::None
    }

    /// Bound on the decompressed bytes: one more than the size, so that a chunk with too many is noticed.
    pub(super) fn limit(&self) -> u64 {
        match self.compression {
            // No memory is allocated by its claim.
            Compression::None => MAX_CHUNK,
            // A chunk that was not closed does not know its size.
            _ if self.is_open() => MAX_CHUNK,
            _ => self.size + 1,
        }
    }

    fn largest(&self) -> u64 {
        self.len.max(self.size)
    }

    /// Compares the number of decompressed bytes with the size that the chunk claims.
    pub(super) fn held_against(&self, unpacked: u64) -> Result<(), String> {
        if unpacked == self.size {
            return Ok(());
        }
        let holds = if unpacked > self.size {
            "more".to_owned()
        } else {
            unpacked.to_string()
        };
        Err(format!(
            "a chunk claims {} bytes of messages but holds {holds}",
            self.size
        ))
    }

    /// A reader of the decompressed bytes.
    pub(super) fn decoder<'r>(&self, packed: impl Read + 'r) -> io::Result<Box<dyn Read + 'r>> {
        Ok(match self.compression {
            Compression::Bz2 => Box::new(bz2_reader(packed)),
            Compression::Lz4 => Box::new(lz4::Decoder::new(packed)?),
            _ => Box::new(packed),
        })
    }
}

/// The message about a chunk that cannot be decompressed.
pub(super) fn damaged(error: impl std::fmt::Display) -> String {
    format!("a chunk is damaged: {error}")
}
