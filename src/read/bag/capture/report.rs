//! The report on a capture after it was read.
//!
//! Owns the messages and the status. Must not read.

use crate::read::bag::Extent;
use crate::source::{Place, ReadStatus, Source};

use super::Pass;

const HELP: &str = "capture again if the missing packets matter: `tcpdump -i INTERFACE -s 0 -w FILE udp`";

impl Pass<'_, '_> {
    /// Reports how far reading went; `whole` says whether all of the file was to be read.
    pub(super) fn report(&self, is_whole: bool, span_ns: Option<(i64, i64)>, source: &mut Source) -> Extent {
        let read = self.senders.messages;
        source.examined.messages = Some(read);
        source.examined.bytes = if is_whole {
            self.losses.read_of(self.tape.total)
        } else {
            self.tape.read.min(self.tape.total)
        };
        let place = Place::whole(source.id);
        let worst = if read == 0 {
            ReadStatus::Unreadable
        } else {
            ReadStatus::Partial
        };
        let mut report = |message: String, help: &str| {
            let help = (!help.is_empty()).then(|| help.to_owned());
            source.problem_with_help(worst, place.clone(), message, help);
        };
        if let Some(fault) = &self.tape.fault {
            report(fault.clone(), "");
        }
        for line in self.losses.lines(self.tape.total) {
            report(line, HELP);
        }
        if let Some(link) = self.counts.strange_link {
            let message = format!("packets of the link type {link} are not read");
            report(message, "capture on an Ethernet interface");
        }
        let broken = self.counts.broken;
        if broken > 0 {
            let of = self.counts.packets;
            report(format!("{broken} of {of} packets are cut or damaged"), HELP);
        }
        if read == 0 {
            let message = match self.counts.packets {
                0 => "the capture has no packets".to_owned(),
                packets => format!(
                    "none of its {packets} packets is of a lidar that is decoded (Velodyne, Hesai, RoboSense, Livox, Ouster)"
                ),
            };
            report(message, "capture the interface that the lidar is connected to");
        }
        let (datagrams, others) = (self.senders.others, self.counts.others);
        if read > 0 && datagrams + others > 0 {
            source.notes.push(format!(
                "{datagrams} datagrams of other senders and {others} packets of other protocols were left out"
            ));
        }
        Extent {
            // Without packets of a lidar their absence proves nothing.
            truncated: read == 0 || self.tape.fault.is_some() || !self.losses.is_empty(),
            whole: is_whole,
            indexed: false,
            messages_total: None,
            span_ns,
        }
    }
}
