//! Transforms of TF that are missing, or published between other frames.

use std::collections::BTreeSet;

use crate::faults::literals::of_edge;
use crate::faults::subject::constant_edges;
use crate::faults::{Change, Subject, SubjectPlace};
use crate::source::Place;
use crate::world::bag::{ParentSwitch, TfEdge, TfSample};
use crate::world::{BagEvidence, FrameId, FrameRole, FrameUse, World};

/// A mistake in what is published.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum TfMistake {
    /// It is not published.
    Missing,
    /// It is published below another frame, too.
    SecondParent,
    /// The root of the tree is published below it.
    Loop,
    /// Its parent is its child.
    OwnParent,
    /// Its parent is its child, and its child its parent.
    Exchanged,
}

impl Change for TfMistake {
    fn subjects(&self, world: &World) -> Vec<Subject> {
        // What moves has mistakes of its own.
        let edges = constant_edges(world).into_iter().filter(|([bag, _], edge)| {
            let counts = || world.bags.get(*bag).is_some_and(|bag| self.counts(world, bag, edge));
            edge.parent.canonical() != edge.child.canonical() && counts()
        });
        edges.map(|(at, edge)| of_edge(at, edge)).collect()
    }

    fn apply(&self, world: &mut World, subject: &Subject) -> bool {
        let SubjectPlace::Edge { bag, edge } = subject.at else {
            return false;
        };
        let Some(evidence) = world.bags.get_mut(bag) else {
            return false;
        };
        let Some(old) = evidence.tf.get(edge).cloned() else {
            return false;
        };
        let between = |parent: &FrameId, child: &FrameId| TfEdge {
            parent: parent.clone(),
            child: child.clone(),
            ..old.clone()
        };
        match self {
            Self::Missing => drop(evidence.tf.remove(edge)),
            Self::OwnParent => {
                evidence.tf.remove(edge);
                evidence.tf.push(between(&old.child, &old.child));
            }
            Self::Exchanged => {
                evidence.tf.remove(edge);
                evidence.tf.push(between(&old.child, &old.parent));
            }
            Self::SecondParent => {
                let Some(other) = other_parent(evidence, &old) else {
                    return false;
                };
                add(evidence, &old, &other, &old.child);
            }
            Self::Loop => {
                let root = root_above(evidence, &old.parent);
                add(evidence, &old, &old.child, &root);
            }
        }
        settle(world, bag, &old);
        true
    }
}

impl TfMistake {
    /// Whether it makes a difference to data.
    fn counts(self, world: &World, bag: &BagEvidence, edge: &TfEdge) -> bool {
        let pair = |edge: &TfEdge| (edge.parent.canonical(), edge.child.canonical());
        let is_elsewhere = || {
            let edges = world.bags.iter().flat_map(|bag| &bag.tf);
            edges.filter(|other| pair(other) == pair(edge)).count() > 1
        };
        match self {
            Self::Missing => !is_elsewhere() && carries_data(bag, &edge.child.canonical()),
            Self::SecondParent => other_parent(bag, edge).is_some(),
            _ => true,
        }
    }
}

/// A frame and all below it, by the TF of a recording.
fn below(bag: &BagEvidence, frame: &FrameId) -> BTreeSet<FrameId> {
    let mut found = BTreeSet::from([frame.clone()]);
    loop {
        let next = bag.tf.iter().filter(|edge| found.contains(&edge.parent.canonical()));
        let next: Vec<FrameId> = next.map(|edge| edge.child.canonical()).collect();
        let before = found.len();
        found.extend(next);
        if found.len() == before {
            return found;
        }
    }
}

/// Whether messages are expressed in a frame or in one below it.
fn carries_data(bag: &BagEvidence, frame: &FrameId) -> bool {
    let found = below(bag, frame);
    let mut frames = bag.topics.values().flat_map(|topic| topic.header_frames.keys());
    frames.any(|frame| found.contains(&frame.canonical()))
}

