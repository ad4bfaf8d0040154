//! What a mistake is put into.

use super::motion::Stream;
use crate::world::bag::{TfEdge, TopicEvidence};
use crate::world::graph::EdgeOrigin;
use crate::world::{FrameId, World};

/// Something of a world that can have a mistake.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Subject {
    /// Its name in reports: ``topic `/imu` ``.
    pub name: String,
    /// Names that the subject of a row contains, with backticks, if the row is about it.
    pub words: Vec<String>,
    /// Where it is in the world.
    pub at: SubjectPlace,
}

/// Where in a world a subject is. Recordings, claims and edges are numbered as in the lists of the world.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum SubjectPlace {
    /// The claim with this number.
    Claim(usize),
    /// An edge of TF.
    Edge {
        /// The recording.
        bag: usize,
        /// The edge.
        edge: usize,
    },
    /// A topic.
    Topic {
        /// The recording.
        bag: usize,
        /// The name of the topic.
        topic: String,
    },
    /// What one driver publishes: a topic, or what states one motion on a topic and on TF.
    Stream(Stream),
    /// The origin on the Earth with this number.
    Origin(usize),
    /// The camera with this number, that a file describes.
    Camera(usize),
    /// The time offset of a camera with this number, that a file states.
    Delay(usize),
    /// A frame of the platform.
    Frame(FrameId),
}

impl Subject {
    /// A topic of the recording with this number.
    pub(super) fn of_topic(bag: usize, topic: &TopicEvidence) -> Self {
        let word = format!("`{}`", topic.topic);
        Self {
            name: format!("topic {word}"),
            words: vec![word],
            at: SubjectPlace::Topic {
                bag,
                topic: topic.topic.clone(),
            },
        }
    }

    /// The file in front of its name, where one states it.
    pub fn file(&self) -> Option<&str> {
        let (file, _) = self.name.strip_prefix('`')?.split_once("`: ")?;
        Some(file)
    }

    /// Whether a row or a finding with this subject is about it.
    pub fn is_in(&self, text: &str) -> bool {
        self.words.iter().any(|word| text.contains(word.as_str()))
    }
}

/// The constant transforms of recordings, each with the numbers of its recording and of itself, in their order.
pub(super) fn constant_edges(world: &World) -> Vec<([usize; 2], &TfEdge)> {
    let rigid = world.graph().edges.iter().filter(|edge| edge.is_rigid);
    let recorded = rigid.filter_map(|edge| {
        let EdgeOrigin::Tf(bag, number) = edge.origin else {
            return None;
        };
        let (_, of) = edge.origin.recorded(world)?;
        Some(([bag, number], of))
    });
    let mut edges: Vec<([usize; 2], &TfEdge)> = recorded.filter(|(_, of)| !of.samples.is_empty()).collect();
    edges.sort_by_key(|(at, _)| *at);
    edges
}
