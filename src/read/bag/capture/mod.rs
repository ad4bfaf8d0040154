//! Captures of a network, pcap and pcapng: what lidars sent becomes the messages that a driver of sockets would have recorded.
//!
//! Owns one pass over a capture and the report on it. Must not know what is inside the packets of lidars.
//!
//! A capture has no index. Some of it is read at places that are spread over its length, where records are found by what follows them.

mod blocks;
mod classic;
mod layout;
mod network;
mod record;
mod report;
mod sample;
mod senders;
mod tape;

use std::fs::File;

use crate::source::{Place, ReadStatus};

use super::losses::{Loss, Losses};
use super::{Extent, Progress, Task};

use layout::Layout;
use network::{Found, Network};
use record::{CapturedPacket, Fault, Record};
use senders::Senders;
use tape::Tape;

/// The block of a section's header, in any byte order.
pub(super) const PCAPNG: [u8; 4] = [0x0a, 0x0d, 0x0d, 0x0a];
/// Of pcap: microseconds and nanoseconds, little and big endian.
pub(super) const PCAP: [[u8; 4]; 4] = [
    [0xd4, 0xc3, 0xb2, 0xa1],
    [0x4d, 0x3c, 0xb2, 0xa1],
    [0xa1, 0xb2, 0xc3, 0xd4],
    [0xa1, 0xb2, 0x3c, 0x4d],
];

/// How far times may be from those at the start and the end of a file, nanoseconds: clocks are set while something is captured.
const SLACK_NS: i64 = 3_600_000_000_000;
/// Records between two calls of the progress function.
const REPORTED: u64 = 1 << 14;

/// One pass over a capture.
struct Pass<'a, 'v> {
    tape: Tape,
    layout: Layout,
    network: Network,
    senders: Senders<'v>,
    losses: Losses,
    counts: Counts,
    /// The times that records may have after damage, nanoseconds.
    plausible_ns: (i64, i64),
    progress: Progress<'a>,
}

/// What was met besides datagrams.
#[derive(Default)]
struct Counts {
    records: u64,
    packets: u64,
    /// Packets of other protocols.
    others: u64,
    /// Packets that were cut when they were captured, or are damaged.
    broken: u64,
    /// A type of link that is not read.
    strange_link: Option<u32>,
}

/// Where a stretch ends.
#[derive(Clone, Copy)]
struct Stop {
    at: u64,
    /// At the first packet that comes so long after the first one, nanoseconds.
    after_ns: i64,
}

impl Stop {
    const NEVER: Self = Self {
        at: u64::MAX,
        after_ns: i64::MAX,
    };
}

/// Reads a capture; see [`super::read`].
pub(super) fn read(file: File, total: u64, task: Task<'_>) -> Extent {
    let Task {
        wanted,
        source,
        progress,
        visit,
    } = task;
    let mut tape = Tape::new(file, total);
    let layout = match Layout::of(&mut tape) {
        Ok(layout) => layout,
        Err(why) => {
            source.problem(ReadStatus::Unreadable, Place::whole(source.id), why);
            return super::NOTHING;
        }
    };
    let mut pass = Pass {
        tape,
        layout,
        network: Network::default(),
        senders: Senders::new(visit),
        losses: Losses::default(),
        counts: Counts::default(),
        plausible_ns: (0, i64::MAX),
        progress,
    };
    let span_ns = pass.span();
    if let Some((first_ns, last_ns)) = span_ns {
        let (earliest, latest) = (first_ns.min(last_ns), first_ns.max(last_ns));
        pass.plausible_ns = (earliest.saturating_sub(SLACK_NS), latest.saturating_add(SLACK_NS));
    }
    let whole = match &wanted.sampling {
        Some(sampling) if sampling.bytes < total => pass.sample(sampling, span_ns),
        _ => {
            let start = pass.layout.start();
            pass.stretch(start, Stop::NEVER);
            true
        }
    };
    (pass.progress)(total, total);
    pass.report(whole, span_ns, source)
}

impl Pass<'_, '_> {
    /// Reads records from a position on; gives where it ended.
    fn stretch(&mut self, from: u64, stop: Stop) -> u64 {
        let (mut at, mut first_ns) = (from, None);
        while at < self.tape.total && at < stop.at && self.tape.fault.is_none() {
            let record = match self.sound(at) {
                Ok(record) => record,
                Err(fault) => {
                    at = self.resume(at, fault);
                    continue;
                }
            };
            if let Some(packet) = record.packet {
                let first_ns = *first_ns.get_or_insert(packet.time_ns);
                if packet.time_ns.saturating_sub(first_ns) > stop.after_ns {
                    break;
                }
                self.packet(packet);
            }
            at = record.next;
            self.counts.records += 1;
            if self.counts.records.is_multiple_of(REPORTED) {
                (self.progress)(at, self.tape.total);
            }
        }
        at
    }

    /// The record at a position. It is used only if another one follows it: bytes that were lost or inserted are in the record before the
    /// fault. After damage its time must be that of the capture, too.
    fn sound(&mut self, at: u64) -> Result<Record, Fault> {
        let record = self.layout.record(&mut self.tape, at)?;
        if !self.layout.goes_on(&mut self.tape, record.next) {
            return Err(Fault::Wrong(format!(
                "no {} begins where this one ends",
                self.layout.word()
            )));
        }
        let is_of_time =
            |packet: &CapturedPacket| (self.plausible_ns.0..=self.plausible_ns.1).contains(&packet.time_ns);
        if !record.packet.as_ref().is_none_or(is_of_time) {
            return Err(Fault::Wrong(format!(
                "the time of this {} is not of the capture",
                self.layout.word()
            )));
        }
        Ok(record)
    }

    /// Looks for records after a fault; gives where reading continues.
    fn resume(&mut self, at: u64, fault: Fault) -> u64 {
        let total = self.tape.total;
        let to = self.layout.find(&mut self.tape, at + 1, total, self.plausible_ns);
        let (Fault::Ended(why) | Fault::Wrong(why)) = fault;
        self.losses.add(Loss { from: at, to, why });
        self.seam();
        to.unwrap_or(total)
    }

    /// Packets were left out.
    fn seam(&mut self) {
        self.network.seam();
        self.senders.visit.seam();
    }

    fn packet(&mut self, packet: CapturedPacket) {
        self.counts.packets += 1;
        if !network::is_known(packet.link) {
            self.counts.strange_link.get_or_insert(packet.link);
            return;
        }
        let bytes = self.tape.bytes(packet.from, packet.len);
        match self.network.datagram(packet.link, bytes, packet.time_ns) {
            Found::Datagram(datagram) => self.senders.datagram(&datagram, packet.time_ns),
            Found::Fragment => {}
            Found::Other => self.counts.others += 1,
            Found::Broken => self.counts.broken += 1,
        }
    }
}
