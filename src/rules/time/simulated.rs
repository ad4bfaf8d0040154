//! Recordings in simulated time: a part of TIME04.

use crate::rules::Judge;
use crate::source::Confidence;
use crate::verdict::{Finding, Measured, Severity};

use crate::verdict::NotEvaluated;
use crate::world::BagEvidence;

use super::streams::{Clock, Of, Stream, UPTIME_BELOW_S, log_clock};

/// The time that a recording's data live in.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Time {
    /// Calendar time.
    Wall,
    /// Simulated time, and the recording knows it: it has a `/clock`, or its log began far before 1973.
    Simulated,
    /// Data that count from a start, transforms among them, which no sensor's own clock stamps, beside a log in calendar
    /// time.
    SimulatedBesideWall,
}

impl Time {
    pub(super) fn of(bag: &BagEvidence, streams: &[Stream<'_>]) -> Self {
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
fn counts_together(streams: &[Stream<'_>]) -> bool {
    let edges = streams.iter().filter(|stream| matches!(stream.of, Of::Edge(_)));
    let mut clocks = edges.filter_map(Stream::clock).peekable();
    let has_tf = clocks.peek().is_some() && clocks.all(|clock| clock == Clock::Uptime);
    has_tf && counting(streams) * 2 > streams.iter().filter(|stream| is_data(stream)).count()
}

/// Whether the stream is of data whose stamps must be of the common clock.
fn is_data(stream: &Stream<'_>) -> bool {
    matches!(stream.of, Of::Edge(_)) || stream.is_live()
}

/// How many streams of data count from a start.
fn counting(streams: &[Stream<'_>]) -> usize {
    let data = streams.iter().filter(|stream| is_data(stream));
    data.filter(|stream| stream.clock() == Some(Clock::Uptime)).count()
}

/// Streams count from one start, and no other shows calendar time: no sensor's clock is odd, and stamps agree with each
/// other.
pub(super) fn tell_simulation(finding: &mut Finding, streams: usize) {
    let stamp_s = finding.measured.first().map_or(0.0, |median| median.value);
    finding.severity = Severity::Note;
    finding.confidence = finding.confidence.min(Confidence::Likely);
    finding.message = format!(
        "{streams} streams are stamped near {stamp_s:.1} s, beside a log in calendar time: a simulation recorded in wall \
         time, or a host whose clock was not set; played back with a clock, look-ups find no transforms"
    );
    "record a simulation with `--use-sim-time`; on a robot, set the host's clock before the drivers start"
        .clone_into(&mut finding.help);
}

/// In simulated time stamps count from the start of the simulation; calendar stamps beside it are of another clock.
pub(super) fn judge_simulated(stream: &Stream<'_>, others: &[Stream<'_>], measured: Measured, out: &mut Judge) {
    let simulated = counting(others);
    let data = others.iter().filter(|other| is_data(other)).count();
    if stream.clock() != Some(Clock::Calendar) || simulated * 2 <= data {
        out.pass(stream.subject.clone(), [measured]);
        return;
    }
    if !is_data(stream) {
        let why = "messages of this type may be stamped by a wall clock beside a simulation";
        out.not_evaluated(stream.subject.clone(), NotEvaluated::NotApplicable, why);
        return;
    }
    let message = format!(
        "stamps on {} are calendar time, but the recording runs in simulated time",
        stream.subject
    );
    out.fail(
        Finding::error(stream.subject.clone(), message, stream.place())
            .likely()
            .label("first stamp")
            .help("set `use_sim_time` for the node that publishes it")
            .measured(Measured::new("median stamp", stream.median_stamp_s().unwrap_or(0.0), "s").limit(UPTIME_BELOW_S))
            .measured(Measured::count("streams in simulated time", simulated)),
    );
}
