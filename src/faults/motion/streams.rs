//! The streams of a recording that a mistake can be put into: what one driver publishes.

use std::collections::{BTreeMap, BTreeSet};
use std::sync::Arc;

use crate::faults::{Family, Subject, SubjectPlace};
use crate::world::bag::{BagEvidence, TfEdge, TopicContent, TopicEvidence};
use crate::world::content::ContentEvidence;
use crate::world::motion::{PoseRow, Series};
use crate::world::{FrameId, World};

/// The last part of the names of frames that do not move, as far as recordings name them.
const WORLDS: &[&str] = &["odom", "map", "world", "earth"];

/// Where the numbers of a stream stand.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum StreamPlace {
    /// In the messages of a topic.
    Topic {
        /// Its name.
        topic: String,
        /// The member of the messages, if it is not the messages themselves.
        field: Option<String>,
    },
    /// In TF.
    Edge {
        /// The parent, as tf2 stores it.
        parent: String,
        /// The child, as tf2 stores it.
        child: String,
        /// The topic.
        topic: String,
    },
}

/// What the poses of a stream are of, by the name of the child frame.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum MovingFrame {
    /// The base of the platform.
    Base,
    /// A frame of the world: the stream is a correction of odometry.
    World,
    /// Another frame.
    Other,
    /// A frame that the messages do not name.
    Unnamed,
}

/// What one driver publishes: a topic, or what states the motion of one frame on a topic and on TF alike.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Stream {
    /// Its recording, by its number in the world.
    pub bag: usize,
    /// What it is of: [`Family::Imu`], [`Family::Pose`] or [`Family::Fix`].
    pub family: Family,
    /// Where its numbers stand.
    pub places: Vec<StreamPlace>,
    /// Frames that it names, as tf2 stores them.
    pub frames: BTreeSet<String>,
    /// What its poses are of.
    pub moving: MovingFrame,
    /// Whether it is a topic with `sensor_msgs/NavSatFix`.
    pub is_standard_fix: bool,
}

impl MovingFrame {
    fn of(child: &str) -> Self {
        if is_world(child) {
            Self::World
        } else if child.contains("base") {
            Self::Base
        } else {
            Self::Other
        }
    }
}

impl StreamPlace {
    /// The place of a TF edge.
    pub fn of_edge(edge: &TfEdge) -> Self {
        Self::Edge {
            parent: name(&edge.parent),
            child: name(&edge.child),
            topic: edge.topic.clone(),
        }
    }

    /// The topic.
    pub fn topic(&self) -> &str {
        match self {
            Self::Topic { topic, .. } | Self::Edge { topic, .. } => topic,
        }
    }
}

impl std::fmt::Display for StreamPlace {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Topic { topic, field: None } => write!(f, "topic `{topic}`"),
            Self::Topic {
                topic,
                field: Some(field),
            } => write!(f, "topic `{topic}` (field `{field}`)"),
            Self::Edge { parent, child, .. } => write!(f, "TF `{parent}` -> `{child}`"),
        }
    }
}

impl Stream {
    /// Every stream of a world.
    pub fn all(world: &World) -> impl Iterator<Item = Self> {
        let bags = world.bags.iter().enumerate();
        bags.flat_map(|(bag, evidence)| of_bag(bag, evidence))
    }

    /// The subjects that the streams of a family are.
    pub(super) fn subjects(world: &World, family: Family) -> Vec<Subject> {
        let streams = Self::all(world).filter(|stream| stream.family == family);
        streams.map(Subject::from).collect()
    }

    /// The stream of a subject.
    pub(super) fn of(subject: &Subject) -> Option<&Self> {
        match &subject.at {
            SubjectPlace::Stream(stream) => Some(stream),
            _ => None,
        }
    }

    /// Its name in reports.
    pub fn name(&self) -> String {
        let places: Vec<String> = self.places.iter().map(ToString::to_string).collect();
        places.join(" and ")
    }

