//! Bounded samples of long series, and how large they may be.
//!
//! Owns thinning. Must not know what is sampled.

use crate::world::bag::MAX_EXAMPLES;
use crate::world::cloud::{MAX_POINTS, MAX_RUNS, MAX_SAMPLES};

/// How many samples one subject (a topic, an edge) may keep. The first subjects of a recording get full series; a
/// recording with thousands of them, real or hostile, gets short ones, so that memory stays bounded.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct SampleBudget {
    /// Pairs of stamps.
    pub(super) stamps: usize,
    /// Steps between stamps.
    pub(super) steps: usize,
    /// Poses.
    pub(super) poses: usize,
    /// Steps between poses.
    pub(super) moves: usize,
    /// The largest of these steps, of each kind.
    pub(super) largest: usize,
    /// Different covariance matrices at first, and twice as many later ones.
    pub(super) matrices: usize,
    /// Frame names in the headers of a topic.
    pub(super) names: usize,
    /// Examples of each fault.
    pub(super) examples: usize,
    /// Clouds of which points are kept, and points of each.
    pub(super) clouds: [usize; 2],
    /// Runs of neighbouring clouds that are kept as slices.
    pub(super) runs: usize,
}

impl SampleBudget {
    /// The share of the subject that came `rank`-th, from 0.
    pub(super) fn of(rank: usize) -> Self {
        let (stamps, steps, poses, names, examples) = match rank {
            0..200 => (2048, 4096, 512, 256, MAX_EXAMPLES),
            200..2_000 => (128, 256, 32, 32, MAX_EXAMPLES),
            _ => (16, 32, 4, 4, 1),
        };
        let (moves, largest, matrices) = match rank {
            0..200 => (1024, 16, 8),
            200..2_000 => (64, 2, 2),
            _ => (8, 1, 1),
        };
        Self {
            stamps,
            steps,
            poses,
            moves,
            largest,
            matrices,
            names,
            examples,
            clouds: [1, 16],
            runs: 0,
        }
        .with_clouds(rank)
    }

    /// The same with room for the clouds of the topic that came `rank`-th among those of its type: vehicles have eight lidars, and
    /// forty other topics before them.
    pub(super) fn with_clouds(self, rank: usize) -> Self {
        let (clouds, runs) = match rank {
            0..8 => ([MAX_SAMPLES, MAX_POINTS], MAX_RUNS),
            8..32 => ([MAX_SAMPLES, 1024], 10),
            32..256 => ([4, 256], 0),
            _ => ([1, 16], 0),
        };
        Self { clouds, runs, ..self }
    }
}

/// Evenly thinned values in order: every n-th, n doubling when the bound is reached; the first and the last are always
/// among them.
#[derive(Clone, Debug)]
pub(super) struct ThinnedSeries<T> {
    bound: usize,
    stride: u64,
    seen: u64,
    kept: Vec<T>,
    last: Option<T>,
}

impl<T: Copy> ThinnedSeries<T> {
    /// At most `bound` values, two at least.
    pub(super) fn new(bound: usize) -> Self {
        Self {
            bound: bound.max(2),
            stride: 1,
            seen: 0,
            kept: Vec::new(),
            last: None,
        }
    }

    pub(super) fn push(&mut self, value: T) {
        if self.seen.is_multiple_of(self.stride) {
            // One place is left for the last value.
            if self.kept.len() + 1 >= self.bound {
                let mut even = false;
                self.kept.retain(|_| {
                    even = !even;
                    even
                });
                self.stride *= 2;
            }
            if self.seen.is_multiple_of(self.stride) {
                if self.bound <= 4 {
                    // By itself a vector makes room for four at once.
                    self.kept.reserve_exact(1);
                }
                self.kept.push(value);
            }
        }
        self.last = Some(value);
        self.seen += 1;
    }

    /// The first value.
    pub(super) fn first(&self) -> Option<&T> {
        self.kept.first()
    }

