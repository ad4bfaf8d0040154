//! Of which streams' stamps TIME01 or TIME02 speak already.
//!
//! Must not report.

use crate::rules::motion;
use crate::world::BagEvidence;

use super::epoch_offset::EpochOffset;
use super::lateness;
use super::naming::Naming;
use super::stamp_vs_log::StampVsLog;
use super::streams::{Of, Stream, streams};
use super::turning::Signal;
use crate::rules::limits_of;

/// The streams of whose stamps another rule speaks.
pub(super) struct Told(Vec<String>);

impl Told {
    pub(super) fn of(bag: &BagEvidence) -> Self {
        let (Some(names), Some(late)) = (limits_of::<EpochOffset>(), limits_of::<StampVsLog>()) else {
            return Self(Vec::new());
        };
        let streams = streams(bag);
        let naming = Naming::new(bag, &streams, &names);
        let told = streams.iter().filter(|stream| {
            stream.stamps.count.saturating_sub(stream.stamps.zero) >= late.min_messages
                && (naming.has_word(stream) || !lateness::faults(stream, &naming, &late).is_empty())
        });
        let subject = |stream: &Stream<'_>| match stream.of {
            Of::Edge(edge) => motion::edge_subject(edge),
            Of::Topic(_) => stream.subject.clone(),
        };
        Self(told.map(subject).collect())
    }

    pub(super) fn stamps(&self, signal: &Signal) -> bool {
        self.0.contains(&signal.stream)
    }
}
