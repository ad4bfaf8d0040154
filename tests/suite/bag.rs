//! Recordings: a recipe becomes an MCAP becomes evidence, and the evidence has the numbers that were written.

#![allow(clippy::unwrap_used, clippy::indexing_slicing, clippy::panic)]

use std::cell::RefCell;

use crate::support;
use crate::support::{edge, evidence, names};
use frames_lint::collect::{CollectOptions, collect};
use frames_lint::source::{MessageRef, ReadStatus, Source, SourceId, SourceKind, SourcePart};
use frames_lint::world::{FrameId, FrameRole};

const START_NS: i64 = 1_700_000_000_000_000_000;
const MS: i64 = 1_000_000;

#[test]
fn stamps_are_measured_against_the_log_clock() {
    let bag = evidence(
        "
        duration_s: 2
        topics:
          - {topic: /imu, type: sensor_msgs/msg/Imu, rate_hz: 100, frame_id: imu, stamp_offset_s: -0.05}
        ",
    );
    assert_eq!((bag.messages, bag.truncated), (200, false));
    assert_eq!((bag.start_ns, bag.end_ns), (Some(START_NS), Some(START_NS + 1990 * MS)));
    let topic = &bag.topics["/imu"];
    assert_eq!((topic.message_type.as_str(), topic.count), ("sensor_msgs/msg/Imu", 200));
    assert_eq!((topic.first_log_ns, topic.last_log_ns), (bag.start_ns, bag.end_ns));
    assert_eq!((topic.unread.as_deref(), topic.malformed), (None, 0));
    assert_eq!(names(topic.header_frames.keys()), ["imu"]);
    assert_eq!(topic.header_frames[&FrameId::new("imu")].count, 200);
    let stamps = &topic.stamps;
    assert_eq!((stamps.count, stamps.samples.len()), (200, 200));
    assert!(stamps.samples.iter().all(|(stamp, log)| stamp - log == -50 * MS));
    assert_eq!(
        (stamps.zero, stamps.backward, stamps.repeated, stamps.long_gaps),
        (0, 0, 0, 0)
    );
    assert_eq!(stamps.median_step_ns, Some(10 * MS));
    assert_eq!(stamps.largest_gap.as_ref().map(|(gap, _)| *gap), Some(10 * MS));
    let last = MessageRef {
        topic: "/imu".to_owned(),
        index: 199,
        stamp_ns: Some(START_NS + 1940 * MS),
        log_ns: START_NS + 1990 * MS,
        field: None,
    };
    assert_eq!(stamps.last, Some(last));
}

#[test]
fn every_stamp_knob_shows_in_the_evidence() {
    let bag = evidence(
        "
        duration_s: 10
        topics:
          - {topic: /zero, type: sensor_msgs/msg/Imu, rate_hz: 10, stamp_s: 0}
          - {topic: /stuck, type: sensor_msgs/msg/Imu, rate_hz: 10, stamp_s: 12.5}
          - {topic: /milli, type: sensor_msgs/msg/Imu, rate_hz: 10, stamp_scale: 0.001}
          - {topic: /uptime, type: sensor_msgs/msg/Imu, rate_hz: 10, stamp_start_s: 3}
          - {topic: /gap, type: sensor_msgs/msg/Imu, rate_hz: 10, until_s: 3}
          - {topic: /gap, type: sensor_msgs/msg/Imu, rate_hz: 10, from_s: 8}
          - {topic: /back, type: sensor_msgs/msg/Imu, rate_hz: 10, until_s: 5}
          - {topic: /back, type: sensor_msgs/msg/Imu, rate_hz: 10, from_s: 5, stamp_offset_s: -2}
        ",
    );
    let stamps = |topic: &str| &bag.topics[topic].stamps;
    assert_eq!((stamps("/zero").zero, stamps("/zero").repeated), (100, 0));
    assert_eq!(stamps("/zero").first_zero.as_ref().unwrap().index, 0);
    assert_eq!(
        (stamps("/stuck").repeated, stamps("/stuck").samples[7].0),
        (99, 12_500 * MS)
    );
    assert_eq!(stamps("/stuck").first_repeated.as_ref().unwrap().index, 1);
    assert_eq!(stamps("/milli").samples[0].0, START_NS / 1000);
    assert_eq!(stamps("/uptime").samples[10], (4000 * MS, START_NS + 1000 * MS));
    let (gap, after) = stamps("/gap").largest_gap.clone().unwrap();
    assert_eq!((gap, after.index, stamps("/gap").long_gaps), (5100 * MS, 30, 1));
    assert_eq!(bag.topics["/gap"].count, 50);
    let (step, at) = stamps("/back").largest_backward.clone().unwrap();
    assert_eq!((step, at.index, stamps("/back").backward), (1900 * MS, 50, 1));
}

