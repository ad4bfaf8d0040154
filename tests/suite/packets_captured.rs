//! Packets that come one by one, in captures of a network and in topics of single packets: they are gathered into the scans of which a driver
//! would have made messages.

#![allow(clippy::unwrap_used, clippy::indexing_slicing, clippy::panic)]

use std::collections::BTreeMap;
use std::fs;
use std::path::Path;
use std::sync::Arc;

use frames_lint::collect::format_of;
use frames_lint::read::bag::{Channel, Extent, Message, Recording, Sampling, Selection, Visit};
use frames_lint::read::messages::content::Body;
use frames_lint::read::messages::decoder::Decoder;
use frames_lint::read::messages::definition::Definitions;
use frames_lint::read::packets::{Maker, Packet, decode};
use frames_lint::read::scans;
use frames_lint::source::{ReadStatus, Source, SourceId, SourceKind};
use nalgebra::Vector3;

use crate::support::capture::{Capture, Datagram, Form, Ip, Link, PCAP};
use crate::support::packets::{PACKET_NS, SEQUENCES, Scan, Shot};
use crate::support::program;
use crate::support::reading::{folder, found, messages};

const START_NS: i64 = 1_700_000_000_000_000_000;
/// Packets of a turn.
pub(super) const TURN: usize = 75;

type Point = [f64; 3];

/// When a packet was sent, nanoseconds, and its bytes.
type Sent = (i64, Vec<u8>);

/// The packets of so many turns of a VLP-16, and what is decoded of each turn.
pub(super) fn turns(count: usize) -> (Vec<Sent>, Vec<Vec<Point>>) {
    let (mut packets, mut clouds) = (Vec::new(), Vec::new());
    for turn in 0..count {
        let scan = Scan {
            sequences: TURN * SEQUENCES,
            start_ns: START_NS + i64::try_from(turn * TURN).unwrap() * PACKET_NS,
            backwards: false,
        };
        let shots: Vec<Shot> = (0..60)
            .map(|number| {
                let azimuth = (0.2 * f64::from(number) * 30.0).to_radians();
                let range = 5.0 + turn as f64 + f64::from(number) * 0.1;
                let elevation = 1_f64.to_radians();
                let flat = range * elevation.cos();
                Shot {
                    sequence: usize::try_from(number).unwrap() * 30,
                    place: Vector3::new(flat * azimuth.cos(), -flat * azimuth.sin(), range * elevation.sin()),
                }
            })
            .collect();
        let of_turn = scan.packets(&shots);
        let received = of_turn.iter().map(|(received_ns, bytes)| Packet {
            received_ns: *received_ns,
            bytes,
        });
        let decoded = decode(Maker::Velodyne, received).unwrap();
        let returns = decoded.returns.iter();
        clouds.push(
            returns
                .map(|point| [point.x, point.y, point.z].map(f64::from))
                .collect(),
        );
        packets.extend(of_turn);
    }
    (packets, clouds)
}

pub(super) fn datagrams(packets: &[(i64, Vec<u8>)], from: [u8; 4]) -> Vec<Datagram> {
    let of = |(at_ns, data): &(i64, Vec<u8>)| Datagram {
        at_ns: *at_ns,
        from,
        port: 2368,
        data: data.clone(),
    };
    packets.iter().map(of).collect()
}

/// A scan: its log time, its stamp, and its points.
type Seen = (i64, i64, Vec<Point>);

/// The scans of every topic.
#[derive(Default)]
pub(super) struct Scans {
    decoders: Vec<Decoder>,
    pub(super) types: BTreeMap<String, String>,
    pub(super) seen: BTreeMap<String, Vec<Seen>>,
    pub(super) seams: usize,
}

impl Visit for Scans {
    fn channel(&mut self, channel: &Channel) {
        assert_eq!(channel.number, self.decoders.len());
        self.decoders
            .push(Decoder::of(&format_of(channel), &Definitions::builtin()));
        self.types.insert(channel.topic.clone(), channel.message_type.clone());
    }

