//! The clock of a stream, chosen so that streams of different clocks can be compared.

use crate::math::stats::median;
use crate::world::motion::{Row, Series};

/// The stamps of a stream are used if their rate matches the recorder's clock to within this share.
const MAX_RATE_ERROR: f64 = 0.02;
/// Length over which the rate is taken, seconds; shorter streams are judged by the spread of `stamp - log` alone.
const MIN_RATE_SPAN_S: f64 = 10.0;
/// The spread of `stamp - log` up to which the stamps of a short stream are used, seconds.
const MAX_SPREAD_S: f64 = 0.5;

/// Source of the time of a row.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Clock {
    /// Header stamp, shifted by the median of log time minus stamp, `-offset_s`: even, and comparable with other streams.
    Stamp {
        /// Median of stamp minus log time, seconds.
        offset_s: f64,
    },
    /// Log time: the stamps are zero, do not increase, or have another rate.
    Log,
}

impl Clock {
    /// The clock of a stream.
    pub(crate) fn of<R: Row>(series: &Series<R>) -> Self {
        let runs = series.stretches.iter();
        Self::of_times(runs.map(|rows| rows.iter().map(|row| (row.stamp_ns(), row.log_ns()))))
    }

    /// The clock of messages with these stamps and log times, nanoseconds, by runs without a gap.
    pub(crate) fn of_times(runs: impl Iterator<Item: Iterator<Item = (i64, i64)>>) -> Self {
        let runs: Vec<Vec<(i64, i64)>> = runs.map(Iterator::collect).collect();
        let all = || runs.iter().flatten();
        let offsets: Vec<f64> = all().map(|(stamp, log)| seconds(*stamp, *log)).collect();
        let (Some(first), Some(last), Some(offset_s)) = (all().next(), all().next_back(), median(&offsets)) else {
            return Self::Log;
        };
        let has_zero = all().any(|(stamp, _)| *stamp == 0);
        let stands = runs.iter().any(|times| {
            times
                .windows(2)
                .any(|pair| matches!(pair, [(earlier, _), (later, _)] if later <= earlier))
        });
        let (by_stamp, by_log) = (seconds(last.0, first.0), seconds(last.1, first.1));
        let runs = if by_log >= MIN_RATE_SPAN_S {
            (by_stamp / by_log - 1.0).abs() <= MAX_RATE_ERROR
        } else {
            offsets.iter().all(|offset| (offset - offset_s).abs() <= MAX_SPREAD_S)
        };
        if has_zero || stands || !runs {
            Self::Log
        } else {
            Self::Stamp { offset_s }
        }
    }

    /// Median of stamp minus log time, seconds; `None` of the recorder's clock.
    pub(crate) fn stamp_offset_s(self) -> Option<f64> {
        match self {
            Self::Stamp { offset_s } => Some(offset_s),
            Self::Log => None,
        }
    }

    /// The time of a row, seconds after `start_ns` of the recorder's clock.
    pub(crate) fn time_s<R: Row>(self, row: &R, start_ns: i64) -> f64 {
        match self {
            Self::Stamp { offset_s } => seconds(row.stamp_ns(), start_ns) - offset_s,
            Self::Log => seconds(row.log_ns(), start_ns),
        }
    }
}

/// `ns - since_ns`, seconds.
fn seconds(ns: i64, since_ns: i64) -> f64 {
    ns.saturating_sub(since_ns) as f64 / 1e9
}
