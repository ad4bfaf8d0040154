//! The layout of pcapng: blocks with their type, their length before and after, and what is between.
//!
//! Owns sections and interfaces. Source: draft-ietf-opsawg-pcapng, sections 3 and 4.

use super::record::{CapturedPacket, Fault, MAX_PACKET, Record};
use super::tape::Tape;

/// Types of blocks.
const SECTION: u32 = 0x0a0d_0d0a;
const INTERFACE: u32 = 1;
const OBSOLETE_PACKET: u32 = 2;
const ENHANCED_PACKET: u32 = 6;
/// The types that are defined: besides the above, simple packets, names, statistics, journals, secrets, events and custom blocks.
const TYPES: [u32; 11] = [
    SECTION,
    INTERFACE,
    OBSOLETE_PACKET,
    3,
    4,
    5,
    ENHANCED_PACKET,
    9,
    10,
    0xbad,
    0x4000_0bad,
];
/// Options of an interface: the unit of its times, and seconds to be added to them.
const UNIT: u16 = 9;
const OFFSET: u16 = 14;
/// Bound on the interfaces of a section.
const MAX_INTERFACES: usize = 1024;
/// Bound on an interface's block, bytes, of which more is not looked at.
const MAX_INTERFACE: usize = 1 << 16;
/// The marks of the byte order in a section's header.
const LITTLE: [u8; 4] = [0x4d, 0x3c, 0x2b, 0x1a];
const BIG: [u8; 4] = [0x1a, 0x2b, 0x3c, 0x4d];

/// What the blocks so far say about those that follow.
#[derive(Default)]
pub(super) struct Blocks {
    is_big: bool,
    interfaces: Vec<Interface>,
}

#[derive(Clone, Copy)]
struct Interface {
    link: u32,
    /// Units of time in a second.
    units: u64,
    offset_s: i64,
}

/// The head of a block.
#[derive(Clone, Copy)]
struct Head {
    kind: u32,
    len: u64,
    is_big: bool,
}

impl Blocks {
    /// Whether these 8 bytes may be the head of a block.
    pub(super) fn may_be(&self, head: &[u8]) -> bool {
        let kind = self.u32(head, 0);
        kind.is_some_and(|kind| TYPES.contains(&kind)) && self.u32(head, 4).is_some_and(|len| len >= 12 && len % 4 == 0)
    }

    fn u32(&self, bytes: &[u8], at: usize) -> Option<u32> {
        u32_of(bytes, at, self.is_big)
    }

    fn u16(&self, bytes: &[u8], at: usize) -> Option<u16> {
        let number = *bytes.get(at..)?.first_chunk()?;
        Some(if self.is_big {
            u16::from_be_bytes(number)
        } else {
            u16::from_le_bytes(number)
        })
    }

    /// The head of the block at a position, which ends as it begins.
    pub(super) fn head(&self, tape: &mut Tape, at: u64) -> Result<(), Fault> {
        self.framed(tape, at).map(|_| ())
    }

    fn framed(&self, tape: &mut Tape, at: u64) -> Result<Head, Fault> {
        let ended = || Fault::Ended("the file ends inside the head of a block".to_owned());
        let first = tape.bytes(at, 12);
        let kind = self.u32(first, 0).ok_or_else(ended)?;
        let is_big = match first.get(8..12) {
            // The same in both orders.
            _ if kind != SECTION => self.is_big,
            Some(mark) if mark == LITTLE => false,
            Some(mark) if mark == BIG => true,
            Some(_) => {
                return Err(Fault::Wrong(
                    "the header of a section has no mark of its byte order".to_owned(),
                ));
            }
            None => return Err(ended()),
        };
        let len = u32_of(first, 4, is_big).ok_or_else(ended)?;
        if len < 12 || len % 4 != 0 {
            return Err(Fault::Wrong(format!(
                "a block has the length {len}, which none can have"
            )));
        }
        let end = at + u64::from(len);
        if end > tape.total {
            return Err(Fault::Ended(format!("the file ends inside a block of {len} bytes")));
        }
        // Both lengths are in memory for all but the largest blocks.
        let behind = u32_of(tape.bytes(end - 4, 4), 0, is_big);
        if behind != Some(len) {
            let behind = behind.unwrap_or_default();
            return Err(Fault::Wrong(format!(
                "a block has the length {len} before it and {behind} after it"
            )));
        }
        let len = u64::from(len);
        Ok(Head { kind, len, is_big })
    }