    fn message(&mut self, channel: &Channel, message: &Message<'_>) {
        let content = self.decoders[channel.number].decode(message.data).unwrap();
        let Body::Packets(scan) = content.body else { return };
        let stamp_ns = content.header.unwrap().stamp_ns;
        let cloud = scan.decode(stamp_ns).unwrap().cloud;
        let axes = ["x", "y", "z"].map(|name| cloud.column(name).unwrap());
        let point = |number| axes.map(|axis| axis.of(cloud.point(0, number).unwrap()).unwrap());
        let points = (0..cloud.width).map(point).collect();
        let seen = self.seen.entry(channel.topic.clone()).or_default();
        seen.push((message.log_ns, stamp_ns, points));
    }

    fn seam(&mut self) {
        self.seams += 1;
    }
}

pub(super) fn read(path: &Path, sampling: Option<Sampling>) -> (Source, Extent, Scans) {
    let mut source = Source::new(SourceId(0), "", SourceKind::Pcap);
    let mut seen = Scans::default();
    let wanted = Selection {
        sampling,
        ..Selection::ALL
    };
    let recording = Recording { path, parts: &[] };
    let definitions = Arc::new(Definitions::builtin());
    let extent = scans::read(&recording, &wanted, &definitions, (&mut source, &|_, _| {}), &mut seen);
    (source, extent, seen)
}

#[test]
fn captures_of_every_kind_have_the_scans_of_the_sensor() {
    // The first and the last turn are not whole.
    let (packets, clouds) = turns(5);
    let packets = &packets[30..packets.len() - 20];
    let ng = |big, unit| Form::PcapNg { big, unit };
    let pcap = |big, nanoseconds| Form::Pcap { big, nanoseconds };
    let kinds = [
        (pcap(false, false), Link::Ethernet, Ip::V4),
        (pcap(true, false), Link::Vlan, Ip::V6),
        (pcap(false, true), Link::Cooked, Ip::Fragments),
        (pcap(true, true), Link::Cooked2, Ip::Fragments6),
        (ng(false, 6), Link::Raw, Ip::V6),
        (ng(true, 9), Link::Loopback, Ip::V4),
        (ng(false, 0x80 + 30), Link::Vlan, Ip::Fragments),
    ];
    let folder = folder();
    let path = folder.path().join("drive.pcap");
    for (form, link, ip) in kinds {
        let of = format!("{form:?} {link:?} {ip:?}");
        let capture = Capture::of(form, link, ip, &datagrams(packets, [192, 168, 1, 201]));
        fs::write(&path, &capture.bytes).unwrap();
        let (source, extent, scans) = read(&path, None);
        assert_eq!((source.status, messages(&source)), (ReadStatus::Read, vec![]), "{of}");
        assert!(extent.whole && !extent.truncated && scans.seams == 0);
        let is_v6 = matches!(ip, Ip::V6 | Ip::Fragments6);
        let topic = if is_v6 {
            "/udp/[::ffff:192.168.1.201]:2368"
        } else {
            "/udp/192.168.1.201:2368"
        };
        assert_eq!(scans.seen.keys().collect::<Vec<_>>(), [topic], "{of}");
        let seen = &scans.seen[topic];
        assert_eq!(seen.len(), 3, "{of}");
        for ((log_ns, stamp_ns, points), turn) in seen.iter().zip(1..) {
            let (first, last) = (packets[TURN * turn - 30].0, packets[TURN * turn + 44].0);
            assert!((stamp_ns - first).abs() < 1000 && (log_ns - last).abs() < 1000, "{of}");
            assert_eq!(*points, clouds[turn], "{of}");
        }
    }
}

