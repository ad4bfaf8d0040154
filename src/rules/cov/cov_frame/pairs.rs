//! One estimate in two frames: its covariance must rotate with the frame.
//!
//! Owns which streams are one estimate. Judges for COV04.

use crate::analysis::Estimates;
use nalgebra::{Matrix2, Rotation2, Vector2};

use crate::analysis::motion::Stream;
use crate::math::circular::{circular_mean, difference};
use crate::verdict::Judge;
use crate::verdict::{Finding, Measured};
use crate::world::motion::PoseRow;

use crate::analysis::cov::declared::{StreamCovariance, each, horizontal};
use crate::analysis::cov::noise::yaw;
use crate::rules::cov::cov_frame::limits::Limits;

/// Rows of two streams are of one time within this, nanoseconds.
const TOGETHER_NS: u64 = 20_000_000;
/// Pairs of poses that determine the rotation between the frames.
const MIN_POSES: usize = 50;
/// Resultant from which two yaws differ by a constant.
const CONSTANT: f64 = 0.9999;

struct PoseCovariances {
    source: crate::source::SourceId,
    stream: Stream<PoseRow>,
    matrices: Vec<(i64, Matrix2<f64>)>,
    is_constant: bool,
}

impl PoseCovariances {
    fn of(stream: &Stream<PoseRow>, declared: &StreamCovariance<'_>) -> Self {
        let matrix = |sample: &crate::world::content::CovarianceAt| {
            let [xx, xy, yy] = horizontal(sample)?;
            Some((sample.at.stamp_ns?, Matrix2::new(xx, xy, xy, yy)))
        };
        Self {
            source: stream.source,
            stream: stream.clone(),
            matrices: declared
                .samples
                .iter()
                .filter_map(|(sample, _)| matrix(sample))
                .collect(),
            is_constant: declared.is_constant(),
        }
    }
}

pub(crate) fn judge(world: &Estimates, limits: &Limits, out: &mut Judge) {
    let mut all: Vec<PoseCovariances> = Vec::new();
    each(world, "pose.covariance", |_, stream, declared| {
        all.push(PoseCovariances::of(stream, declared));
    });
    for (index, a) in all.iter().enumerate() {
        for b in all.iter().skip(index + 1).filter(|b| b.source == a.source) {
            if a.stream.frame != b.stream.frame
                && let Some(turn_rad) = one_estimate(&a.stream, &b.stream, limits)
            {
                judge_pair(a, b, turn_rad, limits, out);
            }
        }
    }
}

/// `frame of b from frame of a`, about z: where the two are one track in two frames.
fn one_estimate(a: &Stream<PoseRow>, b: &Stream<PoseRow>, limits: &Limits) -> Option<f64> {
    let of_b: Vec<&PoseRow> = b.rows().map(|timed| &timed.row).collect();
    let pairs: Vec<(&PoseRow, &PoseRow)> = a
        .rows()
        .filter_map(|timed| {
            let row = &timed.row;
            let at = of_b.partition_point(|other| other.stamp_ns.saturating_add(10_000_000) < row.stamp_ns);
            let other = of_b
                .get(at)
                .filter(|other| other.stamp_ns.abs_diff(row.stamp_ns) <= TOGETHER_NS)?;
            Some((row, *other))
        })
        .collect();
    if pairs.len() < MIN_POSES {
        return None;
    }
    let turns = pairs
        .iter()
        .filter_map(|(a, b)| Some((difference(yaw(b.orientation)?, yaw(a.orientation)?), 1.0)));
    let turn = circular_mean(turns).filter(|mean| mean.resultant > CONSTANT)?;
    // The steps from one pose to the next, in both frames.
    let rotation = Rotation2::new(turn.mean_rad);
    let (mut left, mut way) = (0.0, 0.0);
    for (before, after) in pairs.iter().zip(pairs.iter().skip(1)) {
        let step = |from: &PoseRow, to: &PoseRow| {
            let ([x0, y0, _], [x1, y1, _]) = (from.position, to.position);
            Vector2::new(x1 - x0, y1 - y0)
        };
        let (in_a, in_b) = (step(before.0, after.0), step(before.1, after.1));
        left += (in_b - rotation * in_a).norm_squared();
        way += in_b.norm_squared();
    }
    (way > 0.0 && left <= limits.rigid_share.powi(2) * way).then_some(turn.mean_rad)
}

