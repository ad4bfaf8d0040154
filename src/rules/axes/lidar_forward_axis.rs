//! AXES12: direction of a lidar's x axis, by its direction of motion.

use crate::advice::places::with_mounting;
use crate::analysis::axes::forward::{Limits, Yaw, look};
use crate::analysis::{hand_eye::HandEye, lidar::Clouds, sensor::lidar_turn, sensor::lidar_turn::Origin};
use crate::math::circular::difference;
use crate::rules::prelude::*;

pub(crate) struct LidarForwardAxis;

impl Rule for LidarForwardAxis {
    const NEEDS: &'static [Need] = &[Need::Bag];
    type Limits = Limits;

    fn judge(world: &Estimates, limits: &Limits, out: &mut Judge) {
        Clouds::say_packets(world, "forward", out);
        for clouds in Clouds::scanners(world) {
            match look(world, &clouds, limits) {
                Ok((yaw, known)) => judge_yaw(world, &clouds, &known, &yaw, limits, out),
                Err((reason, why)) => out.not_evaluated(clouds.subject("forward"), reason, why),
            }
        }
    }
}

/// The cause of a quarter turn.
const OTHER_DRIVER: &str =
    "the transform was made for another driver (some drivers publish azimuth 0 along y, others along x)";

fn judge_yaw(world: &Estimates, clouds: &Clouds, known: &HandEye, yaw: &Yaw, limits: &Limits, out: &mut Judge) {
    let subject = clouds.subject("forward");
    let measured = yaw.measured(limits);
    if yaw.off_deg.abs() <= limits.pass_deg {
        return out.pass(subject, measured);
    }
    let off_deg = yaw.off_deg.abs();
    if off_deg <= limits.pass_deg + 2.0 * yaw.error_deg {
        let why = format!(
            "the mounting is missing a yaw of {off_deg:.1} +- {:.1} deg, {} deg are allowed",
            yaw.error_deg, limits.pass_deg
        );
        return out.too_little(subject, why);
    }
    let direction = crate::analysis::cross::direction::direction_fit(world, clouds);
    let quarters = yaw.quarters(limits);
    let (relation, what) = match quarters {
        Some(1) => ("z90", OTHER_DRIVER),
        Some(-1) => ("z-90", OTHER_DRIVER),
        Some(2 | -2) => (
            "z180",
            "the transform is that of a sensor that faces forward, but this sensor faces backward",
        ),
        _ => ("yaw", "the transform states another yaw than the sensor has"),
    };
    let error_rad = (limits.pass_deg + 2.0 * yaw.error_deg).to_radians();
    let or = crate::analysis::cross::direction::doubt(
        direction.as_ref(),
        &known.stated,
        yaw.off_deg.to_radians(),
        error_rad,
    );
    let (_, _, stated_rad) = known.stated.rotation.euler_angles();
    let stated_deg = stated_rad.to_degrees();
    // A rotation with a name is meant to be exact.
    let missing_deg = quarters.map_or(yaw.off_deg, |quarters| {
        90.0 * f64::from(quarters).abs().copysign(yaw.off_deg)
    });
    let missing = if quarters.is_some() {
        format!("{missing_deg:+.0} deg")
    } else {
        format!("{missing_deg:+.1} deg")
    };
    let message = format!(
        "`{}` -> `{}` is missing a yaw of {missing}, by the scans on `{}`",
        known.body, known.lidar, clouds.topic.topic
    );
    let side = if relation == "z180" {
        "opposite to".to_owned()
    } else {
        let side = if yaw.off_deg > 0.0 { "right" } else { "left" };
        format!("{off_deg:.0} deg to the {side} of")
    };
    let detail = format!(
        "With this transform, the scans show a motion {side} that of {}. Probable cause: {what}{or}.",
        known.poses.0
    );
    let finding = if off_deg > limits.error_deg {
        Finding::error(subject, message, clouds.place())
    } else {
        Finding::warning(subject, message, clouds.place())
    };
    let finding = finding
        .likely()
        .relation(relation)
        .detail(detail)
        .related(known.poses.1.clone(), "compared with this motion")
        .help(format!(
            "change the yaw of `{}` -> `{}` from {stated_deg:.1} deg to {:.1} deg, and keep roll, pitch and translation",
            known.body,
            known.lidar,
            difference(stated_deg.to_radians() + missing_deg.to_radians(), 0.0).to_degrees()
        ))
        .unless(codes::CROSS04);
    let origin = quarters.and_then(|quarters| lidar_turn::origin(world, clouds, known, quarters));
    let finding = match origin {
        Some(Origin::OusterFrame) => finding.unless(codes::SENSOR01),
        Some(Origin::OusterTf) => finding.unless_about(codes::SENSOR02, format!("`{}`", known.lidar)),
        Some(Origin::OusterMounting) => finding.unless(codes::SENSOR03),
        Some(Origin::Driver) => finding.unless(codes::SENSOR04),
        None => finding,
    };
    let mounting = [&known.body, &known.lidar];
    let finding = clouds.once_per_lidar(world, finding.measured(measured));
    out.fail(with_mounting(world, mounting, finding));
}
