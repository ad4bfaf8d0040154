//! Rows of a fast stream: messages become means over short times, and of long recordings whole blocks are kept.
//!
//! Owns the length of rows and stretches and the bound on them. Must not know what the numbers mean.

use crate::world::motion::{ROW_NS, Series};

use super::point::Point;

/// A gap longer than this ends a stretch, nanoseconds: GNSS receivers publish once a second, filters pause for a second or
/// two.
const MAX_GAP_NS: i64 = 5_000_000_000;
/// A stamp that falls back by more than this ends a stretch, nanoseconds.
const RESTART_NS: i64 = 1_000_000_000;

/// How many rows a stream may keep.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct RowBudget {
    /// Rows of a block: rows are left out in whole blocks.
    block: usize,
    /// Blocks.
    blocks: usize,
}

impl RowBudget {
    /// The room of the stream that came `rank`-th, from 0. The first streams keep half an hour at twenty rows a second.
    pub(super) fn of(rank: usize) -> Self {
        let (block, blocks) = match rank {
            0..16 => (4096, 8),
            16..256 => (256, 8),
            _ => (16, 2),
        };
        Self { block, blocks }
    }
}

/// `N` numbers at a time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Sample<const N: usize> {
    pub(super) stamp_ns: i64,
    pub(super) log_ns: i64,
    pub(super) values: [f64; N],
}

impl<const N: usize> Sample<N> {
    /// `L` numbers from the `at`-th on.
    pub(super) fn part<const L: usize>(&self, at: usize) -> [f64; L] {
        let rest = self.values.get(at..).and_then(|rest| rest.first_chunk());
        rest.copied().unwrap_or([f64::NAN; L])
    }
}

/// Takes in `N` numbers a message, in recording order. `Q` is where among them a quaternion begins, which has two signs;
/// `N` where there is none.
#[derive(Clone, Debug)]
pub(super) struct Rows<const N: usize, const Q: usize> {
    room: RowBudget,
    /// Whether a row is no mean: later messages only fill in what earlier ones left NaN.
    fills: bool,
    count: u64,
    /// The messages of the current row.
    open: Option<OpenBlock<N>>,
    stretch: u32,
    /// Every `stride`-th block is kept.
    stride: u64,
    /// Rows made so far.
    made: u64,
    blocks: Vec<Block<N>>,
}

#[derive(Clone, Copy, Debug)]
struct OpenBlock<const N: usize> {
    first: Sample<N>,
    last: Sample<N>,
    sum: [f64; N],
    stamps: i128,
    logs: i128,
    count: u32,
}

#[derive(Clone, Debug)]
struct Block<const N: usize> {
    number: u64,
    rows: Vec<(u32, Sample<N>)>,
}

impl<const N: usize, const Q: usize> Rows<N, Q> {
    pub(super) fn new(room: RowBudget) -> Self {
        Self {
            room,
            fills: false,
            count: 0,
            open: None,
            stretch: 0,
            stride: 1,
            made: 0,
            blocks: Vec::new(),
        }
    }

    /// Rows that are no means: messages that follow each other closely hold different fields, and a row combines
    /// them.
    pub(super) fn filled(room: RowBudget) -> Self {
        Self {
            fills: true,
            ..Self::new(room)
        }
    }

    /// Messages were left out here.
    pub(super) fn seam(&mut self) {
        self.close();
        self.stretch = self.stretch.wrapping_add(1);
    }

    pub(super) fn push(&mut self, point: Point, values: [f64; N]) {
        self.count += 1;
        let mut sample = Sample {
            stamp_ns: point.stamp_ns.unwrap_or(0),
            log_ns: point.log_ns,
            values,
        };
        if let Some(open) = &mut self.open {
            let stamp = sample.stamp_ns.saturating_sub(open.last.stamp_ns);
            let log = sample.log_ns.saturating_sub(open.last.log_ns);
            if !(-RESTART_NS..=MAX_GAP_NS).contains(&stamp) || log > MAX_GAP_NS {
                self.seam();
            } else {
                // By the recorder's clock where the stamps do not advance.
                let [since, by_log] = [
                    sample.stamp_ns.saturating_sub(open.first.stamp_ns),
                    sample.log_ns.saturating_sub(open.first.log_ns),
                ];
                let since = if sample.stamp_ns == 0 { by_log } else { since };
                if (0..ROW_NS).contains(&since) {
                    if self.fills {
                        open.fill(&sample);
                    } else {
                        open.add(&mut sample, Q);
                    }
                    return;
                }
                self.close();
            }
        }
        self.open = Some(OpenBlock::new(sample));
    }

