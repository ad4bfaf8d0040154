//! How late messages are logged.

use serde::Deserialize;

use crate::analysis::{time::naming::Naming, time::streams::Stream};

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Limits {
    pub(crate) min_messages: u64,
    pub(crate) late_s: f64,
    pub(crate) gnss_late_s: f64,
    pub(crate) sweep_late_s: f64,
    pub(crate) ahead_s: f64,
    pub(crate) far_s: f64,
    pub(crate) rate_span_s: f64,
    pub(crate) rate: f64,
    pub(crate) drift_span_s: f64,
    pub(crate) drift_ppm: f64,
    pub(crate) drift_error_ppm: f64,
    pub(crate) drift_gain_s: f64,
    pub(crate) step_s: f64,
    pub(crate) margin: f64,
    pub(crate) together_s: f64,
    pub(crate) together_share: f64,
    pub(crate) all_streams: usize,
}

/// How late, and how far ahead, the stamps of a stream may be, seconds.
pub(crate) fn allowed_s(stream: &Stream<'_>, naming: &Naming<'_>, limits: &Limits) -> (f64, f64) {
    let late_s = if stream.is_gnss() {
        limits.gnss_late_s
    } else if stream.is_of_sweeps() {
        let period_s = stream.stamps.median_step_ns.map_or(0.0, |step_ns| step_ns as f64 / 1e9);
        limits.late_s.max(period_s.min(limits.late_s) + limits.sweep_late_s)
    } else {
        limits.late_s
    };
    let ahead_s = if naming.is_simulated {
        limits.late_s
    } else {
        limits.ahead_s
    };
    (late_s, ahead_s)
}
