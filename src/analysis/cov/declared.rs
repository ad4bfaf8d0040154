//! The covariances that a stream of poses states, each with the yaw at its time.
//!
//! Must not judge.

use std::borrow::Cow;

use crate::analysis::Estimates;
use crate::analysis::cov::noise::{Variances, yaw};
use crate::analysis::motion::{Motion, Stream};
use crate::math::circular::{circular_mean, diversity};
use crate::math::{noise::Ellipse, stats::median};
use crate::world::content::{CovarianceAt, CovarianceEvidence};
use crate::world::{BagEvidence, bag::TopicEvidence, motion::PoseRow};

/// A pose at the time of a matrix is no further away than this, nanoseconds.
const MAX_APART_NS: u64 = 200_000_000;
/// Numbers of a matrix that differ by less than this share of it are equal.
const SAME: f64 = 1e-9;

/// Every stream of poses on a topic, with the covariance field of this name.
pub(crate) fn each(
    world: &Estimates,
    field: &str,
    mut with: impl FnMut(&BagEvidence, &Stream<PoseRow>, &StreamCovariance<'_>),
) {
    let motion = Motion::of(world);
    for (bag, moved) in world.bags.iter().zip(&motion.bags) {
        for stream in &moved.poses {
            let topics = bag.topics.values().filter(|topic| topic.topic == stream.topic);
            for topic in topics.filter(|topic| topic.content.motion.poses.is_some()) {
                if let Some(evidence) = topic.content.covariances.get(field) {
                    with(
                        bag,
                        stream,
                        &StreamCovariance::of(stream, topic, evidence, field.starts_with("twist")),
                    );
                }
            }
        }
    }
}

/// The covariances of a stream.
pub(crate) struct StreamCovariance<'w> {
    pub(crate) topic: &'w TopicEvidence,
    /// The different ones that state something, in the axes of ROS, with the yaw at their time.
    pub(crate) samples: Vec<(Cow<'w, CovarianceAt>, Option<f64>)>,
    /// The yaws of the whole stream.
    yaws: Vec<f64>,
}

/// Where the longer axis of horizontal covariances points.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Axes {
    /// Longer over shorter deviation, the median of the matrices.
    pub(crate) stretch: f64,
    /// Sum of both variances, the median of the matrices.
    pub(crate) trace: f64,
    /// How constant its direction is in the axes that the matrix is expressed in, 0..=1.
    pub(crate) constant: f64,
    /// How constant its direction minus the yaw is.
    pub(crate) less_yaw: f64,
    /// How widely the yaw is spread, 0..=1.
    pub(crate) spread: f64,
    /// Matrices.
    pub(crate) count: usize,
}

impl<'w> StreamCovariance<'w> {
    fn of(
        stream: &Stream<PoseRow>,
        topic: &'w TopicEvidence,
        evidence: &'w CovarianceEvidence,
        is_twist: bool,
    ) -> Self {
        let rows: Vec<&PoseRow> = stream.rows().map(|timed| &timed.row).collect();
        let at = |sample: &CovarianceAt| {
            let log_ns = sample.at.log_ns;
            let after = rows.partition_point(|row| row.log_ns < log_ns);
            let near = [after.checked_sub(1), Some(after)].into_iter().flatten();
            let row = near
                .filter_map(|index| rows.get(index))
                .min_by_key(|row| row.log_ns.abs_diff(log_ns))?;
            (row.log_ns.abs_diff(log_ns) <= MAX_APART_NS).then(|| yaw(row.orientation))?
        };
        let says = |sample: &&CovarianceAt| {
            let finite = sample.values.iter().all(|value| value.is_finite());
            finite && sample.values.len() == 36 && sample.values.iter().any(|value| *value != 0.0)
        };
        let samples = evidence.samples.iter().filter(says);
        let in_ros = |sample: &'w CovarianceAt| {
            if !stream.expressed_in.converts() {
                return Cow::Borrowed(sample);
            }
            Cow::Owned(CovarianceAt {
                values: stream.expressed_in.covariance(&sample.values, is_twist),
                ..sample.clone()
            })
        };
        Self {
            topic,
            samples: samples.map(|sample| (in_ros(sample), at(sample))).collect(),
            yaws: stream.rows().filter_map(|timed| yaw(timed.row.orientation)).collect(),
        }
    }

    /// Whether all of them are equal: hard-coded numbers.
    pub(crate) fn is_constant(&self) -> bool {
        let mut values = self.samples.iter().map(|(sample, _)| &sample.values);
        let Some(first) = values.next() else { return true };
        let largest = first.iter().fold(0.0_f64, |most, value| most.max(value.abs()));
        values.all(|other| first.iter().zip(other).all(|(a, b)| (a - b).abs() <= SAME * largest))
    }

    /// The variances, each the median of the matrices.
    pub(crate) fn variances(&self) -> Option<Variances> {
        let of = |axes: &[usize]| {
            let mean = |sample: &CovarianceAt| {
                let values = axes.iter().filter_map(|axis| sample.values.get(7 * axis));
                values.sum::<f64>() / axes.len() as f64
            };
            let values: Vec<f64> = self.samples.iter().map(|(sample, _)| mean(sample)).collect();
            median(&values)
        };
        Some(Variances {
            horizontal: of(&[0, 1])?,
            vertical: of(&[2])?,
            tilt: of(&[3, 4])?,
            yaw: of(&[5])?,
        })
    }

    /// Where the horizontal covariances point. `None` where none of them is an ellipse, or no yaw is known.
    pub(crate) fn axes(&self) -> Option<Axes> {
        let ellipses: Vec<(Ellipse, f64)> = self
            .samples
            .iter()
            .filter_map(|(sample, yaw)| {
                let [xx, xy, yy] = horizontal(sample)?;
                Some((Ellipse::of(xx, xy, yy)?, (*yaw)?))
            })
            .collect();
        let stretches: Vec<f64> = ellipses.iter().map(|(ellipse, _)| ellipse.stretch.min(1e6)).collect();
        let traces: Vec<f64> = ellipses.iter().map(|(ellipse, _)| ellipse.trace).collect();
        let (angles, yaws): (Vec<f64>, Vec<f64>) = if self.is_constant() {
            // One matrix for all messages, at all yaws.
            let (ellipse, _) = ellipses.first()?;
            (vec![ellipse.angle_rad; self.yaws.len()], self.yaws.clone())
        } else {
            ellipses.iter().map(|(ellipse, yaw)| (ellipse.angle_rad, *yaw)).unzip()
        };
        let resultant = |angles: &mut dyn Iterator<Item = f64>| {
            circular_mean(angles.map(|angle| (2.0 * angle, 1.0))).map(|mean| mean.resultant)
        };
        Some(Axes {
            stretch: median(&stretches)?,
            trace: median(&traces)?,
            constant: resultant(&mut angles.iter().copied())?,
            less_yaw: resultant(&mut angles.iter().zip(&yaws).map(|(angle, yaw)| angle - yaw))?,
            spread: diversity(yaws.iter().map(|yaw| (*yaw, 1.0)))?,
            count: ellipses.len(),
        })
    }
}

/// xx, xy and yy of a 6x6.
pub(crate) fn horizontal(sample: &CovarianceAt) -> Option<[f64; 3]> {
    let value = |index: usize| sample.values.get(index).copied();
    Some([value(0)?, value(1)?, value(7)?])
}
