//! The quaternion order in recordings, by a platform that stays level while it turns.
//!
//! Owns the judgement of QUAT02 on streams, except where a gyro decides.

use crate::analysis::Estimates;
use crate::analysis::quat::level::{Order, Tilts, is_platform};
use std::collections::BTreeMap;

use crate::advice::diagnosis::defer;
use crate::analysis::axes::sensors::{Sensor, Sensors};
use crate::analysis::motion::{Imu, Motion};
use crate::source::{Place, SourceId};
use crate::verdict::Judge;
use crate::verdict::{Finding, NotEvaluated};
use crate::world::FrameId;

use crate::analysis::quat::level::Limits;
use crate::rules::codes;

/// Judges inertial sensors and poses.
pub(crate) fn judge(world: &Estimates, limits: &Limits, out: &mut Judge) {
    let (motion, sensors) = (Motion::of(world), Sensors::of(world));
    for (imu, sensor) in sensors.each(&motion) {
        judge_sensor(imu, sensor, limits, out);
    }
    let mut reported: BTreeMap<(SourceId, FrameId, FrameId), String> = BTreeMap::new();
    for stream in motion
        .bags
        .iter()
        .flat_map(|bag| &bag.poses)
        .filter(|stream| is_platform(stream))
    {
        let subject = format!("order of the orientation of {}", stream.subject);
        let Some(tilts) = Tilts::of_poses(stream) else {
            out.not_evaluated(
                subject,
                NotEvaluated::InputBroken,
                "none of its orientations is a valid quaternion",
            );
            continue;
        };
        let pair = stream.frame.clone().zip(stream.child.clone());
        let pair = pair.map(|(frame, child)| (stream.source, frame, child));
        let known = pair.as_ref().and_then(|pair| reported.get(pair));
        if let (Order::Wrong, Some(known)) = (tilts.order(limits), known) {
            let same = |finding: Finding| finding.same_cause_as(known);
            judge_tilts(subject, &stream.topic, stream.place(), &tilts, same, limits, out);
            continue;
        }
        if let (Order::Wrong, Some(pair)) = (tilts.order(limits), pair) {
            reported.insert(pair, subject.clone());
        }
        judge_tilts(
            subject,
            &stream.topic,
            stream.place(),
            &tilts,
            |finding| finding,
            limits,
            out,
        );
    }
}

fn judge_sensor(imu: &Imu, sensor: &Sensor, limits: &Limits, out: &mut Judge) {
    let subject = format!("order of the orientation of {}", imu.stream.subject);
    if let Some(why) = imu.no_orientation {
        return out.not_applicable(subject, why);
    }
    if sensor.turn.is_ok() {
        return out.not_applicable(subject, "its gyro decides the order");
    }
    let slots = || imu.stream.rows().map(|timed| timed.row.orientation);
    let Some(tilts) = Tilts::of(slots, &imu.base_from_imu()) else {
        return out.not_evaluated(
            subject,
            NotEvaluated::InputBroken,
            "none of its orientations is a valid quaternion",
        );
    };
    let better = |finding| defer(&sensor.diagnosis, imu, None, finding).unless(codes::AXES03);
    judge_tilts(
        subject,
        &imu.stream.topic,
        imu.stream.place(),
        &tilts,
        better,
        limits,
        out,
    );
}

fn judge_tilts(
    subject: String,
    topic: &str,
    place: Place,
    tilts: &Tilts,
    better: impl FnOnce(Finding) -> Finding,
    limits: &Limits,
    out: &mut Judge,
) {
    match tilts.order(limits) {
        Order::Right => out.pass(subject, tilts.measured(limits)),
        Order::Unknown(why) => out.too_little(subject, why),
        Order::Wrong => {
            let message = format!(
                "`{topic}`: quaternion is in the order w, x, y, z (tilt {:.0} deg as published)",
                tilts.published.tilt_rad.to_degrees(),
            );
            let detail = format!(
                "Read as w, x, y, z, the tilt is {:.0} deg, while the orientation rotates by {:.0} deg.",
                tilts.reordered.tilt_rad.to_degrees(),
                tilts.reordered.turned_rad.to_degrees(),
            );
            let finding = Finding::warning(subject, message, place)
                .likely()
                .relation("wxyz")
                .detail(detail)
                .help(format!(
                    "publish the quaternion on `{topic}` as x, y, z, w (scalar last), then check that yaw increases in a left turn"
                ));
            out.fail(better(finding.measured(tilts.measured(limits))));
        }
    }
}
