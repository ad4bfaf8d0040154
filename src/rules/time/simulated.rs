//! Recordings in simulated time: a part of TIME04.

use crate::rules::Judge;
use crate::source::Confidence;
use crate::verdict::{Finding, Measured, Severity};

use super::streams::{Clock, Of, Stream, UPTIME_BELOW_S};

/// Whether these streams, which count from one start, are a simulation that was recorded in wall time: all streams of
/// the recording do so, and they are either `enough` or transforms, which no sensor's own clock stamps.
pub(super) fn is_simulation(from_one_start: usize, streams: &[Stream<'_>], enough: usize) -> bool {
    let has_tf = streams.iter().any(|stream| matches!(stream.of, Of::Edge(_)));
    from_one_start == streams.len() && (from_one_start >= enough || has_tf)
}

/// Every stream counts from one start: no sensor's clock is odd, and header stamps agree with each other.
pub(super) fn tell_simulation(finding: &mut Finding, streams: usize) {
    let stamp_s = finding.measured.first().map_or(0.0, |median| median.value);
    finding.severity = Severity::Note;
    finding.confidence = finding.confidence.min(Confidence::Likely);
    finding.message = format!(
        "all {streams} streams are stamped near {stamp_s:.1} s, beside a log in calendar time: a simulation recorded in \
         wall time, or a host whose clock was not set; played back with a clock, look-ups find no transforms"
    );
    "record a simulation with `--use-sim-time`; on a robot, set the host's clock before the drivers start"
        .clone_into(&mut finding.help);
}

/// In simulated time stamps count from the start of the simulation; calendar stamps beside it are of another clock.
pub(super) fn judge_simulated(stream: &Stream<'_>, others: &[Stream<'_>], measured: Measured, out: &mut Judge) {
    let simulated = others
        .iter()
        .filter(|other| other.clock() != Some(Clock::Calendar))
        .count();
    if stream.clock() != Some(Clock::Calendar) || simulated * 2 <= others.len() {
        out.pass(stream.subject.clone(), [measured]);
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
