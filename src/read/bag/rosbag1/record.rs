//! Records of a ROS 1 bag: their frame, the fields of their headers, and the records inside a chunk.
//!
//! Owns the bytes between a header's length and the end of the data. Must not know what the records mean.
//!
//! A record is: length of the header (4 bytes, little-endian), header, length of the data (4 bytes), data. A header is
//! a run of fields: length (4 bytes), name, `=`, value. Format: <http://wiki.ros.org/Bags/Format/2.0>.

use std::io::Read;

use super::super::MAX_MESSAGE;

/// Bound on the header of a record, bytes. The longest hold a topic and some numbers.
pub(super) const MAX_HEADER: u32 = 1 << 16;

/// The kinds of records, by the value of the field `op`.
pub(super) mod op {
    pub(crate) const MESSAGE: u8 = 2;
    pub(crate) const BAG_HEADER: u8 = 3;
    pub(crate) const INDEX_DATA: u8 = 4;
    pub(crate) const CHUNK: u8 = 5;
    pub(crate) const CHUNK_INFO: u8 = 6;
    pub(crate) const CONNECTION: u8 = 7;
}

/// The name of a kind of record.
pub(super) fn kind(op: u8) -> String {
    let name = match op {
        op::MESSAGE => "message",
        op::BAG_HEADER => "bag header",
        op::INDEX_DATA => "index data",
        op::CHUNK => "chunk",
        op::CHUNK_INFO => "chunk info",
        op::CONNECTION => "connection",
        other => return format!("{other:#04x}"),
    };
    name.to_owned()
}

/// Why a record cannot be read.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) enum Fault {
    /// The bytes end inside the record.
    Ended,
    /// Something is wrong with the bytes.
    Wrong(String),
}

/// The fields of a header, whose frames are known to be sound.
#[derive(Clone, Copy, Debug)]
pub(super) struct Fields<'a> {
    bytes: &'a [u8],
    op: u8,
}

impl<'a> Fields<'a> {
    /// The fields of a record's header, which has a kind.
    pub(super) fn of(header: &'a [u8]) -> Result<Self, String> {
        let mut fields = Self::plain(header)?;
        let [op] = fields.get("op").unwrap_or_default() else {
            return Err("a record has no kind".to_owned());
        };
        fields.op = *op;
        Ok(fields)
    }

    /// Fields that are not the header of a record, such as a connection's.
    pub(super) fn plain(bytes: &'a [u8]) -> Result<Self, String> {
        let mut rest = bytes;
        while !rest.is_empty() {
            let (field, behind) = split_field(rest).ok_or("a record header is shorter than its fields")?;
            if !field.contains(&b'=') {
                return Err("a field of a header has no name".to_owned());
            }
            rest = behind;
        }
        Ok(Self { bytes, op: 0 })
    }

    /// The kind of the record; 0 for plain fields.
    pub(super) fn op(&self) -> u8 {
        self.op
    }

    /// The value of a field; of the first one where a name is repeated.
    pub(super) fn get(&self, name: &str) -> Option<&'a [u8]> {
        let mut rest = self.bytes;
        while let Some((field, behind)) = split_field(rest) {
            let value = field
                .strip_prefix(name.as_bytes())
                .and_then(|rest| rest.strip_prefix(b"="));
            if value.is_some() {
                return value;
            }
            rest = behind;
        }
        None
    }

    /// A text; what is not UTF-8 in it is replaced.
    pub(super) fn text(&self, name: &str) -> Option<String> {
        self.get(name).map(|value| String::from_utf8_lossy(value).into_owned())
    }

    /// A number of 4 bytes.
    pub(super) fn u32(&self, name: &str) -> Result<u32, String> {
        let value = self.get(name).and_then(|value| value.try_into().ok());
        value.map(u32::from_le_bytes).ok_or_else(|| self.lacks(name))
    }

    /// A number of 8 bytes.
    pub(super) fn u64(&self, name: &str) -> Result<u64, String> {
        let value = self.get(name).and_then(|value| value.try_into().ok());
        value.map(u64::from_le_bytes).ok_or_else(|| self.lacks(name))
    }

    /// A time: seconds and nanoseconds, 4 bytes each; as nanoseconds.
    pub(super) fn time_ns(&self, name: &str) -> Result<i64, String> {
        let time = self.u64(name)?;
        let (seconds, nanoseconds) = (time & 0xffff_ffff, time >> 32);
        // Both parts have 32 bits: the sum stays below 2^62.
        i64::try_from(seconds * 1_000_000_000 + nanoseconds).map_err(|_| self.lacks(name))
    }

    fn lacks(&self, name: &str) -> String {
        format!(
            "the field `{name}` of a {} record is missing or not valid",
            kind(self.op)
        )
    }
}