    /// The block at a position, without taking in what it says about others.
    pub(super) fn peek(&self, tape: &mut Tape, at: u64) -> Result<Record, Fault> {
        let head = self.framed(tape, at)?;
        let packet = match head.kind {
            ENHANCED_PACKET | OBSOLETE_PACKET => self.packet(tape, at, head)?,
            _ => None,
        };
        let next = at + head.len;
        Ok(Record { next, packet })
    }

    pub(super) fn record(&mut self, tape: &mut Tape, at: u64) -> Result<Record, Fault> {
        let head = self.framed(tape, at)?;
        match head.kind {
            SECTION => {
                self.is_big = head.is_big;
                self.interfaces.clear();
            }
            INTERFACE if self.interfaces.len() < MAX_INTERFACES => {
                let len = usize::try_from(head.len).unwrap_or(MAX_INTERFACE).min(MAX_INTERFACE);
                let interface = self.interface(tape.bytes(at, len));
                self.interfaces.push(interface);
            }
            _ => return self.peek(tape, at),
        }
        let next = at + head.len;
        Ok(Record { next, packet: None })
    }

    fn interface(&self, block: &[u8]) -> Interface {
        let mut interface = Interface {
            link: self.u16(block, 8).map_or(u32::MAX, u32::from),
            units: 1_000_000,
            offset_s: 0,
        };
        let mut rest = block.get(16..block.len().saturating_sub(4)).unwrap_or_default();
        while let (Some(code @ 1..), Some(len)) = (self.u16(rest, 0), self.u16(rest, 2)) {
            let len = usize::from(len);
            let value = rest.get(4..4 + len).unwrap_or_default();
            match (code, value) {
                (UNIT, [unit, ..]) => interface.units = units(*unit),
                (OFFSET, value) => {
                    let offset = value.first_chunk().map(|offset| {
                        if self.is_big {
                            i64::from_be_bytes(*offset)
                        } else {
                            i64::from_le_bytes(*offset)
                        }
                    });
                    interface.offset_s = offset.unwrap_or(0);
                }
                _ => {}
            }
            rest = rest.get(4 + len.next_multiple_of(4)..).unwrap_or_default();
        }
        interface
    }

    /// The packet of a block; `None` where its interface is not described.
    fn packet(&self, tape: &mut Tape, at: u64, head: Head) -> Result<Option<CapturedPacket>, Fault> {
        let body = tape.bytes(at, 28);
        let number = if head.kind == ENHANCED_PACKET {
            self.u32(body, 8)
        } else {
            self.u16(body, 8).map(u32::from)
        };
        let short = || Fault::Wrong("a block is too short for a packet".to_owned());
        let number = number.ok_or_else(short)?;
        let high = self.u32(body, 12).ok_or_else(short)?;
        let low = self.u32(body, 16).ok_or_else(short)?;
        let len = self.u32(body, 20).ok_or_else(short)?;
        if u64::from(len) + 32 > head.len || len > MAX_PACKET {
            let of = head.len;
            return Err(Fault::Wrong(format!("a block of {of} bytes has a packet of {len}")));
        }
        let described = usize::try_from(number)
            .ok()
            .and_then(|number| self.interfaces.get(number));
        Ok(described.map(|interface| CapturedPacket {
            time_ns: interface.time_ns(u64::from(high) << 32 | u64::from(low)),
            link: interface.link,
            from: at + 28,
            len: len as usize,
        }))
    }
}

impl Interface {
    /// A time of this interface, nanoseconds since 1970.
    fn time_ns(&self, time: u64) -> i64 {
        let ns = u128::from(time) * 1_000_000_000 / u128::from(self.units);
        let ns = i64::try_from(ns).unwrap_or(i64::MAX);
        ns.saturating_add(self.offset_s.saturating_mul(1_000_000_000))
    }
}

/// Units in a second: a power of ten, or of two where the highest bit is set.
fn units(code: u8) -> u64 {
    let exponent = u32::from(code & 0x7f);
    let units = if code & 0x80 == 0 {
        10_u64.checked_pow(exponent)
    } else {
        1_u64.checked_shl(exponent)
    };
    units.unwrap_or(u64::MAX)
}

fn u32_of(bytes: &[u8], at: usize, is_big: bool) -> Option<u32> {
    let number = *bytes.get(at..)?.first_chunk()?;
    Some(if is_big {
        u32::from_be_bytes(number)
    } else {
        u32::from_le_bytes(number)
    })
}
