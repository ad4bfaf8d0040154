//! Optical frames: what the rotation of one is compared with.
//!
//! Must not judge.

use nalgebra::UnitQuaternion;

use crate::analysis::names;
use crate::world::FrameId;
use crate::world::graph::{Edge, FrameGraph};

/// The parent of an optical frame, or the camera's own link.
pub(crate) struct Mount<'a> {
    /// The parent.
    pub(crate) parent: &'a FrameId,
    /// Whether the parent is the camera's own link, by name.
    pub(crate) is_sibling: bool,
    /// Its rotation.
    pub(crate) parent_from_optical: UnitQuaternion<f64>,
    /// The edge itself, where the parent is the direct one.
    pub(crate) edge: Option<&'a Edge>,
}

/// The camera's own link if it is rigidly connected, else the direct parents.
pub(crate) fn mounts<'a>(graph: &'a FrameGraph, frame: &FrameId, stem: &[String]) -> Vec<Mount<'a>> {
    let is_sibling = |other: &FrameId| {
        !stem.is_empty() && names::optical_stem(other).is_none() && names::without_ending(other.tokens()) == stem
    };
    let direct = |edge: &'a Edge| {
        let parent_from_optical = edge.pose?.rotation;
        Some(Mount {
            parent: &edge.parent,
            is_sibling: is_sibling(&edge.parent),
            parent_from_optical,
            edge: Some(edge),
        })
    };
    let above: Vec<Mount> = graph
        .edges_to(frame)
        .filter(|edge| edge.is_rigid)
        .filter_map(direct)
        .collect();
    if above.iter().any(|mount| mount.is_sibling) {
        return above.into_iter().filter(|mount| mount.is_sibling).collect();
    }
    let far = graph.frames.iter().filter(|other| is_sibling(other)).find_map(|other| {
        let (other_from_optical, _) = graph.chain(other, frame, |edge| edge.is_rigid)?;
        let parent_from_optical = other_from_optical.rotation;
        Some(Mount {
            parent: other,
            is_sibling: true,
            parent_from_optical,
            edge: None,
        })
    });
    far.map_or(above, |mount| vec![mount])
}
