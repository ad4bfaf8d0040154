//! The entities of the frames of a world, and their names.

use std::collections::BTreeMap;
use std::rc::Rc;

use nalgebra::{Isometry3, Point3, Translation3, UnitQuaternion, Vector3};

use crate::verdict::Finding;
use crate::world::tf2::{self, Buffer};
use crate::world::{FrameId, World};

use super::scene::{Color, Content, Path, Points, Scene, narrow};
use super::upright::upright;

pub(super) const OF_LABELS: Color = [200, 200, 200];

/// The entities of the frames of a world.
pub(super) struct FrameEntities<'w> {
    world: &'w World,
    /// The transforms of the first namespace, as in tf2.
    buffer: Rc<Buffer>,
    paths: BTreeMap<FrameId, Path>,
    /// Roots by their frames: that of each component.
    root_of: BTreeMap<FrameId, FrameId>,
    /// The rotations that show trees upright, by their roots.
    turn_of: BTreeMap<FrameId, UnitQuaternion<f64>>,
    /// Length of axes, metres.
    pub(super) size_m: f32,
    /// The root of the largest tree.
    pub(super) fixed: Option<FrameId>,
    /// Frames corrected by rules, with the entities of their corrected poses.
    pub(super) candidates: Vec<(FrameId, Path)>,
}

impl<'w> FrameEntities<'w> {
    /// Nothing yet.
    pub(super) fn of(world: &'w World) -> Self {
        let namespace = world.bags.iter().flat_map(tf2::namespaces).min();
        let (buffer, _) = world.tf2(namespace.unwrap_or_default());
        Self {
            world,
            buffer: Rc::new(buffer),
            paths: BTreeMap::new(),
            root_of: BTreeMap::new(),
            turn_of: BTreeMap::new(),
            size_m: size_of_axes(world),
            fixed: None,
            candidates: Vec::new(),
        }
    }

    /// Registers the entity of a frame, in the tree of a root.
    pub(super) fn put(&mut self, frame: &FrameId, path: &Path, root: &FrameId) {
        self.paths.insert(frame.clone(), path.clone());
        self.root_of.insert(frame.clone(), root.clone());
    }

    /// Places a root: at this distance to the side, rotated to be upright. Returns the reason of the rotation, if any.
    pub(super) fn turn(
        &mut self,
        root: &FrameId,
        (path, aside_m): (&Path, f64),
        findings: &[&Finding],
        scene: &mut Scene,
    ) -> Option<String> {
        let upright = upright(self.world, root, findings);
        let aside = Translation3::new(0.0, aside_m, 0.0);
        scene.always(path, Content::Pose(Isometry3::from_parts(aside, upright.turn)));
        self.turn_of.insert(root.clone(), upright.turn);
        upright.why
    }

    /// Draws a frame that is not in a tree, with the reason.
    pub(super) fn stand_apart(
        &mut self,
        frame: &FrameId,
        (path, aside_m): (&Path, f64),
        why: &str,
        findings: &[&Finding],
        scene: &mut Scene,
    ) {
        let turned = self.turn(frame, (path, aside_m), findings, scene);
        scene.always(path, Content::Axes(self.size_m));
        let why: Vec<&str> = [Some(why), turned.as_deref()].into_iter().flatten().collect();
        let label = format!("{frame} ({})", why.join("; "));
        scene.always(path, label_at(&Vector3::zeros(), label, self.size_m, OF_LABELS));
        self.put(frame, path, frame);
    }

    /// The height of a point of a tree's root in the view, metres.
    pub(super) fn height_m(&self, root: &FrameId, in_root: &Point3<f64>) -> f64 {
        self.turn_of.get(root).map_or(in_root.z, |turn| (turn * in_root).z)
    }

    /// The entity of a frame.
    pub(super) fn path(&self, frame: &FrameId) -> Option<&Path> {
        self.paths.get(&frame.canonical())
    }

    /// Whether a frame is another, or below it.
    pub(super) fn stands_beneath(&self, frame: &FrameId, above: &FrameId) -> bool {
        let paths = self.path(frame).zip(self.path(above));
        paths.is_some_and(|(path, above)| path.is_in(above))
    }

    /// Answers look-ups between frames.
    pub(super) fn buffer(&self) -> &Rc<Buffer> {
        &self.buffer
    }

    /// The world whose frames they are.
    pub(super) fn world(&self) -> &'w World {
        self.world
    }

    /// The root of the tree of a frame.
    pub(super) fn root(&self, frame: &FrameId) -> Option<&FrameId> {
        self.root_of.get(&frame.canonical())
    }
}

/// A third of the usual distance of rigid frames, metres.
fn size_of_axes(world: &World) -> f32 {
    let edges = world.graph().edges.iter().filter(|edge| edge.is_rigid);
    let mut lengths: Vec<f64> = edges
        .filter_map(|edge| Some(edge.pose?.translation.vector.norm()))
        .filter(|length| length.is_finite() && *length > 1e-3)
        .collect();
    lengths.sort_by(f64::total_cmp);
    let usual = lengths.get(lengths.len() / 2).copied().unwrap_or(1.0);
    (usual / 3.0).clamp(0.02, 0.5) as f32
}

/// The end of the x, y or z axis, in turn.
pub(super) fn axis(turn: usize, size_m: f32) -> Vector3<f64> {
    let ends = [Vector3::x(), Vector3::y(), Vector3::z()];
    ends.get(turn % 3).copied().unwrap_or_default() * f64::from(size_m) * 1.1
}

/// A label at a place.
pub(super) fn label_at(at: &Vector3<f64>, label: String, size_m: f32, color: Color) -> Content {
    Content::Points(Points {
        xyz_m: vec![narrow(at)],
        colors: vec![color],
        radius: size_m / 20.0,
        labels: vec![label],
    })
}
