//! The frame graph: parents and children by URDF joints and by TF.
//!
//! Names are compared as tf2 stores them (one leading slash stripped). Calibration claims are not edges: they are
//! compared with the graph. The transforms that a launch file publishes are edges of the tree that it starts, together with the joints: see
//! [`FrameGraph::launched`].

use std::collections::{BTreeMap, BTreeSet, VecDeque};

use std::sync::OnceLock;

use nalgebra::Isometry3;

use crate::source::SourceId;

use super::World;
use super::bag::{BagEvidence, TfEdge};
use super::claim::{Claim, ClaimKind};
use super::frame::{FrameId, FrameRole};
use super::frame_words::{is_moving_part, is_world};
use super::rigid::Rigid;

/// The statement from which an edge comes.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum EdgeOrigin {
    /// Index into `World::claims`: the origin of a URDF joint.
    Joint(usize),
    /// Index into `World::claims`: what a launch file or a script publishes.
    Published(usize),
    /// Index into `World::bags` and into its `tf`.
    Tf(usize, usize),
}

impl EdgeOrigin {
    /// The recording, and its transform; `None` for claims.
    pub fn recorded(self, world: &World) -> Option<(&BagEvidence, &TfEdge)> {
        let Self::Tf(bag, edge) = self else { return None };
        let bag = world.bags.get(bag)?;
        Some((bag, bag.tf.get(edge)?))
    }
}

/// One stated edge `parent_from_child`.
#[derive(Clone, Debug, PartialEq)]
pub struct Edge {
    /// Parent frame, canonical.
    pub parent: FrameId,
    /// Child frame, canonical.
    pub child: FrameId,
    /// The statement.
    pub origin: EdgeOrigin,
    /// Whether the edge is constant: a fixed joint, static TF, or TF of one value that is none of a joint or of a world.
    pub is_rigid: bool,
    /// `parent_from_child`, where known: for moving edges the zero position or the first sample.
    pub pose: Option<Isometry3<f64>>,
}

impl Edge {
    /// The claim that states the edge; `None` for recorded TF.
    pub fn claim<'w>(&self, world: &'w World) -> Option<&'w Claim> {
        match self.origin {
            EdgeOrigin::Joint(index) | EdgeOrigin::Published(index) => world.claims.get(index),
            EdgeOrigin::Tf(..) => None,
        }
    }

    /// The source that states it.
    pub fn source(&self, world: &World) -> Option<SourceId> {
        match self.origin {
            EdgeOrigin::Tf(bag, _) => world.bags.get(bag).map(|bag| bag.source),
            EdgeOrigin::Joint(_) | EdgeOrigin::Published(_) => self.claim(world).map(|claim| claim.place.source),
        }
    }

    /// Whether a launch file or a script publishes it.
    pub fn is_published(&self) -> bool {
        matches!(self.origin, EdgeOrigin::Published(_))
    }
}

/// A set of frames connected by edges.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Component {
    /// Frames without a parent; empty in a pure cycle.
    pub roots: Vec<FrameId>,
    /// All frames, sorted.
    pub members: BTreeSet<FrameId>,
}

/// One step of a chain.
#[derive(Clone, Debug, PartialEq)]
pub struct Step {
    /// Index into [`FrameGraph::edges`].
    pub edge: usize,
    /// Whether the step goes from parent to child (the edge's own direction in `target_from_source`).
    pub forward: bool,
}

/// All edges together.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct FrameGraph {
    /// Edges, sorted by child, parent and origin.
    pub edges: Vec<Edge>,
    /// Every frame, links without joints among them.
    pub frames: BTreeSet<FrameId>,
    by_child: BTreeMap<FrameId, Vec<usize>>,
    by_parent: BTreeMap<FrameId, Vec<usize>>,
    rigid: OnceLock<Rigid>,
}

impl FrameGraph {
    /// The frames that are rigid with each other; computed at first use.
    pub fn rigid(&self) -> &Rigid {
        self.rigid
            .get_or_init(|| Rigid::new(&self.frames, |frame| self.reach(frame, |edge| edge.is_rigid)))
    }

