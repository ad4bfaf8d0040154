//! Evidence of recordings: bounded measurements, no messages.

use std::collections::BTreeMap;
use std::sync::Arc;

use serde::{Deserialize, Serialize};

use crate::source::{MessageRef, SourceId};

use super::claim::Pose;
use super::content::{ContentEvidence, StepEvidence};
use super::frame::FrameId;
use super::motion::{PoseRow, Series};

/// Bound on every list of examples kept in evidence.
pub const MAX_EXAMPLES: usize = 8;

/// Fewer messages, or a shorter time, give no rate.
const MIN_MESSAGES: u64 = 10;
/// Seconds.
const MIN_S: f64 = 5.0;

/// The header stamps of one topic, compared with the recorder's clock.
///
/// Steps are taken between neighbouring stamps that are not zero, in recording order: a zero stamp is a fault of its
/// own, and the steps to and from it would hide what the other stamps do.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct StampEvidence {
    /// Messages with a header stamp.
    pub count: u64,
    /// Evenly thinned samples `(stamp_ns, log_ns)`, in recording order; at most a few thousand.
    pub samples: Vec<(i64, i64)>,
    /// Stamps that are exactly zero.
    pub zero: u64,
    /// First message with a zero stamp.
    pub first_zero: Option<MessageRef>,
    /// Stamps smaller than the one before.
    pub backward: u64,
    /// Largest step back, nanoseconds (positive), and the message it happens at.
    pub largest_backward: Option<(i64, MessageRef)>,
    /// Stamps equal to the one before.
    pub repeated: u64,
    /// First message whose stamp equals the one before.
    pub first_repeated: Option<MessageRef>,
    /// Largest gap between neighbouring stamps, nanoseconds, and the message after it.
    pub largest_gap: Option<(i64, MessageRef)>,
    /// Median of the forward steps between neighbouring stamps, nanoseconds; of a random sample where they are many.
    pub median_step_ns: Option<i64>,
    /// Gaps longer than three median steps (and one second).
    pub long_gaps: u64,
    /// First message.
    pub first: Option<MessageRef>,
    /// Last message.
    pub last: Option<MessageRef>,
}

impl StampEvidence {
    /// Messages per second by the usual step of the stamps; `None` where it is not known.
    pub fn usual_hz(&self) -> Option<f64> {
        let step_ns = self.median_step_ns.filter(|step| *step > 0)?;
        Some(1e9 / step_ns as f64)
    }
}

/// Transforms of one edge that share a stamp with the one before, and differ from it.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Contradictions {
    /// How many.
    pub count: u64,
    /// The one that differs most, by 0.1° as by 1 mm.
    pub worst: MessageRef,
    /// Rotation from the one before, radians.
    #[serde(with = "super::number")]
    pub angle_rad: f64,
    /// Distance between the two, metres.
    #[serde(with = "super::number")]
    pub distance_m: f64,
}

/// How a frame id is used in the headers of a topic.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct HeaderFrame {
    /// Messages that carry it.
    pub count: u64,
    /// The first one.
    pub first: MessageRef,
}

/// One topic of a recording.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct TopicEvidence {
    /// The topic.
    pub topic: String,
    /// Type of its messages (`sensor_msgs/msg/Imu`).
    pub message_type: String,
    /// Messages read; zero for a topic that the recording names and that has no messages.
    pub count: u64,
    /// Messages in the whole recording, if its index states it.
    pub total: Option<u64>,
    /// Whether late subscribers get the last message again (`latching` of ROS 1, `transient_local` of ROS 2).
    pub latched: bool,
    /// Messages by writer, where the format knows (`callerid` of ROS 1).
    pub writers: BTreeMap<String, u64>,
    /// Earliest log time, nanoseconds.
    pub first_log_ns: Option<i64>,
    /// Latest log time, nanoseconds.
    pub last_log_ns: Option<i64>,
    /// The `offered_qos_profiles` of the channel as recorded (YAML text), where the recording has it.
    pub offered_qos_profiles: Option<String>,
    /// Why nothing inside the messages could be read; `None` when they could.
    pub unread: Option<String>,
    /// Messages whose bytes could not be decoded, with the first one's error.
    pub malformed: u64,
    /// The first malformed message and what was wrong.
    pub first_malformed: Option<(MessageRef, String)>,
    /// `header.frame_id` values. The empty id is kept as an empty frame.
    pub header_frames: BTreeMap<FrameId, HeaderFrame>,
    /// `child_frame_id` values of odometry.
    pub child_frames: BTreeMap<FrameId, HeaderFrame>,
    /// Header stamps.
    pub stamps: StampEvidence,
    /// The content of the messages beyond their header; copies of a world share what they do not change.
    pub content: Arc<ContentEvidence>,
    /// Parts of messages that are not of a standard type, with the content of a standard type: by field
    /// (`imu`), or the fields it is made of (`lat, lon, alt`).
    #[serde(default)]
    pub members: BTreeMap<String, MemberEvidence>,
}