fn split_field(bytes: &[u8]) -> Option<(&[u8], &[u8])> {
    let (len, rest) = split_u32(bytes)?;
    rest.split_at_checked(usize::try_from(len).ok()?)
}

fn split_u32(bytes: &[u8]) -> Option<(u32, &[u8])> {
    let (number, rest) = bytes.split_first_chunk()?;
    Some((u32::from_le_bytes(*number), rest))
}

/// The next of the records in `bytes`, which is removed from them; `None` at the end.
pub(super) fn next<'a>(bytes: &mut &'a [u8]) -> Result<Option<(Fields<'a>, &'a [u8])>, Fault> {
    if bytes.is_empty() {
        return Ok(None);
    }
    let (len, rest) = split_u32(bytes).ok_or(Fault::Ended)?;
    let len = header_len(len)?;
    let (header, rest) = rest.split_at_checked(len).ok_or(Fault::Ended)?;
    let fields = Fields::of(header).map_err(Fault::Wrong)?;
    let (len, rest) = split_u32(rest).ok_or(Fault::Ended)?;
    let len = usize::try_from(len).map_err(|_| Fault::Ended)?;
    let (data, rest) = rest.split_at_checked(len).ok_or(Fault::Ended)?;
    *bytes = rest;
    Ok(Some((fields, data)))
}

/// The length of a header, which no sound record exceeds.
pub(super) fn header_len(len: u32) -> Result<usize, Fault> {
    match usize::try_from(len) {
        Ok(0) => Err(Fault::Wrong("a record has no header".to_owned())),
        Ok(bytes) if len <= MAX_HEADER => Ok(bytes),
        _ => Err(Fault::Wrong(format!("a record claims a header of {len} bytes"))),
    }
}

/// Records of a stream, one at a time: for chunks too large for memory, and those whose end is missing.
pub(super) struct Stream<R> {
    input: R,
    len: Vec<u8>,
    header: Vec<u8>,
    data: Vec<u8>,
}

impl<R: Read> Stream<R> {
    pub(super) fn new(input: R) -> Self {
        Self {
            input,
            len: Vec::new(),
            header: Vec::new(),
            data: Vec::new(),
        }
    }

    /// The stream, positioned after the last record.
    pub(super) fn into_inner(self) -> R {
        self.input
    }

    /// The next record; `None` at the end.
    pub(super) fn next(&mut self) -> Result<Option<(Fields<'_>, &[u8])>, Fault> {
        let Some(len) = self.len()? else {
            return Ok(None);
        };
        fill(&mut self.input, &mut self.header, header_len(len)? as u64)?;
        let len = self.len()?.ok_or(Fault::Ended)?;
        if u64::from(len) > MAX_MESSAGE {
            return Err(Fault::Wrong(format!(
                "a record of {len} bytes is above the limit of {MAX_MESSAGE}"
            )));
        }
        fill(&mut self.input, &mut self.data, u64::from(len))?;
        let fields = Fields::of(&self.header).map_err(Fault::Wrong)?;
        Ok(Some((fields, &self.data)))
    }

