//! Packets of an Ouster become clouds and inertial measurements by the metadata of their sensor, wherever that is; without it nothing is invented.

#![allow(clippy::unwrap_used, clippy::indexing_slicing, clippy::panic)]

use std::fs;
use std::path::Path;

use frames_lint::source::{ReadStatus, Source};
use frames_lint::world::bag::BagEvidence;
use frames_lint::world::cloud::{CloudEvidence, CloudSample};

use crate::support::at_hand::ouster_recordings;
use crate::support::clouds::Lidar;
use crate::support::drive::lidar::{Beams, Scanner};
use crate::support::packets_ouster::{SERIAL, metadata};
use crate::support::program;
use crate::support::reading::{folder, found, messages};
use crate::support::ros1::bag_of;
use crate::support::rosbag1;
use crate::support::rosbag2::{Db3, Drive, Schema};

const LIDAR: &str = "/ouster/lidar_packets";
const IMU: &str = "/ouster/imu_packets";
const METADATA: &str = "/ouster/metadata";

const RECIPE: &str = "\
duration_s: 2
drive: {vehicle: car, motion: turning, seed: 5}
topics:
  - {topic: /ouster/metadata, text: 'METADATA', latched: true}
  - {topic: /ouster/imu_packets, from_drive: ouster_imu, rate_hz: 100}
  - {topic: /ouster/lidar_packets, from_drive: lidar, rate_hz: 10, xyz: [0, 0, 1.8], lidar: {driver: ouster_packets, beams: 16, columns: 256}}
";

fn scanner(table: Beams) -> Scanner {
    let lidar = Lidar {
        table,
        beams: 16,
        columns: 256,
        ..Lidar::default()
    };
    lidar.scanner()
}

fn text() -> String {
    metadata(&scanner(Beams::Even), SERIAL)
}

fn drive() -> Drive {
    Drive::of(&RECIPE.replace("METADATA", &text()))
}

fn number(drive: &Drive, topic: &str) -> usize {
    drive.topics.iter().position(|known| known.name == topic).unwrap()
}

/// The drive without the messages of a topic.
fn without(topic: &str) -> Drive {
    let mut drive = drive();
    let number = number(&drive, topic);
    drive.messages.retain(|message| message.topic != number);
    drive
}

fn read(path: &Path) -> (Source, BagEvidence) {
    let (source, collection) = found(path);
    (source, collection.facts.bags.into_iter().next().unwrap())
}

/// The drive collected, with these files beside it.
fn collected(drive: &Drive, beside: &[(&str, &str)]) -> (Source, BagEvidence) {
    let folder = folder();
    for (name, text) in beside {
        fs::write(folder.path().join(name), text).unwrap();
    }
    let path = folder.path().join("drive.mcap");
    drive.write_mcap(&path);
    read(&path)
}

fn clouds<'b>(bag: &'b BagEvidence, topic: &str) -> Option<&'b CloudEvidence> {
    bag.topics[topic].content.clouds.as_ref()
}

/// Clouds of a recording that is read without a problem.
fn samples(drive: &Drive, beside: &[(&str, &str)]) -> Vec<CloudSample> {
    let (source, bag) = collected(drive, beside);
    assert_eq!((source.status, messages(&source)), (ReadStatus::Read, vec![]));
    clouds(&bag, LIDAR).unwrap().samples.clone()
}

