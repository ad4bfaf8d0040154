//! Frames as axes at their poses over time, each beneath its parent; what other sources say of the same pair beside it, with the
//! difference; what is not connected set apart.

use std::collections::{BTreeMap, BTreeSet};

use nalgebra::{Isometry3, Translation3, UnitQuaternion, Vector3};

use crate::source::{Source, SourceId};
use crate::verdict::Finding;
use crate::world::graph::{Edge, EdgeOrigin};
use crate::world::{Claim, ClaimKind, FrameId, World};

use super::scene::{Color, Lines, Path, Points, Scene, What, narrow};
use super::upright::upright;

/// Differences below these are none to look at: those of TREE11's rounding.
const SAME_DEG: f64 = 0.05;
const SAME_M: f64 = 1e-3;
/// Steps of one moving edge that are shown.
const MAX_STEPS: usize = 3000;

/// Metres; farther from its parent is no frame but those that stand on the Earth and are told from its centre.
const FAR_M: f64 = 1e6;

const OF_LABELS: Color = [200, 200, 200];
const OF_LINKS: Color = [110, 110, 120];
pub(super) const OF_PREFERRED: Color = [110, 220, 130];
const OF_DIFFERENCES: Color = [235, 60, 60];

/// Where the frames of a world stand in the tree of entities.
pub(super) struct Placed<'w> {
    /// The number of the world.
    pub(super) number: usize,
    world: &'w World,
    paths: BTreeMap<FrameId, Path>,
    /// Roots by their frames: that of each component.
    root_of: BTreeMap<FrameId, FrameId>,
    /// Length of axes, metres.
    pub(super) size_m: f32,
    /// The frame beneath which most stand.
    pub(super) fixed: Option<FrameId>,
    /// Where rules would have frames instead: the frame, and the entity that stands there.
    pub(super) candidates: Vec<(FrameId, Path)>,
}

impl Placed<'_> {
    /// The entity of a frame.
    pub(super) fn path(&self, frame: &FrameId) -> Option<&Path> {
        self.paths.get(&frame.canonical())
    }

    /// Whether a frame is another, or stands beneath it.
    pub(super) fn stands_beneath(&self, frame: &FrameId, above: &FrameId) -> bool {
        let paths = self.path(frame).zip(self.path(above));
        paths.is_some_and(|(path, above)| path.is_in(above))
    }

    /// The world whose frames they are.
    pub(super) fn world(&self) -> &World {
        self.world
    }

    /// The root of the tree that a frame stands in.
    pub(super) fn root(&self, frame: &FrameId) -> Option<&FrameId> {
        self.root_of.get(&frame.canonical())
    }
}

/// Draws the frames of a world beneath `top`. `events_ns` are stamps at which something is shown: frames stand exactly right then.
pub(super) fn frames<'w>(
    world: &'w World,
    findings: &[&Finding],
    (top, events_ns): (&Path, &BTreeSet<i64>),
    scene: &mut Scene,
) -> Placed<'w> {
    let sources = world.sources.as_slice();
    let graph = world.graph();
    let mut components = graph.components();
    components.sort_by_key(|component| std::cmp::Reverse(component.members.len()));
    let mut placed = Placed {
        number: 0,
        world,
        paths: BTreeMap::new(),
        root_of: BTreeMap::new(),
        size_m: size_of_axes(world),
        fixed: None,
        candidates: Vec::new(),
    };
    let namespaces: BTreeSet<&str> = world.bags.iter().flat_map(crate::world::tf2::namespaces).collect();
    let namespace = namespaces.first().copied().unwrap_or_default();
    let (buffer, _) = world.tf2(namespace);
    let mut aside_m = 0.0;
    for (number, component) in components.iter().enumerate() {
        let Some(root) = component.roots.first().or_else(|| component.members.first()) else {
            continue;
        };
        if number == 0 {
            placed.fixed = Some(root.clone());
        }
        let upright = upright(world, root, findings);
        let path = top.then(root.as_str());
        scene.always(
            &path,
            What::Pose(Isometry3::from_parts(
                Translation3::new(0.0, aside_m, 0.0),
                upright.turn,
            )),
        );
        let why = [
            (number > 0).then(|| "not connected to the others".to_owned()),
            graph
                .edges_from(root)
                .any(is_far)
                .then(|| "its own place is far away".to_owned()),
            (!upright.why.is_empty()).then_some(upright.why),
        ];
        let why: Vec<String> = why.into_iter().flatten().collect();
        let mut drawing = Drawing {
            placed: &mut placed,
            sources,
            buffer: &buffer,
            events_ns,
            root: root.clone(),
            said_by: BTreeMap::new(),
            first_far: None,
            scene,
        };
        drawing.frame(root, &path, None, &why.join(", "));
        drawing.children(root, &path);
        // A second root of one component, and what only a loop leads to.
        for member in &component.members {
            if drawing.placed.path(member).is_none() {
                let path = top.then(member.as_str());
                drawing
                    .scene
                    .always(&path, What::Pose(Isometry3::translation(0.0, aside_m, 0.0)));
                drawing.frame(member, &path, None, "not connected beneath a root");
                drawing.children(member, &path);
            }
        }
        aside_m += 2.0 + f64::from(placed.size_m) * 8.0;
    }
    claims(&mut placed, sources, (top, &mut aside_m), scene);
    preferred(&mut placed, findings, scene);
    of_messages(&mut placed, (top, aside_m), scene);
    placed
}

