//! Collecting: a recording becomes evidence, in one pass and in bounded memory.
//!
//! Owns what is kept of a recording. Must not know container formats, nor judge what it keeps.

mod annotations;
mod content;
mod descriptions;
mod edge;
mod members;
mod names;
mod parts;
pub mod pcd;
mod point;
mod series;
mod stamps;
mod tf;
mod thin;
mod topic;
mod unread;
mod writers;

use std::collections::{BTreeMap, HashMap};
use std::path::{Path, PathBuf};
use std::sync::Arc;

use crate::read::bag::{Channel, Extent, Message, Progress, Recording, Sampling, Selection, Visit};
use crate::read::calibration::ouster::may_be_ouster;
use crate::read::messages::content::{Body, Content};
use crate::read::messages::decoder::Decoder;
use crate::read::messages::decoders::Decoders;
use crate::read::messages::definition::Definitions;
use crate::read::messages::format::Format;
use crate::read::messages::packets::ASSEMBLED;
use crate::read::packets::Unit;
use crate::read::scans;
use crate::source::{MessageRef, Place, ReadStatus, Source};
use crate::world::bag::Share as Examined;
use crate::world::{BagEvidence, Facts};

use annotations::Annotations;
use descriptions::{Descriptions, MAX_DESCRIPTIONS};
use members::MAX_MEMBERS;
use parts::Parts;
use tf::{MAX_EDGES, Tf};
use topic::{Topic, last_segment};
use writers::{Writer, Writers};

/// Bound on topics; large systems have some hundred.
const MAX_TOPICS: usize = 10_000;
/// Bound on the length of a topic, bytes; DDS allows no more.
const MAX_TOPIC_NAME: usize = 256;
/// Bound on the topics whose malformed messages get a problem of their own.
const MAX_PROBLEMS: usize = 20;

/// Bound on the stretches that are kept apart.
const MAX_STRETCHES: usize = 10_000;

/// The result of one recording.
#[derive(Clone, Debug, Default)]
pub struct Collection {
    /// Evidence and frame names; exactly one bag.
    pub facts: Facts,
    /// Texts of robot descriptions, each different one once, with the first message that carries it.
    pub descriptions: Vec<(MessageRef, String)>,
    /// Texts in which sensors describe themselves, likewise.
    pub metadata: Vec<(MessageRef, String)>,
}

/// How a recording is read.
#[derive(Clone, Debug, Default)]
pub struct CollectOptions {
    /// Which part of it; everything where `None`.
    pub sampling: Option<Sampling>,
    /// The files of a split recording in order, where they are known to be one; empty otherwise.
    pub parts: Vec<PathBuf>,
    /// The definitions of messages for recordings that carry none.
    pub definitions: Arc<Definitions>,
    /// How clouds are kept.
    pub clouds: CloudOptions,
}

/// How clouds are kept.
#[derive(Clone, Debug, Default)]
pub struct CloudOptions {
    /// Fields that hold the times of points, in addition to the known ones; they take precedence.
    pub time_fields: Arc<[String]>,
    /// Whether slices have the points near the plane of a camera's x and y, too: mistakes are tried on them.
    pub has_optical: bool,
    /// What files beside the recording tell of the sensor whose packets it may hold.
    pub unit: Unit,
}

/// Reads a recording once and keeps bounded evidence of it. How far that went, and every problem, is written into
/// `source`; what could be read before a fault is in the evidence.
pub fn collect(path: &Path, how: &CollectOptions, source: &mut Source, progress: Progress<'_>) -> Collection {
    let mut collector = Collector {
        decoders: Decoders::new(Arc::clone(&how.definitions)),
        room_for_members: MAX_MEMBERS,
        of_clouds: how.clouds.clone(),
        ..Collector::default()
    };
    let wanted = Selection {
        sampling: how.sampling,
        throughout: &decides_the_tree,
        in_a_row: &is_matched,
    };
    let recording = Recording {
        path,
        parts: &how.parts,
    };
    let extent = scans::read(
        &recording,
        &wanted,
        &how.definitions,
        (source, progress),
        &mut collector,
    );
    collector.finish(source, &extent)
}

