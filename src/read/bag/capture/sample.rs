//! Some of a capture, where not all of it is read.
//!
//! Owns the choice of places. Must not know layouts.

use crate::read::bag::Sampling;

use super::{Pass, Stop};

/// Bytes at the end of a file in which its last record is looked for.
const TAIL: u64 = 2 << 20;
/// Records at the start of a file in which the first packet is looked for.
const FIRST: usize = 1000;
/// The shortest stretch: two turns of the slowest lidars, of which one is whole, nanoseconds; and its bound, bytes.
const LEAST_NS: i64 = 500_000_000;
const LEAST_BYTES: u64 = 16 << 20;
/// How far a record is looked for from a place.
const SEARCHED: u64 = 4 << 20;

impl Pass<'_, '_> {
    /// Times of the first packet and of the last one, nanoseconds. Takes in what the blocks before the first packet describe.
    pub(super) fn span(&mut self) -> Option<(i64, i64)> {
        let (start, total) = (self.layout.start(), self.tape.total);
        let (mut at, mut first_ns) = (start, None);
        for _ in 0..FIRST {
            let record = (at < total)
                .then(|| self.layout.record(&mut self.tape, at).ok())
                .flatten()?;
            at = record.next;
            if let Some(packet) = record.packet {
                first_ns = Some(packet.time_ns);
                break;
            }
        }
        let first_ns = first_ns?;
        let mut last_ns = first_ns;
        let tail = total.saturating_sub(TAIL);
        if tail > at {
            // The year of the first packet and the next ten.
            let plausible_ns = (
                first_ns.saturating_sub(super::SLACK_NS),
                first_ns.saturating_add(87_600 * super::SLACK_NS),
            );
            at = self.layout.find(&mut self.tape, tail, total, plausible_ns)?;
        }
        while at < total {
            let Ok(record) = self.layout.record(&mut self.tape, at) else {
                break;
            };
            if !self.layout.goes_on(&mut self.tape, record.next) {
                break;
            }
            at = record.next;
            last_ns = record.packet.map_or(last_ns, |packet| packet.time_ns);
        }
        Some((first_ns, last_ns))
    }

    /// Reads stretches spread evenly over the file; gives whether that was all of it.
    pub(super) fn sample(&mut self, sampling: &Sampling, span_ns: Option<(i64, i64)>) -> bool {
        let (start, total) = (self.layout.start(), self.tape.total);
        let windows = sampling.windows.max(1);
        let length_ns = nanoseconds(sampling.seconds).max(LEAST_NS);
        let span_s = span_ns.map_or(0.0, |(first, last)| last.saturating_sub(first) as f64 * 1e-9);
        // What a stretch of that length has in the mean.
        let mean = total as f64 * (length_ns as f64 * 1e-9 / span_s.max(1e-9)).min(1.0);
        let (mut at, mut seams) = (start, 0);
        for window in 0..windows {
            let bytes = sampling.bounds(window).1.max(LEAST_BYTES);
            let room = total.saturating_sub(whole(mean).min(bytes)).saturating_sub(start);
            let place = start + room / u64::from(windows.max(2) - 1) * u64::from(window);
            if place > at {
                let until = place.saturating_add(SEARCHED).min(total);
                let Some(found) = self.layout.find(&mut self.tape, place, until, self.plausible_ns) else {
                    continue;
                };
                self.seam();
                seams += 1;
                at = found;
            }
            let stop = Stop {
                at: at.saturating_add(bytes),
                after_ns: length_ns,
            };
            at = self.stretch(at, stop);
            (self.progress)(at, total);
        }
        seams == 0 && at >= total
    }
}

#[allow(clippy::cast_possible_truncation)] // cut to the range
fn nanoseconds(seconds: f64) -> i64 {
    (seconds * 1e9) as i64
}

#[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss)] // a share of a size
fn whole(bytes: f64) -> u64 {
    bytes as u64
}