#[test]
fn metadata_are_taken_from_their_topic() {
    let drive = drive();
    let folder = folder();
    let at = |name: &str| folder.path().join(name);
    drive.write_mcap(&at("drive.mcap"));
    let humble = Db3 {
        schema: Schema::Humble,
        ..Db3::default()
    };
    drive.write_db3(&at("drive.db3"), humble);
    let mut ros1 = drive.clone();
    for topic in &mut ros1.topics {
        topic.message_type = topic.message_type.replace("ouster_sensor_msgs", "ouster_ros");
    }
    // The driver of ROS 1 publishes its buffers, which have a byte more.
    let (lidar, imu) = (number(&drive, LIDAR), number(&drive, IMU));
    for message in ros1.messages.iter_mut().filter(|one| [lidar, imu].contains(&one.topic)) {
        let length = u32::from_le_bytes(message.data[4..8].try_into().unwrap()) + 1;
        message.data[4..8].copy_from_slice(&length.to_le_bytes());
        message.data.truncate(7 + length as usize);
        message.data.push(0);
    }
    fs::write(at("drive.bag"), bag_of(&ros1, rosbag1::Layout::default()).bytes).unwrap();
    let mut seen = Vec::new();
    for name in ["drive.mcap", "drive.db3", "drive.bag"] {
        let (source, bag) = read(&at(name));
        assert_eq!((source.status, messages(&source)), (ReadStatus::Read, vec![]), "{name}");
        let clouds = clouds(&bag, LIDAR).unwrap();
        let sensor = clouds.packets.as_ref().unwrap();
        assert_eq!(
            (sensor.maker.as_str(), sensor.model.as_str()),
            ("Ouster", "OS-1-16"),
            "{name}"
        );
        assert!(
            clouds
                .samples
                .iter()
                .all(|sample| sample.returns > 500 && sample.rings == Some(16))
        );
        // The header has the time at which the first packet was received, at its end.
        let times = clouds.samples[0].times.as_ref().unwrap();
        assert!(
            times.range[0] > -0.01 && times.range[1] < 0.1 + 1e-6,
            "{:?}",
            times.range
        );
        assert_eq!(
            bag.topics[IMU].content.imu.as_ref().map(|imu| imu.count),
            Some(200),
            "{name}"
        );
        seen.push(clouds.samples.clone());
    }
    assert!(seen.windows(2).all(|pair| pair[0] == pair[1]));
}

#[test]
fn metadata_are_taken_from_a_file_beside_the_recording() {
    let beside = samples(
        &without(METADATA),
        &[("sensor.json", &text()), ("other.json", "{\"a\": 1}")],
    );
    assert_eq!(beside, samples(&drive(), &[]));
    // The topic is nearer than a file.
    let other = metadata(&scanner(Beams::Os1), SERIAL);
    assert_eq!(samples(&drive(), &[("drive.json", &other)]), beside);
}

#[test]
fn without_metadata_nothing_is_invented() {
    for beside in [vec![], vec![("sensor.json", "{\"beam_altitude_angles\": [1]}")]] {
        let (source, bag) = collected(&without(METADATA), &beside);
        assert_eq!(source.status, ReadStatus::Partial);
        let [said] = messages(&source)[..] else {
            panic!("{:?}", messages(&source))
        };
        assert!(
            said.contains(LIDAR) && said.contains("record its topic, or put its JSON file beside the recording"),
            "{said}"
        );
        assert!(clouds(&bag, LIDAR).is_none_or(|clouds| clouds.samples.is_empty() && clouds.packets.is_none()));
        assert!(bag.topics[IMU].content.imu.is_none());
    }
}

#[test]
fn each_of_two_sensors_has_the_metadata_of_its_serial_number() {
    let recipe = "\
duration_s: 2
drive: {vehicle: car, motion: turning, seed: 5}
topics:
  - {topic: /left/lidar_packets, from_drive: lidar, rate_hz: 10, xyz: [0, 1, 1.8], lidar: {driver: ouster_packets, beams: 16, columns: 256, serial: 1001}}
  - {topic: /right/lidar_packets, from_drive: lidar, rate_hz: 10, xyz: [0, 1, 1.8], lidar: {driver: ouster_packets, table: os1, beams: 16, columns: 256, serial: 1002}}
";
    let [left, right] = [
        metadata(&scanner(Beams::Even), 1001),
        metadata(&scanner(Beams::Os1), 1002),
    ];
    let drive = Drive::of(recipe);
    let (source, both) = collected(&drive, &[("a.json", &right), ("b.json", &left)]);
    assert_eq!((source.status, messages(&source)), (ReadStatus::Read, vec![]));
    for (topic, one) in [("/left/lidar_packets", &left), ("/right/lidar_packets", &right)] {
        let (_, alone) = collected(&drive, &[("one.json", one)]);
        let [both, alone] = [&both, &alone].map(|bag| clouds(bag, topic).unwrap().samples.clone());
        assert!(!both.is_empty() && both == alone, "{topic}");
    }
    // One of them has none.
    let (source, bag) = collected(&drive, &[("b.json", &left)]);
    let said = messages(&source).join("\n");
    assert!(
        source.status == ReadStatus::Partial && said.contains("/right/lidar_packets"),
        "{said}"
    );
    assert!(!said.contains("/left/lidar_packets"), "{said}");
    assert!(clouds(&bag, "/right/lidar_packets").is_none_or(|clouds| clouds.samples.is_empty()));
}