    /// Collects the edges of a world: joints and recorded TF.
    pub fn new(world: &World) -> Self {
        Self::recorded(world, Self::stated(world, |_| false))
    }

    /// Joints, recorded TF, and all that launch files publish.
    pub fn whole(world: &World) -> Self {
        Self::recorded(world, Self::stated(world, |_| true))
    }

    /// The edges of recordings only: the tree that tf2 had.
    pub fn of_recordings(world: &World) -> Self {
        let recorded = Self::recorded(world, Vec::new());
        let frames = recorded
            .by_child
            .keys()
            .chain(recorded.by_parent.keys())
            .cloned()
            .collect();
        Self { frames, ..recorded }
    }

    /// With the edges of recorded TF.
    fn recorded(world: &World, mut edges: Vec<Edge>) -> Self {
        let joints: BTreeMap<FrameId, bool> = (world.claims.iter())
            .filter_map(|claim| match claim.kind {
                ClaimKind::Joint { fixed, .. } => Some((claim.source_frame()?.canonical(), fixed)),
                ClaimKind::File { .. } => None,
            })
            .collect();
        for (bag_index, bag) in world.bags.iter().enumerate() {
            let has_joint_states = bag.has_joint_states();
            for (index, tf) in bag.tf.iter().enumerate() {
                let (parent, child) = (tf.parent.canonical(), tf.child.canonical());
                // A joint that is held, and a world that was not corrected, have one value, too.
                let is_fixed = || match joints.get(&child) {
                    Some(is_fixed) => *is_fixed,
                    None => {
                        !has_joint_states && ![&parent, &child].into_iter().any(is_world) && !is_moving_part(&child)
                    }
                };
                edges.push(Edge {
                    is_rigid: tf.is_static || tf.is_repeated() && is_fixed(),
                    parent,
                    child,
                    origin: EdgeOrigin::Tf(bag_index, index),
                    pose: tf.first().map(|sample| sample.pose.isometry()),
                });
            }
        }
        Self::of(world, edges)
    }

    /// The tree that each launch file or script starts: its publishers and the joints of the platform. Two files are two ways to start the platform.
    pub fn launched(world: &World) -> Vec<Self> {
        let files: BTreeSet<SourceId> = world
            .publishers
            .iter()
            .map(|publisher| publisher.place.source)
            .collect();
        let tree = |file: &SourceId| Self::of(world, Self::stated(world, |claim| claim.place.source == *file));
        files.iter().map(tree).collect()
    }

    /// Joints, and those of the published transforms that are wanted.
    fn stated(world: &World, is_wanted: impl Fn(&Claim) -> bool) -> Vec<Edge> {
        let mut edges = Vec::new();
        for (index, claim) in world.claims.iter().enumerate() {
            let (origin, is_rigid) = match claim.kind {
                ClaimKind::Joint { fixed, .. } => (EdgeOrigin::Joint(index), fixed),
                _ if claim.is_published() && is_wanted(claim) => (EdgeOrigin::Published(index), true),
                ClaimKind::File { .. } => continue,
            };
            if let Some((parent, child)) = &claim.frames {
                edges.push(Edge {
                    parent: parent.canonical(),
                    child: child.canonical(),
                    origin,
                    is_rigid,
                    pose: claim.pose.as_ref().map(super::Pose::isometry),
                });
            }
        }
        edges
    }

    fn of(world: &World, mut edges: Vec<Edge>) -> Self {
        edges.sort_by(|a, b| (&a.child, &a.parent, a.origin).cmp(&(&b.child, &b.parent, b.origin)));
        let mut frames: BTreeSet<FrameId> = world
            .frames
            .iter()
            .filter(|used| used.role == FrameRole::Link)
            .map(|used| used.frame.canonical())
            .collect();
        let mut by_child: BTreeMap<FrameId, Vec<usize>> = BTreeMap::new();
        let mut by_parent: BTreeMap<FrameId, Vec<usize>> = BTreeMap::new();
        for (index, edge) in edges.iter().enumerate() {
            frames.insert(edge.parent.clone());
            frames.insert(edge.child.clone());
            by_child.entry(edge.child.clone()).or_default().push(index);
            by_parent.entry(edge.parent.clone()).or_default().push(index);
        }
        Self {
            edges,
            frames,
            by_child,
            by_parent,
            rigid: OnceLock::new(),
        }
    }

