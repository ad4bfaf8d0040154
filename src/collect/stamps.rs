//! Header stamps of a topic or an edge, compared with the recorder's clock.

use std::cmp::Ordering;

use crate::world::bag::StampEvidence;

use super::point::Point;
use super::thin::{Reservoir, SampleBudget, ThinnedSeries};

/// A gap counts as long above three median steps and above this, nanoseconds.
const LONG_GAP_NS: i64 = 1_000_000_000;

/// Takes in stamps in recording order.
///
/// Steps are taken between neighbouring stamps that are not zero: a zero stamp is a fault of its own, and the steps to
/// and from it would hide what the others do.
#[derive(Clone, Debug)]
pub(super) struct Stamps {
    count: u64,
    samples: ThinnedSeries<(i64, i64)>,
    zero: u64,
    first_zero: Option<Point>,
    previous: Option<i64>,
    backward: u64,
    largest_backward: Option<(i64, Point)>,
    repeated: u64,
    first_repeated: Option<Point>,
    largest_gap: Option<(i64, Point)>,
    steps: Reservoir<i64>,
    above_a_second: u64,
    first: Option<Point>,
    last: Option<Point>,
}

impl Stamps {
    pub(super) fn new(share: SampleBudget) -> Self {
        Self {
            count: 0,
            samples: ThinnedSeries::new(share.stamps),
            zero: 0,
            first_zero: None,
            previous: None,
            backward: 0,
            largest_backward: None,
            repeated: 0,
            first_repeated: None,
            largest_gap: None,
            steps: Reservoir::new(share.steps),
            above_a_second: 0,
            first: None,
            last: None,
        }
    }

    /// Takes in one stamp; points without one are skipped.
    pub(super) fn push(&mut self, point: Point) {
        let Some(stamp) = point.stamp_ns else { return };
        self.count += 1;
        self.samples.push((stamp, point.log_ns));
        self.first.get_or_insert(point);
        self.last = Some(point);
        if stamp == 0 {
            self.zero += 1;
            self.first_zero.get_or_insert(point);
            return;
        }
        if let Some(previous) = self.previous.replace(stamp) {
            self.step(stamp.saturating_sub(previous), point);
        }
    }

    /// Messages were left out here: the next stamp is no neighbour of the last one.
    pub(super) fn seam(&mut self) {
        self.previous = None;
    }

    fn step(&mut self, step: i64, point: Point) {
        match step.cmp(&0) {
            Ordering::Less => {
                self.backward += 1;
                enlarge(&mut self.largest_backward, step.saturating_neg(), point);
            }
            Ordering::Equal => {
                self.repeated += 1;
                self.first_repeated.get_or_insert(point);
            }
            Ordering::Greater => {
                enlarge(&mut self.largest_gap, step, point);
                self.steps.push(step);
                self.above_a_second += u64::from(step > LONG_GAP_NS);
            }
        }
    }

    pub(super) fn finish(self, topic: &str) -> StampEvidence {
        let median = self.steps.median();
        let limit = median.map_or(i64::MAX, |median| median.saturating_mul(3));
        let long_gaps = if limit <= LONG_GAP_NS {
            self.above_a_second
        } else {
            self.steps.count_above(limit)
        };
        let on = |point: Option<Point>| point.map(|point| point.on(topic));
        let with = |largest: Option<(i64, Point)>| largest.map(|(step, point)| (step, point.on(topic)));
        StampEvidence {
            count: self.count,
            samples: self.samples.finish(),
            zero: self.zero,
            first_zero: on(self.first_zero),
            backward: self.backward,
            largest_backward: with(self.largest_backward),
            repeated: self.repeated,
            first_repeated: on(self.first_repeated),
            largest_gap: with(self.largest_gap),
            median_step_ns: median,
            long_gaps,
            first: on(self.first),
            last: on(self.last),
        }
    }
}

fn enlarge(largest: &mut Option<(i64, Point)>, step: i64, point: Point) {
    if largest.is_none_or(|(known, _)| step > known) {
        *largest = Some((step, point));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Evidence of stamps in milliseconds, logged every 100 ms.
    fn evidence(stamps_ms: &[i64]) -> StampEvidence {
        let mut stamps = Stamps::new(SampleBudget::of(0));
        for (index, stamp) in (0..).zip(stamps_ms) {
            stamps.push(Point {
                index,
                stamp_ns: Some(stamp * 1_000_000),
                log_ns: i64::try_from(index).unwrap() * 100_000_000,
                transform: None,
            });
        }
        stamps.finish("/t")
    }

    #[test]
    fn every_kind_of_step_is_counted_once() {
        let e = evidence(&[100, 200, 200, 300, 250, 350, 450, 2450, 2550]);
        assert_eq!((e.count, e.zero, e.repeated, e.backward), (9, 0, 1, 1));
        assert_eq!(e.first_repeated.unwrap().index, 2);
        assert_eq!(
            e.largest_backward.map(|(step, at)| (step, at.index)),
            Some((50_000_000, 4))
        );
        assert_eq!(
            e.largest_gap.map(|(step, at)| (step, at.index)),
            Some((2_000_000_000, 7))
        );
        assert_eq!(e.median_step_ns, Some(100_000_000));
        assert_eq!(e.long_gaps, 1);
        assert_eq!((e.first.unwrap().index, e.last.unwrap().index), (0, 8));
        assert_eq!(e.samples[1], (200_000_000, 100_000_000));
    }

    #[test]
    fn zero_stamps_are_counted_apart_and_take_no_part_in_steps() {
        let e = evidence(&[100, 0, 200, 0, 0]);
        assert_eq!((e.count, e.zero, e.repeated, e.backward), (5, 3, 0, 0));
        assert_eq!(e.first_zero.unwrap().index, 1);
        assert_eq!(e.largest_gap.map(|(step, _)| step), Some(100_000_000));
    }

    #[test]
    fn a_slow_topic_has_no_long_gaps_for_being_slow() {
        assert_eq!(evidence(&[1000, 3000, 5000, 7000]).long_gaps, 0);
        assert_eq!(evidence(&[1000, 3000, 5000, 7000, 14_000]).long_gaps, 1);
    }
}
