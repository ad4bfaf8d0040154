//! CROSS04: a mounting that is told the wrong way round, by the motion on both of its sides.

use crate::analysis::cross::direction::{Limits, Reading, Seen, look};
use crate::analysis::lidar::Clouds;
use crate::rules::prelude::*;

pub(crate) struct ExtrinsicDirection;

impl Rule for ExtrinsicDirection {
    const NEEDS: &'static [Need] = &[Need::Bag];
    type Limits = Limits;

    fn judge(world: &Estimates, limits: &Limits, out: &mut Judge) {
        Clouds::say_packets(world, "direction of the mounting", out);
        for clouds in Clouds::scanners(world) {
            match look(world, &clouds, limits) {
                Ok(seen) => judge_seen(&clouds, &seen, limits, out),
                Err((reason, why)) => out.not_evaluated(clouds.subject("direction of the mounting"), reason, why),
            }
        }
    }
}

fn judge_seen(clouds: &Clouds, seen: &Seen, limits: &Limits, out: &mut Judge) {
    let subject = clouds.subject("direction of the mounting");
    let (told, inverse) = (seen.of(Reading::AsPublished), seen.of(Reading::Inverse));
    let measured = [
        Measured::new("residual of the motions, as published", told, "m")
            .limit(limits.max_residual_m)
            .samples(seen.pairs as u64),
        Measured::new("residual of the inverse", inverse, "m"),
    ];
    let name = format!("{}_from_{}", seen.known.body, seen.known.lidar);
    match seen.decided {
        Some(Reading::AsPublished) => out.pass(subject, measured),
        Some(Reading::Inverse) => {
            let message = format!(
                "`{name}` is told the wrong way round: its inverse brings the scans on `{}` and {} together to {inverse:.2} m, the transform as it is \
                 to {told:.2} m",
                clouds.topic.topic, seen.known.poses.0
            );
            let finding = Finding::error(subject, message, clouds.place())
                .likely()
                .relation("inverse")
                .related(seen.known.poses.1.clone(), "where it went")
                .help("publish the inverse: TF's transform of a child is its pose in the parent, `parent_from_child`")
                .prefers(
                    seen.known.body.to_string(),
                    seen.known.lidar.to_string(),
                    seen.known.told.inverse(),
                );
            out.fail(finding.measured(measured));
        }
        Some(_) => {
            out.not_applicable(subject, format!("`{name}` fits the motion once it is turned by 180 deg about z"));
        }
        None => {
            let why = format!(
                "the motions are brought together to {told:.2} m by `{name}`, to {inverse:.2} m by its inverse, and to {:.2} and {:.2} m by both with \
                 half a turn: that does not tell them apart",
                seen.of(Reading::Turned),
                seen.of(Reading::InverseTurned)
            );
            out.too_little(subject, why);
        }
    }
}