    /// Edges that state a parent of `child`.
    pub fn edges_to(&self, child: &FrameId) -> impl Iterator<Item = &Edge> {
        self.by_child
            .get(child)
            .into_iter()
            .flatten()
            .filter_map(|index| self.edges.get(*index))
    }

    /// Edges that state a child of `parent`.
    pub fn edges_from(&self, parent: &FrameId) -> impl Iterator<Item = &Edge> {
        self.by_parent
            .get(parent)
            .into_iter()
            .flatten()
            .filter_map(|index| self.edges.get(*index))
    }

    /// The different parents stated for `child`, sorted.
    pub fn parents_of(&self, child: &FrameId) -> BTreeSet<&FrameId> {
        self.edges_to(child).map(|edge| &edge.parent).collect()
    }

    /// Frames without a parent, sorted.
    pub fn roots(&self) -> Vec<&FrameId> {
        self.frames
            .iter()
            .filter(|frame| !self.by_child.contains_key(*frame))
            .collect()
    }

    /// Connected components, the largest first, then by name.
    pub fn components(&self) -> Vec<Component> {
        let mut seen: BTreeSet<&FrameId> = BTreeSet::new();
        let mut components = Vec::new();
        for start in &self.frames {
            if seen.contains(start) {
                continue;
            }
            let mut members = BTreeSet::new();
            let mut queue = VecDeque::from([start]);
            seen.insert(start);
            while let Some(frame) = queue.pop_front() {
                members.insert(frame.clone());
                let up = self.by_child.get(frame).into_iter().flatten();
                let down = self.by_parent.get(frame).into_iter().flatten();
                for edge in up.chain(down).filter_map(|index| self.edges.get(*index)) {
                    for next in [&edge.parent, &edge.child] {
                        if seen.insert(next) {
                            queue.push_back(next);
                        }
                    }
                }
            }
            let roots = members
                .iter()
                .filter(|frame| !self.by_child.contains_key(*frame))
                .cloned()
                .collect();
            components.push(Component { roots, members });
        }
        components.sort_by(|a, b| (b.members.len(), a.members.first()).cmp(&(a.members.len(), b.members.first())));
        components
    }

    /// A shortest chain of edges from `target` to `source` over the edges that `usable` admits, with every pose known:
    /// the composed `target_from_source` and its steps. `None` where there is no such chain.
    pub fn chain(
        &self,
        target: &FrameId,
        source: &FrameId,
        usable: impl Fn(&Edge) -> bool,
    ) -> Option<(Isometry3<f64>, Vec<Step>)> {
        let start = self.frames.get(target)?;
        let came_from = self.search(start, Some(source), usable);
        let mut steps = Vec::new();
        let mut at = self.frames.get(source)?;
        while at != start {
            let (previous, step) = came_from.get(at)?;
            steps.push(step.clone());
            at = previous;
        }
        steps.reverse();
        let mut target_from_source = Isometry3::identity();
        for step in &steps {
            target_from_source *= self.pose_of(step)?;
        }
        Some((target_from_source, steps))
    }

