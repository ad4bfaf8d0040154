//! The samples of one child: insertion, pruning and interpolation as in tf2's cache.cpp and static_cache.cpp.

use std::collections::VecDeque;

use nalgebra::Isometry3;

use crate::world::claim::Pose;

use super::errors::{Extrapolation, Rejection};
use super::{FrameIndex, SampleOrigin};

/// One transform of a child.
#[derive(Clone, Copy, Debug)]
pub(super) struct Sample {
    pub(super) stamp_ns: i64,
    pub(super) parent: FrameIndex,
    pub(super) pose: Pose,
    pub(super) tag: usize,
}

impl Sample {
    /// Whether all published values are equal.
    fn repeats(&self, other: &Self) -> bool {
        (self.stamp_ns, self.parent) == (other.stamp_ns, other.parent) && self.pose == other.pose
    }
}

/// What is known about one child.
#[derive(Clone, Debug)]
pub(super) enum History {
    /// One transform for all times.
    Static(Sample),
    /// By stamp; of equal stamps, the one that came later follows. Never empty.
    Moving(VecDeque<Sample>),
}

/// A child's edge at a stamp.
#[derive(Clone, Copy, Debug)]
pub(super) struct Edge {
    pub(super) parent: FrameIndex,
    pub(super) parent_from_child: Isometry3<f64>,
    pub(super) made_from: SampleOrigin,
    pub(super) tags: (usize, Option<usize>),
}

impl History {
    pub(super) fn new(first: Sample, is_static: bool) -> Self {
        if is_static {
            Self::Static(first)
        } else {
            Self::Moving(VecDeque::from([first]))
        }
    }

    pub(super) fn is_static(&self) -> bool {
        matches!(self, Self::Static(_))
    }

    /// Old data are removed first, by the newest stamp before this sample.
    pub(super) fn insert(&mut self, sample: Sample, cache_ns: Option<i64>) -> Result<(), Rejection> {
        let samples = match self {
            Self::Static(known) => {
                *known = sample;
                return Ok(());
            }
            Self::Moving(samples) => samples,
        };
        if let (Some(cache_ns), Some(latest)) = (cache_ns, samples.back().map(|last| last.stamp_ns)) {
            let oldest_kept = latest.saturating_sub(cache_ns);
            while samples.front().is_some_and(|first| first.stamp_ns < oldest_kept) {
                samples.pop_front();
            }
            if sample.stamp_ns < oldest_kept {
                return Err(Rejection::Old);
            }
        }
        let after = samples.partition_point(|known| known.stamp_ns <= sample.stamp_ns);
        let of_same_stamp = samples.range(..after).rev();
        if of_same_stamp
            .take_while(|known| known.stamp_ns == sample.stamp_ns)
            .any(|known| known.repeats(&sample))
        {
            return Err(Rejection::Repeated);
        }
        samples.insert(after, sample);
        Ok(())
    }

    /// The edge at a stamp; zero requests the latest.
    pub(super) fn at(&self, stamp_ns: i64) -> Result<Edge, Extrapolation> {
        let samples = match self {
            Self::Static(sample) => return Ok(whole(sample, SampleOrigin::Static)),
            Self::Moving(samples) => samples,
        };
        let one = |sample: &Sample| Ok(whole(sample, SampleOrigin::Sample(sample.stamp_ns)));
        let requested_ns = stamp_ns;
        let (Some(first), Some(last)) = (samples.front(), samples.back()) else {
            return Err(Extrapolation::Single {
                requested_ns,
                only_ns: 0,
            });
        };
        if stamp_ns == 0 || stamp_ns == last.stamp_ns {
            return one(last);
        }
        if stamp_ns == first.stamp_ns {
            return one(first);
        }
        if samples.len() == 1 {
            return Err(Extrapolation::Single {
                requested_ns,
                only_ns: first.stamp_ns,
            });
        }
        if stamp_ns > last.stamp_ns {
            return Err(Extrapolation::Future {
                requested_ns,
                latest_ns: last.stamp_ns,
            });
        }
        let past = Extrapolation::Past {
            requested_ns,
            earliest_ns: first.stamp_ns,
        };
        let after = samples.partition_point(|known| known.stamp_ns <= stamp_ns);
        let older = after.checked_sub(1).and_then(|index| samples.get(index)).ok_or(past)?;
        match samples.get(after) {
            Some(newer) if newer.parent == older.parent => Ok(between(older, newer, stamp_ns)),
            // Where the parent changes there is nothing to interpolate: the older sample is used.
            _ => one(older),
        }
    }

    /// Stamp of the newest sample, zero for a static one, and its parent.
    pub(super) fn latest(&self) -> Option<(i64, FrameIndex)> {
        match self {
            Self::Static(sample) => Some((0, sample.parent)),
            Self::Moving(samples) => samples.back().map(|last| (last.stamp_ns, last.parent)),
        }
    }

    pub(super) fn span_ns(&self) -> Option<(i64, i64)> {
        match self {
            Self::Static(_) => None,
            Self::Moving(samples) => Some((samples.front()?.stamp_ns, samples.back()?.stamp_ns)),
        }
    }

    /// The parents of the samples, in their order.
    pub(super) fn parents(&self) -> impl Iterator<Item = FrameIndex> {
        let (one, many) = match self {
            Self::Static(sample) => (Some(sample), None),
            Self::Moving(samples) => (None, Some(samples)),
        };
        one.into_iter()
            .chain(many.into_iter().flatten())
            .map(|sample| sample.parent)
    }
}

fn whole(sample: &Sample, made_from: SampleOrigin) -> Edge {
    Edge {
        parent: sample.parent,
        parent_from_child: sample.pose.isometry(),
        made_from,
        tags: (sample.tag, None),
    }
}

/// Linear in the translation, spherical (along the shorter arc) in the rotation.
fn between(older: &Sample, newer: &Sample, stamp_ns: i64) -> Edge {
    if stamp_ns == older.stamp_ns {
        return whole(older, SampleOrigin::Sample(older.stamp_ns));
    }
    let length = i128::from(newer.stamp_ns) - i128::from(older.stamp_ns);
    let ratio = (i128::from(stamp_ns) - i128::from(older.stamp_ns)) as f64 / length as f64;
    let (a, b) = (older.pose.isometry(), newer.pose.isometry());
    let translation = a.translation.vector.lerp(&b.translation.vector, ratio);
    // Rotations that are equal to the last digits have no arc to divide.
    let rotation = a.rotation.try_slerp(&b.rotation, ratio, 1e-12).unwrap_or(a.rotation);
    Edge {
        parent: older.parent,
        parent_from_child: Isometry3::from_parts(translation.into(), rotation),
        made_from: SampleOrigin::Between(older.stamp_ns, newer.stamp_ns),
        tags: (older.tag, Some(newer.tag)),
    }
}