/// A part of the messages of a topic with the content of a standard type.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct MemberEvidence {
    /// Whether it was recognised by the names of plain fields only, not by a type: it may be a target, or where another vehicle is.
    pub guessed: bool,
    /// `header.frame_id` values: its own, or the message's where its own is empty.
    pub header_frames: BTreeMap<FrameId, HeaderFrame>,
    /// `child_frame_id` values of odometry.
    pub child_frames: BTreeMap<FrameId, HeaderFrame>,
    /// First message that carries it.
    pub first: Option<MessageRef>,
    /// Its content beyond its header.
    pub content: Arc<ContentEvidence>,
}

/// The content of a topic's messages beyond their header: of the messages themselves, or of a member.
#[derive(Clone, Copy, Debug)]
pub struct TopicContent<'e> {
    /// The topic.
    pub topic: &'e TopicEvidence,
    /// The member's field.
    pub field: Option<&'e str>,
    /// Whether it was recognised by the names of plain fields only.
    pub guessed: bool,
    /// `header.frame_id` values.
    pub header_frames: &'e BTreeMap<FrameId, HeaderFrame>,
    /// `child_frame_id` values.
    pub child_frames: &'e BTreeMap<FrameId, HeaderFrame>,
    /// First message.
    pub first: Option<&'e MessageRef>,
    /// Its content.
    pub content: &'e ContentEvidence,
}

impl TopicContent<'_> {
    /// Its name in reports: ``topic `/imu` ``, ``topic `/imu` (field `imu`)``.
    pub fn subject(&self) -> String {
        match self.field {
            None => format!("topic `{}`", self.topic.topic),
            Some(field) => format!("topic `{}` (field `{field}`)", self.topic.topic),
        }
    }
}

impl TopicEvidence {
    /// The name of its type, without the package.
    pub fn type_name(&self) -> &str {
        self.message_type.rsplit(['/', '.']).next().unwrap_or_default()
    }

    /// Whether its messages were made of packets that state no frame.
    pub(crate) fn is_frameless(&self) -> bool {
        self.header_frames.is_empty() && self.type_name() == "Imu"
    }

    /// The lower-case words of all names around it: topic, type, frames and writers.
    pub fn words(&self) -> Vec<String> {
        let names = [self.topic.as_str(), self.message_type.as_str()].into_iter();
        let names = names.chain(self.header_frames.keys().map(FrameId::as_str));
        let names = names.chain(self.writers.keys().map(String::as_str));
        names.flat_map(|name| FrameId::new(name).tokens()).collect()
    }

    /// The content of its messages themselves, and of every member of them.
    pub fn contents(&self) -> impl Iterator<Item = TopicContent<'_>> {
        let whole = TopicContent {
            topic: self,
            field: None,
            guessed: false,
            header_frames: &self.header_frames,
            child_frames: &self.child_frames,
            first: self.stamps.first.as_ref(),
            content: &self.content,
        };
        let members = self.members.iter().map(|(field, member)| TopicContent {
            topic: self,
            field: Some(field),
            guessed: member.guessed,
            header_frames: &member.header_frames,
            child_frames: &member.child_frames,
            first: member.first.as_ref(),
            content: &member.content,
        });
        std::iter::once(whole).chain(members)
    }

    /// The content, to be changed in this copy of the topic only.
    pub fn content_mut(&mut self) -> &mut ContentEvidence {
        Arc::make_mut(&mut self.content)
    }

    /// The content of its members, then its own, to be changed in this copy of the topic only.
    pub fn contents_mut(&mut self) -> impl Iterator<Item = &mut ContentEvidence> {
        let members = self.members.values_mut().map(|member| &mut member.content);
        members.chain([&mut self.content]).map(Arc::make_mut)
    }

    /// Whether the recording has messages of the topic that were not read.
    pub fn has_more(&self) -> bool {
        self.total.is_some_and(|total| total > self.count)
    }

    /// Whether every message of the topic is known to be read.
    pub fn is_read_up(&self) -> bool {
        self.total.is_some_and(|total| total <= self.count)
    }
}