const ROBOT: &str = "
duration_s: 4
topics:
  - topic: /tf_static
    transforms:
      - {parent: base_link, child: lidar, xyz: [0.3, 0, 1.2], rpy_deg: [0, 0, 90]}
      - {parent: /base_link, child: imu, quaternion: [0, 0, 0, 1]}
  - topic: /tf
    rate_hz: 50
    transforms:
      - {parent: odom, child: base_link, velocity: [1, 0, 0], yaw_rate_deg_s: 45}
      - {parent: base_link, child: wheel, until_s: 1}
  - {topic: /odom, type: nav_msgs/msg/Odometry, rate_hz: 20, frame_id: odom, child_frame_id: base_link}
  - {topic: /points, type: sensor_msgs/msg/PointCloud2, rate_hz: 10, frame_id: lidar}
  - {topic: /robot_description, text: \"<robot name='r'/>\"}
";

#[test]
fn edges_have_the_poses_that_were_published() {
    let bag = evidence(ROBOT);
    let edges: Vec<(&str, &str, u64)> = bag
        .tf
        .iter()
        .map(|edge| (edge.parent.as_str(), edge.child.as_str(), edge.count))
        .collect();
    let expected = [
        ("odom", "base_link", 200),
        ("/base_link", "imu", 1),
        ("base_link", "lidar", 1),
        ("base_link", "wheel", 50),
    ];
    assert_eq!(edges, expected);

    let lidar = edge(&bag, "base_link", "lidar");
    assert!(lidar.is_static && lidar.topic == "/tf_static" && lidar.extreme.is_none());
    let pose = lidar.first().unwrap().pose;
    let half = std::f64::consts::FRAC_1_SQRT_2;
    assert_eq!(format!("{:?}", pose.translation_m), "[0.3, 0.0, 1.2]");
    assert!((pose.rotation_xyzw[2] - half).abs() < 1e-12 && (pose.rotation_xyzw[3] - half).abs() < 1e-12);
    assert_eq!(
        edge(&bag, "/base_link", "imu").first_at.field.as_deref(),
        Some("transforms[1]")
    );

    // 1 m/s and 45 °/s from the origin: after 2 s a quarter of a circle of radius 4/π was driven, to (r, r).
    let moving = edge(&bag, "odom", "base_link");
    assert!(!moving.is_static && moving.samples.len() == 200);
    let quarter = &moving.samples[100];
    assert_eq!((quarter.at.index, quarter.at.log_ns), (100, START_NS + 2000 * MS));
    let radius = 4.0 / std::f64::consts::PI;
    let [x, y, z] = quarter.pose.translation_m;
    assert!(
        (x - radius).abs() < 1e-9 && (y - radius).abs() < 1e-9 && z.abs() < 1e-12,
        "{quarter:?}"
    );
    let (extreme, angle, distance) = moving.extreme.clone().unwrap();
    // The distance from the start decides here: it grows to the last tick, 3.98 s, where the turn is 179.1°.
    assert_eq!(extreme.at.index, 199);
    assert!((angle.to_degrees() - 179.1).abs() < 1e-9, "{angle}");
    assert!(
        (distance - 2.0 * radius * (angle / 2.0).sin()).abs() < 1e-9,
        "{distance}"
    );
    assert_eq!(moving.stamps.median_step_ns, Some(20 * MS));
    assert!(moving.worst_norm_error < 1e-12);
}

#[test]
fn frames_are_used_once_for_each_name_role_and_topic() {
    let (_, collected) = support::collected(&support::build(ROBOT));
    let uses: Vec<(&str, FrameRole, u64)> = collected
        .facts
        .frames
        .iter()
        .map(|used| (used.frame.as_str(), used.role, used.count))
        .collect();
    let expected = [
        ("/base_link", FrameRole::TfParent, 1),
        ("base_link", FrameRole::TfParent, 50),
        ("base_link", FrameRole::TfParent, 1),
        ("base_link", FrameRole::TfChild, 200),
        ("base_link", FrameRole::OdometryChild, 80),
        ("imu", FrameRole::TfChild, 1),
        ("lidar", FrameRole::TfChild, 1),
        ("lidar", FrameRole::Header, 40),
        ("odom", FrameRole::TfParent, 200),
        ("odom", FrameRole::Header, 80),
        ("wheel", FrameRole::TfChild, 50),
    ];
    assert_eq!(uses, expected);
    let SourcePart::Message(first) = &collected.facts.frames[1].place.at else {
        panic!()
    };
    assert_eq!(
        (first.topic.as_str(), first.index, first.field.as_deref()),
        ("/tf", 0, Some("transforms[1]"))
    );
    let (at, text) = &collected.descriptions[0];
    assert_eq!(
        (at.topic.as_str(), text.as_str()),
        ("/robot_description", "<robot name='r'/>")
    );
}

#[test]
fn layout_and_byte_order_make_no_difference() {
    // As text: a NaN equals itself.
    let text = |recipe: &str| format!("{:#?}", evidence(recipe));
    let expected = text(ROBOT);
    for layout in [
        "compression: none",
        "compression: lz4",
        "compression: zstd\nchunk_size_bytes: 700",
    ] {
        assert!(text(&format!("{layout}\n{ROBOT}")) == expected, "{layout}");
    }
    let big = ROBOT
        .replace("rate_hz: 50", "rate_hz: 50\n    big_endian: true")
        .replace("rate_hz: 20", "rate_hz: 20, big_endian: true");
    assert!(text(&big) == expected);
}

#[test]
fn each_robot_description_is_given_once() {
    let recipe = "
        duration_s: 3
        topics:
          - {topic: /robot_description, rate_hz: 1, text: <robot name='a'/>}
          - {topic: /arm/robot_description, text: <robot name='b'/>}
          - {topic: /chatter, text: <robot name='c'/>}
        ";
    let (_, collected) = support::collected(&support::build(recipe));
    let texts: Vec<(&str, u64, &str)> = collected
        .descriptions
        .iter()
        .map(|(at, text)| (at.topic.as_str(), at.index, text.as_str()))
        .collect();
    let expected = [
        ("/robot_description", 0, "<robot name='a'/>"),
        ("/arm/robot_description", 0, "<robot name='b'/>"),
    ];
    assert_eq!(texts, expected);
    assert_eq!(collected.facts.bags[0].topics["/chatter"].unread, None);
}

#[test]
fn durability_is_kept_as_recorded() {
    let bag = evidence(
        "
        topics:
          - {topic: /tf_static, transforms: [{parent: a, child: b}]}
          - {topic: /x/tf_static, durability: volatile, transforms: [{parent: a, child: b}]}
          - {topic: /y/tf_static, qos: '', transforms: [{parent: a, child: b}]}
        ",
    );
    let qos = |topic: &str| bag.topics[topic].offered_qos_profiles.clone();
    assert!(qos("/tf_static").unwrap().contains("durability: transient_local"));
    assert!(qos("/x/tf_static").unwrap().contains("durability: volatile"));
    assert_eq!(qos("/y/tf_static"), None);
}

#[test]
fn progress_reaches_the_end() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("drive.mcap");
    support::write(ROBOT, &path);
    let size = std::fs::metadata(&path).unwrap().len();
    let calls = RefCell::new(Vec::new());
    let mut source = Source::new(SourceId(0), "drive.mcap", SourceKind::Mcap);
    collect(&path, &CollectOptions::default(), &mut source, &|done, total| {
        calls.borrow_mut().push((done, total));
    });
    assert_eq!(calls.into_inner().last(), Some(&(size, size)));
}

