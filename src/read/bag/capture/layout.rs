//! The two layouts of captures: records of pcap, blocks of pcapng.
//!
//! Owns what a record is. Written here, not taken from a crate: `pcap-parser` 0.17 refuses times in powers of two and reads offsets of times
//! in one byte order only, `pcap-file` 2 gives no place to continue at after damage; and both know nothing of where records begin.
//! Sources: draft-ietf-opsawg-pcap, draft-ietf-opsawg-pcapng.

use super::blocks::Blocks;
use super::classic::Classic;
use super::network;
use super::record::{Fault, Record};
use super::tape::Tape;

/// Records in a row that must be sound for reading to continue there.
const CHAIN: usize = 8;
/// Bytes that are searched for the start of a record at once.
const SEARCHED: usize = 1 << 16;
/// How far records in a row may be apart in time where a chain is searched, nanoseconds.
const APART_NS: u64 = 60_000_000_000;

pub(super) enum Layout {
    Classic(Classic),
    Blocks(Blocks),
}

impl Layout {
    /// The layout of a file by its first bytes, which are known to be of a capture.
    pub(super) fn of(tape: &mut Tape) -> Result<Self, String> {
        let first = tape.bytes(0, 24);
        if first.starts_with(&super::PCAPNG) {
            return Ok(Self::Blocks(Blocks::default()));
        }
        Classic::of(first).map(Self::Classic)
    }

    /// Where the first record is.
    pub(super) fn start(&self) -> u64 {
        match self {
            Self::Classic(_) => Classic::START,
            Self::Blocks(_) => 0,
        }
    }

    /// What a record is called.
    pub(super) fn word(&self) -> &'static str {
        match self {
            Self::Classic(_) => "record",
            Self::Blocks(_) => "block",
        }
    }

    /// The record at a position, which is in the file.
    pub(super) fn record(&mut self, tape: &mut Tape, at: u64) -> Result<Record, Fault> {
        match self {
            Self::Classic(classic) => classic.record(tape, at),
            Self::Blocks(blocks) => blocks.record(tape, at),
        }
    }

    /// Whether a record seems to begin at a position, or the file ends there or inside of one.
    pub(super) fn goes_on(&self, tape: &mut Tape, at: u64) -> bool {
        let head = match self {
            Self::Classic(classic) => classic.head(tape, at),
            Self::Blocks(blocks) => blocks.head(tape, at),
        };
        !matches!(head, Err(Fault::Wrong(_)))
    }

    /// The first position from `from` to before `until` at which records follow each other. Their times lie in `span_ns`.
    pub(super) fn find(&mut self, tape: &mut Tape, from: u64, until: u64, span_ns: (i64, i64)) -> Option<u64> {
        let (head, step) = match self {
            Self::Classic(_) => (16, 1),
            Self::Blocks(_) => (8, 4),
        };
        let mut at = from.next_multiple_of(step);
        let mut found = Vec::new();
        while at < until {
            let bytes = tape.bytes(at, SEARCHED);
            let starts = bytes
                .windows(head)
                .step_by(usize::try_from(step).unwrap_or(1))
                .enumerate();
            let may_be = |(number, window): (usize, &[u8])| {
                let is_it = match self {
                    Self::Classic(classic) => classic.may_be(window, span_ns),
                    Self::Blocks(blocks) => blocks.may_be(window),
                };
                is_it.then_some(at + step * number as u64)
            };
            found.extend(starts.filter_map(may_be));
            let searched = bytes.len().saturating_sub(head - 1);
            if searched == 0 {
                return None;
            }
            let chain = found
                .drain(..)
                .find(|start| *start < until && self.is_chain(tape, *start, span_ns));
            if chain.is_some() {
                return chain;
            }
            at = (at + searched as u64).next_multiple_of(step);
        }
        None
    }

    /// Whether records follow each other from a position on, most of them with a packet of a network.
    fn is_chain(&mut self, tape: &mut Tape, start: u64, span_ns: (i64, i64)) -> bool {
        let (mut at, mut packets, mut sound, mut before_ns) = (start, 0, 0, None);
        for number in 0..CHAIN {
            if at == tape.total {
                return number >= 2 && 2 * sound >= packets && sound > 0;
            }
            let record = match self {
                // Sections and interfaces are taken in only where they are read.
                Self::Blocks(blocks) => blocks.peek(tape, at),
                Self::Classic(classic) => classic.record(tape, at),
            };
            let record = match record {
                Ok(record) => record,
                Err(Fault::Ended(_)) => return number >= 2 && 2 * sound >= packets && sound > 0,
                Err(Fault::Wrong(_)) => return false,
            };
            at = record.next;
            let Some(packet) = record.packet else { continue };
            packets += 1;
            let is_near = before_ns.is_none_or(|before: i64| packet.time_ns.abs_diff(before) <= APART_NS);
            if !is_near || !(span_ns.0..=span_ns.1).contains(&packet.time_ns) {
                return false;
            }
            before_ns = Some(packet.time_ns);
            let bytes = tape.bytes(packet.from, packet.len);
            sound += usize::from(network::is_packet(packet.link, bytes));
        }
        sound > 0 && 2 * sound >= packets
    }
}
