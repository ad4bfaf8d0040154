//! Scans of lidars out of recordings that hold their packets one by one: topics of single packets, and captures of a network.
//!
//! Owns the gathering of packets into scans. A scan begins where [`crate::read::packets::boundary`] says; its header has the time at which
//! its first packet was received and the frame of its message, if that has one. Must not know what is in a packet.

use std::collections::BTreeMap;
use std::path::Path;
use std::sync::Arc;

use super::bag::{self, Channel, Extent, Message, Progress, Recording, Selection, Visit};
use super::messages::assembled::{AssembledScan, MadeMessage};
use super::messages::content::Body;
use super::messages::decoder::Decoder;
use super::messages::decoders::Decoders;
use super::messages::definition::Definitions;
use super::messages::format::Format;
use super::messages::packets::ASSEMBLED;
use super::ouster::{KnownSensors, Origin, may_be_imu};
use super::packets::{Boundary, Maker, Packet, boundary};
use crate::source::Source;

/// Types of messages with a single packet.
const SINGLE: [&str; 5] = [
    "VelodynePacket",
    "PandarPacket",
    "NebulaPacket",
    "UdpPacket",
    "PacketMsg",
];
/// A scan in which no packet comes for so long is not continued, nanoseconds; the slowest sensors turn in a fifth of a second.
const PAUSE_NS: u64 = 500_000_000;
/// Bound on a scan, nanoseconds: sensors that stand still begin no new one.
const LONGEST_NS: i64 = 1_000_000_000;
/// Bound on a scan, bytes. The largest of known sensors have five megabytes.
const MAX_SCAN: usize = 8 << 20;
/// Bound on all scans that are being gathered, bytes.
const MAX_GATHERED: usize = 96 << 20;

/// Reads a recording once, as [`bag::read`] does; single packets of lidars arrive as scans.
pub fn read(
    recording: &Recording<'_>,
    wanted: &Selection<'_>,
    definitions: &Arc<Definitions>,
    (source, progress): (&mut Source, Progress<'_>),
    visit: &mut dyn Visit,
) -> Extent {
    let path = recording.parts.first().map_or(recording.path, |part| part.as_path());
    let folder = if path.is_dir() { Some(path) } else { path.parent() };
    let name = path.file_name().unwrap_or_default().to_string_lossy();
    let mut scans = Scans {
        visit,
        name: &name,
        folder,
        sensors: None,
        decoders: Decoders::new(Arc::clone(definitions)),
        channels: Vec::new(),
        announced: 0,
        gathered: 0,
    };
    let mut extent = bag::read(recording, wanted, source, progress, &mut scans);
    if scans.finish() {
        // An index counts packets.
        extent.messages_total = None;
    }
    extent
}

/// What becomes of a channel's messages.
enum Entry {
    /// They are passed on.
    Plain(Channel),
    /// They are passed on, and may be the metadata of a sensor.
    Metadata(Channel, Decoder),
    /// They may be packets of a lidar: the first one decides.
    Open(Channel, Decoder),
    /// They are packets of an Ouster's IMU.
    Imu(Channel, Decoder),
    /// They are gathered.
    Lidar(Box<Lidar>),
}

/// Passes a recording on, with scans in the place of packets.
struct Scans<'v> {
    visit: &'v mut dyn Visit,
    /// The name of the recording's file, and its folder.
    name: &'v str,
    folder: Option<&'v Path>,
    /// The metadata that packets may decode by, once there are such packets or there is metadata.
    sensors: Option<KnownSensors>,
    decoders: Decoders,
    /// By the number of the channel in the recording.
    channels: Vec<Entry>,
    /// Channels that were announced.
    announced: usize,
    /// Bytes of the scans that are being gathered.
    gathered: usize,
}

impl Scans<'_> {
    fn sensors(&mut self) -> &mut KnownSensors {
        let folder = self.folder;
        self.sensors
            .get_or_insert_with(|| folder.map_or_else(KnownSensors::default, KnownSensors::in_folder))
    }

    fn announce(&mut self, channel: &Channel) -> Channel {
        let channel = Channel {
            number: self.announced,
            ..channel.clone()
        };
        self.announced += 1;
        self.visit.channel(&channel);
        channel
    }

    /// The first message of a channel decides what the channel is.
    fn decide(&mut self, channel: &Channel, decoder: Decoder, data: &[u8]) -> Entry {
        let copy = decoder.clone();
        let packet = match copy.decode(data).map(|content| content.body) {
            Ok(Body::Packet(packet)) => packet.bytes,
            _ => &[],
        };
        let Some(maker) = Maker::of(packet) else {
            let name = self.name;
            if !may_be_imu(packet) {
                return Entry::Plain(self.announce(channel));
            }
            if self.sensors().of_imu(packet, &origin(name, &channel.topic)).is_none() {
                // Its metadata may follow.
                return Entry::Open(channel.clone(), decoder);
            }
            let channel = self.announce(&Channel {
                message_type: "sensor_msgs/msg/Imu".to_owned(),
                message_encoding: ASSEMBLED.to_owned(),
                schema: Arc::from([]),
                schema_encoding: String::new(),
                ..channel.clone()
            });
            return Entry::Imu(channel, decoder);
        };
        if maker == Maker::Ouster {
            self.sensors();
        }
        let channel = self.announce(&Channel {
            message_encoding: ASSEMBLED.to_owned(),
            total: None,
            ..channel.clone()
        });
        Entry::Lidar(Box::new(Lidar::new(channel, decoder, maker)))
    }

    /// Passes on what was gathered last; gives whether there are scans.
    fn finish(&mut self) -> bool {
        let mut has_scans = false;
        let only = self
            .sensors
            .as_ref()
            .and_then(KnownSensors::only)
            .map(ToOwned::to_owned);
        for entry in std::mem::take(&mut self.channels) {
            match entry {
                Entry::Plain(_) | Entry::Metadata(..) | Entry::Imu(..) => {}
                // Without messages it is announced too.
                Entry::Open(channel, _) => {
                    self.announce(&channel);
                }
                Entry::Lidar(mut lidar) => {
                    has_scans = true;
                    lidar.finish(only.as_deref(), &mut *self.visit);
                }
            }
        }
        has_scans
    }
}