#[test]
fn each_lidar_has_its_topic_and_other_packets_are_left_out() {
    let (packets, clouds) = turns(4);
    let mut all = datagrams(&packets[10..], [192, 168, 1, 201]);
    all.extend(datagrams(&packets[40..], [192, 168, 1, 202]));
    let other = |at_ns, port, data: &[u8]| Datagram {
        at_ns,
        from: [192, 168, 1, 1],
        port,
        data: data.to_vec(),
    };
    all.push(other(packets[100].0, 53, b"who is it"));
    let sentence = b"$GPRMC,123519,A,4807.038,N,01131.000,E,022.4,084.4,230394,003.1,W*6A\r\n";
    let position = [&[0; 206][..], sentence, &[0; 306 - 70]].concat();
    all.push(other(packets[100].0, 8308, &position));
    all.push(other(packets[101].0, 8308, &position));
    all.sort_by_key(|datagram| datagram.at_ns);
    let folder = folder();
    let path = folder.path().join("drive.pcapng");
    fs::write(&path, Capture::of(PCAP, Link::Ethernet, Ip::V4, &all).bytes).unwrap();
    let (source, _, scans) = read(&path, None);
    assert_eq!(messages(&source), [""; 0]);
    assert_eq!(
        source.notes,
        ["1 datagrams of other senders and 0 packets of other protocols were left out"]
    );
    for address in ["201", "202"] {
        let seen = &scans.seen[&format!("/udp/192.168.1.{address}:2368")];
        let points: Vec<&Vec<Point>> = seen.iter().map(|(.., points)| points).collect();
        assert_eq!(points, [&clouds[1], &clouds[2]], "{address}");
    }
    assert_eq!(scans.types["/udp/192.168.1.1:8308"], "nmea_msgs/msg/Sentence");
    let (source, collection) = found(&path);
    assert_eq!(source.kind, SourceKind::Pcap);
    let bag = &collection.facts.bags[0];
    assert_eq!(bag.topics["/udp/192.168.1.1:8308"].count, 1);
    let topic = &bag.topics["/udp/192.168.1.202:2368"];
    assert!(topic.header_frames.is_empty() && topic.count == 2 && topic.stamps.count == 2);
    assert!(topic.content.clouds.as_ref().unwrap().packets.is_some());
}

#[test]
fn a_few_packets_are_a_part_of_a_scan() {
    let (packets, _) = turns(1);
    let folder = folder();
    let path = folder.path().join("drive.cap");
    let capture = Capture::of(
        PCAP,
        Link::Ethernet,
        Ip::V4,
        &datagrams(&packets[20..50], [10, 0, 0, 1]),
    );
    fs::write(&path, capture.bytes).unwrap();
    let (source, _, scans) = read(&path, None);
    assert_eq!(source.status, ReadStatus::Read);
    assert_eq!(scans.seen["/udp/10.0.0.1:2368"].len(), 1);
}

/// Packets as messages of a type: the definition, and how a message is written.
type Written = (&'static str, &'static str, fn(i64, &[u8]) -> Vec<u8>);

fn time(at_ns: i64) -> [u8; 8] {
    let seconds = u32::try_from(at_ns / 1_000_000_000).unwrap().to_le_bytes();
    let rest = u32::try_from(at_ns % 1_000_000_000).unwrap().to_le_bytes();
    [seconds, rest].concat().try_into().unwrap()
}

