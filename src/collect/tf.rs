//! TF: edges, their faults, and changes of parent.
//!
//! Owns the state of every edge while a recording is read. What tf2 accepts and drops is judged by its own tests
//! (`setTransformImpl` in geometry2, tf2/src/buffer_core.cpp).

use std::collections::hash_map::Entry;
use std::collections::{BTreeMap, HashMap};

use crate::read::messages::tf::Transform;
use crate::source::{Place, SourceId};
use crate::world::bag::{MAX_EXAMPLES, ParentSwitch, TfEdge};
use crate::world::{FrameId, FrameRole, FrameUse};

use super::edge::EdgeState;
use super::point::Point;
use super::topic::last_segment;
use super::writers::{Writer, Writers};

/// Bound on edges; the largest trees met in recordings have some hundred.
pub(super) const MAX_EDGES: usize = 10_000;
/// Bound on frame names: two for every edge, each with and without a slash.
const MAX_NAMES: usize = 4 * MAX_EDGES;

/// A name in [`Names`].
type NameId = u32;

/// Every TF topic of a recording.
#[derive(Default)]
pub(super) struct Tf {
    names: Names,
    topics: BTreeMap<usize, TfTopic>,
    scopes: HashMap<String, usize>,
    edges: Vec<EdgeState>,
    edge_of: HashMap<(usize, NameId, NameId), usize>,
    parents: HashMap<(usize, NameId), Parents>,
    /// Transforms whose edge is beyond the bound.
    pub(super) refused: u64,
}

struct TfTopic {
    name: String,
    is_static: bool,
    /// What tf2 would fill one buffer from: `/tf` and `/tf_static` of one namespace.
    scope: usize,
}

/// The parents of one child in one scope.
struct Parents {
    current: NameId,
    taken: Vec<NameId>,
    switches: u64,
    first: Option<(usize, Point)>,
}

impl Tf {
    /// Registers a topic with TF messages under its number.
    pub(super) fn topic(&mut self, number: usize, name: &str) {
        let last = last_segment(name);
        let scope = match last {
            "tf" | "tf_static" => name.strip_suffix(last).unwrap_or(name),
            _ => name,
        };
        let next = self.scopes.len();
        let scope = *self.scopes.entry(scope.to_owned()).or_insert(next);
        let topic = TfTopic {
            name: name.to_owned(),
            is_static: last == "tf_static",
            scope,
        };
        self.topics.insert(number, topic);
    }

