//! The order of the four numbers in recordings, by a platform that stays level while it turns.
//!
//! Owns the judgement of QUAT02 on streams. Where a gyro decides, QUAT01 does, and this is not asked.

use std::collections::BTreeMap;

use nalgebra::UnitQuaternion;

use crate::math::level::{Level, level};
use crate::math::readings::Reading;
use crate::rules::axes::sensors::{Sensor, Sensors};
use crate::rules::motion::{Imu, Motion, Stream};
use crate::rules::{Judge, limits_of, names};
use crate::source::{Place, SourceId};
use crate::verdict::{Finding, Measured, NotEvaluated};
use crate::world::motion::PoseRow;
use crate::world::{FrameId, World};

use super::quaternion_order_static::{Limits, QuaternionOrderStatic};

/// Tilts as published and in the other order.
struct Tilts {
    published: Level,
    reordered: Level,
}

/// What the tilts say.
enum Order {
    Right,
    Wrong,
    Unknown(String),
}

impl Tilts {
    fn of<I: Iterator<Item = [f64; 4]>>(slots: impl Fn() -> I, base_from_sensor: &UnitQuaternion<f64>) -> Option<Self> {
        Some(Self {
            published: level(slots(), base_from_sensor, Reading::Xyzw)?,
            reordered: level(slots(), base_from_sensor, Reading::Wxyz)?,
        })
    }

    fn of_poses(stream: &Stream<PoseRow>) -> Option<Self> {
        let slots = || stream.rows().map(|timed| timed.row.orientation);
        Self::of(slots, &UnitQuaternion::identity())
    }

    fn order(&self, limits: &Limits) -> Order {
        let degrees = |level: &Level| (level.tilt_rad.to_degrees(), level.turned_rad.to_degrees());
        let ((as_is, turned), (other, other_turned)) = (degrees(&self.published), degrees(&self.reordered));
        let rows = self.published.rows;
        if (rows as f64) < limits.min_rows {
            return Order::Unknown(format!("{rows} orientations, {} are needed", limits.min_rows));
        }
        let is_level = |tilt: f64| tilt < limits.level_deg;
        let is_tilted = |tilt: f64| tilt > limits.tilted_deg;
        if is_level(as_is) && is_tilted(other) {
            return Order::Right;
        }
        let least = self.published.least_rad.to_degrees();
        if least > 90.0 - limits.tilted_deg {
            return Order::Unknown(format!(
                "it lies on its side all the time, by {least:.0} to {as_is:.0} deg, as an optical frame does in a level one"
            ));
        }
        if is_tilted(as_is) && is_level(other) && other_turned >= limits.min_turn_deg {
            return Order::Wrong;
        }
        let tilts = format!("tilted by {as_is:.0} deg as published and by {other:.0} deg read as w x y z");
        Order::Unknown(if is_level(as_is) {
            format!("{tilts}: while the yaw stays near 0 or 180 deg (it turns by {turned:.0}) both orders are level")
        } else if is_level(other) {
            format!(
                "{tilts}, but it turns by {other_turned:.0} deg so read, {} are needed: a sensor on its side looks the same",
                limits.min_turn_deg
            )
        } else {
            format!("{tilts}: the platform is not level, or not in a world whose z is vertical")
        })
    }

    fn measured(&self, limits: &Limits) -> [Measured; 3] {
        let tilt = |what: &str, level: &Level| {
            Measured::new(what, level.tilt_rad.to_degrees(), "deg").samples(level.rows as u64)
        };
        [
            tilt("tilt as published, nine tenths", &self.published).limit(limits.tilted_deg),
            tilt("tilt read as w x y z, nine tenths", &self.reordered).limit(limits.level_deg),
            Measured::new("turned read as w x y z", self.reordered.turned_rad.to_degrees(), "deg")
                .limit(limits.min_turn_deg),
        ]
    }
}