#[test]
fn topics_of_single_packets_are_scans_in_their_own_type() {
    let (packets, clouds) = turns(4);
    let kinds: [Written; 3] = [
        (
            "velodyne_msgs/msg/VelodynePacket",
            "builtin_interfaces/Time stamp\nuint8[1206] data",
            |at_ns, data| [&[0, 1, 0, 0][..], &time(at_ns), data].concat(),
        ),
        (
            "nebula_msgs/msg/NebulaPacket",
            "builtin_interfaces/Time stamp\nuint8[] data",
            |at_ns, data| {
                let length = u32::try_from(data.len()).unwrap().to_le_bytes();
                [&[0, 1, 0, 0][..], &time(at_ns), &length, data].concat()
            },
        ),
        (
            "udp_msgs/msg/UdpPacket",
            "std_msgs/Header header\nstring address\nuint16 src_port\nuint8[] data",
            |at_ns, data| {
                let length = u32::try_from(data.len()).unwrap().to_le_bytes();
                let head = [6, 0, 0, 0, b'l', b'i', b'd', b'a', b'r', 0, 0, 0];
                let address = [4, 0, 0, 0, b'1', b'.', b'2', 0, 0x40, 0x09, 0, 0];
                [&[0, 1, 0, 0][..], &time(at_ns), &head, &address, &length, data].concat()
            },
        ),
    ];
    let folder = folder();
    let path = folder.path().join("drive.mcap");
    for (name, definition, written) in kinds {
        let separator = "=".repeat(80);
        let definition = format!(
            "{definition}\n{separator}\nMSG: std_msgs/Header\nbuiltin_interfaces/Time stamp\nstring frame_id\n{separator}\n\
             MSG: builtin_interfaces/Time\nint32 sec\nuint32 nanosec\n"
        );
        let mut writer = mcap::Writer::new(fs::File::create(&path).unwrap()).unwrap();
        let schema = writer.add_schema(name, "ros2msg", definition.as_bytes()).unwrap();
        let channel = writer.add_channel(schema, "/raw", "cdr", &BTreeMap::new()).unwrap();
        let other = writer.add_channel(schema, "/other", "cdr", &BTreeMap::new()).unwrap();
        for (number, (at_ns, data)) in packets.iter().skip(10).enumerate() {
            for (channel_id, data) in [(channel, data.clone()), (other, vec![7; data.len()])] {
                let header = mcap::records::MessageHeader {
                    channel_id,
                    sequence: u32::try_from(number).unwrap(),
                    log_time: u64::try_from(*at_ns).unwrap(),
                    publish_time: u64::try_from(*at_ns).unwrap(),
                };
                writer.write_to_known_channel(&header, &written(*at_ns, &data)).unwrap();
            }
        }
        writer.finish().unwrap();
        let (source, extent, scans) = read(&path, None);
        assert_eq!((source.status, messages(&source)), (ReadStatus::Read, vec![]), "{name}");
        assert_eq!(extent.messages_total, None);
        let points: Vec<&Vec<Point>> = scans.seen["/raw"].iter().map(|(.., points)| points).collect();
        assert_eq!(points, [&clouds[1], &clouds[2]], "{name}");
        assert_eq!(scans.types["/raw"], name);
        assert!(!scans.seen.contains_key("/other") && scans.types["/other"] == name);
        let (_, collection) = found(&path);
        let topics = &collection.facts.bags[0].topics;
        assert_eq!((topics["/raw"].count, topics["/other"].count), (2, 290), "{name}");
        assert_eq!(
            topics["/raw"].header_frames.len(),
            usize::from(name.starts_with("udp")),
            "{name}"
        );
    }
}

#[test]
fn that_a_capture_states_no_frame_is_no_fault() {
    let (packets, _) = turns(20);
    let folder = folder();
    let capture = Capture::of(PCAP, Link::Ethernet, Ip::V4, &datagrams(&packets, [192, 168, 1, 201]));
    fs::write(folder.path().join("drive.pcap"), capture.bytes).unwrap();
    let robot = "<robot name='r'><link name='base_link'/><link name='front_lidar'/><joint name='j' type='fixed'>\
                 <parent link='base_link'/><child link='front_lidar'/><origin xyz='0 0 1.8'/></joint></robot>";
    fs::write(folder.path().join("r.urdf"), robot).unwrap();
    let report = program::run(folder.path(), ["check", ".", "--format", "json"]).report();
    assert_eq!(
        report["findings"].as_array().unwrap().len(),
        0,
        "{}",
        report["findings"]
    );
    let reason = "missing input: a capture, or a topic of single packets, does not state the frame of its lidar";
    let rows = report["outcomes"].as_array().unwrap();
    assert!(rows.iter().any(|row| row["reason"] == reason), "{rows:#?}");
    let clouds = folder.path().join("cloud.pcd");
    let ran = program::run(folder.path(), ["collect", "drive.pcap", "--clouds", "cloud.pcd"]);
    assert_eq!(ran.code, 0, "{}", ran.text());
    assert!(fs::read(&clouds).unwrap().starts_with(b"# .PCD"));
}