struct Drawing<'a, 'w> {
    placed: &'a mut Placed<'w>,
    sources: &'a [Source],
    buffer: &'a crate::world::tf2::Buffer,
    events_ns: &'a BTreeSet<i64>,
    root: FrameId,
    /// Who says where frames are.
    said_by: BTreeMap<FrameId, SourceId>,
    /// The first frame that stands far from its parent, as it stands there.
    first_far: Option<Isometry3<f64>>,
    scene: &'a mut Scene,
}

impl Drawing<'_, '_> {
    /// The axes and the label of a frame.
    fn frame(&mut self, frame: &FrameId, path: &Path, edge: Option<&Edge>, remark: &str) {
        self.placed.paths.insert(frame.clone(), path.clone());
        self.placed.root_of.insert(frame.clone(), self.root.clone());
        let said_by = edge.and_then(|edge| source_of(self.placed.world, edge));
        // What the source of the frame above says, too, need not be told of each.
        let above = edge.and_then(|edge| self.said_by.get(&edge.parent).copied());
        let is_told = said_by.is_some() && said_by != above && self.placed.world.members.len() > 1;
        self.said_by.extend(said_by.map(|id| (frame.clone(), id)));
        let said_by = said_by.filter(|_| is_told).map(|id| name(self.sources, id));
        let declared = self.placed.world.conventions.of(&crate::world::conventions::Subject {
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
        self.scene.always(path, What::Axes(size_m));
        // Names of frames that stand in one place are read at the ends of different axes.
        let is_at_parent = |pose: Isometry3<f64>| pose.translation.vector.norm() < f64::from(size_m) / 2.0;
        let at = edge.and_then(|edge| edge.pose).filter(|pose| is_at_parent(*pose));
        let at = at.map_or_else(Vector3::zeros, |_| axis(path.names().len(), size_m));
        self.scene.always(path, label_at(&at, label, size_m, OF_LABELS));
    }

    fn children(&mut self, parent: &FrameId, path: &Path) {
        let mut stack = vec![(parent.clone(), path.clone())];
        while let Some((parent, path)) = stack.pop() {
            let graph = self.placed.world.graph();
            let mut of_child: BTreeMap<&FrameId, Vec<&Edge>> = BTreeMap::new();
            for edge in graph.edges_from(&parent) {
                of_child.entry(&edge.child).or_default().push(edge);
            }
            for (child, edges) in of_child {
                if self.placed.path(child).is_some() {
                    continue;
                }
                // As tf2 has it: what is published counts, and moves.
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
                    let said = source_of(self.placed.world, other).map(|id| name(self.sources, id));
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

    /// Where a frame stands in its parent: once, or at every step. What stands on the Earth stands about the first of it instead: its
    /// centre is too far to be seen, and its axes are upright nowhere.
    fn pose(&mut self, edge: &Edge, path: &Path) {
        if edge.is_rigid {
            let Some(pose) = edge.pose else { return };
            let pose = if is_far(edge) {
                let first = *self.first_far.get_or_insert(pose);
                first.inv_mul(&pose)
            } else {
                pose
            };
            self.scene.always(path, What::Pose(pose));
            let back = pose.inverse();
            self.scene.always(
                path,
                What::Lines(Lines {
                    strips_m: vec![vec![[0.0; 3], narrow(&back.translation.vector)]],
                    color: OF_LINKS,
                    radius: -1.0,
                    labels: Vec::new(),
                }),
            );
            return;
        }
        let EdgeOrigin::Tf(bag, index) = edge.origin else {
            self.scene
                .always(path, What::Pose(edge.pose.unwrap_or_else(Isometry3::identity)));
            return;
        };
        let published = self.placed.world.bags.get(bag).and_then(|bag| bag.tf.get(index));
        let samples = published.map(|edge| edge.samples.as_slice()).unwrap_or_default();
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
            self.scene.at(path, stamp_ns, What::Pose(pose));
        }
    }
}

fn is_far(edge: &Edge) -> bool {
    edge.is_rigid && edge.pose.is_some_and(|pose| pose.translation.vector.norm() > FAR_M)
}

/// The end of the x, y or z axis by turns.
fn axis(turn: usize, size_m: f32) -> Vector3<f64> {
    let ends = [Vector3::x(), Vector3::y(), Vector3::z()];
    ends.get(turn % 3).copied().unwrap_or_default() * f64::from(size_m) * 1.1
}

fn label_at(at: &Vector3<f64>, label: String, size_m: f32, color: Color) -> What {
    What::Points(Points {
        xyz_m: vec![narrow(at)],
        colors: vec![color],
        radius: size_m / 20.0,
        labels: vec![label],
    })
}

/// The same frame as another source has it, and how far that is from where it stands.
fn beside(
    main: Option<Isometry3<f64>>,
    (other, said_by): (Option<Isometry3<f64>>, String),
    (frame, parent): (&FrameId, &Path),
    size_m: f32,
    scene: &mut Scene,
) {
    let Some(other) = other else { return };
    let own = parent.then(format!("{frame} by {said_by}"));
    scene.always(&own, What::Pose(other));
    scene.always(&own, What::Axes(size_m * 0.7));
    let apart = main.map(|main| main.inverse() * other);
    let differs = apart.map(|apart| (apart.rotation.angle().to_degrees(), apart.translation.vector.norm()));
    if differs.is_some_and(|(deg, m)| deg <= SAME_DEG && m <= SAME_M) {
        // The name of the frame stands there already.
        return;
    }
    let label = format!("{frame} by {said_by}");
    scene.always(&own, label_at(&axis(1, size_m * 0.7), label, size_m, OF_LABELS));
    let Some((main, (deg, m))) = main.zip(differs) else {
        return;
    };
    // A turn about one point has no length: it is shown by where a point before the frame goes.
    let reach = Vector3::x() * f64::from(size_m);
    let tip = |pose: &Isometry3<f64>| narrow(&(pose.translation.vector + pose.rotation * reach));
    let (origin, others) = (narrow(&main.translation.vector), narrow(&other.translation.vector));
    scene.always(
        &own.then("~ difference"),
        // In the frame of the other source itself.
        What::Lines(Lines {
            strips_m: [[origin, others], [tip(&main), tip(&other)]]
                .into_iter()
                .map(|ends| ends.map(|end| inside(&other, end)).to_vec())
                .collect(),
            color: OF_DIFFERENCES,
            radius: size_m / 30.0,
            labels: vec![format!("{deg:.2} deg, {m:.3} m apart"), String::new()],
        }),
    );
}

fn inside(parent_from_own: &Isometry3<f64>, in_parent: [f32; 3]) -> [f32; 3] {
    let point = nalgebra::Point3::from(in_parent.map(f64::from));
    narrow(&parent_from_own.inverse_transform_point(&point).coords)
}

/// What calibration files say of frames of the tree, and of others.
fn claims(placed: &mut Placed, sources: &[Source], (top, aside_m): (&Path, &mut f64), scene: &mut Scene) {
    let world = placed.world;
    let of_file = |claim: &&Claim| matches!(claim.kind, ClaimKind::File { .. });
    for claim in world.claims.iter().filter(of_file) {
        let (Some((target, source)), Some(pose)) = (&claim.frames, &claim.pose) else {
            continue;
        };
        let (target, source, pose) = (target.canonical(), source.canonical(), pose.isometry());
        let said_by = name(sources, claim.place.source);
        let known = (placed.path(&target).cloned(), placed.path(&source).cloned());
        let (parent, frame, stated) = match known {
            (Some(path), _) => (path, source.clone(), pose),
            (None, Some(path)) => (path, target.clone(), pose.inverse()),
            (None, None) => {
                *aside_m += 2.0;
                let path = top.then(target.as_str());
                let turned = UnitQuaternion::identity();
                let place = Isometry3::from_parts(Translation3::new(0.0, *aside_m, 0.0), turned);
                scene.always(&path, What::Pose(place));
                scene.always(&path, What::Axes(placed.size_m));
                let label = format!("{target} ({said_by}; not in the tree)");
                scene.always(&path, label_at(&Vector3::zeros(), label, placed.size_m, OF_LABELS));
                placed.paths.insert(target.clone(), path.clone());
                placed.root_of.insert(target.clone(), target.clone());
                (path, source.clone(), pose)
            }
        };
        let other_end = if frame == source { &target } else { &source };
        let chain = world.graph().chain(other_end, &frame, |edge| edge.is_rigid);
        let main = chain.map(|(pose, _)| pose);
        let own = parent.then(format!("{frame} by {said_by}"));
        beside(main, (Some(stated), said_by), (&frame, &parent), placed.size_m, scene);
        if placed.path(&frame).is_none() {
            placed.paths.insert(frame.clone(), own);
            let root = placed.root(other_end).cloned().unwrap_or_else(|| other_end.clone());
            placed.root_of.insert(frame, root);
        }
    }
}

/// Where rules would have frames instead.
fn preferred(placed: &mut Placed, findings: &[&Finding], scene: &mut Scene) {
    for finding in findings {
        let Some(prefers) = &finding.prefers else { continue };
        let Some(parent) = placed.path(&FrameId::new(prefers.target.as_str())).cloned() else {
            continue;
        };
        let label = format!("{} as {} would have it", prefers.source, finding.rule);
        let own = parent.then(label.clone());
        scene.always(&own, What::Pose(prefers.pose));
        scene.always(&own, What::Axes(placed.size_m * 0.7));
        scene.always(
            &own,
            label_at(&axis(2, placed.size_m * 0.7), label, placed.size_m, OF_PREFERRED),
        );
        let frame = FrameId::new(prefers.source.as_str()).canonical();
        placed.candidates.push((frame, own));
    }
}

/// Frames that only headers of messages name: nothing says where they are.
fn of_messages(placed: &mut Placed, (top, aside_m): (&Path, f64), scene: &mut Scene) {
    let topics = placed.world.bags.iter().flat_map(|bag| bag.topics.values());
    let named: BTreeSet<FrameId> = topics
        .flat_map(|topic| {
            topic
                .said()
                .flat_map(|said| said.header_frames.keys())
                .collect::<Vec<_>>()
        })
        .map(FrameId::canonical)
        .filter(|frame| !frame.as_str().is_empty())
        .collect();
    let lost = named.into_iter().filter(|frame| placed.path(frame).is_none());
    for (number, frame) in lost.collect::<Vec<_>>().into_iter().enumerate() {
        let path = top.then(frame.as_str());
        let place = Isometry3::translation(0.0, aside_m + 2.0 * (number as f64 + 1.0), 0.0);
        scene.always(&path, What::Pose(place));
        scene.always(&path, What::Axes(placed.size_m));
        let label = format!("{frame} (in messages; no transform leads to it)");
        scene.always(&path, label_at(&Vector3::zeros(), label, placed.size_m, OF_LABELS));
        placed.root_of.insert(frame.clone(), frame.clone());
        placed.paths.insert(frame, path);
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

fn source_of(world: &World, edge: &Edge) -> Option<SourceId> {
    match edge.origin {
        EdgeOrigin::Joint(index) => world.claims.get(index).map(|claim| claim.place.source),
        EdgeOrigin::Tf(bag, _) => world.bags.get(bag).map(|bag| bag.source),
    }
}

/// The last part of a source's path.
fn name(sources: &[Source], id: SourceId) -> String {
    let path = sources.get(id.0 as usize).map_or("", |source| source.path.as_str());
    let path = path.strip_suffix("/metadata.yaml").unwrap_or(path);
    path.rsplit('/').next().unwrap_or(path).to_owned()
}
