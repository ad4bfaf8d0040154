//! Evidence of lidars: layouts of points, samples of clouds, and the ranges of every cloud's times and coordinates.
//! Bounded, as published.

use std::collections::BTreeSet;
use std::f64::consts::{PI, TAU};
use std::sync::Arc;

use nalgebra::Vector3;
use serde::{Deserialize, Serialize};

use crate::math::constants::optical_inverse;
use crate::source::MessageRef;

/// Different layouts of one topic that are kept.
pub const MAX_LAYOUTS: usize = 4;
/// Fields with the ring of a point, by the drivers of lidars.
pub const RING_FIELDS: [&str; 5] = ["ring", "line", "channel", "laser_id", "laser"];
/// Clouds of one topic of which points are kept.
pub const MAX_SAMPLES: usize = 20;
/// Points that are kept of a cloud.
pub const MAX_POINTS: usize = 4096;

/// The layout of the points of a topic.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct CloudLayout {
    /// The first cloud of the layout.
    pub at: MessageRef,
    /// How many clouds have it.
    pub count: u64,
    /// The fields of a point, in the order of the message.
    pub fields: Vec<PointField>,
    /// Whether its numbers are big-endian.
    pub is_bigendian: bool,
}

/// One number, or several, of each point: `sensor_msgs/msg/PointField`.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct PointField {
    /// Name.
    pub name: String,
    /// `float32`, `uint32`; the number as published if it is unknown.
    pub datatype: String,
    /// How many of them.
    pub count: u32,
}

/// Points of one cloud, thinned evenly in rows and columns.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct CloudSample {
    /// The message.
    pub at: MessageRef,
    /// Rows and columns; one row where the cloud is not organised.
    pub size: [u32; 2],
    /// Rings of a lidar: different numbers in the field of rings, or else the rows of an organised cloud. `None` without both.
    #[serde(default)]
    pub rings: Option<u32>,
    /// Points with finite coordinates that are not all zero, of all that were examined.
    pub returns: u64,
    /// Points that were examined.
    pub looked_at: u64,
    /// The points with a return that are kept.
    pub points: Vec<CloudPoint>,
    /// The times of the points, where they have one.
    pub times: Option<PointTimes>,
}

/// The points of one cloud near the plane of its x and y: the nearest in each of [`SLICE_BINS`] directions, of those above that plane
/// and of those below it.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct CloudSlice {
    /// Stamp of its header, nanoseconds; none if that is zero.
    pub stamp_ns: Option<i64>,
    /// Log time, nanoseconds.
    pub log_ns: i64,
    /// x, y, z as published, counter-clockwise from -x: finite.
    pub points: Vec<[f64; 3]>,
    /// The time of each after the earliest of them, in the unit that is published: finite. Empty where points have no times.
    pub after: Vec<f64>,
    /// Points and times of the same cloud in the [`optical`] axes, if mistakes are tried on it: its points near another plane.
    #[serde(skip)]
    pub optical: Option<Arc<PlanePoints>>,
}

/// Points near the plane of x and y, counter-clockwise from -x, and the time of each after the earliest; see [`CloudSlice`].
pub type PlanePoints = (Vec<[f64; 3]>, Vec<f64>);

/// A point in the axes of a camera (x right, y down, z forward) from x forward, y left, z up: REP-103.
pub fn optical(point: [f64; 3]) -> [f64; 3] {
    (optical_inverse() * Vector3::from(point)).into()
}

/// Directions of a slice.
pub const SLICE_BINS: u32 = 720;
/// Tangent of the elevation up to which points belong to a slice: 4 degrees.
pub const SLICE_SLOPE: f64 = 0.0699;
/// Clouds of a run.
pub const RUN_CLOUDS: usize = 16;
/// Runs of one topic that are kept.
pub const MAX_RUNS: usize = 48;

/// A point with a return.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct CloudPoint {
    /// x, y, z as published, metres in the header's frame if the publisher keeps the convention.
    #[serde(with = "super::number::array")]
    pub xyz: [f64; 3],
    /// Row and column.
    pub cell: [u32; 2],
    /// Its time, as published.
    #[serde(with = "super::number")]
    pub time: f64,
}

/// The times of the points of one cloud, numbers as published.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct PointTimes {
    /// The field.
    pub field: String,
    /// Its type.
    pub datatype: String,
    /// The smallest and the largest of points with a return.
    #[serde(with = "super::number::array")]
    pub range: [f64; 2],
    /// The percentiles 0.1 and 99.9.
    #[serde(with = "super::number::array")]
    pub quantiles: [f64; 2],
    /// Different ones, counted up to [`MAX_DISTINCT`].
    pub distinct: u32,
    /// The time from which they count, if it is not that of the header, nanoseconds.
    pub timebase_ns: Option<u64>,
}

/// Different times are counted up to this number.
pub const MAX_DISTINCT: u32 = 64;

