//! Zstandard around recordings: whole files, and single messages inside of them.
//!
//! rosbag2 compresses files when they are closed (`compression_mode: FILE`) or each message as one frame (`MESSAGE`).
//! Owns decompression and its bounds. Must not know what is inside.

use std::collections::BTreeMap;
use std::fs::File;
use std::io::{Read, Write};

use zstd::bulk::Decompressor;
use zstd::zstd_safe::get_frame_content_size;

use crate::files::TempPath;
use crate::source::{Place, ReadStatus, Source};

use super::{Channel, MAX_MESSAGE, Message, Progress, Visit};

/// First bytes of a frame. No CDR message begins with them: its first two bytes are an encoding below 256.
const MAGIC: [u8; 4] = [0x28, 0xb5, 0x2f, 0xfd];
/// Bound on what a file may unpack to, bytes.
const MAX_UNPACKED: u64 = 64 << 30;
/// What any file may unpack to, even a small one, bytes.
const FREE: u64 = 256 << 20;
/// How many times larger than itself a file may get beyond that. Recordings shrink to a half, or a tenth.
const MAX_RATIO: u64 = 100;
/// Bytes that are unpacked at a time.
const STEP: usize = 1 << 20;

/// A file that was unpacked.
pub(super) struct UnpackedFile {
    /// What came out; removed when this is dropped.
    pub(super) file: TempPath,
    /// Its size, bytes.
    pub(super) size: u64,
    /// Why the file was not unpacked to its end.
    pub(super) fault: Option<String>,
}

/// Unpacks a compressed file of `total` bytes to a temporary one. Everything before a damaged place is unpacked.
pub(super) fn unpack(file: File, total: u64, progress: Progress<'_>) -> Result<UnpackedFile, String> {
    let bound = (FREE + total.saturating_mul(MAX_RATIO)).min(MAX_UNPACKED);
    unpack_within(bound, file, total, progress)
}

fn unpack_within(bound: u64, file: File, total: u64, progress: Progress<'_>) -> Result<UnpackedFile, String> {
    let cannot = |error: std::io::Error| format!("cannot be unpacked: {error}");
    let (temporary, mut out) = TempPath::file().map_err(cannot)?;
    let mut counted = CountingReader { file, done: 0 };
    let mut decoder = zstd::Decoder::new(&mut counted).map_err(cannot)?;
    let mut buffer = vec![0; STEP];
    let (mut size, mut fault) = (0, None);
    loop {
        let read = match decoder.read(&mut buffer) {
            Ok(0) => break,
            Ok(read) => read,
            Err(error) if error.kind() == std::io::ErrorKind::Interrupted => continue,
            Err(error) => {
                fault = Some(format!(
                    "the compressed file is cut off or damaged after {size} unpacked bytes: {error}"
                ));
                break;
            }
        };
        size += read as u64;
        if size > bound {
            fault = Some(format!(
                "the file unpacks to more than {bound} bytes; the rest was not read"
            ));
            break;
        }
        let full =
            |error: std::io::Error| format!("cannot be unpacked into {}: {error}", std::env::temp_dir().display());
        out.write_all(buffer.get(..read).unwrap_or_default()).map_err(full)?;
        progress(decoder.get_ref().get_ref().done.min(total), total);
    }
    out.flush().map_err(cannot)?;
    Ok(UnpackedFile {
        file: temporary,
        size,
        fault,
    })
}

struct CountingReader {
    file: File,
    done: u64,
}

impl Read for CountingReader {
    fn read(&mut self, buffer: &mut [u8]) -> std::io::Result<usize> {
        let read = self.file.read(buffer)?;
        self.done += read as u64;
        Ok(read)
    }
}

/// Passes messages on, decompressed where each is a frame.
pub(super) struct Inflate<'v> {
    visit: &'v mut dyn Visit,
    decompressor: Option<Decompressor<'static>>,
    buffer: Vec<u8>,
    /// Messages that were compressed.
    pub(super) compressed: u64,
    /// Messages that could not be decompressed, with the first one's reason.
    broken: u64,
    why: Option<String>,
}

impl<'v> Inflate<'v> {
    pub(super) fn new(visit: &'v mut dyn Visit) -> Self {
        Self {
            visit,
            decompressor: None,
            buffer: Vec::new(),
            compressed: 0,
            broken: 0,
            why: None,
        }
    }

