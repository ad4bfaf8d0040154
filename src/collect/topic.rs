//! What is gathered of one topic: counts, log times, header frames, stamps.

use std::borrow::Cow;

use crate::read::bag::{Channel, Message};
use crate::read::messages::DecodeError;
use crate::read::messages::decoder::Decoder;
use crate::read::messages::header::Header;
use crate::source::{Place, SourceId};
use crate::world::bag::TopicEvidence;
use crate::world::{FrameId, FrameRole, FrameUse};

use super::CloudOptions;
use super::content::Contents;
use super::members::Members;
use super::names::Names;
use super::point::{Point, PointOwner};
use super::series::RowBudget;
use super::stamps::Stamps;
use super::thin::SampleBudget;
use super::writers::{Writer, WriterCounts, Writers};

/// The last part of a topic's path: `tf_static` of `/robot1/tf_static`.
pub(super) fn last_segment(topic: &str) -> &str {
    topic.rsplit('/').next().unwrap_or(topic)
}

/// One topic while it is being collected.
pub(super) struct Topic {
    pub(super) name: String,
    pub(super) message_type: String,
    pub(super) count: u64,
    log_ns: Option<(i64, i64)>,
    total: Option<u64>,
    latched: bool,
    written: WriterCounts,
    offered_qos_profiles: Option<String>,
    unread: Option<String>,
    /// Whether rules need the content of such messages.
    pub(super) is_asked_for: bool,
    /// Whether a definition is all that is missing.
    pub(super) lacks_definition: bool,
    /// What stays unread besides the headers.
    pub(super) note: Option<String>,
    malformed: u64,
    first_malformed: Option<(Point, String)>,
    frames: Names,
    children: Names,
    stamps: Stamps,
    /// The content of the messages beyond their header.
    pub(super) contents: Contents,
    /// The standard types inside of them.
    pub(super) members: Members,
}

impl Topic {
    /// A topic that came `rank`-th, from 0, and `of_type`-th among those of its type.
    pub(super) fn new(
        channel: &Channel,
        decoder: &Decoder,
        rank: usize,
        of_type: usize,
        of_clouds: &CloudOptions,
    ) -> Self {
        let share = SampleBudget::of(rank).with_clouds(of_type);
        Self {
            name: channel.topic.clone(),
            message_type: channel.message_type.clone(),
            count: 0,
            log_ns: None,
            offered_qos_profiles: channel.metadata.get("offered_qos_profiles").cloned(),
            total: None,
            latched: false,
            written: WriterCounts::default(),
            unread: decoder.unread().map(str::to_owned),
            is_asked_for: false,
            lacks_definition: decoder.lacks_definition(),
            note: decoder.note().map(str::to_owned),
            malformed: 0,
            first_malformed: None,
            frames: Names::new(share),
            children: Names::new(share),
            stamps: Stamps::new(share),
            contents: Contents::new(share, RowBudget::of(rank), of_clouds.clone()),
            members: Members::new(rank, of_type, of_clouds.clone()),
        }
    }

    /// Counts a message and gives its point, without stamp.
    pub(super) fn next_point(&mut self, message: &Message<'_>) -> Point {
        let log_ns = message.log_ns;
        let (first, last) = self.log_ns.unwrap_or((log_ns, log_ns));
        self.log_ns = Some((first.min(log_ns), last.max(log_ns)));
        self.count += 1;
        Point {
            index: self.count - 1,
            stamp_ns: None,
            log_ns,
            transform: None,
        }
    }

    /// Takes in a channel of the topic.
    pub(super) fn channel(&mut self, channel: &Channel) {
        self.latched |= channel.latched;
        if let Some(total) = channel.total {
            *self.total.get_or_insert(0) += total;
        }
    }

    /// Notes who wrote a message, where that is known.
    pub(super) fn written_by(&mut self, writer: Option<Writer>) {
        self.written.push(writer);
    }