fn judge_pair(a: &PoseCovariances, b: &PoseCovariances, turn_rad: f64, limits: &Limits, out: &mut Judge) {
    let subject = format!("`pose.covariance` of {} and of {}", a.stream.subject, b.stream.subject);
    let turn_deg = turn_rad.to_degrees();
    if a.is_constant || b.is_constant {
        return out.not_applicable(
            subject,
            "one constant matrix in all messages: hard-coded numbers do not rotate",
        );
    }
    // A rotation by 180 deg does not change a covariance.
    let quarter = turn_deg.abs().min(180.0 - turn_deg.abs());
    if quarter < limits.min_turn_deg {
        let why = format!("the frames are rotated by {turn_deg:.1} deg, which hardly changes a covariance");
        return out.too_little(subject, why);
    }
    let rotation = *Rotation2::new(turn_rad).matrix();
    let (mut same, mut turned, mut distinct, mut count) = (0.0, 0.0, 0.0, 0_usize);
    for (stamp, of_a) in &a.matrices {
        let found = b
            .matrices
            .iter()
            .find(|(other, _)| other.abs_diff(*stamp) <= TOGETHER_NS);
        let Some((_, of_b)) = found else { continue };
        let weight = of_b.norm_squared();
        if weight > 0.0 && weight.is_finite() {
            same += (of_b - of_a).norm_squared() / weight;
            turned += (of_b - rotation * of_a * rotation.transpose()).norm_squared() / weight;
            distinct += (of_a - rotation * of_a * rotation.transpose()).norm_squared() / weight;
            count += 1;
        }
    }
    let [same, turned, distinct] = [same, turned, distinct].map(|sum| (sum / count as f64).sqrt());
    if count < 5 || distinct < 4.0 * limits.same_share {
        let why = format!(
            "too few or too round matrices: {count} at equal times, which the rotation of {turn_deg:.0} deg changes by {:.0} %",
            100.0 * distinct
        );
        return out.too_little(subject, why);
    }
    let measured = [
        Measured::new("difference of the covariances as published", same, "1")
            .limit(limits.same_share)
            .samples(count as u64),
        Measured::new("difference of the covariances after the rotation", turned, "1")
            .limit(limits.same_share)
            .samples(count as u64),
        Measured::new("rotation between the frames", turn_deg, "deg"),
    ];
    if turned <= limits.same_share {
        return out.pass(subject, measured);
    }
    if same > limits.same_share {
        let why = format!(
            "they differ by {:.0} % as published and by {:.0} % after the rotation: two different error estimates",
            100.0 * same,
            100.0 * turned
        );
        return out.too_little(subject, why);
    }
    let message = format!(
        "`{}` and `{}` have the same covariance in frames rotated by {turn_deg:.1} deg",
        a.stream.topic, b.stream.topic
    );
    let detail = format!(
        "Both topics have one track, in two frames. The covariances differ by {:.1} %, but rotated from one frame to the other they would \
         differ by {:.0} %: one covariance was copied and not rotated. The data do not show which.",
        100.0 * same,
        100.0 * distinct
    );
    let finding = Finding::warning(subject, message, b.stream.place())
        .likely()
        .relation("not-rotated")
        .label("the covariance in one frame")
        .related(a.stream.place(), "the same covariance in the other frame")
        .detail(detail)
        .help("find the topic whose covariance was copied, and rotate both 3x3 blocks there: `C_b = R C_a R^T`, with `R` the rotation that takes vectors from the frame of the original pose (a) to that of this one (b)");
    out.fail(finding.measured(measured));
}
