//! The layout of pcap: a header of 24 bytes, then records of 16 bytes and a packet each.
//!
//! Source: draft-ietf-opsawg-pcap.

use super::record::{CapturedPacket, Fault, MAX_PACKET, Record};
use super::tape::Tape;

/// What the header of a file says about its records.
pub(super) struct Classic {
    is_little: bool,
    /// Nanoseconds of a unit of the fraction of a second.
    unit_ns: u32,
    link: u32,
}

/// The head of a record.
#[derive(Clone, Copy)]
struct Head {
    time_ns: i64,
    len: u32,
}

impl Classic {
    /// Where the first record is.
    pub(super) const START: u64 = 24;
    /// Bytes of the head of a record.
    const HEAD: u64 = 16;

    /// By the first 24 bytes of a file.
    pub(super) fn of(first: &[u8]) -> Result<Self, String> {
        let (is_little, unit_ns) = match first {
            [0xd4, 0xc3, 0xb2, 0xa1, ..] => (true, 1000),
            [0x4d, 0x3c, 0xb2, 0xa1, ..] => (true, 1),
            [0xa1, 0xb2, 0xc3, 0xd4, ..] => (false, 1000),
            _ => (false, 1),
        };
        let [.., a, b, c, d] = *first.first_chunk::<24>().ok_or("the file ends inside its header")?;
        let link = [a, b, c, d];
        let link = if is_little {
            u32::from_le_bytes(link)
        } else {
            u32::from_be_bytes(link)
        };
        Ok(Self {
            is_little,
            unit_ns,
            // Above are flags about checksums.
            link: link & 0xffff,
        })
    }

    fn parse(&self, head: &[u8]) -> Option<Result<Head, String>> {
        let mut numbers = head.chunks_exact(4).map(|number| {
            let number = *number.first_chunk().unwrap_or(&[0; 4]);
            if self.is_little {
                u32::from_le_bytes(number)
            } else {
                u32::from_be_bytes(number)
            }
        });
        let (seconds, fraction) = (numbers.next()?, numbers.next()?);
        let (len, original) = (numbers.next()?, numbers.next()?);
        if len > MAX_PACKET {
            return Some(Err(format!(
                "a record of {len} bytes is above the limit of {MAX_PACKET}"
            )));
        }
        // Zeros, as a system that stopped leaves them.
        if len == 0 {
            return Some(Err("a record has no packet".to_owned()));
        }
        if len > original {
            return Some(Err(format!("a record has {len} bytes of a packet of {original}")));
        }
        let fraction_ns = i64::from(fraction) * i64::from(self.unit_ns);
        if fraction_ns >= 1_000_000_000 {
            return Some(Err(format!(
                "a record has the fraction {fraction} of a second, which is above one"
            )));
        }
        Some(Ok(Head {
            time_ns: i64::from(seconds) * 1_000_000_000 + fraction_ns,
            len,
        }))
    }

    /// Whether these 16 bytes may be the head of a record with a time in a span.
    pub(super) fn may_be(&self, head: &[u8], span_ns: (i64, i64)) -> bool {
        let Some(Ok(head)) = self.parse(head) else { return false };
        head.len >= 14 && (span_ns.0..=span_ns.1).contains(&head.time_ns)
    }

    /// Checks the head of the record at a position.
    pub(super) fn head(&self, tape: &mut Tape, at: u64) -> Result<(), Fault> {
        self.read(tape, at).map(|_| ())
    }

    fn read(&self, tape: &mut Tape, at: u64) -> Result<Head, Fault> {
        let head = self.parse(tape.bytes(at, 16));
        let head = head.ok_or_else(|| Fault::Ended("the file ends inside the head of a record".to_owned()))?;
        head.map_err(Fault::Wrong)
    }

    pub(super) fn record(&self, tape: &mut Tape, at: u64) -> Result<Record, Fault> {
        let head = self.read(tape, at)?;
        let from = at + Self::HEAD;
        let next = from + u64::from(head.len);
        if next > tape.total {
            return Err(Fault::Ended(format!(
                "the file ends inside a record of {} bytes",
                head.len
            )));
        }
        let packet = CapturedPacket {
            time_ns: head.time_ns,
            link: self.link,
            from,
            len: head.len as usize,
        };
        Ok(Record {
            next,
            packet: Some(packet),
        })
    }
}
