//! The streams of a recording that an error can be put into.

use std::collections::{BTreeMap, BTreeSet};

use frames_lint::world::World;
use frames_lint::world::bag::{BagEvidence, TopicEvidence};
use frames_lint::world::content::ContentEvidence;

use crate::cameras::is_optical;

/// Frames that do not move, as far as recordings name them.
const WORLDS: &[&str] = &["odom", "map", "world", "earth"];

/// Where the numbers of a stream stand.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum StreamPlace {
    /// In the messages of a topic, or in a member of them.
    Topic(String, Option<String>),
    /// In TF: parent, child, topic.
    Edge(String, String, String),
}

/// What a stream is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    Imu,
    Poses,
    Fixes,
    /// An optical frame.
    Camera,
}

/// What one driver publishes: a topic, or what tells the way of one frame on topics and TF alike.
#[derive(Clone, Debug)]
pub struct Stream {
    /// Its recording, by its number in the world.
    pub bag: usize,
    pub kind: Kind,
    pub at: Vec<StreamPlace>,
    /// Frames that it names.
    pub frames: BTreeSet<String>,
    /// Whether it tells how a frame of the platform moves in one that does not.
    pub is_of_base: bool,
    /// Whether it is a topic with `sensor_msgs/NavSatFix`.
    pub is_standard: bool,
}

impl Stream {
    /// Every stream of a world.
    pub fn all(world: &World) -> Vec<Self> {
        world
            .bags
            .iter()
            .enumerate()
            .flat_map(|(bag, evidence)| of_bag(bag, evidence))
            .collect()
    }

    /// In a few words.
    pub fn name(&self) -> String {
        let kind = match self.kind {
            Kind::Imu => "imu",
            Kind::Poses => "poses",
            Kind::Fixes => "fixes",
            Kind::Camera => "camera",
        };
        let at: Vec<String> = self.at.iter().map(ToString::to_string).collect();
        format!("{kind} {}", at.join(" + "))
    }

    /// The words in a row's subject that say that it is of this stream.
    pub fn words(&self) -> Vec<String> {
        let at = self.at.iter().flat_map(|at| match at {
            StreamPlace::Topic(topic, _) => vec![format!("`{topic}`")],
            StreamPlace::Edge(parent, child, _) => vec![format!("`{parent}` -> `{child}`")],
        });
        at.chain(self.frames.iter().map(|frame| format!("`{frame}`"))).collect()
    }

    /// Changes what the topics and members say.
    pub fn contents(&self, world: &mut World, mut change: impl FnMut(&mut ContentEvidence)) {
        let bag = &mut world.bags[self.bag];
        for at in &self.at {
            let StreamPlace::Topic(topic, field) = at else { continue };
            let topic = bag.topics.get_mut(topic).unwrap();
            match field {
                None => change(&mut topic.content),
                Some(field) => change(&mut topic.members.get_mut(field).unwrap().content),
            }
        }
    }
}

impl std::fmt::Display for StreamPlace {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Topic(topic, None) => f.write_str(topic),
            Self::Topic(topic, Some(field)) => write!(f, "{topic}.{}", field.split(',').next().unwrap_or_default()),
            Self::Edge(parent, child, _) => write!(f, "TF {parent}>{child}"),
        }
    }
}

fn of_bag(bag: usize, evidence: &BagEvidence) -> Vec<Stream> {
    let mut streams = Vec::new();
    let mut ways: BTreeMap<(String, String), Stream> = BTreeMap::new();
    for said in evidence.topics.values().flat_map(TopicEvidence::contents) {
        let frames = said.header_frames.keys().chain(said.child_frames.keys());
        let stream = |kind| Stream {
            bag,
            kind,
            at: vec![StreamPlace::Topic(
                said.topic.topic.clone(),
                said.field.map(str::to_owned),
            )],
            frames: frames
                .clone()
                .map(|frame| frame.canonical().as_str().to_owned())
                .collect(),
            is_of_base: said
                .child_frames
                .keys()
                .any(|frame| frame.canonical().as_str().contains("base")),
            is_standard: said.field.is_none() && said.topic.message_type.contains("NavSatFix"),
        };
        let motion = &said.content.motion;
        if motion.inertial.is_some() {
            streams.push(stream(Kind::Imu));
        }
        if motion.fixes.is_some() {
            streams.push(stream(Kind::Fixes));
        }
        if motion.poses.is_some() {
            let name = |frames: &BTreeMap<_, _>| -> Option<String> {
                let frame: &frames_lint::world::FrameId = frames.keys().next()?;
                Some(frame.canonical().as_str().to_owned())
            };
            let parent = name(said.header_frames).unwrap_or_default();
            // What names no child stands for itself.
            let child = name(said.child_frames).unwrap_or_else(|| said.topic.topic.clone());
            ways.insert((parent, child), stream(Kind::Poses));
        }
    }
    for edge in evidence
        .tf
        .iter()
        .filter(|edge| edge.motion.is_some() && !edge.is_static)
    {
        let [parent, child] = [&edge.parent, &edge.child].map(|frame| frame.canonical().as_str().to_owned());
        if !WORLDS.contains(&parent.as_str()) {
            continue;
        }
        let at = StreamPlace::Edge(parent.clone(), child.clone(), edge.topic.clone());
        let way = ways.entry((parent.clone(), child.clone())).or_insert_with(|| Stream {
            bag,
            kind: Kind::Poses,
            at: Vec::new(),
            is_of_base: child.contains("base"),
            is_standard: false,
            frames: [parent, child].into(),
        });
        way.at.push(at);
    }
    streams.extend(ways.into_values());
    streams.extend(evidence.tf.iter().filter(|edge| is_optical(&edge.child)).map(|edge| {
        let [parent, child] = [&edge.parent, &edge.child].map(|frame| frame.canonical().as_str().to_owned());
        Stream {
            bag,
            kind: Kind::Camera,
            at: vec![StreamPlace::Edge(parent, child.clone(), edge.topic.clone())],
            frames: [child].into(),
            is_of_base: false,
            is_standard: false,
        }
    }));
    streams
}
