//! The known cause of a stream's offset, as TIME01 finds it; used by the rules that leave such offsets to TIME01.
//!
//! Must not report.

use serde::Deserialize;

use crate::analysis::time::known_offsets::{Explanation, Tolerance, explain};
use crate::analysis::time::streams::{Clock, Stream, StreamSource, log_clock, log_start_s};
use crate::analysis::{time::simulated::Time, time::units::unit_error};
use crate::math::stats::median;
use crate::world::BagEvidence;

/// What the offsets of a recording's streams are compared with.
pub(crate) struct Naming<'l> {
    limits: &'l Limits,
    /// Log time at the start, Unix seconds.
    pub(crate) log_s: f64,
    log_clock: Clock,
    /// The offset that the streams have in common, seconds; `None` where there is one stream only.
    common_s: Option<f64>,
    /// Whether the recording runs in simulated time: its clock moves in ticks, and stamps may be between two ticks.
    pub(crate) is_simulated: bool,
}

impl<'l> Naming<'l> {
    pub(crate) fn new(bag: &BagEvidence, streams: &[Stream<'_>], limits: &'l Limits) -> Self {
        let offsets: Vec<f64> = streams
            .iter()
            .filter(|stream| stream.stamps.count >= limits.min_messages)
            .filter_map(|stream| stream.offset_s().map(|(offset, _)| offset))
            .collect();
        // A stream that agrees with the recorder's clock shows that the recorder's clock is also that of sensors.
        let trusted = offsets.iter().any(|offset| offset.abs() <= limits.quiet_s);
        let common = if trusted { Some(0.0) } else { median(&offsets) };
        Self {
            limits,
            log_s: log_start_s(bag),
            log_clock: log_clock(bag),
            common_s: common.filter(|_| offsets.len() >= 2),
            is_simulated: Time::of(bag, streams) != Time::Wall,
        }
    }

    /// Whether both clocks show calendar time: only then can the offset have a known cause.
    pub(crate) fn is_calendar(&self, stream: &Stream<'_>) -> bool {
        stream.clock() == Some(Clock::Calendar) && self.log_clock == Clock::Calendar
    }

    /// Whether stamps and log show clocks of one kind.
    pub(crate) fn is_comparable(&self, stream: &Stream<'_>) -> bool {
        stream.clock() == Some(self.log_clock)
    }

    /// What explains the stream's offset, and what it was compared with.
    pub(crate) fn explain(&self, stream: &Stream<'_>) -> (Explanation, &'static str) {
        let Some((offset, spread)) = stream.offset_s() else {
            return (Explanation::Unknown, "");
        };
        let limits = self.limits;
        if offset.abs() <= limits.quiet_s || !self.is_calendar(stream) {
            return (Explanation::Unknown, "");
        }
        let widened = |base: f64| (base + limits.spread_factor * spread).min(limits.max_tolerance_s);
        let tolerance = Tolerance {
            usual_s: widened(limits.base_tolerance_s),
            fine_s: limits.fine_tolerance_s,
        };
        // A slow stream may be a second late without a fault.
        let slow = stream
            .stamps
            .median_step_ns
            .is_none_or(|step| step as f64 / 1e9 > limits.slow_s);
        let believed = |found: Explanation| match found {
            Explanation::One(named) if named.is_latency() && (slow || stream.is_gnss()) => Explanation::Unknown,
            // Localisation stamps a second ahead by intent.
            Explanation::One(named) if named.is_fine() && matches!(stream.of, StreamSource::Edge(_)) => {
                Explanation::Unknown
            }
            found => found,
        };
        let against_log = believed(explain(offset, tolerance, self.log_s));
        match (against_log, self.common_s) {
            (Explanation::Unknown, Some(common)) => {
                let against_others = believed(explain(offset - common, tolerance, self.log_s));
                (against_others, "the other topics")
            }
            (found, _) => (found, "the recorder's clock"),
        }
    }

    /// Whether TIME01 has an explanation for the stream.
    pub(crate) fn has_word(&self, stream: &Stream<'_>) -> bool {
        unit_error(stream, self.log_s).is_some() || matches!(self.explain(stream).0, Explanation::One(_))
    }
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Limits {
    pub(crate) quiet_s: f64,
    pub(crate) min_messages: u64,
    pub(crate) base_tolerance_s: f64,
    pub(crate) max_tolerance_s: f64,
    pub(crate) fine_tolerance_s: f64,
    pub(crate) spread_factor: f64,
    pub(crate) slow_s: f64,
}
