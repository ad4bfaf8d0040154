//! CROSS04: an inverted mounting transform, by the motions of lidar and body.

use crate::advice::places::with_mounting;
use crate::analysis::cross::direction::{DirectionFit, Limits, Reading, look};
use crate::analysis::lidar::Clouds;
use crate::rules::prelude::*;
use crate::world::World;

pub(crate) struct ExtrinsicDirection;

impl Rule for ExtrinsicDirection {
    const NEEDS: &'static [Need] = &[Need::Bag];
    type Limits = Limits;

    fn judge(world: &Estimates, limits: &Limits, out: &mut Judge) {
        Clouds::say_packets(world, "direction of the mounting", out);
        for clouds in Clouds::scanners(world) {
            match look(world, &clouds, limits) {
                Ok(seen) => judge_seen(world, &clouds, &seen, limits, out),
                Err((reason, why)) => out.not_evaluated(clouds.subject("direction of the mounting"), reason, why),
            }
        }
    }
}

fn judge_seen(world: &World, clouds: &Clouds, seen: &DirectionFit, limits: &Limits, out: &mut Judge) {
    let subject = clouds.subject("direction of the mounting");
    let (published, inverse) = (seen.of(Reading::AsPublished), seen.of(Reading::Inverse));
    let [by_published, by_inverse] =
        [("as published", published), ("with the inverse", inverse)].map(|(what, value)| {
            Measured::new(format!("disagreement of the motions, {what}"), value, "m").samples(seen.pairs as u64)
        });
    let name = format!("{}_from_{}", seen.known.body, seen.known.lidar);
    match seen.decided {
        Some(Reading::AsPublished) => out.pass(subject, [by_published.limit(limits.max_residual_m), by_inverse]),
        Some(Reading::Inverse) => {
            let edge = format!("`{}` -> `{}`", seen.known.body, seen.known.lidar);
            let message =
                format!("{edge} is inverted: motions disagree by {published:.2} m, by {inverse:.2} m with the inverse");
            let finding = Finding::error(subject, message, clouds.place())
                .likely()
                .detail(format!(
                    "The motion of the scans on `{}` was compared with that of {}, once with the transform as published and once with its inverse.",
                    clouds.topic.topic, seen.known.poses.0
                ))
                .relation("inverse")
                .related(seen.known.poses.1.clone(), "motion of the body")
                .help(format!(
                    "invert {edge} where it is written or published: in URDF and TF, a transform is the pose of the child in its parent"
                ))
                .prefers(
                    seen.known.body.to_string(),
                    seen.known.lidar.to_string(),
                    seen.known.stated.inverse(),
                );
            let mounting = [&seen.known.body, &seen.known.lidar];
            out.fail(with_mounting(
                world,
                mounting,
                clouds.once_per_lidar(world, finding.measured([by_published, by_inverse])),
            ));
        }
        Some(_) => {
            out.not_applicable(
                subject,
                format!(
                    "`{name}` matches the motion once it is rotated by 180 deg about z: the direction is not the error"
                ),
            );
        }
        None => {
            let why = format!(
                "the residuals of the motions do not decide: {published:.2} m with `{name}`, {inverse:.2} m with its inverse, and {:.2} and {:.2} m with \
                 both rotated by 180 deg about z; record a drive with more turns",
                seen.of(Reading::Turned),
                seen.of(Reading::InverseTurned)
            );
            out.too_little(subject, why);
        }
    }
}