    /// A length; `None` where the bytes end before it.
    fn len(&mut self) -> Result<Option<u32>, Fault> {
        fill_some(&mut self.input, &mut self.len, 4)?;
        match self.len.as_slice() {
            [] => Ok(None),
            [a, b, c, d] => Ok(Some(u32::from_le_bytes([*a, *b, *c, *d]))),
            _ => Err(Fault::Ended),
        }
    }
}

/// Reads a number of bytes into a buffer, which grows by what exists and not by what is requested.
fn fill(input: &mut impl Read, buffer: &mut Vec<u8>, len: u64) -> Result<(), Fault> {
    fill_some(input, buffer, len)?;
    if (buffer.len() as u64) < len {
        Err(Fault::Ended)
    } else {
        Ok(())
    }
}

fn fill_some(input: &mut impl Read, buffer: &mut Vec<u8>, len: u64) -> Result<(), Fault> {
    buffer.clear();
    match input.take(len).read_to_end(buffer) {
        Ok(_) => Ok(()),
        Err(error) if error.kind() == std::io::ErrorKind::UnexpectedEof => Err(Fault::Ended),
        Err(error) => Err(Fault::Wrong(error.to_string())),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn field(name: &str, value: &[u8]) -> Vec<u8> {
        let len = u32::try_from(name.len() + 1 + value.len()).unwrap();
        [&len.to_le_bytes(), name.as_bytes(), b"=", value].concat()
    }

    #[test]
    fn fields_are_found_by_their_whole_name() {
        let header = [
            field("connection", b"x"),
            field("conn", &7_u32.to_le_bytes()),
            field("op", &[2]),
            field("time", &[[1, 0, 0, 0], [5, 0, 0, 0]].concat()),
        ]
        .concat();
        let fields = Fields::of(&header).unwrap();
        assert_eq!((fields.op(), fields.u32("conn")), (2, Ok(7)));
        assert_eq!(fields.time_ns("time"), Ok(1_000_000_005));
        assert!(fields.u32("con").is_err() && fields.u64("conn").is_err());
    }

    #[test]
    fn the_latest_time_has_room() {
        let header = [field("op", &[2]), field("time", &[0xff; 8])].concat();
        let latest = (i64::from(u32::MAX)) * 1_000_000_000 + i64::from(u32::MAX);
        assert_eq!(Fields::of(&header).unwrap().time_ns("time"), Ok(latest));
    }

    #[test]
    fn unsound_headers_are_refused() {
        for header in [
            &b"\x05\0\0\0op=\x02"[..],
            b"\x02\0\0\0op",
            b"\x04\0\0",
            b"\x04\0\0\0ab=c",
            b"\xff\xff\xff\xffop=",
        ] {
            assert!(Fields::of(header).is_err(), "{header:?}");
        }
    }

    #[test]
    fn records_in_memory_and_in_a_stream_are_the_same() {
        let header = field("op", &[2]);
        let one = [
            u32::try_from(header.len()).unwrap().to_le_bytes().as_slice(),
            &header,
            &3_u32.to_le_bytes(),
            b"abc",
        ]
        .concat();
        let two = [one.clone(), one.clone()].concat();
        for cut in 0..=two.len() {
            let bytes = &two[..cut];
            let (mut rest, mut stream) = (bytes, Stream::new(bytes));
            loop {
                let slice = next(&mut rest).map(|record| record.map(|(fields, data)| (fields.op(), data.to_vec())));
                let streamed = stream
                    .next()
                    .map(|record| record.map(|(fields, data)| (fields.op(), data.to_vec())));
                assert_eq!(slice, streamed, "cut at {cut}");
                if !matches!(slice, Ok(Some(_))) {
                    assert_eq!(slice.is_ok(), cut % one.len() == 0);
                    break;
                }
            }
        }
    }
}
