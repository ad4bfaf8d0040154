//! COV02: covariances with rotations before positions.

use crate::analysis::cov::declared::{StreamCovariance, each};
use crate::analysis::cov::fit::{Fit, Reading};
use crate::analysis::motion::Stream;
use crate::math::{level::tilt, readings::Reading as Slots};
use crate::rules::prelude::*;
use crate::world::motion::PoseRow;

pub(crate) struct CovOrder;

/// What to do.
const SWAP: &str = "swap the two diagonal 3x3 blocks, and the two others, before publishing: ROS has position first, GTSAM's Pose3 has rotation first";

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Limits {
    min_poses: f64,
    fits: f64,
    loosely: f64,
    misses: f64,
    margin: f64,
    way_m: f64,
}

impl Rule for CovOrder {
    const NEEDS: &'static [Need] = &[Need::Bag];
    type Limits = Limits;

    fn judge(world: &Estimates, limits: &Limits, out: &mut Judge) {
        each(world, "pose.covariance", |_, stream, declared| {
            judge_stream(stream, declared, limits, out);
        });
    }
}

fn judge_stream(stream: &Stream<PoseRow>, declared: &StreamCovariance<'_>, limits: &Limits, out: &mut Judge) {
    let subject = format!("order of `pose.covariance` on {}", stream.subject);
    if let Some(way_m) = moves_in_a_plane(stream).filter(|way| *way >= limits.way_m)
        && states_tilts_alone(declared)
    {
        return out.fail(in_a_plane(stream, subject, declared, way_m, limits));
    }
    let fit = match Fit::of(stream, declared, limits.min_poses) {
        Ok(fit) => fit,
        Err(why) => return out.too_little(subject, why),
    };
    let (published, swapped) = (fit.miss(Reading::AsPublished), fit.miss(Reading::RotationFirst));
    let measured = [
        Measured::new(
            "largest factor between a variance and the noise, positions first (ROS)",
            published,
            "1",
        )
        .limit(limits.loosely)
        .samples(fit.poses),
        Measured::new(
            "largest factor between a variance and the noise, rotations first",
            swapped,
            "1",
        )
        .limit(limits.fits)
        .samples(fit.poses),
        Measured::new(
            "log-likelihood per pose, rotations first minus positions first",
            fit.order_ratio,
            "1",
        ),
    ];
    if published <= limits.loosely && published < swapped {
        return out.pass(subject, measured);
    }
    let best = fit.best(limits.loosely, limits.margin);
    let is_swapped = best == Some(Reading::RotationFirst) && published >= limits.misses && fit.order_ratio > 0.0;
    if !is_swapped {
        return out.too_little(subject, match best {
            Some(Reading::AsPublished | Reading::RotationFirst) | None => format!(
                "the variances differ from the noise of the poses by a factor of {published:.1e} as published, and {swapped:.1e} with rotations \
                 first: they describe other errors than those from pose to pose"
            ),
            Some(_) => "another unit explains it".to_owned(),
        });
    }
    let message = format!(
        "`{}`: `pose.covariance` has rotations before positions (variances up to {published:.0} times off)",
        stream.topic
    );
    let finding = Finding::warning(subject, message, stream.place())
        .relation("rotation-first")
        .detail(
            "The variances were compared with the noise from pose to pose. With rotations first all of them (x and y, z, tilt, yaw) are \
             near that noise, but in the order of ROS (positions first) not all of them are.",
        )
        .help(SWAP);
    let finding = if swapped <= limits.fits {
        finding.likely()
    } else {
        finding.hint()
    };
    out.fail(finding.measured(measured));
}

/// How far apart the poses are in x and y, metres, where height and tilt are the same in all of them.
fn moves_in_a_plane(stream: &Stream<PoseRow>) -> Option<f64> {
    let [x0, y0, z0] = stream.rows().next()?.row.position;
    let mut way = 0.0_f64;
    for row in stream.rows().map(|timed| &timed.row) {
        let [x, y, z] = row.position;
        let tilted = tilt(&Slots::Xyzw.world_from_body(row.orientation)?);
        if (z - z0).abs() > FLAT || tilted > FLAT {
            return None;
        }
        way = way.max((x - x0).hypot(y - y0));
    }
    Some(way)
}

/// What rounding makes of a plane, metres and radians.
const FLAT: f64 = 1e-6;

/// Whether every matrix has zero variance of x and y, but not of roll and pitch.
fn states_tilts_alone(declared: &StreamCovariance<'_>) -> bool {
    let alone = |values: &[f64]| {
        let of = |axis: usize| values.get(7 * axis).copied().unwrap_or(f64::NAN);
        of(0) == 0.0 && of(1) == 0.0 && of(3) > 0.0 && of(4) > 0.0
    };
    !declared.is_constant() && declared.samples.iter().all(|(sample, _)| alone(&sample.values))
}

fn in_a_plane(
    stream: &Stream<PoseRow>,
    subject: String,
    declared: &StreamCovariance<'_>,
    way_m: f64,
    limits: &Limits,
) -> Finding {
    let count = declared.samples.len();
    let message = format!(
        "`{}`: `pose.covariance` has rotations before positions (zero variance of x and y)",
        stream.topic
    );
    Finding::warning(subject, message, stream.place())
        .likely()
        .relation("rotation-first")
        .detail(format!(
            "The poses move by {way_m:.1} m in x and y and never tilt. The matrices state zero variance for x and y, but not for roll and pitch."
        ))
        .help(SWAP)
        .measured(Measured::new("largest distance from the first pose in x and y", way_m, "m").at_least(limits.way_m))
        .measured(Measured::count(
            "matrices with zero variance of x and y, but not of roll and pitch",
            count,
        ))
}