#[test]
fn real_recordings_are_read() {
    let Some(folder) = support::real_bags() else { return };
    for path in support::files(&folder, ".mcap") {
        let (source, collected) = support::collected_from(&path);
        let bag = &collected.facts.bags[0];
        let mut spoken = bag.topics.values().filter(|topic| topic.count > 0);
        let expected = if spoken.all(|topic| topic.unread.is_some()) {
            ReadStatus::Partial
        } else {
            ReadStatus::Read
        };
        let problems = usize::from(expected != ReadStatus::Read);
        assert_eq!(
            (source.status, source.problems.len()),
            (expected, problems),
            "{source:?}"
        );
        if bag.messages == 0 {
            assert_eq!(source.detail.as_deref(), Some("no messages"));
        }
        if path.ends_with("nav2_turtlebot.mcap") {
            let seconds = (bag.end_ns.unwrap() - bag.start_ns.unwrap()) as f64 * 1e-9;
            let map = edge(bag, "map", "odom");
            assert_eq!((bag.messages, bag.topics["/tf"].count, map.count), (8197, 5422, 921));
            assert!((map.count as f64 / seconds - 9.5).abs() < 0.05, "{seconds}");
            assert_eq!(bag.tf.iter().filter(|edge| edge.is_static).count(), 29);
            assert_eq!(names(bag.topics["/odom"].child_frames.keys()), ["base_link"]);
        }
    }
}
