//! Whether a recording runs in simulated time.

use crate::analysis::time::streams::{Clock, Stream, StreamSource, log_clock};
use crate::world::BagEvidence;

/// The kind of time that a recording's data are stamped in.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Time {
    /// Calendar time.
    Wall,
    /// Simulated time of the whole recording: it has a `/clock`, or its log time is before 1973.
    Simulated,
    /// Data whose stamps count from a start, in a log in calendar time. Transforms are among them, which no sensor's own clock
    /// stamps.
    SimulatedBesideWall,
}

impl Time {
    pub(crate) fn of(bag: &BagEvidence, streams: &[Stream<'_>]) -> Self {
        let has_clock = bag.topics.keys().any(|topic| topic.rsplit('/').next() == Some("clock"));
        if has_clock || (bag.start_ns.is_some() && log_clock(bag) == Clock::Uptime) {
            Self::Simulated
        } else if counts_together(streams) {
            Self::SimulatedBesideWall
        } else {
            Self::Wall
        }
    }
}

/// Whether the moving transforms and most data count from a start, and no transform shows calendar time.
pub(crate) fn counts_together(streams: &[Stream<'_>]) -> bool {
    let edges = streams
        .iter()
        .filter(|stream| matches!(stream.of, StreamSource::Edge(_)));
    let mut clocks = edges.filter_map(Stream::clock).peekable();
    let has_tf = clocks.peek().is_some() && clocks.all(|clock| clock == Clock::Uptime);
    has_tf && counting(streams) * 2 > streams.iter().filter(|stream| is_data(stream)).count()
}

/// Whether the stream is of data whose stamps must be of the common clock.
pub(crate) fn is_data(stream: &Stream<'_>) -> bool {
    matches!(stream.of, StreamSource::Edge(_)) || stream.is_live()
}

/// How many streams of data count from a start.
pub(crate) fn counting(streams: &[Stream<'_>]) -> usize {
    let data = streams.iter().filter(|stream| is_data(stream));
    data.filter(|stream| stream.clock() == Some(Clock::Uptime)).count()
}
