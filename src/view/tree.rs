//! Frames as axes at their poses over time, each below its parent; unconnected trees are placed apart.

use std::collections::{BTreeMap, BTreeSet};
use std::rc::Rc;

use nalgebra::{Isometry3, Vector3};

use crate::source::SourceId;
use crate::verdict::Finding;
use crate::world::graph::{Edge, EdgeOrigin};
use crate::world::tf2::Buffer;
use crate::world::{FrameId, World};

use super::claims::{beside, claims, name, of_messages, preferred};
use super::placed::{FrameEntities, OF_LABELS, axis, label_at};
use super::scene::{Color, Content, Lines, Path, Scene, narrow};

/// Maximum number of shown samples of a moving edge.
const MAX_STEPS: usize = 3000;

/// Metres; only frames on the Earth with poses relative to its centre are farther from their parent.
const FAR_M: f64 = 1e6;

const OF_LINKS: Color = [110, 110, 120];

/// Draws the frames of a world below `top`. `events_ns` are timestamps at which something is shown: poses are exact then.
pub(super) fn frames<'w>(
    world: &'w World,
    findings: &[&Finding],
    (top, events_ns): (&Path, &BTreeSet<i64>),
    scene: &mut Scene,
) -> FrameEntities<'w> {
    let graph = world.graph();
    let mut components = graph.components();
    components.sort_by_key(|component| std::cmp::Reverse(component.members.len()));
    let mut placed = FrameEntities::of(world);
    let buffer = Rc::clone(placed.buffer());
    let mut aside_m = 0.0;
    for (number, component) in components.iter().enumerate() {
        let Some(root) = component.roots.first().or_else(|| component.members.first()) else {
            continue;
        };
        if number == 0 {
            placed.fixed = Some(root.clone());
        }
        let path = top.then(root.as_str());
        let turned = placed.turn(root, (&path, aside_m), findings, scene);
        let why = [
            (number > 0).then(|| "not connected to the other frames".to_owned()),
            graph
                .edges_from(root)
                .any(is_far)
                .then(|| "shown here instead of its true, distant position".to_owned()),
            turned,
        ];
        let why: Vec<String> = why.into_iter().flatten().collect();
        let mut drawing = Drawing {
            placed: &mut placed,
            buffer: &buffer,
            events_ns,
            root: root.clone(),
            said_by: BTreeMap::new(),
            first_far: None,
            scene,
        };
        drawing.frame(root, &path, None, &why.join(", "));
        drawing.children(root, &path);
        // A second root of one component, and frames on a cycle.
        for member in &component.members {
            if drawing.placed.path(member).is_none() {
                let path = top.then(member.as_str());
                drawing
                    .scene
                    .always(&path, Content::Pose(Isometry3::translation(0.0, aside_m, 0.0)));
                drawing.frame(member, &path, None, "not connected to a root");
                drawing.children(member, &path);
            }
        }
        aside_m += 2.0 + f64::from(placed.size_m) * 8.0;
    }
    claims(&mut placed, findings, (top, &mut aside_m), scene);
    preferred(&mut placed, findings, scene);
    of_messages(&mut placed, findings, (top, aside_m), scene);
    placed
}

struct Drawing<'a, 'w> {
    placed: &'a mut FrameEntities<'w>,
    buffer: &'a Buffer,
    events_ns: &'a BTreeSet<i64>,
    root: FrameId,
    /// The source of poses.
    said_by: BTreeMap<FrameId, SourceId>,
    /// The first frame that is far from its parent, with its pose.
    first_far: Option<Isometry3<f64>>,
    scene: &'a mut Scene,
}