    /// Takes in the transforms of one message.
    pub(super) fn message(&mut self, topic: usize, point: Point, writer: Option<Writer>, transforms: &[Transform<'_>]) {
        for (index, transform) in (0..).zip(transforms) {
            let point = Point {
                stamp_ns: Some(transform.stamp_ns),
                transform: Some(index),
                ..point
            };
            self.transform(topic, point, writer, transform);
        }
    }

    /// Messages were left out here.
    pub(super) fn seam(&mut self) {
        for edge in &mut self.edges {
            edge.seam();
        }
    }

    fn transform(&mut self, topic: usize, point: Point, writer: Option<Writer>, transform: &Transform<'_>) {
        let (Some(parent), Some(child)) = (self.names.id(&transform.parent), self.names.id(&transform.child)) else {
            self.refused += 1;
            return;
        };
        let next = self.edges.len();
        let edge = match self.edge_of.entry((topic, parent, child)) {
            Entry::Occupied(known) => *known.get(),
            Entry::Vacant(_) if next >= MAX_EDGES => {
                self.refused += 1;
                return;
            }
            Entry::Vacant(free) => {
                self.edges.push(EdgeState::new((topic, parent, child), point, next));
                *free.insert(next)
            }
        };
        let Some(edge) = self.edges.get_mut(edge) else { return };
        if edge.push(point, writer, transform.translation, transform.rotation) {
            self.note_parent(topic, point, parent, child);
        }
    }

    /// Takes in the parent of a transform with valid numbers. Names that tf2 drops make no parent.
    fn note_parent(&mut self, topic: usize, point: Point, parent: NameId, child: NameId) {
        let (parent, child) = (self.names.canonical(parent), self.names.canonical(child));
        let Some(scope) = self.topics.get(&topic).map(|topic| topic.scope) else {
            return;
        };
        if parent == child || self.names.is_empty(parent) || self.names.is_empty(child) {
            return;
        }
        let known = self.parents.entry((scope, child)).or_insert_with(|| Parents {
            current: parent,
            taken: vec![parent],
            switches: 0,
            first: None,
        });
        if known.current != parent {
            known.current = parent;
            known.switches += 1;
            known.first.get_or_insert((topic, point));
            if known.taken.len() < MAX_EXAMPLES && !known.taken.contains(&parent) {
                known.taken.push(parent);
            }
        }
    }

    /// Edges, changes of parent, and the names used, once for each name, role and topic.
    pub(super) fn finish(self, source: SourceId, writers: &Writers) -> (Vec<TfEdge>, Vec<ParentSwitch>, Vec<FrameUse>) {
        let Self {
            names,
            topics,
            edges,
            parents,
            ..
        } = self;
        let topic_name = |topic: usize| topics.get(&topic).map_or("", |topic| topic.name.as_str());

        let mut uses = HashMap::new();
        for edge in &edges {
            let (topic, parent, child) = edge.key;
            for (name, role) in [(parent, FrameRole::TfParent), (child, FrameRole::TfChild)] {
                let (count, first) = uses.entry((topic, name, role)).or_insert((0, edge.first));
                *count += edge.count;
                if (edge.first.index, edge.first.transform) < (first.index, first.transform) {
                    *first = edge.first;
                }
            }
        }
        let frame_use = |((topic, name, role), (count, first)): ((usize, NameId, FrameRole), (u64, Point))| FrameUse {
            frame: names.frame(name),
            role,
            place: Place::message(source, first.on(topic_name(topic))),
            count,
        };
        let mut frame_uses: Vec<FrameUse> = uses
            .into_iter()
            .filter(|((_, name, _), _)| !names.is_empty(*name))
            .map(frame_use)
            .collect();
        frame_uses.sort();

        let switch = |((_, child), known): ((usize, NameId), Parents)| {
            let (topic, point) = known.first?;
            Some(ParentSwitch {
                child: names.frame(child),
                parents: known.taken.iter().map(|parent| names.frame(*parent)).collect(),
                switches: known.switches,
                at: point.on(topic_name(topic)),
            })
        };
        let mut switches: Vec<ParentSwitch> = parents.into_iter().filter_map(switch).collect();
        switches.sort_by(|a, b| (&a.child, &a.at).cmp(&(&b.child, &b.at)));

        let finished = |edge: EdgeState| {
            let (topic, parent, child) = edge.key;
            let is_static = topics.get(&topic).is_some_and(|topic| topic.is_static);
            let frames = (names.frame(parent), names.frame(child));
            edge.finish(frames, topic_name(topic), is_static, writers)
        };
        let mut tf: Vec<TfEdge> = edges.into_iter().map(finished).collect();
        tf.sort_by(|a, b| (&a.child, &a.parent, &a.topic).cmp(&(&b.child, &b.parent, &b.topic)));
        (tf, switches, frame_uses)
    }
}

/// Every name once.
#[derive(Default)]
struct Names {
    ids: HashMap<String, NameId>,
    names: Vec<Name>,
}

struct Name {
    text: String,
    canonical: NameId,
}

impl Names {
    /// The id of a name; `None` where there is no room for a new one.
    fn id(&mut self, text: &str) -> Option<NameId> {
        if let Some(id) = self.ids.get(text) {
            return Some(*id);
        }
        if self.names.len() >= MAX_NAMES {
            return None;
        }
        let canonical = FrameId::new(text).canonical();
        let canonical = (canonical.as_str() != text).then(|| self.plain(canonical.as_str()));
        let id = self.plain(text);
        if let (Some(canonical), Some(name)) = (canonical, self.names.get_mut(id as usize)) {
            name.canonical = canonical;
        }
        Some(id)
    }

    /// The id of a name that is its own canonical form, for now.
    fn plain(&mut self, text: &str) -> NameId {
        let next = NameId::try_from(self.names.len()).unwrap_or(NameId::MAX);
        let id = *self.ids.entry(text.to_owned()).or_insert(next);
        if id == next {
            self.names.push(Name {
                text: text.to_owned(),
                canonical: id,
            });
        }
        id
    }

    fn canonical(&self, id: NameId) -> NameId {
        self.names.get(id as usize).map_or(id, |name| name.canonical)
    }

    fn is_empty(&self, id: NameId) -> bool {
        self.names.get(id as usize).is_none_or(|name| name.text.is_empty())
    }

    fn frame(&self, id: NameId) -> FrameId {
        FrameId::new(self.names.get(id as usize).map_or("", |name| &name.text))
    }
}