/// Whether the orientations of a stream stand in the order w x y z, by the limits of QUAT02's page.
pub(crate) fn is_reordered(stream: &Stream<PoseRow>) -> bool {
    limits_of::<QuaternionOrderStatic>().is_some_and(|limits| {
        is_platform(stream) && Tilts::of_poses(stream).is_some_and(|tilts| matches!(tilts.order(&limits), Order::Wrong))
    })
}

/// A pose of the platform, or of another frame of the world, in the world.
fn is_platform(stream: &Stream<PoseRow>) -> bool {
    let is_level = |child: &FrameId| (names::is_base(child) || names::is_world(child)) && !names::is_sensor(child);
    stream.is_of_world() && !stream.is_earth_centred() && stream.child.as_ref().is_none_or(is_level)
}

/// Judges inertial sensors and poses.
pub(super) fn judge(world: &World, limits: &Limits, out: &mut Judge) {
    let (motion, sensors) = (Motion::of(world), Sensors::of(world));
    for (imu, sensor) in sensors.each(&motion) {
        judge_sensor(imu, sensor, limits, out);
    }
    let mut told: BTreeMap<(SourceId, FrameId, FrameId), String> = BTreeMap::new();
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
                "none of its orientations is a rotation",
            );
            continue;
        };
        let pair = stream.frame.clone().zip(stream.child.clone());
        let pair = pair.map(|(frame, child)| (stream.source, frame, child));
        let known = pair.as_ref().and_then(|pair| told.get(pair));
        if let (Order::Wrong, Some(known)) = (tilts.order(limits), known) {
            let why = format!("w stands first, as in the {known}: the same transform");
            out.not_evaluated(subject, NotEvaluated::NotApplicable, why);
            continue;
        }
        if let (Order::Wrong, Some(pair)) = (tilts.order(limits), pair) {
            told.insert(pair, subject.clone());
        }
        judge_tilts(subject, &stream.topic, stream.place(), &tilts, limits, out);
    }
}

fn judge_sensor(imu: &Imu, sensor: &Sensor, limits: &Limits, out: &mut Judge) {
    let subject = format!("order of the orientation of {}", imu.stream.subject);
    if let Some(why) = imu.no_orientation {
        return out.not_evaluated(subject, NotEvaluated::NotApplicable, why);
    }
    if sensor.turn.is_ok() {
        return out.not_evaluated(subject, NotEvaluated::NotApplicable, "QUAT01 decides it by the gyro");
    }
    let slots = || imu.stream.rows().map(|timed| timed.row.orientation);
    let Some(tilts) = Tilts::of(slots, &imu.base_from_imu()) else {
        return out.not_evaluated(
            subject,
            NotEvaluated::InputBroken,
            "none of its orientations is a rotation",
        );
    };
    if matches!(tilts.order(limits), Order::Wrong)
        && let Some(why) = sensor
            .diagnosis
            .reported_elsewhere("QUAT02", "it is level only read as w x y z")
    {
        return out.not_evaluated(subject, NotEvaluated::NotApplicable, why);
    }
    judge_tilts(subject, &imu.stream.topic, imu.stream.place(), &tilts, limits, out);
}

fn judge_tilts(subject: String, topic: &str, place: Place, tilts: &Tilts, limits: &Limits, out: &mut Judge) {
    match tilts.order(limits) {
        Order::Right => out.pass(subject, tilts.measured(limits)),
        Order::Unknown(why) => out.not_evaluated(subject, NotEvaluated::TooLittleEvidence, why),
        Order::Wrong => {
            let message = format!(
                "the {subject} is w, x, y, z: so read it stays within {:.0} deg of level while it turns by {:.0} deg, as published \
                 it is tilted by up to {:.0} deg (the inverse would be as level)",
                tilts.reordered.tilt_rad.to_degrees(),
                tilts.reordered.turned_rad.to_degrees(),
                tilts.published.tilt_rad.to_degrees(),
            );
            let finding = Finding::warning(subject, message, place)
                .likely()
                .relation("wxyz")
                .help(format!(
                    "write the four numbers on `{topic}` as x, y, z, w: the last one is the scalar"
                ));
            out.fail(tilts.measured(limits).into_iter().fold(finding, Finding::measured));
        }
    }
}