/// Whether a channel holds what determines the tree: latched transforms, descriptions of robots and sensors, and what else is sent once.
fn decides_the_tree(channel: &Channel) -> bool {
    let is_sensor = || channel.message_type.ends_with("/String") && last_segment(&channel.topic).ends_with("metadata");
    channel.latched || matches!(last_segment(&channel.topic), "tf_static" | "robot_description") || is_sensor()
}

/// Whether a channel holds scans, which rules match to the next ones.
fn is_matched(channel: &Channel) -> bool {
    matches!(
        last_segment(&channel.message_type),
        "PointCloud2"
            | "CustomMsg"
            | "LaserScan"
            | "MultiEchoLaserScan"
            | "VelodyneScan"
            | "PandarScan"
            | "NebulaPackets"
            | "VelodynePacket"
            | "PandarPacket"
            | "NebulaPacket"
            | "UdpPacket"
            | "PacketMsg"
    )
}

/// A channel that was announced.
struct ChannelState {
    /// Its topic's number.
    topic: usize,
    decoder: Decoder,
    writer: Option<Writer>,
}

#[derive(Default)]
struct Collector {
    decoders: Decoders,
    /// By the channel's number; `None` where there was no room for its topic.
    channels: Vec<Option<ChannelState>>,
    topics: Vec<Topic>,
    topic_of: HashMap<String, usize>,
    tf: Tf,
    writers: Writers,
    descriptions: Descriptions,
    metadata: Descriptions,
    of_clouds: CloudOptions,
    parts: Parts,
    annotations: Annotations,
    log_ns: Option<(i64, i64)>,
    /// First and last log time of each unbroken stretch.
    stretches_ns: Vec<(i64, i64)>,
    at_seam: bool,
    messages: u64,
    refused_channels: u64,
    /// How many more members of messages may be kept.
    room_for_members: usize,
    /// Topics recorded as more than one type: `(topic, the other type, whether that one is read)`.
    mixed: Vec<(usize, String, bool)>,
}

impl Visit for Collector {
    fn channel(&mut self, channel: &Channel) {
        let entry = self.topic(channel);
        self.refused_channels += u64::from(entry.is_none());
        self.channels.push(entry);
    }

    fn message(&mut self, channel: &Channel, message: &Message<'_>) {
        self.messages += 1;
        self.parts.message(channel, message.log_ns);
        let log_ns = message.log_ns;
        let (first, last) = self.log_ns.unwrap_or((log_ns, log_ns));
        self.log_ns = Some((first.min(log_ns), last.max(log_ns)));

        if let Some((_, last)) = self.stretches_ns.last_mut().filter(|_| !self.at_seam) {
            *last = (*last).max(log_ns);
        } else if self.stretches_ns.len() < MAX_STRETCHES {
            self.stretches_ns.push((log_ns, log_ns));
        }
        self.at_seam = false;

        let Some(Some(state)) = self.channels.get(channel.number) else {
            return;
        };
        let Some(topic) = self.topics.get_mut(state.topic) else {
            return;
        };
        let point = topic.next_point(message);
        topic.written_by(state.writer);
        let Content { header, body, members } = match state.decoder.decode(message.data) {
            Ok(content) => content,
            Err(error) => return topic.malformed(point, error),
        };
        let has_header = header.is_some();
        // A capture states no frame, and most single packets neither: that they are without one is no fault.
        let is_made = channel.message_encoding == ASSEMBLED;
        let point = header.map_or(point, |header| {
            let is_frameless = is_made && header.frame_id.is_empty();
            topic.stamped(point, &header, is_frameless)
        });
        match body {
            // No buffer of tf2 listens to a single transform on a topic of its own: its frames are names, not TF.
            Body::Transforms(transforms) if has_header => {
                for transform in &transforms {
                    topic.child(point, &transform.child);
                }
            }
            Body::Transforms(transforms) => self.tf.message(state.topic, point, state.writer, &transforms),
            Body::ChildFrame(child) => topic.child(point, &child),
            Body::Frames(names) => topic.named(point, &names),
            Body::Description(text) => self.descriptions.push(point, &topic.name, &text),
            Body::Metadata(text) if may_be_ouster(&text) => self.metadata.push(point, &topic.name, &text),
            body => {
                if let Body::Odometry(odometry) = &body {
                    topic.child(point, &odometry.child);
                }
                topic.contents.body(point, &body);
            }
        }
        for member in &members {
            topic.members.push(point, member, &mut self.room_for_members);
        }
    }

