//! Chunks: checked, decompressed in parallel, passed on in order.
//!
//! Owns the bound on memory: a batch is decompressed while the one before it is read. Must not know what
//! is inside a chunk.

use std::cell::RefCell;
use std::io::{self, Read};
use std::panic::{AssertUnwindSafe, catch_unwind};

/// Bytes of a batch, decompressed, if that gives every core a chunk.
const BATCH_BYTES: u64 = 8 << 20;
/// Bytes above which a batch is never filled up, one chunk excepted.
const LARGEST_BATCH: u64 = 64 << 20;
/// Buffers kept for the next batch.
const KEPT: usize = 64;

/// How a chunk is compressed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Compression {
    /// Not at all.
    None,
    /// Zstandard frames.
    Zstd,
    /// An LZ4 frame.
    Lz4,
    /// A bzip2 stream.
    Bz2,
}

/// A chunk as stored in the file.
pub(super) struct PackedChunk {
    /// Where its record starts in the file.
    pub(super) at: u64,
    /// Its compression.
    pub(super) compression: Compression,
    /// Bytes when decompressed, as the file says; bounded by the reader.
    pub(super) size: u64,
    /// CRC-32 of the decompressed bytes; 0 where there is none.
    pub(super) checksum: u32,
    /// First and last log time of its messages, nanoseconds, where its head says and no checksum guards it.
    pub(super) log_times: Option<(u64, u64)>,
    /// Whether the chunk does not follow the one before.
    pub(super) seam: bool,
    /// The bytes.
    pub(super) data: Vec<u8>,
}

/// A chunk ready to be read.
pub(super) struct UnpackedChunk {
    /// Where its record starts in the file.
    pub(super) at: u64,
    /// Whether the chunk does not follow the one before.
    pub(super) seam: bool,
    /// See [`PackedChunk::log_times`].
    pub(super) log_times: Option<(u64, u64)>,
    /// The decompressed bytes, or what is wrong. Nothing that came out before an error is used: it may be wrong as well.
    pub(super) data: Result<Vec<u8>, String>,
}

/// Takes chunks in and returns them in the same order.
#[derive(Default)]
pub(super) struct Inflater {
    packed: Vec<PackedChunk>,
    waiting_bytes: u64,
    unpacked: Vec<UnpackedChunk>,
    free: Vec<Vec<u8>>,
}

impl Inflater {
    /// An empty buffer for the bytes of the next chunk.
    pub(super) fn buffer(&mut self) -> Vec<u8> {
        let mut buffer = self.free.pop().unwrap_or_default();
        buffer.clear();
        buffer
    }

    /// Takes in a chunk. Once a batch is full, the batch before it is passed to `look`, whose error stops the reading.
    pub(super) fn push<E>(
        &mut self,
        chunk: PackedChunk,
        look: &mut dyn FnMut(&UnpackedChunk) -> Result<(), E>,
    ) -> Result<(), E> {
        self.waiting_bytes += chunk.size.max(chunk.data.len() as u64);
        self.packed.push(chunk);
        let for_all = self.packed.len() >= rayon::current_num_threads().max(2);
        if self.waiting_bytes < BATCH_BYTES || (!for_all && self.waiting_bytes < LARGEST_BATCH) {
            return Ok(());
        }
        self.turn(look)
    }

    /// Passes on everything that was taken in.
    pub(super) fn finish<E>(&mut self, look: &mut dyn FnMut(&UnpackedChunk) -> Result<(), E>) -> Result<(), E> {
        self.turn(look)?;
        self.turn(look)
    }