    /// Decompresses one message into the buffer.
    fn inflate(&mut self, data: &[u8]) -> Result<(), String> {
        let words = |error: std::io::Error| error.to_string();
        self.buffer.clear();
        match get_frame_content_size(data) {
            Ok(Some(size)) if size > MAX_MESSAGE => Err(format!(
                "its header claims {size} bytes, above the limit of {MAX_MESSAGE}"
            )),
            Ok(Some(size)) => {
                self.buffer.reserve(usize::try_from(size).unwrap_or(0));
                let decompressor = match &mut self.decompressor {
                    Some(known) => known,
                    none => none.insert(Decompressor::new().map_err(words)?),
                };
                decompressor
                    .decompress_to_buffer(data, &mut self.buffer)
                    .map_err(words)?;
                Ok(())
            }
            // A frame that was written as a stream does not say how long it is.
            Ok(None) => {
                let decoder = zstd::Decoder::new(data).map_err(words)?;
                decoder
                    .take(MAX_MESSAGE + 1)
                    .read_to_end(&mut self.buffer)
                    .map_err(words)?;
                if self.buffer.len() as u64 > MAX_MESSAGE {
                    return Err(format!("it unpacks to more than {MAX_MESSAGE} bytes"));
                }
                Ok(())
            }
            Err(_) => Err("its header is damaged".to_owned()),
        }
    }

    /// Reports what could not be decompressed; returns whether anything was lost.
    pub(super) fn report(&self, source: &mut Source) -> bool {
        if let Some(why) = &self.why {
            let (broken, of) = (self.broken, self.compressed);
            let message = format!("{broken} of {of} compressed messages cannot be decompressed; the first: {why}");
            source.problem(ReadStatus::Partial, Place::whole(source.id), message);
            let read = &mut source.examined.messages;
            *read = read.map(|read| read.saturating_sub(broken));
        }
        self.broken > 0
    }
}

impl Visit for Inflate<'_> {
    fn channel(&mut self, channel: &Channel) {
        self.visit.channel(channel);
    }

    fn message(&mut self, channel: &Channel, message: &Message<'_>) {
        if channel.message_encoding != "cdr" || !message.data.starts_with(&MAGIC) {
            return self.visit.message(channel, message);
        }
        self.compressed += 1;
        match self.inflate(message.data) {
            Ok(()) => {
                let inflated = Message {
                    log_ns: message.log_ns,
                    data: &self.buffer,
                };
                self.visit.message(channel, &inflated);
            }
            Err(why) => {
                self.broken += 1;
                self.why.get_or_insert(why);
            }
        }
        // The memory of one large message must not be kept for ever.
        if self.buffer.capacity() > STEP {
            self.buffer = Vec::new();
        }
    }

    fn seam(&mut self) {
        self.visit.seam();
    }

    fn part(&mut self, name: &str) {
        self.visit.part(name);
    }

    fn annotation(&mut self, name: &str, fields: &BTreeMap<String, String>) {
        self.visit.annotation(name, fields);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn unpacked(bound: u64, bytes: &[u8]) -> UnpackedFile {
        let mut file = tempfile::tempfile().unwrap();
        file.write_all(bytes).unwrap();
        std::io::Seek::rewind(&mut file).unwrap();
        unpack_within(bound, file, bytes.len() as u64, &|_, _| {}).unwrap()
    }

    #[test]
    fn a_file_that_unpacks_without_end_is_left_at_the_bound() {
        let packed = zstd::encode_all(vec![0; 5 << 20].as_slice(), 3).unwrap();
        let whole = unpacked(5 << 20, &packed);
        assert_eq!((whole.size, whole.fault.clone()), (5 << 20, None));
        let bounded = unpacked(3 << 20, &packed);
        assert!(bounded.fault.unwrap().contains("more than 3145728 bytes"));
        assert!(std::fs::metadata(bounded.file.path()).unwrap().len() <= 3 << 20);
    }

    #[test]
    fn what_stands_before_a_cut_comes_out() {
        let noise: Vec<u8> = (0..1_000_000_u32)
            .flat_map(|i| i.wrapping_mul(2_654_435_761).to_le_bytes())
            .collect();
        let packed = zstd::encode_all(noise.as_slice(), 1).unwrap();
        let cut = unpacked(1 << 30, &packed[..packed.len() / 2]);
        assert!(cut.fault.unwrap().contains("cut off or damaged"));
        let got = std::fs::read(cut.file.path()).unwrap();
        assert!(got.len() > 1 << 20 && noise.starts_with(&got), "{}", got.len());
    }
}
