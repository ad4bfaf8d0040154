//! How `stamp - log` changes in the course of a recording: at a steady rate, or by one step.
//!
//! Must not judge, nor know what the limits are.

use crate::analysis::time::streams::Stream;
use crate::math::stats::{mad, median};

/// Bins of time; the median of each stands for it.
const BINS: usize = 12;
/// Samples on each side of a step.
const WINDOW: usize = 25;

/// A steady change.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Drift {
    /// Seconds that the stamps gain in a second of the recorder's clock; negative where they fall behind.
    pub(crate) rate: f64,
    /// Length of the log, seconds.
    pub(crate) span_s: f64,
    /// Residual of the bins' medians without the drift (1.4826 MAD), seconds.
    pub(crate) residual_s: f64,
}

impl Drift {
    /// What the stamps gained from start to end, seconds.
    pub(crate) fn gained_s(self) -> f64 {
        self.rate * self.span_s
    }
}

/// `(log time since the start, stamp - log)`, seconds, of stamps that are not zero.
fn series(stream: &Stream<'_>) -> Vec<(f64, f64)> {
    let samples = &stream.stamps.samples;
    let start = samples.first().map_or(0, |(_, log)| *log);
    let seconds = |ns: i64| ns as f64 / 1e9;
    samples
        .iter()
        .filter(|(stamp, _)| *stamp != 0)
        .map(|(stamp, log)| (seconds(log.saturating_sub(start)), seconds(stamp.saturating_sub(*log))))
        .collect()
}

/// The steady change of a stream's offset: Theil and Sen's slope of the medians of equal parts. `None` where a part of
/// the recording holds too few stamps.
pub(crate) fn drift(stream: &Stream<'_>) -> Option<Drift> {
    drift_of(&series(stream))
}

fn drift_of(series: &[(f64, f64)]) -> Option<Drift> {
    let length = series.len() / BINS;
    if length < 2 {
        return None;
    }
    let bins: Vec<(f64, f64)> = series
        .chunks(length)
        .take(BINS)
        .filter_map(|part| {
            let (times, offsets): (Vec<f64>, Vec<f64>) = part.iter().copied().unzip();
            Some((median(&times)?, median(&offsets)?))
        })
        .collect();
    let mut slopes = Vec::with_capacity(BINS * BINS / 2);
    for (index, (t0, y0)) in bins.iter().enumerate() {
        slopes.extend(bins.iter().skip(index + 1).map(|(t1, y1)| (y1 - y0) / (t1 - t0)));
    }
    let rate = median(&slopes)?;
    let residuals: Vec<f64> = bins.iter().map(|(t, y)| y - rate * t).collect();
    Some(Drift {
        rate,
        span_s: series.last()?.0 - series.first()?.0,
        residual_s: mad(&residuals)?,
    })
}

/// A step of the offset that stays.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Change {
    /// Seconds of the log since the stream's first message.
    pub(crate) after: f64,
    /// By how much the offset changes, seconds.
    pub(crate) by: f64,
    /// Spread of the offset beside the step (1.4826 MAD, the larger side), seconds.
    pub(crate) spread: f64,
}

/// The largest step of a stream's offset, if the offset is constant before and after it: medians of the neighbours, of all samples on
/// either side, and of the earliest arrivals agree on its size to a fifth.
pub(crate) fn change(stream: &Stream<'_>) -> Option<Change> {
    change_of(&series(stream))
}

fn change_of(series: &[(f64, f64)]) -> Option<Change> {
    let offsets: Vec<f64> = series.iter().map(|(_, offset)| *offset).collect();
    let middle = |part: &[f64]| median(part).unwrap_or(0.0);
    // Means are steepest at the step itself; medians are constant around it and give its size.
    let mean = |part: &[f64]| part.iter().sum::<f64>() / part.len() as f64;
    let mut steepest = (0, 0.0, 0.0_f64);
    for (index, pair) in offsets.windows(2 * WINDOW).enumerate() {
        let (before, after) = pair.split_at(WINDOW);
        let height = (mean(after) - mean(before)).abs();
        if height > steepest.2 {
            steepest = (index + WINDOW, middle(after) - middle(before), height);
        }
    }
    let (at, by, _) = steepest;
    let (before, after) = offsets.split_at_checked(at).filter(|_| by != 0.0)?;
    let earliest = |part: &[f64]| part.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    let sides = [middle(after) - middle(before), earliest(after) - earliest(before)];
    let spread = mad(before)?.max(mad(after)?);
    let stays = sides.iter().all(|side| (side - by).abs() <= 0.2 * by.abs());
    stays.then_some(Change {
        after: series.get(at)?.0,
        by,
        spread,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Ten samples a second, with a latency that goes up and down by 4 ms.
    fn samples(seconds: u32, offset: impl Fn(f64) -> f64) -> Vec<(f64, f64)> {
        (0..seconds * 10)
            .map(|tick| {
                let t = f64::from(tick) / 10.0;
                (t, offset(t) - 0.002 * f64::from(tick * 7 % 3))
            })
            .collect()
    }

    #[test]
    fn a_steady_drift_is_measured_and_a_step_is_none() {
        let found = drift_of(&samples(120, |t| -0.05 - 2e-4 * t)).unwrap();
        assert!((found.rate + 2e-4).abs() < 2e-6, "{found:?}");
        assert!(found.gained_s().abs() > 10.0 * found.residual_s);
        let step = drift_of(&samples(120, |t| if t < 70.0 { 0.0 } else { 0.3 })).unwrap();
        assert!(step.gained_s().abs() < 6.0 * step.residual_s, "{step:?}");
        assert_eq!(drift_of(&samples(2, |_| 0.0)), None);
    }

    #[test]
    fn a_step_is_found_where_it_is_and_a_drift_is_none() {
        let found = change_of(&samples(60, |t| if t < 40.0 { -0.05 } else { 0.25 })).unwrap();
        assert!(
            (found.after - 40.0).abs() < 1e-9 && (found.by - 0.3).abs() < 0.01,
            "{found:?}"
        );
        assert_eq!(change_of(&samples(60, |t| -0.01 * t)), None);
        // A machine that is busy for a while sends late, and returns.
        assert_eq!(
            change_of(&samples(60, |t| if (20.0..40.0).contains(&t) { -0.3 } else { 0.0 })),
            None
        );
    }
}
