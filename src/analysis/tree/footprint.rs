//! The pose of `base_footprint` relative to `base_link`, and to level frames.
//!
//! Must not judge.

use nalgebra::{Isometry3, Vector3};
use serde::Deserialize;

use crate::analysis::{names, names::Standard};
use crate::source::Place;
use crate::world::graph::{Edge, EdgeOrigin};
use crate::world::{FrameId, World};

/// The pose of `base_link` in `base_footprint`.
pub(crate) struct Mount {
    /// Yaw of the base in its footprint, degrees, without sign.
    pub(crate) yaw_deg: f64,
    /// How far the base is below, metres; negative above.
    pub(crate) below_m: f64,
    /// Where it is stated.
    pub(crate) place: Place,
}

impl Mount {
    fn new(footprint_from_base: &Isometry3<f64>, place: Place) -> Self {
        let ahead = footprint_from_base.rotation * Vector3::x();
        Self {
            yaw_deg: ahead.y.atan2(ahead.x).to_degrees().abs(),
            below_m: -footprint_from_base.translation.z,
            place,
        }
    }

    /// How far beyond the limits it is.
    pub(crate) fn rank(&self, limits: &Limits) -> f64 {
        (self.yaw_deg / limits.max_yaw_deg).max(self.below_m / limits.max_below_m)
    }
}

/// What is stated between the two frames: all samples of transforms, and fixed joints; else the rigid chain between them.
pub(crate) fn mounts(world: &World, footprint: &FrameId, base: &FrameId) -> Vec<Mount> {
    let graph = world.graph();
    let down = graph
        .edges_to(base)
        .filter(|edge| edge.parent == *footprint)
        .map(|edge| (edge, false));
    let up = graph
        .edges_to(footprint)
        .filter(|edge| edge.parent == *base)
        .map(|edge| (edge, true));
    let mut mounts = Vec::new();
    for (edge, is_inverse) in down.chain(up) {
        for (pose, place) in samples(world, edge) {
            mounts.push(Mount::new(&if is_inverse { pose.inverse() } else { pose }, place));
        }
    }
    if mounts.is_empty()
        && let Some((pose, steps)) = graph.chain(footprint, base, |edge| edge.is_rigid)
    {
        let place = steps
            .first()
            .and_then(|step| crate::analysis::places::of_numbers(world, graph.edges.get(step.edge)?));
        mounts.extend(place.map(|place| Mount::new(&pose, place)));
    }
    mounts
}

/// The values of an edge: the samples of a transform, or the origin of a fixed joint.
fn samples(world: &World, edge: &Edge) -> Vec<(Isometry3<f64>, Place)> {
    match edge.origin {
        EdgeOrigin::Joint(_) | EdgeOrigin::Published(_) => {
            let fixed = edge
                .pose
                .filter(|_| edge.is_rigid)
                .zip(crate::analysis::places::of_numbers(world, edge));
            fixed.into_iter().collect()
        }
        EdgeOrigin::Tf(..) => {
            let recorded = edge.origin.recorded(world).into_iter();
            let samples = recorded.flat_map(|(bag, tf)| tf.samples.iter().map(move |sample| (bag.source, sample)));
            samples
                .map(|(source, sample)| (sample.pose.isometry(), Place::message(source, sample.at.clone())))
                .collect()
        }
    }
}

/// A moving transform from a level frame to the footprint, or to a frame that carries it rigidly.
pub(crate) struct LevelPath<'a> {
    /// The moving transform.
    pub(crate) edge: &'a Edge,
    /// Angle between the two verticals, degrees, at each sample.
    pub(crate) tilts: Vec<(f64, Place)>,
}

/// All such transforms of a world.
pub(crate) fn level_paths<'a>(world: &'a World, footprint: &FrameId, namespace: &str) -> Vec<LevelPath<'a>> {
    let is_level = |frame: &FrameId| match names::standard(frame) {
        Some((space, Standard::Map | Standard::Odom)) => space == namespace || space.is_empty(),
        Some(_) => false,
        None => frame.as_str() == "world",
    };
    let graph = world.graph();
    let moving = graph.edges.iter().filter(|edge| {
        matches!(edge.origin, EdgeOrigin::Tf(..)) && !edge.is_rigid && is_level(&edge.parent) && !is_level(&edge.child)
    });
    let path = |edge: &'a Edge| {
        let carried = if edge.child == *footprint {
            Isometry3::identity()
        } else {
            graph.chain(&edge.child, footprint, |edge| edge.is_rigid)?.0
        };
        let tilt = |pose: &Isometry3<f64>| {
            ((pose * carried).rotation * Vector3::z())
                .angle(&Vector3::z())
                .to_degrees()
        };
        let tilts: Vec<_> = samples(world, edge)
            .into_iter()
            .map(|(pose, place)| (tilt(&pose), place))
            .collect();
        (!tilts.is_empty()).then_some(LevelPath { edge, tilts })
    };
    moving.filter_map(path).collect()
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Limits {
    /// Limit of the tilt in a level frame (95th percentile), degrees.
    pub max_tilt_deg: f64,
    /// Tilt that 95 of 100 samples exceed where one of the frames is upside down, degrees.
    pub upside_down_deg: f64,
    /// Yaw between `base_footprint` and `base_link`, degrees.
    pub max_yaw_deg: f64,
    /// How far `base_link` may be below, metres.
    pub max_below_m: f64,
    /// How far the lowest points of the wheels may be from the ground, metres.
    pub max_ground_m: f64,
    /// How far the lowest points of wheels that stand on the ground may differ, metres.
    pub same_wheels_m: f64,
}