    /// Decompresses the waiting batch while the one before is read.
    fn turn<E>(&mut self, look: &mut dyn FnMut(&UnpackedChunk) -> Result<(), E>) -> Result<(), E> {
        let packed = std::mem::take(&mut self.packed);
        self.waiting_bytes = 0;
        let ready = std::mem::take(&mut self.unpacked);
        let mut result = Ok(());
        let mut look_all = || {
            for chunk in &ready {
                if result.is_ok() {
                    result = look(chunk);
                }
            }
        };
        let mut buffers: Vec<Vec<u8>> = packed.iter().map(|_| self.free.pop().unwrap_or_default()).collect();
        let mut slots: Vec<Option<Result<Vec<u8>, String>>> = packed.iter().map(|_| None).collect();
        let jobs = packed.iter().zip(&mut slots).zip(buffers.drain(..));
        if packed.len() < 2 {
            for ((chunk, slot), buffer) in jobs {
                *slot = Some(unpack(chunk, buffer));
            }
            look_all();
        } else {
            // Reading stays on this thread; the other threads decompress.
            rayon::in_place_scope(|scope| {
                for ((chunk, slot), buffer) in jobs {
                    scope.spawn(move |_| *slot = Some(unpack(chunk, buffer)));
                }
                look_all();
            });
        }
        let done = ready.into_iter().filter_map(|chunk| chunk.data.ok());
        let room = KEPT.saturating_sub(self.free.len());
        self.free.extend(done.take(room));
        for (chunk, slot) in packed.into_iter().zip(slots) {
            let data = slot.unwrap_or_else(|| Err("the chunk was not decompressed".to_owned()));
            let mut compressed = chunk.data;
            let data = match data {
                // Bytes that were not compressed are passed on unchanged.
                Ok(buffer) if chunk.compression == Compression::None => {
                    let bytes = std::mem::replace(&mut compressed, buffer);
                    Ok(bytes)
                }
                other => other,
            };
            if self.free.len() < KEPT {
                self.free.push(compressed);
            }
            self.unpacked.push(UnpackedChunk {
                at: chunk.at,
                seam: chunk.seam,
                log_times: chunk.log_times,
                data,
            });
        }
        result
    }
}

/// Decompresses a chunk into a buffer and compares its checksum; of a chunk that is not compressed only the
/// checksum is compared.
fn unpack(chunk: &PackedChunk, mut buffer: Vec<u8>) -> Result<Vec<u8>, String> {
    buffer.clear();
    let size = usize::try_from(chunk.size).map_err(|_| "a chunk is larger than this machine's memory".to_owned())?;
    let bytes = match chunk.compression {
        Compression::None => chunk.data.as_slice(),
        Compression::Zstd => {
            zstd(&chunk.data, size, &mut buffer)?;
            buffer.as_slice()
        }
        Compression::Lz4 => {
            lz4(&chunk.data, size, &mut buffer)?;
            buffer.as_slice()
        }
        Compression::Bz2 => {
            let mut reader = bz2_reader(chunk.data.as_slice()).take(chunk.size + 1);
            let result = reader.read_to_end(&mut buffer);
            result.map_err(|error| format!("a chunk is damaged: {error}"))?;
            buffer.as_slice()
        }
    };
    if bytes.len() != size {
        let got = bytes.len();
        return Err(format!(
            "a chunk is damaged: it decompresses to {got} bytes, its header says {size}"
        ));
    }
    if chunk.checksum != 0 {
        let found = crc32fast::hash(bytes);
        if found != chunk.checksum {
            let said = chunk.checksum;
            return Err(format!(
                "a chunk is damaged: its checksum is {found:#010x}, the file says {said:#010x}"
            ));
        }
    }
    Ok(buffer)
}

thread_local! {
    static ZSTD: RefCell<Option<::zstd::bulk::Decompressor<'static>>> = const { RefCell::new(None) };
}

fn zstd(data: &[u8], size: usize, out: &mut Vec<u8>) -> Result<(), String> {
    let damaged = |error: std::io::Error| format!("a chunk is damaged: {error}");
    out.reserve(size);
    ZSTD.with_borrow_mut(|kept| {
        if kept.is_none() {
            *kept = Some(::zstd::bulk::Decompressor::new().map_err(damaged)?);
        }
        let Some(decompressor) = kept.as_mut() else {
            return Ok(());
        };
        decompressor
            .decompress_to_buffer(data, out)
            .map_err(damaged)
            .map(|_| ())
    })
}

