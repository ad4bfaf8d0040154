//! Reads flatbuffers: tables, and vectors in them. Each access checks its bounds, so that damaged input gives None.
//!
//! Source: "FlatBuffers Internals" of the documentation on <https://flatbuffers.dev>. The crate `flatbuffers` is not used:
//! its safe interface needs code generated for each schema, which has `unsafe` blocks.

/// The bytes of the size that precedes a buffer.
pub(super) const SIZE_BYTES: usize = 4;

/// A table of a flatbuffer.
#[derive(Clone, Copy, Debug)]
pub(super) struct Table<'b> {
    /// The whole buffer.
    bytes: &'b [u8],
    /// Where the table starts.
    at: usize,
    /// Where its list of fields starts, and the bytes of the list.
    fields: (usize, usize),
}

/// A number of N bytes.
fn number<const N: usize>(bytes: &[u8], at: usize) -> Option<[u8; N]> {
    bytes.get(at..)?.first_chunk().copied()
}

fn offset(bytes: &[u8], at: usize) -> Option<usize> {
    usize::try_from(u32::from_le_bytes(number(bytes, at)?)).ok()
}

impl<'b> Table<'b> {
    /// The root of a buffer with its size before it; the identifier is checked where one is given.
    pub(super) fn root(bytes: &'b [u8], identifier: Option<&[u8; 4]>) -> Option<Self> {
        let size = offset(bytes, 0)?;
        let bytes = bytes.get(SIZE_BYTES..)?.get(..size)?;
        if identifier.is_some_and(|wanted| bytes.get(4..8) != Some(wanted)) {
            return None;
        }
        Self::at(bytes, offset(bytes, 0)?)
    }

    fn at(bytes: &'b [u8], at: usize) -> Option<Self> {
        let back = i64::from(i32::from_le_bytes(number(bytes, at)?));
        let list = usize::try_from(i64::try_from(at).ok()? - back).ok()?;
        let length = usize::from(u16::from_le_bytes(number(bytes, list)?));
        bytes.get(list..list.checked_add(length)?)?;
        Some(Self {
            bytes,
            at,
            fields: (list, length),
        })
    }

    /// Where a field is; None where the table lacks it.
    fn field(&self, slot: usize) -> Option<usize> {
        let entry = 4 + 2 * slot;
        if entry + 2 > self.fields.1 {
            return None;
        }
        match u16::from_le_bytes(number(self.bytes, self.fields.0 + entry)?) {
            0 => None,
            offset => self.at.checked_add(usize::from(offset)),
        }
    }

    /// A number of N bytes; None where the table lacks it, which means its default.
    pub(super) fn number<const N: usize>(&self, slot: usize) -> Option<[u8; N]> {
        number(self.bytes, self.field(slot)?)
    }

    pub(super) fn u64(&self, slot: usize) -> u64 {
        self.number(slot).map_or(0, u64::from_le_bytes)
    }

    pub(super) fn u32(&self, slot: usize) -> u32 {
        self.number(slot).map_or(0, u32::from_le_bytes)
    }

    pub(super) fn u8(&self, slot: usize) -> u8 {
        self.number(slot).map_or(0, u8::from_le_bytes)
    }

    /// Where the entries of a vector start, and how many there are; all of them are within the buffer.
    fn entries(&self, slot: usize, width: usize) -> Option<(usize, usize)> {
        let field = self.field(slot)?;
        let vector = field.checked_add(offset(self.bytes, field)?)?;
        let (count, start) = (offset(self.bytes, vector)?, vector.checked_add(4)?);
        self.bytes.get(start..start.checked_add(count.checked_mul(width)?)?)?;
        Some((start, count))
    }

    /// The bytes of a vector whose entries have this width; None where the table lacks it.
    pub(super) fn vector(&self, slot: usize, width: usize) -> Option<&'b [u8]> {
        let (start, count) = self.entries(slot, width)?;
        self.bytes.get(start..start + count * width)
    }

    /// The numbers of a vector; empty where the table lacks it.
    pub(super) fn numbers<const N: usize, T>(&self, slot: usize, of: fn([u8; N]) -> T) -> Vec<T> {
        let (numbers, _) = self.vector(slot, N).unwrap_or_default().as_chunks();
        numbers.iter().copied().map(of).collect()
    }

    pub(super) fn text(&self, slot: usize) -> Option<&'b str> {
        std::str::from_utf8(self.vector(slot, 1)?).ok()
    }

    /// The tables of a vector; empty where the table lacks it. None in place of a damaged one.
    pub(super) fn tables(&self, slot: usize) -> impl ExactSizeIterator<Item = Option<Table<'b>>> + use<'b> {
        let (start, count) = self.entries(slot, 4).unwrap_or_default();
        let bytes = self.bytes;
        (0..count).map(move |i| {
            let entry = start + 4 * i;
            Table::at(bytes, entry.checked_add(offset(bytes, entry)?)?)
        })
    }
}