    /// Ends the current row.
    fn close(&mut self) {
        let Some(open) = self.open.take() else { return };
        let number = self.made / self.room.block as u64;
        self.made += 1;
        if !number.is_multiple_of(self.stride) {
            return;
        }
        if self.blocks.last().is_none_or(|block| block.number != number) {
            if self.blocks.len() >= self.room.blocks {
                self.stride *= 2;
                self.blocks.retain(|block| block.number.is_multiple_of(self.stride));
                if !number.is_multiple_of(self.stride) {
                    return;
                }
            }
            self.blocks.push(Block {
                number,
                rows: Vec::new(),
            });
        }
        if let Some(block) = self.blocks.last_mut() {
            block.rows.push((self.stretch, open.mean()));
        }
    }

    /// The rows, each converted to its type; `None` where there were no messages.
    pub(super) fn finish<T>(mut self, row: impl Fn(Sample<N>) -> T) -> Option<Series<T>> {
        self.close();
        let mut stretches: Vec<Vec<T>> = Vec::new();
        let mut before: Option<(u64, u32)> = None;
        for Block { number, rows } in self.blocks {
            for (stretch, sample) in rows {
                let follows = before.is_some_and(|(block, known)| {
                    known == stretch && (block == number || (self.stride == 1 && block + 1 == number))
                });
                match stretches.last_mut().filter(|_| follows) {
                    Some(last) => last.push(row(sample)),
                    None => stretches.push(vec![row(sample)]),
                }
                before = Some((number, stretch));
            }
        }
        (self.count > 0).then_some(Series {
            count: self.count,
            stretches,
        })
    }
}

impl<const N: usize> OpenBlock<N> {
    fn new(sample: Sample<N>) -> Self {
        Self {
            first: sample,
            last: sample,
            sum: sample.values,
            stamps: sample.stamp_ns.into(),
            logs: sample.log_ns.into(),
            count: 1,
        }
    }

    /// Takes from a message what is still missing; the row keeps its time.
    fn fill(&mut self, sample: &Sample<N>) {
        for (slot, value) in self.first.values.iter_mut().zip(&sample.values) {
            if slot.is_nan() {
                *slot = *value;
            }
        }
        self.last = *sample;
    }

    /// Adds a message; the quaternion at `quaternion` takes the sign of the first one.
    fn add(&mut self, sample: &mut Sample<N>, quaternion: usize) {
        let of = |values: &[f64; N]| -> [f64; 4] {
            let slots = values.get(quaternion..).and_then(|rest| rest.first_chunk());
            slots.copied().unwrap_or_default()
        };
        let (first, now) = (of(&self.first.values), of(&sample.values));
        let dot: f64 = first.iter().zip(now).map(|(a, b)| a * b).sum();
        let sign = if dot < 0.0 { -1.0 } else { 1.0 };
        for (at, (sum, value)) in self.sum.iter_mut().zip(&sample.values).enumerate() {
            let is_of_quaternion = (quaternion..quaternion.saturating_add(4)).contains(&at);
            *sum += if is_of_quaternion { sign * value } else { *value };
        }
        self.stamps += i128::from(sample.stamp_ns);
        self.logs += i128::from(sample.log_ns);
        self.count += 1;
        self.last = *sample;
    }

