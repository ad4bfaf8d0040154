//! Messages with packets of a lidar: read in every recording, and where they are damaged, that is said and nothing is invented.

#![allow(clippy::unwrap_used, clippy::indexing_slicing, clippy::panic)]

use std::fs;
use std::path::Path;

use frames_lint::read::messages::content::Body;
use frames_lint::read::messages::decoder::Decoder;
use frames_lint::read::messages::definition::Definitions;
use frames_lint::read::messages::format::Format;
use frames_lint::read::packets::{Maker, Packet, decode};
use frames_lint::source::{ReadStatus, Source};
use frames_lint::world::bag::BagEvidence;
use frames_lint::world::cloud::CloudEvidence;
use nalgebra::Vector3;

use crate::support::packets::{BYTES, SEQUENCES, Scan, Shot};
use crate::support::program;
use crate::support::reading::{folder, found, messages};
use crate::support::ros1::bag_of;
use crate::support::rosbag1;
use crate::support::rosbag2::{Db3, Drive, Schema};

const RECIPE: &str = "\
duration_s: 2
drive: {vehicle: car, motion: turning, seed: 5}
topics:
  - {topic: /imu, from_drive: imu, rate_hz: 100, frame_id: imu_link}
  - {topic: /velodyne_packets, from_drive: lidar, rate_hz: 10, frame_id: velodyne, xyz: [0, 0, 1.8], lidar: {driver: velodyne_packets, table: vlp16, columns: 180}}
";

/// Bytes of a message from one packet to the next, as CDR aligns them, and what precedes the data of the first: encapsulation, header with the frame
/// `velodyne`, the number of packets, the first stamp.
const STEP: usize = 8 + BYTES + 2;
const FIRST: usize = 4 + 8 + 4 + 12 + 4 + 8;

/// The drive with its messages of packets changed.
fn drive(mut change: impl FnMut(&mut Vec<u8>)) -> Drive {
    let mut drive = Drive::of(RECIPE);
    let topic = drive
        .topics
        .iter()
        .position(|topic| topic.name == "/velodyne_packets")
        .unwrap();
    let of_lidar = drive.messages.iter_mut().filter(|message| message.topic == topic);
    of_lidar.for_each(|message| change(&mut message.data));
    drive
}

/// Sets a byte of every packet, counted from its start.
fn in_packets(message: &mut [u8], at: usize, value: u8) {
    for packet in (FIRST..message.len()).step_by(STEP) {
        message[packet + at] = value;
    }
}

fn collected(drive: &Drive) -> (Source, BagEvidence) {
    let folder = folder();
    let path = folder.path().join("drive.mcap");
    drive.write_mcap(&path);
    read(&path)
}

fn read(path: &Path) -> (Source, BagEvidence) {
    let (source, collection) = found(path);
    (source, collection.facts.bags.into_iter().next().unwrap())
}

fn clouds(bag: &BagEvidence) -> Option<&CloudEvidence> {
    bag.topics["/velodyne_packets"].content.clouds.as_ref()
}

#[test]
fn packets_are_clouds_in_every_recording() {
    let drive = drive(|_| {});
    let folder = folder();
    let at = |name: &str| folder.path().join(name);
    drive.write_mcap(&at("drive.mcap"));
    let humble = Db3 {
        schema: Schema::Humble,
        ..Db3::default()
    };
    drive.write_db3(&at("drive.db3"), humble);
    fs::write(at("drive.bag"), bag_of(&drive, rosbag1::Layout::default()).bytes).unwrap();
    let mut samples = Vec::new();
    for name in ["drive.mcap", "drive.db3", "drive.bag"] {
        let (source, bag) = read(&at(name));
        assert_eq!((source.status, messages(&source)), (ReadStatus::Read, vec![]), "{name}");
        let clouds = clouds(&bag).unwrap();
        let sensor = clouds.packets.as_ref().unwrap();
        assert_eq!(
            (sensor.maker.as_str(), sensor.model.as_str()),
            ("Velodyne", "VLP-16"),
            "{name}"
        );
        let fields: Vec<&str> = clouds.layouts[0]
            .fields
            .iter()
            .map(|field| field.name.as_str())
            .collect();
        assert_eq!(fields, ["x", "y", "z", "intensity", "ring", "time"]);
        assert!(
            clouds
                .samples
                .iter()
                .all(|sample| sample.returns > 500 && sample.rings == Some(16))
        );
        // The header has the stamp of the last packet, as the driver writes it.
        let times = clouds.samples[0].times.as_ref().unwrap();
        assert!(times.range[0] > -0.1 && times.range[1] < 0.01, "{:?}", times.range);
        samples.push(clouds.samples.clone());
    }
    assert!(samples.windows(2).all(|pair| pair[0] == pair[1]));
}