/// A lidar, as its packets identify it.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct PacketSensor {
    /// `Velodyne`.
    pub maker: String,
    /// `VLP-16`.
    pub model: String,
}

/// The clouds of one topic.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct CloudEvidence {
    /// Messages.
    pub count: u64,
    /// The lidar, if the messages are its packets: these clouds were decoded here and not published by a driver, so that layout, types of
    /// numbers and origin of the times are not those of a publisher.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub packets: Option<PacketSensor>,
    /// The first different layouts.
    pub layouts: Vec<CloudLayout>,
    /// Messages of others.
    pub others: u64,
    /// Messages whose data end before the number of points that they claim, and the first of them.
    pub cut: u64,
    /// The first of them.
    pub first_cut: Option<MessageRef>,
    /// Evenly thinned clouds, the first among them.
    pub samples: Vec<CloudSample>,
    /// Evenly thinned runs of clouds that follow each other.
    pub runs: Vec<Vec<CloudSlice>>,
    /// The cloud with the largest coordinate, of those examined, and that coordinate, metres as published.
    pub farthest: Option<(MessageRef, f64)>,
}

impl PointTimes {
    /// With the range, the quantiles and the variety of these times; `None` if none is finite.
    #[must_use]
    pub fn of(self, mut times: Vec<f64>) -> Option<Self> {
        times.retain(|time| time.is_finite());
        times.sort_by(f64::total_cmp);
        let (first, last) = (*times.first()?, *times.last()?);
        let at = |permille: usize| {
            let index = (times.len() - 1) * permille / 1000;
            times.get(index).copied().unwrap_or(first)
        };
        let mut distinct = BTreeSet::new();
        for time in &times {
            distinct.insert(time.to_bits());
            if distinct.len() >= MAX_DISTINCT as usize {
                break;
            }
        }
        Some(Self {
            range: [first, last],
            quantiles: [at(1), at(999)],
            distinct: u32::try_from(distinct.len()).unwrap_or(MAX_DISTINCT),
            ..self
        })
    }
}

/// A point near the plane: its distance squared, its coordinates, and its time as published.
type PlanePoint = (f64, [f64; 3], f64);

/// Takes in the points of a cloud, and keeps those of its [`CloudSlice`].
#[derive(Clone, Debug)]
pub struct PlaneCut(Vec<[Option<PlanePoint>; 2]>);

impl Default for PlaneCut {
    fn default() -> Self {
        Self(vec![[None; 2]; SLICE_BINS as usize])
    }
}

impl PlaneCut {
    /// Takes in a point, with its time as published: NaN if it has none.
    pub fn push(&mut self, [x, y, z]: [f64; 3], time: impl FnOnce() -> f64) {
        let flat = x * x + y * y;
        // Also false where one is NaN, or all are zero.
        let is_level = z * z < SLICE_SLOPE * SLICE_SLOPE * flat && flat.is_finite();
        if !is_level {
            return;
        }
        // Those below, and those above.
        let kept = self
            .0
            .get_mut(bin(x, y))
            .and_then(|bin| bin.get_mut(usize::from(z >= 0.0)));
        if let Some(kept) = kept.filter(|kept| kept.is_none_or(|(least, ..)| flat < least)) {
            *kept = Some((flat, [x, y, z], time()));
        }
    }

    /// The points that are kept, and the time of each after the earliest; no times where one is NaN, or all are the same.
    pub fn finish(self) -> PlanePoints {
        let kept = self.0.iter().flat_map(|bin| bin.iter().flatten());
        let (points, times): (Vec<_>, Vec<_>) = kept.map(|(_, point, time)| (*point, *time)).unzip();
        (points, after(times))
    }
}

/// Times after the earliest; none where one is NaN, or all are the same.
fn after(mut times: Vec<f64>) -> Vec<f64> {
    let first = times.iter().copied().fold(f64::INFINITY, f64::min);
    for time in &mut times {
        *time -= first;
    }
    let is_clear = times.iter().all(|time| time.is_finite()) && times.iter().any(|time| *time > 0.0);
    if is_clear { times } else { Vec::new() }
}

/// The direction of a point.
#[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss)] // from 0 to the number of bins
fn bin(x: f64, y: f64) -> usize {
    let share = (y.atan2(x) + PI) / TAU;
    ((share * f64::from(SLICE_BINS)) as usize).min(SLICE_BINS as usize - 1)
}

#[cfg(test)]
mod tests {
    use super::after;

    #[test]
    fn times_count_from_the_earliest() {
        assert_eq!(format!("{:?}", after(vec![5.5, 5.0, 6.0])), "[0.5, 0.0, 1.0]");
        assert!(after(vec![5.0, f64::NAN]).is_empty());
        assert!(after(vec![5.0, 5.0]).is_empty());
        assert!(after(Vec::new()).is_empty());
    }
}
