//! The scale between odometry and GNSS: a part of AXES07.

use crate::advice::scale::wrong_scale;
use crate::analysis::axes::handedness::{Limits, Votes};
use crate::analysis::motion::Stream;
use crate::analysis::names;
use crate::rules::prelude::*;
use crate::world::motion::{FixRow, PoseRow};

/// A scale that was reported, and the subject of the finding.
pub(super) struct WrongScale {
    subject: String,
    scale: f64,
}

/// Judges whether the tracks have the same unit: no scale factor between them. One that other poses have as well is reported once.
pub(super) fn judge(
    poses: &Stream<PoseRow>,
    fixes: &Stream<FixRow>,
    reported: &mut Vec<WrongScale>,
    votes: &Votes,
    limits: &Limits,
    out: &mut Judge,
) {
    let subject = format!("scale of {} against {}", poses.subject, fixes.subject);
    if !is_of_platform(poses) {
        return out.not_applicable(
            subject,
            "poses that are not those of the platform's base may have any scale",
        );
    }
    let Some((scale, error)) = votes.scale().filter(|(scale, _)| *scale > 0.0) else {
        return out.too_little(subject, "no window of the tracks shows a scale");
    };
    let measured = Measured::new(
        "length of the GNSS track / length of the odometry track, minus 1",
        scale - 1.0,
        "1",
    )
    .limit(limits.max_scale)
    .spread(error)
    .samples(votes.says.iter().sum::<usize>() as u64);
    let off = (scale - 1.0).abs();
    if off <= limits.max_scale && error <= limits.max_scale {
        return out.pass(subject, [measured]);
    }
    if off <= limits.sigmas * error {
        let why = format!(
            "the GNSS track is {scale:.2} +- {error:.2} times as long as that of the odometry: not accurate enough to decide"
        );
        return out.too_little(subject, why);
    }
    let of_track = format!("the GNSS track on `{}`", fixes.topic);
    let finding = wrong_scale(
        (subject.clone(), poses.place()),
        (&format!("`{}`", poses.topic), &of_track),
        scale,
        limits.max_scale,
    )
    .related(fixes.place(), "GNSS track")
    .measured(measured);
    let is_same = |other: &&WrongScale| (other.scale / scale - 1.0).abs() <= limits.sigmas * error;
    let same = reported.iter().find(is_same).map(|other| &other.subject);
    out.fail(same.into_iter().fold(finding, Finding::same_cause_as));
    reported.push(WrongScale { subject, scale });
}

/// Whether the poses are those of the platform's base in the world.
pub(super) fn is_of_platform(poses: &Stream<PoseRow>) -> bool {
    poses.is_way() && poses.child.as_ref().is_some_and(names::is_base)
}
