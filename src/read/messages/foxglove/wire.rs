//! A cursor over the wire format of Protocol Buffers.
//!
//! Owns varints, tags, lengths and bounds; skips what is not wanted without reading it.
//! Source: <https://protobuf.dev/programming-guides/encoding>.

use crate::read::messages::DecodeError;

/// One field as encoded.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum RawField<'m> {
    Varint(u64),
    Fixed64([u8; 8]),
    Fixed32([u8; 4]),
    Bytes(Wire<'m>),
    /// A group, skipped: the oldest way to nest, which no type that is read here uses.
    Group,
}

/// A section of a message. Positions in errors count from the first byte of the whole message.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Wire<'m> {
    message: &'m [u8],
    at: usize,
    end: usize,
}

impl<'m> Wire<'m> {
    pub(super) fn new(message: &'m [u8]) -> Self {
        Self {
            message,
            at: 0,
            end: message.len(),
        }
    }

    /// The position of the cursor in the whole message.
    pub(super) fn position(&self) -> usize {
        self.at
    }

    pub(super) fn is_empty(&self) -> bool {
        self.at >= self.end
    }

    /// The bytes of the section.
    pub(super) fn bytes(&self) -> &'m [u8] {
        self.message.get(self.at..self.end).unwrap_or_default()
    }

    /// The next field with its number; `None` at the end.
    pub(super) fn field(&mut self) -> Result<Option<(u32, RawField<'m>)>, DecodeError> {
        if self.is_empty() {
            return Ok(None);
        }
        let start = self.at;
        let (number, kind) = self.tag()?;
        let raw = match kind {
            3 => {
                self.skip_group(start)?;
                RawField::Group
            }
            4 => return Err(DecodeError(format!("a group ends at byte {start} that never began"))),
            _ => self.raw(start, kind)?,
        };
        Ok(Some((number, raw)))
    }

    /// The next varint.
    pub(super) fn varint(&mut self) -> Result<u64, DecodeError> {
        let start = self.at;
        let mut value = 0;
        for shift in (0..70).step_by(7) {
            let [byte] = self.fixed::<1>()?;
            // Only one bit of the tenth byte counts; the others are dropped, as in other readers.
            value |= u64::from(byte & 0x7f).checked_shl(shift).unwrap_or(0);
            if byte & 0x80 == 0 {
                return Ok(value);
            }
        }
        Err(DecodeError(format!("the varint at byte {start} does not end")))
    }

    /// The next `N` bytes.
    pub(super) fn fixed<const N: usize>(&mut self) -> Result<[u8; N], DecodeError> {
        match self.bytes().first_chunk::<N>() {
            Some(bytes) => {
                self.at += N;
                Ok(*bytes)
            }
            None => Err(self.too_short(N as u64)),
        }
    }

    fn tag(&mut self) -> Result<(u32, u64), DecodeError> {
        let start = self.at;
        let tag = self.varint()?;
        match u32::try_from(tag >> 3) {
            Ok(number @ 1..=0x1fff_ffff) => Ok((number, tag & 7)),
            _ => Err(DecodeError(format!("{tag} at byte {start} is not the tag of a field"))),
        }
    }

    fn raw(&mut self, start: usize, kind: u64) -> Result<RawField<'m>, DecodeError> {
        Ok(match kind {
            0 => RawField::Varint(self.varint()?),
            1 => RawField::Fixed64(self.fixed()?),
            2 => RawField::Bytes(self.stretch()?),
            5 => RawField::Fixed32(self.fixed()?),
            _ => return Err(DecodeError(format!("the wire type {kind} at byte {start} is unknown"))),
        })
    }

    fn stretch(&mut self) -> Result<Self, DecodeError> {
        let length = self.varint()?;
        let end = usize::try_from(length)
            .ok()
            .and_then(|length| self.at.checked_add(length));
        match end {
            Some(end) if end <= self.end => {
                let inner = Self { end, ..*self };
                self.at = end;
                Ok(inner)
            }
            _ => Err(self.too_short(length)),
        }
    }

    /// Skips a group and the groups inside it, counting instead of recursing.
    fn skip_group(&mut self, start: usize) -> Result<(), DecodeError> {
        let mut open = 1_u64;
        while open > 0 {
            if self.is_empty() {
                return Err(DecodeError(format!("the group at byte {start} does not end")));
            }
            let at = self.at;
            match self.tag()?.1 {
                3 => open += 1,
                4 => open -= 1,
                kind => {
                    self.raw(at, kind)?;
                }
            }
        }
        Ok(())
    }

    fn too_short(&self, wanted: u64) -> DecodeError {
        let (at, end, all) = (self.at, self.end, self.message.len());
        DecodeError(if end == all {
            format!("{wanted} bytes at byte {at} run past the end of the message of {all}")
        } else {
            format!("{wanted} bytes at byte {at} run past the end of their field at byte {end}")
        })
    }
}