    fn seam(&mut self) {
        self.at_seam = true;
        for topic in &mut self.topics {
            topic.seam();
        }
        self.tf.seam();
    }

    fn part(&mut self, name: &str) {
        self.parts.start(name);
    }

    fn annotation(&mut self, name: &str, fields: &BTreeMap<String, String>) {
        self.annotations.push(name, fields);
    }
}

/// What a channel says of its messages before the first one.
pub fn format_of(channel: &Channel) -> Format<'_> {
    Format {
        topic: &channel.topic,
        message_type: &channel.message_type,
        message_encoding: &channel.message_encoding,
        schema: &channel.schema,
        schema_encoding: &channel.schema_encoding,
    }
}

impl Collector {
    fn topic(&mut self, channel: &Channel) -> Option<ChannelState> {
        let format = format_of(channel);
        let decoder = self.decoders.of(&format, &channel.schema);
        let next = self.topics.len();
        let number = match self.topic_of.get(&channel.topic).copied() {
            Some(known) => {
                self.note_mixed(known, channel, &decoder);
                known
            }
            None if next >= MAX_TOPICS || channel.topic.len() > MAX_TOPIC_NAME => return None,
            None => {
                self.topic_of.insert(channel.topic.clone(), next);
                let alike = self
                    .topics
                    .iter()
                    .filter(|topic| topic.message_type == channel.message_type);
                let of_type = alike.count();
                self.topics
                    .push(Topic::new(channel, &decoder, next, of_type, &self.of_clouds));
                next
            }
        };
        if let Some(topic) = self.topics.get_mut(number) {
            topic.channel(channel);
            topic.is_asked_for |= format.is_asked_for();
        }
        self.tf.topic(number, &channel.topic);
        Some(ChannelState {
            topic: number,
            decoder,
            writer: channel.writer.as_deref().and_then(|writer| self.writers.number(writer)),
        })
    }

    fn note_mixed(&mut self, number: usize, channel: &Channel, decoder: &Decoder) {
        let known = self.topics.get(number);
        if self.mixed.len() < MAX_PROBLEMS && known.is_some_and(|topic| topic.message_type != channel.message_type) {
            let is_read = decoder.unread().is_none();
            self.mixed.push((number, channel.message_type.clone(), is_read));
        }
    }

    fn finish(self, source: &mut Source, extent: &Extent) -> Collection {
        self.problems(source);
        self.examined(source, extent);
        self.nothing_to_judge(source, extent.truncated);
        let (edges, parent_switches, mut frames) = self.tf.finish(source.id, &self.writers);
        for topic in &self.topics {
            frames.extend(topic.frame_uses(source.id));
        }
        frames.sort();
        let evidence = BagEvidence {
            start_ns: self.log_ns.map(|(first, _)| first),
            end_ns: self.log_ns.map(|(_, last)| last),
            messages: self.messages,
            topics: self
                .topics
                .into_iter()
                .map(|topic| (topic.name.clone(), topic.finish(&self.writers)))
                .collect(),
            tf: edges,
            parent_switches,
            truncated: extent.truncated,
            parts: self.parts.kept,
            share: Examined {
                // Where messages follow a seam, some are missing between.
                whole: extent.whole && self.stretches_ns.len() < 2,
                messages_total: extent.messages_total,
                span_ns: extent.span_ns.or(self.log_ns),
                stretches_ns: self.stretches_ns,
            },
            annotations: self.annotations.kept,
            ..BagEvidence::new(source.id)
        };
        Collection {
            facts: Facts {
                frames,
                bags: vec![evidence],
                ..Facts::default()
            },
            descriptions: self.descriptions.kept,
            metadata: self.metadata.kept,
        }
    }

