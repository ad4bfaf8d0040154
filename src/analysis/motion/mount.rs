//! The mounting of a sensor: its pose on the platform's base, by URDF and static TF.

use std::collections::BTreeMap;

use nalgebra::{Isometry3, Vector3};

use crate::analysis::{names, names::Standard};
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