    /// The values kept, in order.
    pub(super) fn finish(mut self) -> Vec<T> {
        let last_is_kept = self.seen.wrapping_sub(1).is_multiple_of(self.stride);
        if let (Some(last), false) = (self.last, last_is_kept || self.seen == 0) {
            self.kept.push(last);
        }
        self.kept
    }
}

/// A random sample of a series, every value with the same chance; all of it while it is short. Thinning by a stride
/// would fall into step with a periodic series. The generator is seeded with a constant: same input, same sample.
#[derive(Clone, Debug)]
pub(super) struct Reservoir<T> {
    bound: usize,
    seen: u64,
    kept: Vec<T>,
    random: fastrand::Rng,
}

impl<T> Reservoir<T> {
    pub(super) fn new(bound: usize) -> Self {
        Self {
            bound,
            seen: 0,
            kept: Vec::new(),
            random: fastrand::Rng::with_seed(0),
        }
    }

    /// Vitter's algorithm R.
    pub(super) fn push(&mut self, value: T) {
        self.seen += 1;
        if self.kept.len() < self.bound {
            self.kept.push(value);
            return;
        }
        let index = self.random.u64(..self.seen);
        if let Some(slot) = usize::try_from(index).ok().and_then(|index| self.kept.get_mut(index)) {
            *slot = value;
        }
    }

    /// The values kept: in order while all are kept, in arbitrary order later.
    pub(super) fn finish(self) -> Vec<T> {
        self.kept
    }
}

impl Reservoir<i64> {
    /// The lower median of the sample.
    pub(super) fn median(&self) -> Option<i64> {
        let mut sorted = self.kept.clone();
        let middle = sorted.len().checked_sub(1)? / 2;
        Some(*sorted.select_nth_unstable(middle).1)
    }

    /// How many values of the series are above `limit`: exact while all were kept, else scaled up from the sample.
    pub(super) fn count_above(&self, limit: i64) -> u64 {
        let above = self.kept.iter().filter(|value| **value > limit).count() as u128;
        let estimate = above * u128::from(self.seen) / (self.kept.len() as u128).max(1);
        u64::try_from(estimate).unwrap_or(u64::MAX)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn thinned(n: u64, bound: usize) -> Vec<u64> {
        let mut thinned = ThinnedSeries::new(bound);
        for value in 0..n {
            thinned.push(value);
        }
        thinned.finish()
    }

    #[test]
    fn short_series_are_kept_whole() {
        assert_eq!(thinned(0, 8), Vec::<u64>::new());
        assert_eq!(thinned(1, 8), [0]);
        assert_eq!(thinned(7, 8), [0, 1, 2, 3, 4, 5, 6]);
    }

    #[test]
    fn long_series_are_even_and_keep_both_ends() {
        assert_eq!(thinned(9, 8), [0, 2, 4, 6, 8]);
        assert_eq!(thinned(10, 8), [0, 2, 4, 6, 8, 9]);
        for n in 2..3000 {
            let kept = thinned(n, 16);
            assert!(kept.len() <= 16, "{n}: {kept:?}");
            assert_eq!((kept.first(), kept.last()), (Some(&0), Some(&(n - 1))));
            let step = kept[1] - kept[0];
            assert!(
                kept.windows(2).rev().skip(1).all(|pair| pair[1] - pair[0] == step),
                "{n}: {kept:?}"
            );
        }
    }

    #[test]
    fn the_median_of_a_short_series_is_exact_and_of_a_long_one_near() {
        let mut short = Reservoir::new(8);
        assert_eq!(short.median(), None);
        for value in [5, 1, 4, 2] {
            short.push(value);
        }
        assert_eq!(short.median(), Some(2));
        assert_eq!(short.count_above(3), 2);
        let mut long = Reservoir::new(1000);
        for value in 0..100_000 {
            long.push(value % 100);
        }
        let median = long.median().unwrap();
        assert!((40..60).contains(&median), "{median}");
        let above = long.count_above(89);
        assert!((7_000..13_000).contains(&above), "{above}");
    }
}