/// A fault in the numbers or names of one TF transform, kept as an example.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct TfFault {
    /// The message and the transform in it.
    pub at: MessageRef,
    /// Numbers as published: `[tx, ty, tz]`.
    #[serde(with = "super::number::array")]
    pub translation: [f64; 3],
    /// As published: `[x, y, z, w]`.
    #[serde(with = "super::number::array")]
    pub rotation: [f64; 4],
}

/// Examples of a fault with their total count.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Faults {
    /// How many transforms show it.
    pub count: u64,
    /// The first few.
    pub examples: Vec<TfFault>,
}

/// A valid sample of an edge.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct TfSample {
    /// Its message.
    pub at: MessageRef,
    /// `parent_from_child`.
    pub pose: Pose,
}

/// One TF edge: `parent_from_child` as published on one topic.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct TfEdge {
    /// `header.frame_id` as spelled.
    pub parent: FrameId,
    /// `child_frame_id` as spelled.
    pub child: FrameId,
    /// The topic (`/tf`, `/tf_static`, or a namespaced one).
    pub topic: String,
    /// Whether the topic is a static one.
    pub is_static: bool,
    /// Transforms published.
    pub count: u64,
    /// First message that carries the edge.
    pub first_at: MessageRef,
    /// Last message that carries the edge.
    pub last_at: MessageRef,
    /// Evenly thinned valid samples in recording order, the first and last among them.
    pub samples: Vec<TfSample>,
    /// The sample that differs most from the first, with its difference: radians and metres. `None` where none differs.
    /// An angle of 0.1° weighs as much as a distance of 1 mm, so that neither hides the other.
    pub extreme: Option<(TfSample, f64, f64)>,
    /// Numbers that are NaN or infinite.
    pub non_finite: Faults,
    /// Quaternions of all zeros.
    pub zero_quaternion: Faults,
    /// Quaternions with `| |q|² - 1 | >= 0.01`, which tf2 drops.
    pub denormalized: Faults,
    /// Largest `| |q| - 1 |` of the quaternions that tf2 accepts.
    #[serde(with = "super::number")]
    pub worst_norm_error: f64,
    /// Stamps of the edge.
    pub stamps: StampEvidence,
    /// Transforms that repeat the stamp of the one before, with other numbers.
    #[serde(default)]
    pub contradictions: Option<Contradictions>,
    /// How the pose moves.
    pub steps: StepEvidence,
    /// Transforms by writer, where the format knows (`callerid` of ROS 1).
    pub writers: BTreeMap<String, u64>,
    /// The poses row by row, if they change; of an edge that is not static.
    #[serde(default)]
    pub motion: Option<Series<PoseRow>>,
}

/// Whether a topic carries latched transforms, by its name.
pub fn is_static_topic(topic: &str) -> bool {
    topic == "tf_static" || topic.ends_with("/tf_static")
}

impl TfEdge {
    /// An edge of one transform, published once; static if its topic is.
    pub fn once(parent: FrameId, child: FrameId, sample: TfSample) -> Self {
        let at = sample.at.clone();
        Self {
            parent,
            child,
            topic: at.topic.clone(),
            is_static: is_static_topic(&at.topic),
            count: 1,
            first_at: at.clone(),
            last_at: at,
            samples: vec![sample],
            extreme: None,
            non_finite: Faults::default(),
            zero_quaternion: Faults::default(),
            denormalized: Faults::default(),
            worst_norm_error: 0.0,
            stamps: StampEvidence::default(),
            contradictions: None,
            steps: StepEvidence::default(),
            writers: BTreeMap::new(),
            motion: None,
        }
    }

    /// Whether it is published again and again with one value on a topic for what moves, as `static_transform_publisher` of ROS 1 does.
    pub fn is_repeated(&self) -> bool {
        const MIN_COUNT: u64 = 10;
        /// Computed anew, a value may differ by its rounding: metres and radians.
        const ROUNDING: f64 = 1e-9;
        let is_one = self.extreme.as_ref().is_none_or(|(_, m, rad)| m.max(*rad) < ROUNDING);
        !self.is_static && self.count >= MIN_COUNT && is_one
    }

    /// The first valid sample.
    pub fn first(&self) -> Option<&TfSample> {
        self.samples.first()
    }
}

/// A change of parent of one child, in recording order.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ParentSwitch {
    /// The child, as tf2 stores it.
    pub child: FrameId,
    /// The different parents, the first one included, in the order of their first use; at most a few.
    pub parents: Vec<FrameId>,
    /// Number of changes.
    pub switches: u64,
    /// The message of the first change.
    pub at: MessageRef,
}

