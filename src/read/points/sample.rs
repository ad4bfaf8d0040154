//! Which points of a file are read: runs of some neighbours, spread evenly over the file.

use std::io::{self, Read, Seek, SeekFrom};

use crate::read::messages::cloud::Column;

/// Points that are read of a file.
pub(super) const MAX_POINTS: u64 = 200_000;
/// Points that are read in a row of a large file. Files are often sorted by tiles or heights: many short runs are an even sample.
const RUN: u64 = 64;
/// Bytes of lines that are read as a whole.
const MAX_LINES: u64 = 16 << 20;
/// Windows of a longer file of lines, and bytes of one.
const WINDOWS: u64 = 512;
const WINDOW: usize = 32 << 10;
/// Bytes that are read at once.
const BLOCK: u64 = 1 << 20;

/// A file, and how much of it was read.
pub(super) struct Tape<F> {
    file: F,
    pub(super) size: u64,
    pub(super) taken: u64,
}

impl<F: Read + Seek> Tape<F> {
    pub(super) fn new(mut file: F) -> io::Result<Self> {
        let size = file.seek(SeekFrom::End(0))?;
        Ok(Self { file, size, taken: 0 })
    }

    /// The bytes from `start`, fewer at the end of the file.
    pub(super) fn at(&mut self, start: u64, length: usize) -> io::Result<Vec<u8>> {
        let length = (length as u64).min(self.size.saturating_sub(start));
        let mut bytes = Vec::with_capacity(usize::try_from(length).unwrap_or_default());
        self.file.seek(SeekFrom::Start(start))?;
        (&mut self.file).take(length).read_to_end(&mut bytes)?;
        self.taken += bytes.len() as u64;
        Ok(bytes)
    }

    /// The bytes of points of equal size, spread over the file; `count` must be in the file.
    pub(super) fn records(
        &mut self,
        start: u64,
        (stride, count): (u64, u64),
        mut take: impl FnMut(&[u8]),
    ) -> io::Result<()> {
        let stride = stride.max(1);
        let in_block = (BLOCK / stride).max(1);
        let (run, runs) = if count <= MAX_POINTS {
            (in_block, count.div_ceil(in_block))
        } else {
            (RUN, MAX_POINTS / RUN)
        };
        for index in 0..runs {
            let first = if count <= MAX_POINTS {
                index * run
            } else {
                spread(index, runs, count - run)
            };
            let length = run.min(count - first) * stride;
            let bytes = self.at(start + first * stride, usize::try_from(length).unwrap_or_default())?;
            bytes
                .chunks_exact(usize::try_from(stride).unwrap_or(usize::MAX))
                .for_each(&mut take);
        }
        Ok(())
    }

    /// Lines of text from `start` to the end of the file, or spread over it; and whether these are all.
    pub(super) fn lines(&mut self, start: u64, mut take: impl FnMut(&str)) -> io::Result<bool> {
        let length = self.size.saturating_sub(start);
        let mut of = |bytes: &[u8]| String::from_utf8_lossy(bytes).lines().for_each(&mut take);
        if length <= MAX_LINES {
            of(&self.at(start, usize::try_from(length).unwrap_or_default())?);
            return Ok(true);
        }
        for index in 0..WINDOWS {
            let bytes = self.at(start + spread(index, WINDOWS, length - WINDOW as u64), WINDOW)?;
            // Lines that are cut off at either end are left out.
            let mut parts = bytes.splitn(2, |byte| *byte == b'\n');
            let whole = parts.nth(1).unwrap_or_default();
            let end = whole.iter().rposition(|byte| *byte == b'\n').unwrap_or_default();
            of(whole.get(..end).unwrap_or_default());
        }
        Ok(false)
    }
}

/// Of numbers from 0 to `last`, the one with this index if `count` of them are spread evenly.
pub(super) fn spread(index: u64, count: u64, last: u64) -> u64 {
    let at = u128::from(index) * u128::from(last) / u128::from(count.saturating_sub(1).max(1));
    u64::try_from(at).unwrap_or(last).min(last)
}

/// The numbers of a point in these columns.
pub(super) fn xyz(columns: [Column; 3], point: &[u8]) -> [f64; 3] {
    columns.map(|column| column.of(point).unwrap_or(f64::NAN))
}

/// The numbers of a line in these columns.
pub(super) fn xyz_of_line(columns: [usize; 3], line: &str) -> [f64; 3] {
    let number = |column| {
        let word = line.split_ascii_whitespace().nth(column);
        word.and_then(|word| word.parse().ok()).unwrap_or(f64::NAN)
    };
    columns.map(number)
}
