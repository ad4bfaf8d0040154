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
            .detail("The cloud is mirrored: its surroundings also turn in the wrong direction when the platform turns.")
            .help("correct the sign of y (or x), or of the azimuth, where the points are computed"),
        Some((true, true, false)) => finding
            .relation("times-reversed")
            .detail(
                "The times of the points run backwards. Excluded causes: z pointing down (the ground is below the sensor), and a mirrored \
                 cloud (its surroundings turn in the right direction when the platform turns).",
            )
            .help("publish the time of each point as (duration of a scan) - (time published now)"),
        Some((false, true, false)) => finding
            .relation("x180")
            .detail("The z axis of the cloud points down, by the ground in the cloud. The cloud is not mirrored, by the turns of the platform.")
            .help("publish the points in axes with z up, or state in the transform that the sensor is mounted upside down"),
        _ => finding
            .detail(
                "The cloud is mirrored, its z axis points down, or the times of its points run backwards. The sweep alone does not \
                 distinguish these causes.",
            )
            .help(
                "correct the driver or the converter of the points, by the cause:\n(1) mirrored cloud: correct the sign of y (or x), or of \
                 the azimuth, where the points are computed\n(2) z down: publish the points in axes with z up, or state in the transform \
                 that the sensor is mounted upside down\n(3) times that run backwards: publish the time of each point as (duration of a \
                 scan) - (time published now)",
            ),
    }
}