    /// Messages were left out here.
    pub(super) fn seam(&mut self) {
        self.stamps.seam();
        self.contents.seam();
        self.members.seam();
    }

    /// Takes in the child frame of an odometry message.
    pub(super) fn child(&mut self, point: Point, child: &str) {
        self.children.add(child, point);
    }

    /// Takes in the header of a message; gives the point with its stamp.
    pub(super) fn stamped(&mut self, point: Point, header: &Header<'_>, is_frameless: bool) -> Point {
        let point = Point {
            stamp_ns: Some(header.stamp_ns),
            ..point
        };
        self.stamps.push(point);
        if !is_frameless {
            self.frames.add(&header.frame_id, point);
        }
        point
    }

    /// Takes in frames that a message names beyond its header's.
    pub(super) fn named(&mut self, point: Point, frames: &[Cow<'_, str>]) {
        for frame in frames {
            self.frames.add(frame, point);
        }
    }

    /// Notes a message that does not decode.
    pub(super) fn malformed(&mut self, point: Point, error: DecodeError) {
        self.malformed += 1;
        self.first_malformed.get_or_insert((point, error.0));
    }

    /// Names beyond the bound.
    pub(super) fn refused_names(&self) -> u64 {
        self.frames.refused + self.children.refused
    }

    /// Why nothing inside the messages can be read.
    pub(super) fn unread(&self) -> Option<&str> {
        self.unread.as_deref()
    }

    /// Messages in the whole recording, as far as that is known.
    pub(super) fn whole_count(&self) -> u64 {
        self.total.unwrap_or(0).max(self.count)
    }

    /// The messages that did not decode, with the first one's error and place.
    pub(super) fn broken(&self) -> Option<(u64, Point, &str)> {
        let (point, error) = self.first_malformed.as_ref()?;
        Some((self.malformed, *point, error))
    }

    /// The frames named by the topic, and inside its messages where the topic does not; the empty id is not a name.
    pub(super) fn frame_uses(&self, source: SourceId) -> Vec<FrameUse> {
        let use_of = |role, on: PointOwner<'_>, name: &str, (count, first): (u64, Point)| FrameUse {
            frame: FrameId::new(name),
            role,
            place: Place::message(source, first.on(on)),
            count,
        };
        let roles = [FrameRole::Header, FrameRole::OdometryChild];
        let own = [&self.frames, &self.children];
        let mut uses = Vec::new();
        for (names, role) in own.into_iter().zip(roles) {
            let named = names.known.iter().filter(|(name, _)| !name.is_empty());
            uses.extend(named.map(|(name, used)| use_of(role, (&self.name).into(), name, *used)));
        }
        for (field, inside) in self.members.names() {
            let on = PointOwner {
                topic: &self.name,
                field: Some(field),
            };
            for ((names, role), own) in inside.into_iter().zip(roles).zip(own) {
                let is_new = |name: &str| !name.is_empty() && !own.known.contains_key(name);
                let named = names.known.iter().filter(|(name, _)| is_new(name));
                uses.extend(named.map(|(name, used)| use_of(role, on, name, *used)));
            }
        }
        uses
    }

    pub(super) fn finish(self, writers: &Writers) -> TopicEvidence {
        let name = self.name;
        TopicEvidence {
            message_type: self.message_type,
            count: self.count,
            total: self.total,
            latched: self.latched,
            writers: self.written.finish(writers),
            first_log_ns: self.log_ns.map(|(first, _)| first),
            last_log_ns: self.log_ns.map(|(_, last)| last),
            offered_qos_profiles: self.offered_qos_profiles,
            unread: self.unread,
            malformed: self.malformed,
            first_malformed: self.first_malformed.map(|(point, error)| (point.on(&name), error)),
            header_frames: self.frames.finish((&name).into()),
            child_frames: self.children.finish((&name).into()),
            stamps: self.stamps.finish(&name),
            content: self.contents.finish((&name).into()).into(),
            members: self.members.finish(&name),
            topic: name,
        }
    }
}