/// One file of a split recording.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Part {
    /// The file's name.
    pub path: String,
    /// Earliest log time read of it, nanoseconds.
    pub start_ns: Option<i64>,
    /// Latest log time read of it, nanoseconds.
    pub end_ns: Option<i64>,
    /// Messages read of it.
    pub messages: u64,
    /// Whether a message on a `tf_static` topic was read of it. Where the recording was sampled, its absence proves little.
    pub static_transforms: bool,
}

/// The evidence of one recording.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct BagEvidence {
    /// The recording.
    pub source: SourceId,
    /// Earliest log time, nanoseconds.
    pub start_ns: Option<i64>,
    /// Latest log time, nanoseconds.
    pub end_ns: Option<i64>,
    /// Messages read.
    pub messages: u64,
    /// Topics, by name.
    pub topics: BTreeMap<String, TopicEvidence>,
    /// TF edges, sorted by child, parent, topic.
    pub tf: Vec<TfEdge>,
    /// Children whose parent changes.
    pub parent_switches: Vec<ParentSwitch>,
    /// Whether the end of the recording could not be read: the absence of a message proves nothing.
    pub truncated: bool,
    /// The files of a split recording, in order; empty where the recording is one file.
    #[serde(default)]
    pub parts: Vec<Part>,
    /// How much of the recording was examined.
    pub share: Share,
    /// Names and keys of what the recording has besides messages: metadata records and attachments.
    pub annotations: BTreeMap<String, BTreeMap<String, String>>,
}

/// How much of a recording was examined.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Share {
    /// Whether every message was read that the file holds (before a fault).
    pub whole: bool,
    /// Messages in the whole recording, if its index states it.
    pub messages_total: Option<u64>,
    /// First and last log time of the whole recording, nanoseconds.
    pub span_ns: Option<(i64, i64)>,
    /// First and last log time of every unbroken section that was read, nanoseconds, in recording order.
    pub stretches_ns: Vec<(i64, i64)>,
}

impl Share {
    /// Everything.
    pub const WHOLE: Self = Self {
        whole: true,
        messages_total: None,
        span_ns: None,
        stretches_ns: Vec::new(),
    };
}

impl BagEvidence {
    /// Evidence of a recording from which nothing was read yet.
    pub fn new(source: SourceId) -> Self {
        Self {
            source,
            start_ns: None,
            end_ns: None,
            messages: 0,
            topics: BTreeMap::new(),
            tf: Vec::new(),
            parent_switches: Vec::new(),
            truncated: false,
            parts: Vec::new(),
            share: Share::WHOLE,
            annotations: BTreeMap::new(),
        }
    }

    /// Messages of a topic per second of log time, from its first message to its last, or to the end of the recording if
    /// that is many steps later: the least and the most that it can be, equal where its first message is known. Steps
    /// between stamps are no rate: drivers send in bursts, or stop. `None` for few messages, a short time, or an unknown
    /// count.
    pub fn rate_hz(&self, topic: &TopicEvidence) -> Option<[f64; 2]> {
        let count = topic.total.or(self.share.whole.then_some(topic.count))?;
        let (start, end) = self.share.span_ns.or(self.start_ns.zip(self.end_ns))?;
        let (first, last) = topic.first_log_ns.zip(topic.last_log_ns)?;
        let steps = i64::try_from(count.saturating_sub(1)).unwrap_or(i64::MAX);
        let is_at_the_end = end.saturating_sub(last) / 3 <= last.saturating_sub(first) / steps.max(1);
        let end = if is_at_the_end { last } else { end };
        let read_before = self.share.stretches_ns.iter().rev().find(|(_, to)| *to < first);
        let is_first = self.share.whole || self.share.stretches_ns.first().is_some_and(|(_, to)| *to >= first);
        let earliest = match read_before {
            _ if is_first => first,
            Some((_, to)) => *to,
            None => start,
        };
        let [long_s, short_s] = [earliest, first].map(|from| end.saturating_sub(from) as f64 / 1e9);
        let over = |seconds: f64| steps as f64 / seconds;
        (count >= MIN_MESSAGES && short_s >= MIN_S).then(|| [over(long_s), over(short_s)])
    }

    /// Whether joints of the platform are published.
    pub fn has_joint_states(&self) -> bool {
        let mut topics = self.topics.values();
        topics.any(|topic| topic.type_name() == "JointState" && topic.total.unwrap_or(0).max(topic.count) > 0)
    }

    /// The part of the messages that was examined, 0 to 1, if that is not all of them.
    pub fn share_of_messages(&self) -> Option<f64> {
        let total = self.share.messages_total.filter(|_| !self.share.whole)?;
        Some(self.messages as f64 / total.max(1) as f64)
    }
}