#[test]
fn points_are_where_the_rays_ended() {
    let scan = Scan {
        sequences: 75 * SEQUENCES,
        start_ns: 1_700_000_000_000_000_000,
        backwards: false,
    };
    let place = |sequence: usize, row: usize| {
        let laser = if row < 8 { 2 * row } else { 2 * (row - 8) + 1 };
        // Lasers fire 2.304 microseconds apart, and the sensor turns on meanwhile.
        let azimuth = (0.2 * (sequence as f64 + laser as f64 * 2.304 / 55.296)).to_radians();
        let elevation = (-15.0 + 2.0 * row as f64).to_radians();
        let flat = 12.5 * elevation.cos();
        Vector3::new(flat * azimuth.cos(), -flat * azimuth.sin(), 12.5 * elevation.sin())
    };
    // The azimuth of a block is that of its first laser: the first shot shows it.
    let rows = [0, 15, 7, 8, 3];
    let shots: Vec<Shot> = (0..200)
        .map(|number| {
            let sequence = number * 9;
            let place = place(sequence, rows[number % rows.len()]);
            Shot { sequence, place }
        })
        .collect();
    let packets = scan.packets(&shots);
    let received = packets.iter().map(|(received_ns, bytes)| Packet {
        received_ns: *received_ns,
        bytes,
    });
    let decoded = decode(Maker::Velodyne, received).unwrap();
    assert_eq!(
        (&*decoded.model, decoded.refused, decoded.returns.len()),
        ("VLP-16", 0, shots.len())
    );
    for (shot, point) in shots.iter().zip(&decoded.returns) {
        let found = Vector3::new(f64::from(point.x), f64::from(point.y), f64::from(point.z));
        // Azimuths are sent in hundredths of a degree: 1.1 mm either way, and the driver rounds once more.
        let off = (found - shot.place).norm();
        assert!(off < 0.004, "sequence {}: {off} m", shot.sequence);
    }
}

#[test]
fn an_unknown_model_is_named_and_the_rest_is_judged() {
    let (source, bag) = collected(&drive(|message| in_packets(message, BYTES - 1, 0x77)));
    assert_eq!(source.status, ReadStatus::Partial);
    let [said] = messages(&source)[..] else {
        panic!("{:?}", messages(&source))
    };
    assert!(
        said.contains("packets on `/velodyne_packets` are not decoded") && said.contains("0x77"),
        "{said}"
    );
    assert!(clouds(&bag).is_none_or(|clouds| clouds.samples.is_empty() && clouds.packets.is_none()));
    assert_eq!(bag.topics["/velodyne_packets"].count, 20);
    assert!(
        bag.topics["/velodyne_packets"]
            .header_frames
            .keys()
            .any(|frame| frame.as_str() == "velodyne")
    );
    assert!(bag.topics["/imu"].content.imu.is_some());
}

#[test]
fn a_damaged_packet_is_counted_and_the_others_are_decoded() {
    let (source, bag) = collected(&drive(|message| message[FIRST] = 0));
    let [said] = messages(&source)[..] else {
        panic!("{:?}", messages(&source))
    };
    assert!(
        said.starts_with("20 of 1500 packets on `/velodyne_packets` are not decoded: "),
        "{said}"
    );
    assert!(clouds(&bag).unwrap().samples.iter().all(|sample| sample.returns > 500));
}

#[test]
fn a_message_that_is_cut_does_not_decode() {
    for length in [FIRST, FIRST + 700, FIRST + 3 * STEP - 1] {
        let (source, bag) = collected(&drive(|message| message.truncate(length)));
        let [said] = messages(&source)[..] else {
            panic!("{:?}", messages(&source))
        };
        assert!(
            said.starts_with("20 of 20 messages on `/velodyne_packets` do not decode"),
            "{said}"
        );
        assert!(clouds(&bag).is_none());
        assert!(bag.topics["/imu"].content.imu.is_some());
    }
}

#[test]
fn one_cloud_is_written_for_other_programs() {
    let folder = folder();
    drive(|_| {}).write_mcap(&folder.path().join("drive.mcap"));
    let ran = program::run(folder.path(), ["collect", "drive.mcap", "--clouds", "first.pcd"]);
    assert_eq!((ran.code, ran.out.is_empty()), (0, true), "{}", ran.err);
    let pcd = fs::read(folder.path().join("first.pcd")).unwrap();
    let text = String::from_utf8_lossy(&pcd);
    let head = text.split("DATA binary\n").next().unwrap();
    assert!(
        head.contains("FIELDS x y z intensity ring time\n") && head.contains("VIEWPOINT 0 0 0 1 0 0 0\n"),
        "{head}"
    );
    let count = head.split("POINTS ").nth(1).unwrap().trim().parse::<usize>().unwrap();
    assert!(count > 500);
    assert_eq!(pcd.len(), head.len() + "DATA binary\n".len() + count * 26);
    // It is replaced by the next run; a recording never is.
    let again = program::run(folder.path(), ["collect", "drive.mcap", "--clouds", "first.pcd"]);
    assert_eq!(again.code, 0, "{}", again.err);
    let over = program::run(
        folder.path(),
        ["collect", "drive.mcap", "--clouds", "drive.mcap", "--force"],
    );
    assert_eq!(over.code, 2, "{}", over.err);
    let none = program::run(
        folder.path(),
        ["collect", "drive.mcap", "--clouds", "b.pcd", "--topic", "/imu"],
    );
    assert!(
        none.code == 2 && none.err.contains("no cloud with a point is on `/imu`"),
        "{}",
        none.err
    );
}