    /// Notes how much of the recording was examined.
    fn examined(&self, source: &mut Source, extent: &Extent) {
        let examined = &mut source.examined;
        examined.messages_total = extent.messages_total;
        let length = |(first, last): (i64, i64)| last.saturating_sub(first);
        examined.time_total_ns = extent.span_ns.or(self.log_ns).map(length);
        examined.time_ns = Some(
            self.stretches_ns
                .iter()
                .copied()
                .map(length)
                .fold(0, i64::saturating_add),
        );
        examined.windows = (!extent.whole).then_some(self.stretches_ns.len() as u64);
    }

    /// Reports a recording that was read and holds nothing to judge.
    fn nothing_to_judge(&self, source: &mut Source, truncated: bool) {
        let spoken = || self.topics.iter().filter(|topic| topic.count > 0);
        let (message, help) = if self.messages == 0 && !truncated {
            (
                "no messages".to_owned(),
                "check that the recorder ran long enough and subscribed with a compatible QoS",
            )
        } else if let Some(first) = spoken().next()
            && let Some(why) = first.unread()
            && spoken().all(|topic| topic.unread().is_some())
        {
            let help = unread::help(first).unwrap_or("record or convert it with CDR messages, as ROS 2 writes them");
            (format!("none of its messages could be decoded: {why}"), help)
        } else {
            return;
        };
        source.problem_with_help(
            ReadStatus::Partial,
            Place::whole(source.id),
            message,
            Some(help.to_owned()),
        );
    }

    /// Reports everything that was left out of the evidence.
    fn problems(&self, source: &mut Source) {
        let id = source.id;
        let broken = self.topics.iter().filter_map(|topic| Some((topic, topic.broken()?)));
        for (topic, (count, first, error)) in broken.take(MAX_PROBLEMS) {
            let of = topic.count;
            let message = format!("{count} of {of} messages on `{}` do not decode: {error}", topic.name);
            let place = Place::message(id, first.on(&topic.name));
            source.problem(ReadStatus::Partial, place, message);
        }
        let refused = self
            .topics
            .iter()
            .filter_map(|topic| Some((&topic.name, topic.contents.refused_packets()?)));
        for (topic, packets) in refused.take(MAX_PROBLEMS) {
            let Some((first, reason)) = &packets.first else {
                continue;
            };
            let (count, of) = (packets.refused, packets.looked_at);
            let message = format!("{count} of {of} packets on `{topic}` are not decoded: {reason}");
            source.problem(ReadStatus::Partial, Place::message(id, first.on(topic)), message);
        }
        for (number, other, is_read) in &self.mixed {
            let Some(topic) = self.topics.get(*number) else {
                continue;
            };
            let (name, first) = (&topic.name, &topic.message_type);
            let message = format!("`{name}` is recorded as two types: `{first}` and `{other}`");
            let status = if *is_read {
                ReadStatus::Read
            } else {
                ReadStatus::Partial
            };
            source.problem(status, Place::whole(id), message);
        }
        unread::say(&self.topics, source);
        let refused_names: u64 = self.topics.iter().map(Topic::refused_names).sum();
        let refused_members: u64 = self.topics.iter().map(|topic| topic.members.refused).sum();
        let left_out = [
            (
                refused_members,
                format!("fields of messages beyond the first {MAX_MEMBERS} with the content of a standard type"),
            ),
            (
                self.refused_channels,
                format!("channels beyond the first {MAX_TOPICS} topics, or with very long names"),
            ),
            (
                self.tf.refused,
                format!("transforms beyond the first {MAX_EDGES} edges of TF"),
            ),
            (
                refused_names,
                "message headers beyond the limit of different frame names".to_owned(),
            ),
            (
                self.descriptions.refused,
                format!("robot descriptions beyond the first {MAX_DESCRIPTIONS}"),
            ),
            (
                self.metadata.refused,
                format!("sensor descriptions beyond the first {MAX_DESCRIPTIONS}"),
            ),
            (self.parts.refused, "files of a split recording".to_owned()),
            (
                self.annotations.refused,
                "fields of metadata records beyond the first megabyte".to_owned(),
            ),
        ];
        for (count, what) in left_out.into_iter().filter(|(count, _)| *count > 0) {
            let message = format!("{count} {what} were left out");
            source.problem(ReadStatus::Partial, Place::whole(id), message);
        }
    }
}
