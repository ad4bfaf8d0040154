//! AXES11: whether a cloud is mirrored, by its rotation compared with a gyro.

use crate::advice::places::with_mounting;
use crate::analysis::axes::cloud_turn::{CloudTurn, Limits};
use crate::analysis::time::sweep::{self, sweeps_the_other_way};
use crate::analysis::{lidar::Clouds, motion::mount::mount};
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
                let why = "not recognised as raw points of a lidar by its fields, topic or frame";
                out.not_applicable(subject, why);
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
        Measured::new("rotation of the scans / rotation of the reference", turned.gain, "1")
            .samples(turned.pairs as u64),
        Measured::new("t statistic of that ratio", turned.t, "1").at_least(limits.min_t),
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
    let reference = beside.name.trim_start_matches("topic ");
    let (z, mounted, expected) = if is_up {
        ("up", "upside down", "+1")
    } else {
        ("down", "upright", "-1")
    };
    let by_transform =
        format!("By the transforms, z of the scanner points {z}. In one plane, the causes below look the same.");
    let look = format!(
        "look at the scanner, then:\n\
         (1) if the scanner is mounted {mounted}, add a roll of 180 deg to its mounting transform\n\
         (2) if the ranges are in reverse order, make the driver publish them in the order of increasing angles (an option such as `inverted`)\n\
         (3) if neither, correct the sign of {reference}: its yaw must increase in a turn to the left"
    );
    let by_ground = |cause: &str| format!("By the ground in the cloud, z points {z}. Probable cause: {cause}.");
    let (relation, fault, detail, help) = if clouds.laser.is_some() {
        (
            if is_up { "upside-down" } else { "upright" },
            "scan is upside down or reversed",
            by_transform,
            look.as_str(),
        )
    } else if is_up {
        (
            "mirrored",
            "cloud is mirrored",
            by_ground("x or y has the wrong sign, or x and y are swapped"),
            "look at a cloud with known objects in front and to the left, and correct the code that makes points:\n(1) left appears right: negate \
             y\n(2) front appears behind: negate x\n(3) front appears left: exchange x and y",
        )
    } else {
        (
            "z-negated",
            "cloud is mirrored",
            by_ground("z has the wrong sign"),
            "in the code that converts ranges and angles to points, do not negate z alone: for a sensor that is upside down, negate y and z",
        )
    };
    let message = format!(
        "`{}`: {fault}: it turns {:+.2} times as far as {reference}, expected {expected}",
        clouds.topic.topic, turned.gain
    );
    let finding = Finding::error(subject, message, clouds.place())
        .likely()
        .relation(relation)
        .detail(detail)
        .related(beside.place.clone(), "compared with this rotation")
        .help(help);
    let mounting = clouds.frame().filter(|_| clouds.laser.is_some());
    let mounting = mounting.and_then(|frame| Some((mount(world, &frame)?.base, frame)));
    let finding = match mounting {
        Some((base, frame)) => with_mounting(world, [&base, &frame], finding),
        None => finding,
    };
    let finding = if relation == "mirrored" && sweeps_the_other_way(clouds, &world.limits::<sweep::Limits>()) {
        finding.detail("The points also sweep in the direction of a mirrored cloud.")
    } else if turn.is_loose(world, clouds) {
        finding.hint()
    } else {
        finding
    };
    out.fail(clouds.once_per_lidar(world, finding.measured(measured)));
}
