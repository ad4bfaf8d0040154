//! The mounting of a sensor: its pose on the platform's base, by URDF and static TF.

use std::collections::BTreeMap;

use nalgebra::{Isometry3, UnitQuaternion, Vector3};

use crate::analysis::{names, names::Standard};
use crate::math::constants::AxisTurn;
use crate::world::conventions::{BodyAxes, Subject, WorldAxes};
use crate::world::{FrameId, World};

/// A sensor's mounting on its platform.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Mount {
    /// The platform's base frame, canonical.
    pub(crate) base: FrameId,
    /// `base_from_sensor`.
    pub(crate) base_from_sensor: Isometry3<f64>,
    /// Whether the sensor's frame is the base itself.
    pub(crate) is_base: bool,
}

impl Mount {
    /// Whether z of the sensor's frame points down.
    pub(crate) fn is_upside_down(&self) -> bool {
        (self.base_from_sensor.rotation * Vector3::z()).z < 0.0
    }
}

/// The rotation of a base into forward, left, up: the identity, unless the configuration or the name declares FRD or NED axes.
pub(crate) fn flu_from_base(world: &World, base: &FrameId) -> UnitQuaternion<f64> {
    let declared = world.conventions.of(&Subject {
        frames: &[base],
        ..Subject::default()
    });
    let convention = declared.map(|declared| declared.convention).unwrap_or_default();
    let is_down = match (convention.body, convention.world) {
        (Some(body), _) => body == BodyAxes::Frd,
        (None, Some(world)) => world == WorldAxes::Ned,
        (None, None) => base.has_token("frd") || base.has_token("ned"),
    };
    if is_down {
        AxisTurn::FluFrd.quaternion()
    } else {
        UnitQuaternion::identity()
    }
}

/// The mounting of every frame with a rigid chain to a base: `base_link` or `base_footprint` of its tree, else a frame with the name of a
/// base, else one that odometry moves.
pub(crate) struct Mounts(BTreeMap<FrameId, Mount>);

impl Mounts {
    /// Of all frames of the platform.
    pub(crate) fn of(world: &World) -> Self {
        let mut mounts: BTreeMap<FrameId, Mount> = BTreeMap::new();
        for base in bases(world) {
            if mounts.contains_key(base) {
                continue;
            }
            for (frame, base_from_sensor) in world.graph().reach(base, |edge| edge.is_rigid) {
                mounts.entry(frame.clone()).or_insert_with(|| Mount {
                    base: base.clone(),
                    base_from_sensor,
                    is_base: base == frame,
                });
            }
        }
        Self(mounts)
    }

    /// The mounting of the sensor with this frame.
    pub(crate) fn get(&self, sensor: &FrameId) -> Option<Mount> {
        if is_standard(sensor) {
            return Some(Mount {
                base: sensor.clone(),
                base_from_sensor: Isometry3::identity(),
                is_base: true,
            });
        }
        self.0.get(sensor).cloned()
    }
}

/// The mounting of one sensor; see [`Mounts`].
pub(crate) fn mount(world: &World, sensor: &FrameId) -> Option<Mount> {
    Mounts::of(world).get(sensor)
}

/// The frame of the platform on which a moving transform carries another one: of a turret, an arm, a gimbal, a trailer. `None` for what is fixed to
/// its platform, however that moves in the world.
pub(crate) fn carrier(world: &World, frame: &FrameId) -> Option<FrameId> {
    let graph = world.graph();
    let fixed = graph.reach(frame, |edge| edge.is_rigid).into_iter();
    let mut moving = fixed
        .flat_map(|(frame, _)| graph.edges_to(frame))
        .filter(|edge| !edge.is_rigid);
    let is_carried = |parent: &FrameId, child: &FrameId| {
        !(names::is_world(parent) || names::is_base(parent) && names::is_base(child))
    };
    moving
        .find(|edge| is_carried(&edge.parent, &edge.child))
        .map(|edge| edge.parent.clone())
}

/// Whether two frames move each by itself: TF moves each in the world, and nothing fixed connects them. Two robots of one recording do.
pub(crate) fn are_apart(world: &World, one: &FrameId, other: &FrameId) -> bool {
    let graph = world.graph();
    let fixed = graph.reach(one, |edge| edge.is_rigid);
    if fixed.iter().any(|(frame, _)| *frame == other) {
        return false;
    }
    let moves = |(frame, _): &(&FrameId, Isometry3<f64>)| {
        let mut moving = graph.edges_to(frame).filter(|edge| !edge.is_rigid);
        moving.any(|edge| names::is_world(&edge.parent))
    };
    fixed.iter().any(moves) && graph.reach(other, |edge| edge.is_rigid).iter().any(moves)
}

fn is_standard(frame: &FrameId) -> bool {
    names::standard(frame).is_some_and(|(_, kind)| kind == Standard::Base)
}

/// Candidates for the base, the best first.
fn bases(world: &World) -> impl Iterator<Item = &FrameId> {
    let graph = world.graph();
    let standard = graph.frames.iter().filter(|frame| is_standard(frame));
    let named = graph
        .frames
        .iter()
        .filter(|frame| !is_standard(frame) && names::is_base(frame) && !names::is_device(frame));
    let topics = world.bags.iter().flat_map(|bag| bag.topics.values());
    let odometry = topics.filter(|topic| topic.type_name() == "Odometry");
    let moved = odometry.flat_map(|topic| topic.child_frames.keys());
    let moved = moved
        .filter(|frame| !names::is_device(frame))
        .filter_map(|frame| graph.frames.get(&frame.canonical()));
    standard.chain(named).chain(moved)
}