#[test]
fn metadata_may_follow_the_first_packets() {
    let mut late = drive();
    let topic = number(&late, METADATA);
    let (start_ns, _) = late.span();
    for message in late.messages.iter_mut().filter(|message| message.topic == topic) {
        message.log_ns = start_ns + 550_000_000;
    }
    late.messages.sort_by_key(|message| message.log_ns);
    let (source, bag) = collected(&late, &[]);
    assert_eq!((source.status, messages(&source)), (ReadStatus::Read, vec![]));
    // The scan in which they come is the first.
    assert!(
        (13..=15).contains(&bag.topics[LIDAR].count),
        "{}",
        bag.topics[LIDAR].count
    );
    assert!(
        clouds(&bag, LIDAR)
            .unwrap()
            .samples
            .iter()
            .all(|sample| sample.returns > 500)
    );
    assert!(bag.topics[IMU].content.imu.is_some());
}

#[test]
fn packets_that_are_cut_are_counted() {
    let mut cut = drive();
    let topic = number(&cut, LIDAR);
    let of_lidar = cut.messages.iter_mut().filter(|message| message.topic == topic);
    // One packet of each scan; the first and the last scan are not whole for certain.
    for message in of_lidar.skip(5).step_by(16) {
        message.data[4..8].copy_from_slice(&1000_u32.to_le_bytes());
        message.data.truncate(8 + 1000);
    }
    let (source, bag) = collected(&cut, &[]);
    let [said] = messages(&source)[..] else {
        panic!("{:?}", messages(&source))
    };
    let expected =
        "are not decoded: a packet of 1000 bytes; the profile RNG19_RFL8_SIG16_NIR16 with 16 columns has 3328";
    assert!(
        said.starts_with("18 of 288 packets on `/ouster/lidar_packets`") && said.contains(expected),
        "{said}"
    );
    assert!(
        clouds(&bag, LIDAR)
            .unwrap()
            .samples
            .iter()
            .all(|sample| sample.returns > 500)
    );
}

#[test]
fn inertial_packets_are_in_the_units_of_ros() {
    let (_, packets) = collected(&drive(), &[]);
    // Its messages have the numbers from which the packets are made.
    let plain = RECIPE.replace("ouster_imu", "imu").replace("METADATA", &text());
    let (_, published) = collected(&Drive::of(&plain), &[]);
    let numbers = [packets, published].map(|bag| {
        let imu = bag.topics[IMU].content.motion.inertial.clone().unwrap();
        assert_eq!(imu.count, 200);
        let rows = imu
            .rows()
            .map(|row| [row.linear_acceleration, row.angular_velocity].concat());
        rows.flatten().collect::<Vec<f64>>()
    });
    assert!(numbers[0].len() > 200 && numbers[0].len() == numbers[1].len());
    for (one, other) in numbers[0].iter().zip(&numbers[1]) {
        // g and degrees a second in float32.
        assert!((one - other).abs() < 1e-5, "{one} {other}");
    }
}

#[test]
fn recordings_of_real_sensors_have_the_points_of_ousters_tools() {
    let Some(recordings) = ouster_recordings() else { return };
    for (name, count) in [
        ("OS-0-128-U1_v2.3.0_1024x10.pcap", 97_299),
        ("OS-1-128_767798045_1024x10_20230712_120049.pcap", 17_462),
        ("OS-1-32-G_v2.1.1_1024x10.pcap", 27_310),
        ("OS-1-64_1024x10_fw20.pcap", 16_749),
        ("windowed_frame1.pcap", 9_246),
        ("single_scan_016.osf", 108_209),
    ] {
        let folder = folder();
        let path = recordings.join(name);
        let arguments = [
            "collect".as_ref(),
            path.as_os_str(),
            "--clouds".as_ref(),
            "out.pcd".as_ref(),
        ];
        let ran = program::run(folder.path(), arguments);
        assert_eq!(ran.code, 0, "{name}: {}", ran.err);
        let pcd = fs::read(folder.path().join("out.pcd")).unwrap();
        let head = String::from_utf8_lossy(&pcd[..300]).into_owned();
        assert!(head.contains(&format!("\nPOINTS {count}\n")), "{name}: {head}");
    }
}