    /// All frames that a shortest chain of edges connects with `target`, over the edges that `usable` admits, with every pose known: itself,
    /// and `target_from_frame` of each. As [`FrameGraph::chain`] finds them one by one.
    pub fn reach<'a>(&'a self, target: &FrameId, usable: impl Fn(&Edge) -> bool) -> Vec<(&'a FrameId, Isometry3<f64>)> {
        let Some(start) = self.frames.get(target) else {
            return Vec::new();
        };
        let mut next_of: BTreeMap<&FrameId, Vec<(&FrameId, Step)>> = BTreeMap::new();
        for (frame, (previous, step)) in self.search(start, None, usable) {
            next_of.entry(previous).or_default().push((frame, step));
        }
        let mut reached = Vec::new();
        let mut stack = vec![(start, Isometry3::identity())];
        while let Some((frame, target_from_frame)) = stack.pop() {
            for (next, step) in next_of.remove(frame).into_iter().flatten() {
                if let Some(pose) = self.pose_of(&step) {
                    stack.push((next, target_from_frame * pose));
                }
            }
            reached.push((frame, target_from_frame));
        }
        reached
    }

    /// `here_from_there` of a step, where `there` is farther from the start.
    fn pose_of(&self, step: &Step) -> Option<Isometry3<f64>> {
        let parent_from_child = self.edges.get(step.edge)?.pose?;
        Some(if step.forward {
            parent_from_child
        } else {
            parent_from_child.inverse()
        })
    }

    /// From which frame, and by which step, each frame is reached, the nearest first; it ends where `until` is reached.
    fn search<'a>(
        &'a self,
        start: &'a FrameId,
        until: Option<&FrameId>,
        usable: impl Fn(&Edge) -> bool,
    ) -> BTreeMap<&'a FrameId, (&'a FrameId, Step)> {
        let mut came_from: BTreeMap<&FrameId, (&FrameId, Step)> = BTreeMap::new();
        let mut queue = VecDeque::from([start]);
        while let Some(frame) = queue.pop_front() {
            if Some(frame) == until {
                break;
            }
            let down = self.by_parent.get(frame).into_iter().flatten().map(|i| (*i, true));
            let up = self.by_child.get(frame).into_iter().flatten().map(|i| (*i, false));
            for (index, forward) in down.chain(up) {
                let Some(edge) = self.edges.get(index) else { continue };
                if edge.pose.is_none() || !usable(edge) {
                    continue;
                }
                let next = if forward { &edge.child } else { &edge.parent };
                if next != start && !came_from.contains_key(next) {
                    came_from.insert(next, (frame, Step { edge: index, forward }));
                    queue.push_back(next);
                }
            }
        }
        came_from
    }

    /// Cycles in the parent relation: each as its frames, from the smallest name on.
    pub fn cycles(&self) -> Vec<Vec<FrameId>> {
        let mut cycles: BTreeSet<Vec<FrameId>> = BTreeSet::new();
        let mut done: BTreeSet<&FrameId> = BTreeSet::new();
        for start in &self.frames {
            self.walk_up(start, &mut done, &mut cycles);
        }
        cycles.into_iter().collect()
    }

    fn walk_up<'a>(
        &'a self,
        start: &'a FrameId,
        done: &mut BTreeSet<&'a FrameId>,
        cycles: &mut BTreeSet<Vec<FrameId>>,
    ) {
        // An explicit stack: chains may be tens of thousands of frames long.
        let mut stack: Vec<(&'a FrameId, bool)> = vec![(start, false)];
        let mut path: Vec<&'a FrameId> = Vec::new();
        let mut positions: BTreeMap<&'a FrameId, usize> = BTreeMap::new();
        while let Some((frame, leaving)) = stack.pop() {
            if leaving {
                path.pop();
                positions.remove(frame);
                done.insert(frame);
                continue;
            }
            if let Some(position) = positions.get(frame) {
                let mut cycle: Vec<FrameId> = path.iter().skip(*position).map(|f| (*f).clone()).collect();
                let smallest = cycle.iter().enumerate().min_by(|a, b| a.1.cmp(b.1));
                let smallest = smallest.map_or(0, |(index, _)| index);
                cycle.rotate_left(smallest);
                cycles.insert(cycle);
                continue;
            }
            if done.contains(frame) {
                continue;
            }
            positions.insert(frame, path.len());
            path.push(frame);
            stack.push((frame, true));
            for parent in self.parents_of(frame) {
                if parent != frame {
                    stack.push((parent, false));
                }
            }
        }
    }
}
