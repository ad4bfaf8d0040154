//! Whether an orientation is level in one order of its numbers.

use nalgebra::UnitQuaternion;

use crate::analysis::{motion::Stream, names};
use crate::math::level::{Level, level};
use crate::math::readings::Reading;
use crate::verdict::Measured;
use crate::world::{FrameId, motion::PoseRow};

#[derive(Debug, serde::Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Limits {
    /// Size from which the first or the last number looks like the scalar of a small rotation.
    pub scalar: f64,
    /// A platform tilted by less is level, degrees.
    pub(crate) level_deg: f64,
    /// A platform tilted by more is not, degrees.
    pub(crate) tilted_deg: f64,
    /// How far it must turn, degrees.
    pub(crate) min_turn_deg: f64,
    /// Orientations needed.
    pub(crate) min_rows: f64,
}

/// Tilts as published and in the other order.
pub(crate) struct Tilts {
    pub(crate) published: Level,
    pub(crate) reordered: Level,
}

/// The order by the tilts.
pub(crate) enum Order {
    Right,
    Wrong,
    Unknown(String),
}

impl Tilts {
    pub(crate) fn of<I: Iterator<Item = [f64; 4]>>(
        slots: impl Fn() -> I,
        base_from_sensor: &UnitQuaternion<f64>,
    ) -> Option<Self> {
        Some(Self {
            published: level(slots(), base_from_sensor, Reading::Xyzw)?,
            reordered: level(slots(), base_from_sensor, Reading::Wxyz)?,
        })
    }

    pub(crate) fn of_poses(stream: &Stream<PoseRow>) -> Option<Self> {
        let slots = || stream.rows().map(|timed| timed.row.orientation);
        Self::of(slots, &UnitQuaternion::identity())
    }

    pub(crate) fn order(&self, limits: &Limits) -> Order {
        let degrees = |level: &Level| (level.tilt_rad.to_degrees(), level.turned_rad.to_degrees());
        let ((as_is, turned), (other, other_turned)) = (degrees(&self.published), degrees(&self.reordered));
        let rows = self.published.rows;
        if (rows as f64) < limits.min_rows {
            return Order::Unknown(format!("only {rows} orientations, {} are needed", limits.min_rows));
        }
        let is_level = |tilt: f64| tilt < limits.level_deg;
        let is_tilted = |tilt: f64| tilt > limits.tilted_deg;
        if is_level(as_is) && is_tilted(other) {
            return Order::Right;
        }
        let least = self.published.least_rad.to_degrees();
        if least > 90.0 - limits.tilted_deg {
            return Order::Unknown(format!(
                "it is on its side throughout (tilted by {least:.0} to {as_is:.0} deg), like an optical frame in a level one"
            ));
        }
        if is_tilted(as_is) && is_level(other) && other_turned >= limits.min_turn_deg {
            return Order::Wrong;
        }
        let tilts = format!("tilted by {as_is:.0} deg as published and by {other:.0} deg read as w, x, y, z");
        Order::Unknown(if is_level(as_is) {
            format!("{tilts}: with the yaw near 0 or 180 deg (it turns by {turned:.0} deg) both orders are level")
        } else if is_level(other) {
            format!(
                "{tilts}, but it rotates by only {other_turned:.0} deg in that order, {} deg are needed: a sensor on its side looks the same",
                limits.min_turn_deg
            )
        } else {
            format!("{tilts}: the platform is not level, or z of its world is not vertical")
        })
    }

    pub(crate) fn measured(&self, limits: &Limits) -> [Measured; 3] {
        let tilt = |what: &str, level: &Level| {
            Measured::new(what, level.tilt_rad.to_degrees(), "deg").samples(level.rows as u64)
        };
        [
            tilt("tilt as published (90th percentile)", &self.published).limit(limits.tilted_deg),
            tilt("tilt read as w, x, y, z (90th percentile)", &self.reordered).limit(limits.level_deg),
            Measured::new(
                "rotation read as w, x, y, z",
                self.reordered.turned_rad.to_degrees(),
                "deg",
            )
            .at_least(limits.min_turn_deg),
        ]
    }
}

/// Whether the orientations of a stream are in the order w, x, y, z.
pub(crate) fn is_reordered(stream: &Stream<PoseRow>, limits: &Limits) -> bool {
    is_platform(stream) && Tilts::of_poses(stream).is_some_and(|tilts| matches!(tilts.order(limits), Order::Wrong))
}

/// A pose of the platform, or of another frame of the world, in the world.
pub(crate) fn is_platform(stream: &Stream<PoseRow>) -> bool {
    let is_level = |child: &FrameId| (names::is_base(child) || names::is_world(child)) && !names::is_sensor(child);
    stream.is_of_world() && !stream.is_earth_centred() && stream.child.as_ref().is_none_or(is_level)
}