fn lz4(data: &[u8], size: usize, out: &mut Vec<u8>) -> Result<(), String> {
    let damaged = |error: std::io::Error| format!("a chunk is damaged: {error}");
    out.reserve(size);
    // One byte more than claimed shows a chunk that holds too much.
    let decoder = ::lz4::Decoder::new(data).map_err(damaged)?;
    decoder.take(size as u64 + 1).read_to_end(out).map_err(damaged)?;
    Ok(())
}

/// Decompresses a bzip2 stream as it is read.
pub(super) fn bz2_reader<'r>(packed: impl Read + 'r) -> impl Read + 'r {
    PanicGuard(::bzip2::read::BzDecoder::new(packed))
}

/// A decompressor whose panic costs one chunk only. It is built to fail with errors.
struct PanicGuard<R>(R);

impl<R: Read> Read for PanicGuard<R> {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        let (decoder, lent) = (&mut self.0, buffer);
        catch_unwind(AssertUnwindSafe(|| decoder.read(lent)))
            .unwrap_or_else(|_| Err(io::Error::other("the decompressor crashed")))
    }
}

#[cfg(test)]
mod tests {
    use std::io::Write;

    use super::*;

    const ALL: [Compression; 4] = [Compression::None, Compression::Zstd, Compression::Lz4, Compression::Bz2];

    fn packed(compression: Compression, plain: &[u8], at: u64) -> PackedChunk {
        let data = match compression {
            Compression::None => plain.to_vec(),
            Compression::Zstd => ::zstd::encode_all(plain, 1).unwrap(),
            Compression::Lz4 => {
                let mut encoder = ::lz4::EncoderBuilder::new().build(Vec::new()).unwrap();
                encoder.write_all(plain).unwrap();
                encoder.finish().0
            }
            Compression::Bz2 => {
                let mut packed = Vec::new();
                let mut encoder = ::bzip2::read::BzEncoder::new(plain, ::bzip2::Compression::fast());
                encoder.read_to_end(&mut packed).unwrap();
                packed
            }
        };
        PackedChunk {
            at,
            compression,
            size: plain.len() as u64,
            checksum: crc32fast::hash(plain),
            log_times: None,
            seam: false,
            data,
        }
    }

    fn all(chunks: Vec<PackedChunk>) -> Vec<(u64, Result<Vec<u8>, String>)> {
        let mut inflater = Inflater::default();
        let mut seen = Vec::new();
        let mut look = |chunk: &UnpackedChunk| {
            seen.push((chunk.at, chunk.data.clone()));
            Ok::<(), ()>(())
        };
        for chunk in chunks {
            inflater.push(chunk, &mut look).unwrap();
        }
        inflater.finish(&mut look).unwrap();
        seen
    }

    #[test]
    fn chunks_come_out_in_order_and_whole_whatever_their_compression() {
        for compression in ALL {
            // Several batches; bzip2 is slow where it is not optimised.
            let size = if compression == Compression::Bz2 {
                300_000
            } else {
                3_000_000
            };
            let plain: Vec<Vec<u8>> = (0..40_u8).map(|n| vec![n; size]).collect();
            let chunks = (0..).zip(&plain).map(|(at, plain)| packed(compression, plain, at));
            let seen = all(chunks.collect());
            assert_eq!(seen.len(), plain.len());
            for ((at, data), (expected, plain)) in seen.into_iter().zip((0..).zip(&plain)) {
                assert_eq!(at, expected);
                assert!(data.unwrap() == *plain, "{compression:?} {at}");
            }
        }
    }

    #[test]
    fn damage_is_said_of_the_chunk_that_has_it() {
        for compression in ALL {
            let mut chunks: Vec<PackedChunk> = (0..3)
                .map(|at| packed(compression, b"some words, some words", at))
                .collect();
            chunks[1].checksum ^= 1;
            let seen = all(chunks);
            assert!(seen[0].1.is_ok() && seen[2].1.is_ok());
            assert!(seen[1].1.as_ref().unwrap_err().contains("checksum"));
            let mut lying = packed(compression, b"some words, some words", 0);
            lying.size -= 3;
            assert!(all(vec![lying])[0].1.is_err(), "{compression:?}");
        }
    }
}