/// A message with packets and the stamp 5 s, behind whose frame `lidar` each packet is written by `write`.
fn message(is_cdr: bool, packets: &[Vec<u8>], write: impl Fn(&[u8], &mut Vec<u8>)) -> Vec<u8> {
    let mut bytes: Vec<u8> = if is_cdr { vec![0, 1, 0, 0] } else { vec![0; 4] };
    bytes.extend([5_u32, 0].map(u32::to_le_bytes).concat());
    let frame: &[u8] = if is_cdr { b"lidar\0\0\0" } else { b"lidar" };
    bytes.extend(if is_cdr { [6, 0, 0, 0] } else { [5, 0, 0, 0] });
    bytes.extend(frame);
    bytes.extend(u32::try_from(packets.len()).unwrap().to_le_bytes());
    for packet in packets {
        while is_cdr && !bytes.len().is_multiple_of(4) {
            bytes.push(0);
        }
        bytes.extend([5_u32, 0].map(u32::to_le_bytes).concat());
        write(packet, &mut bytes);
    }
    bytes
}

#[test]
fn the_maker_is_that_of_the_packets() {
    let scan = Scan {
        sequences: 2 * SEQUENCES,
        start_ns: 5_000_000_000,
        backwards: false,
    };
    let shot = Shot {
        sequence: 0,
        place: Vector3::new(3.0 * 15_f64.to_radians().cos(), 0.0, -3.0 * 15_f64.to_radians().sin()),
    };
    let velodyne: Vec<Vec<u8>> = scan.packets(&[shot]).into_iter().map(|(_, bytes)| bytes).collect();
    let length = |packet: &[u8], bytes: &mut Vec<u8>| bytes.extend(u32::try_from(packet.len()).unwrap().to_le_bytes());
    let nebula = |packet: &[u8], bytes: &mut Vec<u8>| {
        length(packet, bytes);
        bytes.extend(packet);
    };
    let pandar = |packet: &[u8], bytes: &mut Vec<u8>| {
        bytes.extend(packet);
        bytes.extend(vec![0; 1500 - packet.len()]);
        length(packet, bytes);
    };
    for (encoding, package) in [("cdr", "msg/"), ("ros1", "")] {
        let is_cdr = encoding == "cdr";
        let decoded = |name: [&str; 2], bytes: &[u8]| {
            let message_type = name.join(&format!("/{package}"));
            let format = Format {
                topic: "/packets",
                message_type: &message_type,
                message_encoding: encoding,
                schema: b"",
                schema_encoding: "",
            };
            let content = Decoder::of(&format, &Definitions::default())
                .decode(bytes)
                .map_err(|error| error.0)?;
            assert_eq!(content.header.unwrap().frame_id, "lidar");
            match content.body {
                Body::Packets(scan) => scan.decode(5_000_000_000).map_err(|error| error.0),
                other => panic!("{other:?}"),
            }
        };
        let cloud = decoded(["nebula_msgs", "NebulaPackets"], &message(is_cdr, &velodyne, nebula)).unwrap();
        assert_eq!(
            (cloud.maker, &*cloud.model, cloud.cloud.width),
            ("Velodyne", "VLP-16", 1),
            "{encoding}"
        );
        let other = [vec![0x55, 1, 5, 10]];
        let error = decoded(["nebula_msgs", "NebulaPackets"], &message(is_cdr, &other, nebula)).unwrap_err();
        assert!(error.contains("0x5501 is of no known maker"), "{error}");
        let hesai = [vec![0xee, 0xff, 99, 99, 0, 0]];
        let error = decoded(["pandar_msgs", "PandarScan"], &message(is_cdr, &hesai, pandar)).unwrap_err();
        assert!(error.starts_with("a packet of 6 bytes"), "{error}");
        let mut long = message(is_cdr, &hesai, pandar);
        let size = long.len() - 4;
        long[size..].copy_from_slice(&1501_u32.to_le_bytes());
        let error = decoded(["pandar_msgs", "PandarScan"], &long).unwrap_err();
        assert_eq!(error, "a packet of 1501 bytes in a field of 1500");
    }
}