    /// The words in a row's subject that show that it is of this stream.
    pub fn words(&self) -> Vec<String> {
        let places = self.places.iter().map(|place| match place {
            StreamPlace::Topic { topic, .. } => format!("`{topic}`"),
            StreamPlace::Edge { parent, child, .. } => format!("`{parent}` -> `{child}`"),
        });
        let frames = self.frames.iter().map(|frame| format!("`{frame}`"));
        places.chain(frames).collect()
    }

    /// What its topics and members state.
    pub(super) fn contents<'w>(&self, world: &'w World) -> Vec<&'w ContentEvidence> {
        let Some(bag) = world.bags.get(self.bag) else {
            return Vec::new();
        };
        let topics = self.places.iter().filter_map(|place| {
            let StreamPlace::Topic { topic, field } = place else {
                return None;
            };
            let topic = bag.topics.get(topic)?;
            match field {
                None => Some(&*topic.content),
                Some(field) => topic.members.get(field).map(|member| &*member.content),
            }
        });
        topics.collect()
    }

    /// Changes what its topics and members state.
    pub fn change_contents(&self, world: &mut World, mut change: impl FnMut(&mut ContentEvidence)) {
        let Some(bag) = world.bags.get_mut(self.bag) else {
            return;
        };
        for place in &self.places {
            let StreamPlace::Topic { topic, field } = place else {
                continue;
            };
            let topic = bag.topics.get_mut(topic);
            let content = match field {
                None => topic.map(|topic| &mut topic.content),
                Some(field) => topic.and_then(|topic| Some(&mut topic.members.get_mut(field)?.content)),
            };
            content.map(Arc::make_mut).into_iter().for_each(&mut change);
        }
    }

    /// Whether a TF edge is one of its places.
    pub fn has_edge(&self, edge: &TfEdge) -> bool {
        self.places.contains(&StreamPlace::of_edge(edge))
    }

    /// Whether it is the correction of a frame that another stream is expressed in.
    pub(super) fn corrects(&self, other: &Self) -> bool {
        let is_parent = |place: &StreamPlace| match place {
            StreamPlace::Edge { child, .. } => other.frames.contains(child),
            StreamPlace::Topic { .. } => false,
        };
        self.bag == other.bag && self.moving == MovingFrame::World && self.places.iter().any(is_parent)
    }

    /// Its edges of TF.
    pub(super) fn edges<'w>(&'w self, world: &'w World) -> impl Iterator<Item = &'w TfEdge> {
        let bag = world.bags.get(self.bag);
        bag.into_iter()
            .flat_map(|bag| &bag.tf)
            .filter(|edge| self.has_edge(edge))
    }

    /// Its edges of TF, to be changed.
    pub fn edges_mut<'w>(&'w self, world: &'w mut World) -> impl Iterator<Item = &'w mut TfEdge> {
        let bag = world.bags.get_mut(self.bag);
        let edges = bag.into_iter().flat_map(|bag| &mut bag.tf);
        edges.filter(|edge| self.has_edge(edge))
    }

    /// The rows of its poses, on topics and on TF, by their sections.
    pub(super) fn pose_sections<'w>(&'w self, world: &'w World) -> impl Iterator<Item = &'w [PoseRow]> {
        let topics = self.contents(world).into_iter();
        let topics = topics.filter_map(|content| content.motion.poses.as_ref());
        let edges = self.edges(world).filter_map(|edge| edge.motion.as_ref());
        topics
            .chain(edges)
            .flat_map(|series| &series.stretches)
            .map(Vec::as_slice)
    }
}

impl From<Stream> for Subject {
    fn from(stream: Stream) -> Self {
        Self {
            name: stream.name(),
            words: stream.words(),
            at: SubjectPlace::Stream(stream),
        }
    }
}

/// A frame's name as tf2 stores it.
fn name(frame: &FrameId) -> String {
    frame.canonical().as_str().to_owned()
}

/// Whether a frame is one of the world, by the last part of its name.
fn is_world(frame: &str) -> bool {
    frame.rsplit('/').next().is_some_and(|last| WORLDS.contains(&last))
}

