//! Stamps in another unit than seconds.

use crate::analysis::time::streams::Stream;

/// How near the ratio of stamp and log time must be to a power of ten.
const RATIO_TOLERANCE: f64 = 0.01;

/// How near the stamps' own rate must be to that power: an uptime clock that happens to show such a number runs at 1.
const RATE_TOLERANCE: f64 = 0.5;

/// The power of ten by which the unit of the stamps differs from that of the log, with its probable cause; for calendar stamps only.
pub(crate) fn unit_error(stream: &Stream<'_>, log_s: f64) -> Option<(f64, &'static str)> {
    let (factor, words) = by_ratio(stream.median_stamp_s()?, log_s)?;
    // Divided stamps may not move by a nanosecond in a whole recording: only a rate that contradicts the factor counts.
    let denied = stream
        .rate()
        .is_some_and(|rate| (rate - factor).abs() > RATE_TOLERANCE * factor && (rate - 1.0).abs() < RATE_TOLERANCE);
    (!denied).then_some((factor, words))
}

fn by_ratio(stamp_s: f64, log_s: f64) -> Option<(f64, &'static str)> {
    if log_s <= 1e9 || stamp_s <= 0.0 {
        return None;
    }
    let ratio = stamp_s / log_s;
    [
        (1e-9, "nanoseconds were divided by 1e9 once too often"),
        (1e-6, "microseconds were divided by 1e6 once too often"),
        (1e-3, "milliseconds were divided by 1e3 once too often"),
        (1e3, "milliseconds were used as seconds"),
        (1e6, "microseconds were used as seconds"),
        (1e9, "nanoseconds were used as seconds"),
    ]
    .into_iter()
    .find(|(factor, _)| (ratio / factor - 1.0).abs() < RATIO_TOLERANCE)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn units_are_told_by_powers_of_ten() {
        let words = |stamp_s| by_ratio(stamp_s, 1.7e9).map(|(_, words)| words);
        assert!(words(1.7e12).unwrap().contains("milliseconds were used as seconds"));
        assert!(words(1.7).unwrap().contains("nanoseconds were divided"));
        assert_eq!(words(1.7e9), None);
        assert_eq!(words(5302.0), None);
    }
}