impl Visit for Scans<'_> {
    fn channel(&mut self, channel: &Channel) {
        let name = channel.message_type.rsplit('/').next().unwrap_or_default();
        let may_be_metadata = name == "String" && channel.topic.ends_with("metadata");
        let entry = if may_be_metadata || SINGLE.contains(&name) {
            let format = Format {
                topic: &channel.topic,
                message_type: &channel.message_type,
                message_encoding: &channel.message_encoding,
                schema: &channel.schema,
                schema_encoding: &channel.schema_encoding,
            };
            let decoder = self.decoders.of(&format, &channel.schema);
            if may_be_metadata {
                Entry::Metadata(self.announce(channel), decoder)
            } else {
                Entry::Open(channel.clone(), decoder)
            }
        } else {
            Entry::Plain(self.announce(channel))
        };
        self.channels.push(entry);
    }

    fn message(&mut self, channel: &Channel, message: &Message<'_>) {
        let number = channel.number;
        if let Some(Entry::Open(_, decoder)) = self.channels.get(number) {
            let decoder = decoder.clone();
            let decided = self.decide(channel, decoder, message.data);
            if let Some(entry) = self.channels.get_mut(number) {
                *entry = decided;
            }
        }
        if let Some(Entry::Metadata(_, decoder)) = self.channels.get(number) {
            let decoder = decoder.clone();
            if let Ok(Body::Metadata(text)) = decoder.decode(message.data).map(|content| content.body) {
                self.sensors().add(&channel.topic, &text, true);
            }
        }
        let (name, sensors) = (self.name, self.sensors.as_ref());
        match self.channels.get_mut(number) {
            Some(Entry::Plain(channel) | Entry::Metadata(channel, _)) => self.visit.message(channel, message),
            Some(Entry::Imu(channel, decoder)) => {
                let content = decoder.decode(message.data);
                let Ok(Body::Packet(packet)) = content.map(|content| content.body) else {
                    return;
                };
                let measured = sensors.and_then(|sensors| sensors.of_imu(packet.bytes, &origin(name, &channel.topic)));
                let mut made = MadeMessage::default();
                for imu in measured.into_iter().flatten() {
                    let data = made.imu(received_ns(&packet, message.log_ns), "", &imu);
                    self.visit.message(channel, &Message { data, ..*message });
                }
            }
            Some(Entry::Lidar(lidar)) => {
                let before = lidar.scan.scan.len();
                lidar.message(message, (self.gathered, name, sensors), &mut *self.visit);
                self.gathered = self.gathered.saturating_sub(before) + lidar.scan.scan.len();
            }
            Some(Entry::Open(..)) | None => {}
        }
    }

    fn seam(&mut self) {
        for entry in &mut self.channels {
            if let Entry::Lidar(lidar) = entry {
                lidar.break_off();
            }
        }
        self.gathered = 0;
        self.visit.seam();
    }

    fn part(&mut self, name: &str) {
        self.visit.part(name);
    }

    fn annotation(&mut self, name: &str, fields: &BTreeMap<String, String>) {
        self.visit.annotation(name, fields);
    }
}

/// One lidar whose packets are gathered.
struct Lidar {
    channel: Channel,
    decoder: Decoder,
    maker: Maker,
    boundary: Box<dyn Boundary>,
    scan: Gathered,
    /// The metadata of an Ouster, if it is known.
    metadata: Option<String>,
    /// Whether the scan has its beginning.
    is_begun: bool,
    /// Whether a scan was passed on.
    has_scans: bool,
    /// The longest part of a scan, while there are no whole ones.
    part: Gathered,
}

/// Packets of a scan, with the log times of the first and the last one, nanoseconds.
#[derive(Default)]
struct Gathered {
    scan: AssembledScan,
    span_ns: (i64, i64),
}

