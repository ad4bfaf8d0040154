//! AXES11: whether a cloud is mirrored, by its rotation compared with a gyro.

use crate::analysis::axes::cloud_turn::{CloudTurn, Limits};
use crate::analysis::lidar::Clouds;
use crate::analysis::time::sweep::{self, sweeps_the_other_way};
use crate::rules::prelude::*;

pub(crate) struct CloudMirror;

impl Rule for CloudMirror {
    const NEEDS: &'static [Need] = &[Need::Bag];
    type Limits = Limits;

    fn judge(world: &Estimates, limits: &Limits, out: &mut Judge) {
        Clouds::say_packets(world, "handedness", out);
        for clouds in Clouds::scanners(world) {
            let subject = clouds.subject("handedness");
            if !clouds.is_of_a_lidar() {
                out.not_applicable(
                    subject,
                    "not recognised as raw points of a lidar by its fields, topic or frame",
                );
                continue;
            }
            match CloudTurn::of(world, &clouds, limits) {
                Ok(turn) => judge_clouds(world, subject, &clouds, &turn, limits, out),
                Err((reason, why)) => out.not_evaluated(subject, reason, why),
            }
        }
    }
}

fn judge_clouds(
    world: &Estimates,
    subject: String,
    clouds: &Clouds,
    turn: &CloudTurn,
    limits: &Limits,
    out: &mut Judge,
) {
    let CloudTurn { beside, turned, is_up } = turn;
    let measured = [
        Measured::new("rotation of the scans over that of the gyro", turned.gain, "1").samples(turned.pairs as u64),
        Measured::new("t statistic of that factor", turned.t, "1").at_least(limits.min_t),
        Measured::new("rotation between two scans (rms)", turned.turn_deg, "deg").at_least(limits.min_turn_deg),
    ];
    let Some(is_up) = *is_up else {
        let why = format!(
            "it rotates {:+.2} times as {} does, but no visible ground shows whether its z points up, so the expected sign is unknown",
            turned.gain, beside.name
        );
        return out.too_little(subject, why);
    };
    if turn.is_right_handed() == Some(true) {
        return out.pass(subject, measured);
    }
    let (relation, what, help) = if clouds.laser.is_some() {
        (
            if is_up { "upside-down" } else { "upright" },
            "the scanner is mounted the other way up than its transform states, or its ranges are in reverse order; in one plane the two \
             are the same",
            "add a roll of 180 deg to the transform if the scanner is mounted so; if not, make its driver publish ranges in the order of \
             increasing angles (`inverted`, `flip_x_axis` or similar, once)",
        )
    } else if is_up {
        (
            "mirrored",
            "x or y has the wrong sign, or the two are swapped",
            "correct x and y in the code that converts ranges and angles to points: an angle counted in the wrong direction, or \
             left-handed axes (x, -y, z)",
        )
    } else {
        (
            "z-negated",
            "z has the wrong sign",
            "correct z in the code that converts ranges and angles to points: an upside-down sensor is rotated by 180 deg, which negates two axes",
        )
    };
    let fault = if clouds.laser.is_some() {
        "the scans are upside down or reversed"
    } else {
        "the cloud is mirrored"
    };
    let message = format!(
        "`{}`: {fault}: it turns {:+.2} times as far as {}",
        clouds.topic.topic, turned.gain, beside.name
    );
    let detail = format!(
        "{} z points {}, so {} times is expected. Probable cause: {what}.",
        if clouds.laser.is_some() {
            "By its transform,"
        } else {
            "By the ground in the cloud,"
        },
        if is_up { "up" } else { "down" },
        if is_up { "+1" } else { "-1" }
    );
    let finding = Finding::error(subject, message, clouds.place())
        .likely()
        .relation(relation)
        .detail(detail)
        .related(beside.place.clone(), "compared with this")
        .help(help);
    let finding = if relation == "mirrored" && sweeps_the_other_way(clouds, &world.limits::<sweep::Limits>()) {
        finding.detail("The points sweep in the direction of a mirrored cloud, too.")
    } else if turn.is_loose(world, clouds) {
        finding.hint()
    } else {
        finding
    };
    out.fail(finding.measured(measured));
}
