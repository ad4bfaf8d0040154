//! Recordings in simulated time: a part of TIME04.

use crate::analysis::time::simulated::{counting, is_data};
use crate::source::Confidence;
use crate::verdict::Judge;
use crate::verdict::{Finding, Measured, Severity};

use crate::analysis::time::streams::{Clock, Stream, UPTIME_BELOW_S};

/// Rewrites the finding for streams that count from one start, where none shows calendar time: no sensor has a clock of its own, and the
/// stamps agree with each other.
pub(crate) fn explain_simulation(finding: &mut Finding, streams: usize) {
    let stamp_s = finding.measured.first().map_or(0.0, |median| median.value);
    finding.severity = Severity::Note;
    finding.confidence = finding.confidence.min(Confidence::Likely);
    finding.message =
        format!("{streams} streams have stamps of about {stamp_s:.0} s, but the recorder's clock shows calendar time");
    finding.detail = format!(
        "The first of them is {}. Probably a simulation recorded in wall time, or a host whose clock was not set. Look-ups find no transforms \
         when the recording is played back with `--clock`.",
        finding.subject
    );
    "record a simulation with `--use-sim-time`; on a robot, set the host's clock before the drivers start"
        .clone_into(&mut finding.help);
}

/// In simulated time stamps count from the start of the simulation; calendar stamps are from another clock.
pub(crate) fn judge_simulated(stream: &Stream<'_>, others: &[Stream<'_>], measured: Measured, out: &mut Judge) {
    let simulated = counting(others);
    let data = others.iter().filter(|other| is_data(other)).count();
    if stream.clock() != Some(Clock::Calendar) || simulated * 2 <= data {
        return out.pass(stream.subject.clone(), [measured]);
    }
    if !is_data(stream) {
        let why = "messages of this type may have wall-clock stamps in a simulation";
        return out.not_applicable(stream.subject.clone(), why);
    }
    let message = format!(
        "{}: stamps are calendar time, but the recording runs in simulated time",
        stream.subject
    );
    out.fail(
        Finding::error(stream.subject.clone(), message, stream.place())
            .likely()
            .label("first stamp")
            .help("set `use_sim_time` to true for the node that publishes it")
            .measured(Measured::new("median stamp", stream.median_stamp_s().unwrap_or(0.0), "s").limit(UPTIME_BELOW_S))
            .measured(Measured::count("streams in simulated time", simulated)),
    );
}