fn parent_of(bag: &BagEvidence, child: &FrameId) -> Option<FrameId> {
    let edge = bag.tf.iter().find(|edge| edge.child.canonical() == *child)?;
    Some(edge.parent.canonical())
}

/// The frame without a parent above a frame.
fn root_above(bag: &BagEvidence, frame: &FrameId) -> FrameId {
    let mut seen = BTreeSet::new();
    let mut root = frame.canonical();
    while seen.insert(root.clone()) {
        match parent_of(bag, &root) {
            Some(parent) => root = parent,
            None => break,
        }
    }
    root
}

/// A frame that another program might publish a child below: the parent of its parent, else one beside it.
fn other_parent(bag: &BagEvidence, edge: &TfEdge) -> Option<FrameId> {
    let (parent, child) = (edge.parent.canonical(), edge.child.canonical());
    let own = below(bag, &child);
    let above = parent_of(bag, &parent);
    let beside = bag.tf.iter().map(|other| other.child.canonical());
    above
        .into_iter()
        .chain(beside)
        .find(|other| *other != parent && !own.contains(other))
}

/// Publishes a transform once more, between other frames, right after another: a latched one once, others as often.
fn add(bag: &mut BagEvidence, beside: &TfEdge, parent: &FrameId, child: &FrameId) {
    let Some(first) = beside.samples.first() else { return };
    let sample = TfSample {
        at: beside.first_at.clone(),
        pose: first.pose,
    };
    let (added, switches) = if beside.is_static {
        (TfEdge::once(parent.clone(), child.clone(), sample), 1)
    } else {
        let again = TfEdge {
            parent: parent.clone(),
            child: child.clone(),
            ..beside.clone()
        };
        (again, 2 * beside.count - 1)
    };
    bag.tf.push(added);
    let child = child.canonical();
    let parents = bag.tf.iter().filter(|edge| edge.child.canonical() == child);
    let parents: Vec<FrameId> = parents.map(|edge| edge.parent.clone()).collect();
    if parents.len() > 1 && bag.parent_switches.iter().all(|known| known.child != child) {
        bag.parent_switches.push(ParentSwitch {
            child,
            parents,
            switches,
            at: beside.first_at.clone(),
        });
    }
}

/// Puts lists in order, and names of frames where they are used, after the edges of a topic have changed.
fn settle(world: &mut World, bag: usize, changed: &TfEdge) {
    let Some(evidence) = world.bags.get_mut(bag) else {
        return;
    };
    let key = |edge: &TfEdge| (edge.child.clone(), edge.parent.clone(), edge.topic.clone());
    evidence.tf.sort_by_key(key);
    evidence
        .parent_switches
        .sort_by(|a, b| (&a.child, &a.at).cmp(&(&b.child, &b.at)));
    let (source, topic) = (evidence.source, changed.topic.as_str());
    let is_of_topic = |used: &FrameUse| {
        let is_tf = matches!(used.role, FrameRole::TfParent | FrameRole::TfChild);
        is_tf && used.place.source == source && used.place.topic() == Some(topic)
    };
    let edges = evidence.tf.iter().filter(|edge| edge.topic == topic);
    // An empty name is no use.
    let uses = edges.flat_map(|edge| {
        [(&edge.parent, FrameRole::TfParent), (&edge.child, FrameRole::TfChild)].map(|(frame, role)| FrameUse {
            frame: frame.clone(),
            role,
            place: Place::message(source, edge.first_at.clone()),
            count: edge.count,
        })
    });
    let mut made: Vec<FrameUse> = Vec::new();
    for used in uses.filter(|used| !used.frame.as_str().is_empty()) {
        match made
            .iter_mut()
            .find(|known| (&known.frame, known.role) == (&used.frame, used.role))
        {
            Some(known) => {
                known.count += used.count;
                if used.place < known.place {
                    known.place = used.place;
                }
            }
            None => made.push(used),
        }
    }
    world.frames.retain(|used| !is_of_topic(used));
    world.frames.extend(made);
    world.forget();
}