impl Lidar {
    fn new(channel: Channel, decoder: Decoder, maker: Maker) -> Self {
        Self {
            channel,
            decoder,
            maker,
            boundary: boundary(maker),
            scan: Gathered::default(),
            metadata: None,
            is_begun: false,
            has_scans: false,
            part: Gathered::default(),
        }
    }

    /// Takes in a message; `gathered` bytes are being held of all lidars.
    fn message(
        &mut self,
        message: &Message<'_>,
        (gathered, name, sensors): (usize, &str, Option<&KnownSensors>),
        visit: &mut dyn Visit,
    ) {
        let Ok(content) = self.decoder.decode(message.data) else {
            // Without bytes it does not decode as a scan either, and is counted as such.
            let broken = Message { data: &[], ..*message };
            return visit.message(&self.channel, &broken);
        };
        if let Body::Packet(packet) = content.body {
            let frame = content.header.map(|header| header.frame_id).unwrap_or_default();
            if self.maker == Maker::Ouster && self.metadata.is_none() {
                let known = sensors.and_then(|all| all.of_lidar(packet.bytes, &origin(name, &self.channel.topic)));
                self.metadata = known.map(ToOwned::to_owned);
            }
            let packet = Packet {
                received_ns: received_ns(&packet, message.log_ns),
                ..packet
            };
            self.packet(message.log_ns, (&packet, &frame), gathered, visit);
        }
    }

    fn packet(&mut self, log_ns: i64, (packet, frame): (&Packet<'_>, &str), gathered: usize, visit: &mut dyn Visit) {
        let (first_ns, last_ns) = self.scan.span_ns;
        if !self.scan.scan.is_empty() && log_ns.abs_diff(last_ns) > PAUSE_NS {
            self.break_off();
        }
        let begins = self.boundary.begins(packet.bytes) == Some(true);
        if !self.scan.scan.is_empty() {
            let more = packet.bytes.len();
            let is_full = self.scan.scan.len() + more > MAX_SCAN || gathered + more > MAX_GATHERED;
            let is_long = is_full || log_ns.saturating_sub(first_ns) > LONGEST_NS;
            if begins || is_long {
                self.end(is_long, visit);
            }
        }
        self.is_begun |= begins;
        if self.scan.scan.is_empty() {
            self.scan.scan.begin(packet.received_ns, frame);
            self.scan.span_ns.0 = log_ns;
        }
        self.scan.span_ns.1 = log_ns;
        self.scan.scan.push(packet);
    }

    /// Ends the scan. The first one of a stretch is passed on only if it is whole: the recording began somewhere in the turn, and rules on
    /// rates and sweeps would take the part for a short scan.
    fn end(&mut self, is_long: bool, visit: &mut dyn Visit) {
        // The metadata may follow.
        let is_undescribed = self.maker == Maker::Ouster && self.metadata.is_none();
        if (self.is_begun || is_long) && !is_undescribed {
            self.has_scans = true;
            pass(&mut self.scan, self.metadata.as_deref(), &self.channel, visit);
        } else {
            self.keep_part();
        }
    }

    /// Ends the scan where packets are missing.
    fn break_off(&mut self) {
        self.keep_part();
        self.is_begun = false;
        self.boundary = boundary(self.maker);
    }

    fn keep_part(&mut self) {
        if !self.has_scans && self.scan.scan.len() > self.part.scan.len() {
            std::mem::swap(&mut self.scan, &mut self.part);
        }
        self.scan.scan.clear();
    }

    /// The end of the recording: a part of a scan is better than none.
    fn finish(&mut self, only: Option<&str>, visit: &mut dyn Visit) {
        self.keep_part();
        if !self.has_scans {
            let metadata = self
                .metadata
                .as_deref()
                .or(only.filter(|_| self.maker == Maker::Ouster));
            pass(&mut self.part, metadata, &self.channel, visit);
        }
    }
}

/// What is known of packets besides their bytes; the topics of captures end with the port.
fn origin<'o>(name: &'o str, topic: &'o str) -> Origin<'o> {
    let port = topic.rsplit_once(':').and_then(|(_, port)| port.parse().ok());
    Origin {
        port,
        names: [name, topic],
    }
}

/// When the host received a packet, nanoseconds: when it was recorded, if its message does not state that.
fn received_ns(packet: &Packet<'_>, log_ns: i64) -> i64 {
    if packet.received_ns == 0 {
        log_ns
    } else {
        packet.received_ns
    }
}

/// Passes on a scan, with the metadata of its sensor, which may have come in its midst.
fn pass(gathered: &mut Gathered, metadata: Option<&str>, channel: &Channel, visit: &mut dyn Visit) {
    let log_ns = gathered.span_ns.1;
    if let Some(text) = metadata.filter(|_| !gathered.scan.is_empty()) {
        gathered.scan.describe(text);
    }
    if let Some(data) = gathered.scan.message() {
        visit.message(channel, &Message { log_ns, data });
    }
    gathered.scan.clear();
}