impl Drawing<'_, '_> {
    /// The axes and the label of a frame.
    fn frame(&mut self, frame: &FrameId, path: &Path, edge: Option<&Edge>, remark: &str) {
        self.placed.put(frame, path, &self.root);
        let said_by = edge.and_then(|edge| edge.source(self.placed.world()));
        // The source is shown only if it differs from that of the parent frame.
        let above = edge.and_then(|edge| self.said_by.get(&edge.parent).copied());
        let is_named = said_by.is_some() && said_by != above && self.placed.world().members.len() > 1;
        self.said_by.extend(said_by.map(|id| (frame.clone(), id)));
        let said_by = said_by.filter(|_| is_named).map(|id| name(self.placed.world(), id));
        let declared = self.placed.world().conventions.of(&crate::world::conventions::Subject {
            file: "",
            topic: None,
            frames: &[frame],
        });
        let convention = declared.map(|declared| declared.convention.words());
        let parts = [
            said_by,
            convention,
            Some(remark.to_owned()).filter(|words| !words.is_empty()),
        ];
        let parts: Vec<String> = parts.into_iter().flatten().collect();
        let label = if parts.is_empty() {
            frame.to_string()
        } else {
            format!("{frame} ({})", parts.join("; "))
        };
        let size_m = self.placed.size_m;
        self.scene.always(path, Content::Axes(size_m));
        // Names of frames at one place are shown at the ends of different axes.
        let is_at_parent = |pose: Isometry3<f64>| pose.translation.vector.norm() < f64::from(size_m) / 2.0;
        let at = edge.and_then(|edge| edge.pose).filter(|pose| is_at_parent(*pose));
        let at = at.map_or_else(Vector3::zeros, |_| axis(path.names().len(), size_m));
        self.scene.always(path, label_at(&at, label, size_m, OF_LABELS));
    }

    fn children(&mut self, parent: &FrameId, path: &Path) {
        let mut stack = vec![(parent.clone(), path.clone())];
        while let Some((parent, path)) = stack.pop() {
            let graph = self.placed.world().graph();
            let mut of_child: BTreeMap<&FrameId, Vec<&Edge>> = BTreeMap::new();
            for edge in graph.edges_from(&parent) {
                of_child.entry(&edge.child).or_default().push(edge);
            }
            for (child, edges) in of_child {
                if self.placed.path(child).is_some() {
                    continue;
                }
                // As in tf2: published transforms count, and move.
                let by_tf = |edge: &&&Edge| matches!(edge.origin, EdgeOrigin::Tf(..));
                let first = edges.iter().find(by_tf).or(edges.first());
                let Some(main) = first.copied() else { continue };
                let own = path.then(child.as_str());
                self.frame(child, &own, Some(main), "");
                self.pose(main, &own);
                for other in edges
                    .iter()
                    .filter(|other| other.origin != main.origin && other.is_rigid)
                {
                    let said = other
                        .source(self.placed.world())
                        .map(|id| name(self.placed.world(), id));
                    let other = (other.pose, said.unwrap_or_default());
                    beside(
                        main.pose.filter(|_| main.is_rigid),
                        other,
                        (child, &path),
                        self.placed.size_m,
                        self.scene,
                    );
                }
                stack.push((child.clone(), own));
            }
        }
    }

    /// The pose of a frame in its parent: once, or at every sample. A frame on the Earth is shown relative to the first such frame instead:
    /// the Earth's centre is too far away, and its axes are upright nowhere.
    fn pose(&mut self, edge: &Edge, path: &Path) {
        if edge.is_rigid {
            let Some(pose) = edge.pose else { return };
            let pose = if is_far(edge) {
                let first = *self.first_far.get_or_insert(pose);
                first.inv_mul(&pose)
            } else {
                pose
            };
            self.scene.always(path, Content::Pose(pose));
            let back = pose.inverse();
            self.scene.always(
                path,
                Content::Lines(Lines {
                    strips_m: vec![vec![[0.0; 3], narrow(&back.translation.vector)]],
                    color: OF_LINKS,
                    radius: -1.0,
                    labels: Vec::new(),
                }),
            );
            return;
        }
        let Some((_, published)) = edge.origin.recorded(self.placed.world()) else {
            self.scene
                .always(path, Content::Pose(edge.pose.unwrap_or_else(Isometry3::identity)));
            return;
        };
        let samples = &published.samples;
        let step = samples.len().div_ceil(MAX_STEPS).max(1);
        let mut poses: BTreeMap<i64, Isometry3<f64>> = BTreeMap::new();
        for sample in samples.iter().step_by(step) {
            poses.insert(sample.at.stamp_ns.unwrap_or(sample.at.log_ns), sample.pose.isometry());
        }
        for at_ns in self.events_ns {
            let found = self.buffer.lookup(edge.parent.as_str(), edge.child.as_str(), *at_ns);
            if let Ok(found) = found {
                poses.insert(*at_ns, found.target_from_source);
            }
        }
        for (stamp_ns, pose) in poses {
            self.scene.at(path, stamp_ns, Content::Pose(pose));
        }
    }
}

fn is_far(edge: &Edge) -> bool {
    edge.is_rigid && edge.pose.is_some_and(|pose| pose.translation.vector.norm() > FAR_M)
}