    fn mean(self) -> Sample<N> {
        let count = f64::from(self.count);
        let of = |sum: i128| i64::try_from(sum / i128::from(self.count)).unwrap_or(i64::MAX);
        if self.count == 1 {
            return self.first;
        }
        Sample {
            stamp_ns: of(self.stamps),
            log_ns: of(self.logs),
            values: self.sum.map(|sum| sum / count),
        }
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, clippy::indexing_slicing, clippy::float_cmp)]
    use super::*;

    const MS: i64 = 1_000_000;

    fn at(ms: i64) -> Point {
        Point {
            index: 0,
            stamp_ns: Some((1_000_000 + ms) * MS),
            log_ns: (1_000_000 + ms) * MS,
            transform: None,
        }
    }

    fn stretches<const Q: usize>(rows: Rows<4, Q>) -> Vec<Vec<(i64, [f64; 4])>> {
        let row = |sample: Sample<4>| (sample.stamp_ns / MS - 1_000_000, sample.values);
        rows.finish(row).unwrap().stretches
    }

    #[test]
    fn fast_messages_become_means_and_slow_ones_stay() {
        let mut fast: Rows<4, 4> = Rows::new(RowBudget::of(0));
        for tick in 0..20 {
            fast.push(at(tick * 10), [tick as f64; 4]);
        }
        let rows = &stretches(fast)[0];
        assert_eq!(rows.iter().map(|row| row.0).collect::<Vec<_>>(), [20, 70, 120, 170]);
        assert_eq!(rows[1].1, [7.0; 4]);
        let mut slow: Rows<4, 4> = Rows::new(RowBudget::of(0));
        for tick in 0..3 {
            slow.push(at(tick * 100), [tick as f64; 4]);
        }
        let rows = &stretches(slow)[0];
        assert_eq!(rows.iter().map(|row| row.0).collect::<Vec<_>>(), [0, 100, 200]);
    }

    #[test]
    fn the_two_signs_of_a_quaternion_do_not_cancel() {
        let mut rows: Rows<4, 0> = Rows::new(RowBudget::of(0));
        rows.push(at(0), [0.0, 0.0, 0.6, 0.8]);
        rows.push(at(10), [0.0, 0.0, -0.6, -0.8]);
        assert_eq!(stretches(rows), [[(5, [0.0, 0.0, 0.6, 0.8])]]);
    }

    #[test]
    fn messages_that_say_different_things_fill_one_row() {
        const X: f64 = f64::NAN;
        let mut rows: Rows<4, 4> = Rows::filled(RowBudget::of(0));
        rows.push(at(0), [1.0, X, X, X]);
        rows.push(at(10), [9.0, 2.0, X, X]);
        rows.push(at(20), [X, X, 3.0, X]);
        rows.push(at(100), [4.0, X, X, X]);
        let bits = |values: [f64; 4]| values.map(|value| if value.is_nan() { -1.0 } else { value });
        let rows: Vec<_> = stretches(rows)[0].iter().map(|row| (row.0, bits(row.1))).collect();
        assert_eq!(rows, [(0, [1.0, 2.0, 3.0, -1.0]), (100, [4.0, -1.0, -1.0, -1.0])]);
    }

    #[test]
    fn seams_silences_and_restarts_end_a_stretch() {
        let mut rows: Rows<4, 4> = Rows::new(RowBudget::of(0));
        for ms in [0, 100, 200] {
            rows.push(at(ms), [0.0; 4]);
        }
        rows.seam();
        for ms in [300, 400, 6_000, 6_100, 2_000] {
            rows.push(at(ms), [0.0; 4]);
        }
        let lengths: Vec<usize> = stretches(rows).iter().map(Vec::len).collect();
        assert_eq!(lengths, [3, 2, 2, 1]);
    }

    #[test]
    fn a_long_stream_keeps_whole_blocks_over_its_length() {
        let room = RowBudget { block: 10, blocks: 4 };
        let mut rows: Rows<4, 4> = Rows::new(room);
        for tick in 0..95 {
            rows.push(at(tick * 100), [0.0; 4]);
        }
        let stretches = stretches(rows);
        // Blocks of a second: of the ten, every fourth remains.
        let first: Vec<i64> = stretches.iter().map(|stretch| stretch[0].0).collect();
        assert_eq!(first, [0, 4_000, 8_000]);
        assert!(stretches.iter().all(|stretch| stretch.len() == 10));
    }

    #[test]
    fn messages_without_stamps_are_told_apart_by_their_log_time() {
        let mut rows: Rows<4, 4> = Rows::new(RowBudget::of(0));
        for tick in 0..10 {
            let point = Point {
                stamp_ns: None,
                ..at(tick * 25)
            };
            rows.push(point, [tick as f64; 4]);
        }
        let means: Vec<f64> = stretches(rows)[0].iter().map(|row| row.1[0]).collect();
        assert_eq!(means, [0.5, 2.5, 4.5, 6.5, 8.5]);
    }
}