/// The stream on a topic or in a member.
fn on_topic(bag: usize, family: Family, said: &TopicContent<'_>) -> Stream {
    let frames = said.header_frames.keys().chain(said.child_frames.keys());
    Stream {
        bag,
        family,
        places: vec![StreamPlace::Topic {
            topic: said.topic.topic.clone(),
            field: said.field.map(str::to_owned),
        }],
        frames: frames.map(name).collect(),
        moving: said
            .child_frames
            .keys()
            .next()
            .map_or(MovingFrame::Unnamed, |frame| MovingFrame::of(&name(frame))),
        is_standard_fix: said.field.is_none() && said.topic.message_type.contains("NavSatFix"),
    }
}

/// The stream on an edge of TF.
fn on_edge(bag: usize, edge: &TfEdge) -> Stream {
    let [parent, child] = [name(&edge.parent), name(&edge.child)];
    Stream {
        bag,
        family: Family::Pose,
        places: Vec::new(),
        moving: MovingFrame::of(&child),
        is_standard_fix: false,
        frames: [parent, child].into(),
    }
}

/// A stream of poses on a topic, with its rows.
type PosesOnTopic<'w> = (Stream, &'w Series<PoseRow>);

fn of_bag(bag: usize, evidence: &BagEvidence) -> Vec<Stream> {
    let mut streams = Vec::new();
    // What states the motion of one frame in another, by their names.
    let mut topics: BTreeMap<[String; 2], Vec<PosesOnTopic<'_>>> = BTreeMap::new();
    for said in evidence.topics.values().flat_map(TopicEvidence::contents) {
        let motion = &said.content.motion;
        if motion.inertial.is_some() {
            streams.push(on_topic(bag, Family::Imu, &said));
        }
        if motion.fixes.is_some() {
            streams.push(on_topic(bag, Family::Fix, &said));
        }
        if let Some(poses) = &motion.poses {
            let parent = said.header_frames.keys().next().map(name).unwrap_or_default();
            // What names no child stands for itself.
            let child = said.child_frames.keys().next().map(name);
            let child = child.unwrap_or_else(|| said.subject());
            let known = topics.entry([parent, child]).or_default();
            known.push((on_topic(bag, Family::Pose, &said), poses));
        }
    }
    let mut on_tf: BTreeMap<[String; 2], Stream> = BTreeMap::new();
    for edge in &evidence.tf {
        let Some(motion) = edge.motion.as_ref().filter(|_| !edge.is_static) else {
            continue;
        };
        let frames = [name(&edge.parent), name(&edge.child)];
        if !frames.first().is_some_and(|parent| is_world(parent)) {
            continue;
        }
        let place = StreamPlace::of_edge(edge);
        let nearest = topics.get_mut(&frames).and_then(|known| nearest(known, motion));
        match nearest {
            Some(stream) => stream.places.push(place),
            None => on_tf
                .entry(frames)
                .or_insert_with(|| on_edge(bag, edge))
                .places
                .push(place),
        }
    }
    streams.extend(topics.into_values().flatten().map(|(stream, _)| stream));
    streams.extend(on_tf.into_values());
    streams
}

/// The stream whose poses are those of an edge of TF: of several between the same frames, the one that is nearest to it.
fn nearest<'s>(known: &'s mut [PosesOnTopic<'_>], edge: &Series<PoseRow>) -> Option<&'s mut Stream> {
    let distance = |poses: &Series<PoseRow>| {
        let at = |row: &PoseRow| poses.rows().min_by_key(|other| other.log_ns.abs_diff(row.log_ns));
        let step = edge.rows().count().div_ceil(8).max(1);
        let rows = edge.rows().step_by(step);
        rows.filter_map(|row| Some(super::turns::distance(row.position, at(row)?.position)))
            .sum::<f64>()
    };
    if known.len() < 2 {
        return known.first_mut().map(|(stream, _)| stream);
    }
    let nearest = known.iter_mut().min_by(|a, b| distance(a.1).total_cmp(&distance(b.1)));
    nearest.map(|(stream, _)| stream)
}
