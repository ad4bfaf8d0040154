//! The file of a bag, as a tape that knows its position.
//!
//! Owns positions, and the frames of the records in the file itself. Nothing a record claims is trusted
//! before it is checked against the file's length.

use std::fs::File;
use std::io::{BufReader, Read, Seek, SeekFrom};

use super::record::{self, Fault, Fields, op};

/// A record's header and the claimed length of its data, with the tape positioned before the data.
pub(super) struct Frame {
    header: Vec<u8>,
    /// The length of the data according to the record; whether they exist is not known.
    pub(super) len: u64,
}

impl Frame {
    /// The fields, which were sound when the frame was read.
    pub(super) fn fields(&self) -> Result<Fields<'_>, Fault> {
        Fields::of(&self.header).map_err(Fault::Wrong)
    }
}

pub(super) struct Tape {
    file: BufReader<File>,
    /// Position in the file.
    pub(super) at: u64,
    /// Length of the file.
    pub(super) total: u64,
}

impl Tape {
    pub(super) fn new(file: File, total: u64) -> Self {
        Self {
            file: BufReader::with_capacity(1 << 18, file),
            at: 0,
            total,
        }
    }

    /// Remaining bytes.
    pub(super) fn rest(&self) -> u64 {
        self.total.saturating_sub(self.at)
    }

    /// Moves to another position.
    pub(super) fn seek(&mut self, to: u64) -> Result<(), Fault> {
        let wrong = |error: std::io::Error| Fault::Wrong(error.to_string());
        // Small steps stay inside the buffer.
        let near = i64::try_from(to).ok().zip(i64::try_from(self.at).ok());
        match near.and_then(|(to, at)| to.checked_sub(at)) {
            Some(step) => self.file.seek_relative(step).map_err(wrong)?,
            None => self.file.seek(SeekFrom::Start(to)).map(|_| ()).map_err(wrong)?,
        }
        self.at = to;
        Ok(())
    }

    /// Reads `len` bytes into a buffer.
    pub(super) fn load(&mut self, buffer: &mut Vec<u8>, len: u64) -> Result<(), Fault> {
        buffer.clear();
        if len > self.rest() {
            return Err(Fault::Ended);
        }
        let result = (&mut self.file).take(len).read_to_end(buffer);
        self.at += buffer.len() as u64;
        result.map_err(|error| Fault::Wrong(error.to_string()))?;
        if (buffer.len() as u64) < len {
            Err(Fault::Ended)
        } else {
            Ok(())
        }
    }

    /// A number of 4 bytes.
    fn u32(&mut self) -> Result<u32, Fault> {
        let mut number = [0; 4];
        if self.rest() < 4 {
            return Err(Fault::Ended);
        }
        let result = self.file.read_exact(&mut number);
        result.map_err(|error| Fault::Wrong(error.to_string()))?;
        self.at += 4;
        Ok(u32::from_le_bytes(number))
    }

    /// The frame of the next record. On a fault the position is undefined.
    pub(super) fn frame(&mut self) -> Result<Frame, Fault> {
        let len = self.u32()?;
        let mut header = Vec::new();
        self.load(&mut header, record::header_len(len)? as u64)?;
        Fields::of(&header).map_err(Fault::Wrong)?;
        let len = u64::from(self.u32()?);
        Ok(Frame { header, len })
    }

    /// The bytes from here on, at most `len`. Afterwards the position is to be set by [`Tape::seek_anew`].
    pub(super) fn bytes(&mut self, len: u64) -> impl Read {
        (&mut self.file).take(len)
    }

    /// Moves to a position from an undefined one: after a fault, and after [`Tape::bytes`].
    pub(super) fn seek_anew(&mut self, to: u64) -> Result<(), Fault> {
        let result = self.file.seek(SeekFrom::Start(to));
        result.map_err(|error| Fault::Wrong(error.to_string()))?;
        self.at = to;
        Ok(())
    }

    /// Whether a record of a known kind seems to begin at a position, and stays inside the file. The position of the
    /// tape does not change.
    pub(super) fn is_record_at(&mut self, at: u64) -> bool {
        self.peek(at)
            .is_some_and(|(kind, _)| (op::MESSAGE..=op::CONNECTION).contains(&kind))
    }

    /// Whether a chunk seems to begin at a position.
    pub(super) fn is_chunk_at(&mut self, at: u64) -> bool {
        self.peek(at).is_some_and(|(kind, _)| kind == op::CHUNK)
    }

    /// The kind and the end of the record at a position, if there is one. The position of the tape does not change.
    fn peek(&mut self, at: u64) -> Option<(u8, u64)> {
        let back = self.at;
        let found = self.seek(at).and_then(|()| {
            let frame = self.frame()?;
            Ok((frame.fields()?.op(), self.at + frame.len))
        });
        self.seek_anew(back).ok()?;
        found.ok().filter(|(_, end)| *end <= self.total)
    }
}
