//! The file of a capture, read through a window of bounded size.
//!
//! Owns positions and the bytes in memory. Must not know what they are.

use std::fs::File;
use std::io::{Read, Seek, SeekFrom};

/// Bytes that are read at once.
const WINDOW: usize = 1 << 18;

pub(super) struct Tape {
    file: File,
    /// Length of the file.
    pub(super) total: u64,
    /// Where the bytes in memory begin.
    start: u64,
    bytes: Vec<u8>,
    /// Bytes that were read of the file, those read twice counted twice.
    pub(super) read: u64,
    /// The first fault of the system.
    pub(super) fault: Option<String>,
}

impl Tape {
    pub(super) fn new(file: File, total: u64) -> Self {
        Self {
            file,
            total,
            start: 0,
            bytes: Vec::new(),
            read: 0,
            fault: None,
        }
    }

    /// The bytes from a position on; fewer where the file ends or cannot be read.
    pub(super) fn bytes(&mut self, at: u64, len: usize) -> &[u8] {
        let end = at.saturating_add(len as u64).min(self.total);
        if at < self.start || end > self.start + self.bytes.len() as u64 {
            self.load(at, len);
        }
        let from = usize::try_from(at.saturating_sub(self.start)).unwrap_or(usize::MAX);
        let rest = self.bytes.get(from..).unwrap_or_default();
        rest.get(..len).unwrap_or(rest)
    }

    fn load(&mut self, at: u64, len: usize) {
        self.start = at;
        self.bytes.clear();
        let more = len.max(WINDOW) as u64;
        let result = self.file.seek(SeekFrom::Start(at));
        let result = result.and_then(|_| (&mut self.file).take(more).read_to_end(&mut self.bytes));
        self.read += self.bytes.len() as u64;
        if let Err(error) = result {
            self.fault
                .get_or_insert(format!("cannot be read at byte {at}: {error}"));
        }
    }
}
