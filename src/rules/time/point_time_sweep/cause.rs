//! Why a sweep is reversed.

use crate::analysis::{axes::cloud_turn::CloudTurn, lidar::Clouds};
use crate::rules::prelude::*;

/// Adds why the sweep is reversed, as far as the ground in the clouds and the turns of the platform show it.
pub(super) fn explained(world: &Estimates, clouds: &Clouds, finding: Finding) -> Finding {
    let turn = CloudTurn::of(world, clouds, &world.limits()).ok();
    let seen = turn.and_then(|turn| Some((turn.is_up?, turn.is_right_handed()?, turn.is_loose(world, clouds))));
    match seen {
        Some((true, false, _)) => finding
            .relation("mirrored")
            .detail("The cloud is mirrored: it turns against the platform, too.")
            .help("look for a wrong sign of y (or x) or of an angle where the points are computed"),
        Some((true, true, false)) => finding
            .relation("times-reversed")
            .detail("The times of its points run backwards: by the ground its z points up, and by its turns it is not mirrored.")
            .help("make the times of the points count from the start of the scan, not from its end"),
        Some((false, true, false)) => finding
            .relation("x180")
            .detail("Its z axis points down, by the ground in the cloud; by its turns it is not mirrored.")
            .help("publish the points in axes with z up, or state in the transform that the sensor is mounted upside down"),
        _ => finding
            .detail(
                "The cloud is mirrored, its z axis points down, or the times of its points run backwards: the sweep alone does not \
                 distinguish these.",
            )
            .help(
                "look for a wrong sign of y (or x) or of an angle where the points are computed, for axes with z down, or for times that count \
                 from the end of the scan",
            ),
    }
}
