//! Recordings of Foxglove's schemas: an MCAP with protobuf and JSON channels becomes evidence.

#![allow(clippy::unwrap_used, clippy::indexing_slicing, clippy::panic, clippy::print_stderr)]

use crate::support;
use crate::support::foxglove::{FrameTransform, FrameTransforms, Stamped, at, descriptor, numbers};
use crate::support::raw::{Layout, RawChannel, in_memory};
use crate::support::{bag, edge, names};
use frames_lint::source::ReadStatus;
use frames_lint::world::FrameId;
use prost::Message;
use prost_types::{FileDescriptorProto, Timestamp};

const START_NS: i64 = 1_700_000_000_000_000_000;
const STEP_NS: i64 = 100_000_000;

fn timestamp(ns: i64) -> Option<Timestamp> {
    at(ns / 1_000_000_000, i32::try_from(ns % 1_000_000_000).unwrap())
}

fn transform(ns: i64, parent: &str, child: &str, x: f64) -> FrameTransform {
    FrameTransform {
        timestamp: timestamp(ns),
        parent: parent.to_owned(),
        child: child.to_owned(),
        translation: numbers(x, 0.0, 0.0, 0.0),
        rotation: numbers(0.0, 0.0, 0.0, 1.0),
    }
}

/// Ten steps of a small robot: TF in protobuf, the cloud in protobuf, the image in JSON.
fn drive(cloud_frame: &str) -> Vec<u8> {
    let descriptor = descriptor(FileDescriptorProto::default());
    in_memory(Layout::default(), |out| {
        let protobuf = |topic, message_type| RawChannel {
            topic,
            message_type,
            schema_encoding: "protobuf",
            descriptor: &descriptor,
            message_encoding: "protobuf",
            ..RawChannel::default()
        };
        let latched = out.channel(&protobuf("/tf_static", "foxglove.FrameTransforms"));
        let moving = out.channel(&protobuf("/tf", "foxglove.FrameTransform"));
        let points = out.channel(&protobuf("/points", "foxglove.PointCloud"));
        let image = out.channel(&RawChannel {
            topic: "/image",
            message_type: "foxglove.CompressedImage",
            schema_encoding: "jsonschema",
            schema: "{}",
            message_encoding: "json",
            ..RawChannel::default()
        });
        let transforms = vec![
            transform(START_NS, "base_link", "lidar", 0.3),
            FrameTransform {
                // Optical axes: z forward, x right, y down.
                rotation: numbers(-0.5, 0.5, -0.5, 0.5),
                ..transform(START_NS, "base_link", "camera", 0.5)
            },
        ];
        out.message(latched, START_NS, &FrameTransforms { transforms }.encode_to_vec());
        for step in 0..10_u32 {
            let ns = START_NS + i64::from(step) * STEP_NS;
            let odometry = transform(ns - 5_000_000, "odom", "base_link", 0.1 * f64::from(step));
            out.message(moving, ns, &odometry.encode_to_vec());
            let cloud = Stamped {
                timestamp: timestamp(ns - 50_000_000),
                frame_id: cloud_frame.to_owned(),
                data: vec![7; 5000],
            };
            out.message(points, ns, &cloud.encode_to_vec());
            let (sec, nsec) = (ns / 1_000_000_000, ns % 1_000_000_000);
            let text = format!(
                r#"{{"timestamp":{{"sec":{sec},"nsec":{nsec}}},"frame_id":"camera","data":"/9j/","format":"jpeg"}}"#
            );
            out.message(image, ns, text.as_bytes());
        }
    })
}

#[test]
fn transforms_and_headers_of_foxglove_become_evidence() {
    let (source, collected) = support::collected(&drive("lidar"));
    assert_eq!(
        (source.status, source.problems.len()),
        (ReadStatus::Read, 0),
        "{source:?}"
    );
    let bag = bag(&collected);
    assert_eq!((bag.messages, bag.tf.len()), (31, 3));
    let mounted = edge(bag, "base_link", "lidar");
    assert!(mounted.is_static);
    let moving = edge(bag, "odom", "base_link");
    assert_eq!(
        (moving.is_static, moving.count, moving.topic.as_str()),
        (false, 10, "/tf")
    );
    assert!(
        moving
            .stamps
            .samples
            .iter()
            .all(|(stamp, log)| log - stamp == 5_000_000)
    );
    for (topic, frame, late_ns) in [("/points", "lidar", 50_000_000), ("/image", "camera", 0)] {
        let evidence = &bag.topics[topic];
        assert_eq!((evidence.unread.as_deref(), evidence.malformed), (None, 0), "{topic}");
        assert_eq!(names(evidence.header_frames.keys()), [frame]);
        assert_eq!(evidence.header_frames[&FrameId::new(frame)].count, 10);
        assert!(
            evidence
                .stamps
                .samples
                .iter()
                .all(|(stamp, log)| log - stamp == late_ns)
        );
    }
}

#[test]
fn a_cloud_in_a_frame_that_nobody_publishes_is_found() {
    let folder = tempfile::tempdir().unwrap();
    for (frame, expected) in [("lidar", 0), ("lidaar", 1)] {
        std::fs::write(folder.path().join("drive.mcap"), drive(frame)).unwrap();
        let ran = support::program::run(folder.path(), ["check", "--format", "json", "drive.mcap"]);
        let report: serde_json::Value = serde_json::from_slice(&ran.out).unwrap();
        let findings = report["findings"].as_array().unwrap();
        assert_eq!(findings.len(), expected, "{findings:?}");
        for finding in findings {
            assert_eq!(
                (finding["rule"].as_str(), finding["severity"].as_str()),
                (Some("TREE07"), Some("error"))
            );
            assert!(finding["message"].as_str().unwrap().contains("`lidaar`"));
        }
    }
}

#[test]
fn what_cannot_be_read_is_said_with_the_reason() {
    let bytes = in_memory(Layout::default(), |out| {
        let broken = out.channel(&RawChannel {
            topic: "/no_descriptor",
            message_type: "foxglove.PointCloud",
            schema_encoding: "protobuf",
            schema: "syntax",
            message_encoding: "protobuf",
            ..RawChannel::default()
        });
        out.message(broken, START_NS, &[1, 2, 3]);
        let json = out.channel(&RawChannel {
            topic: "/json",
            message_encoding: "json",
            ..RawChannel::default()
        });
        out.message(json, START_NS, br#"{"timestamp":{"sec":5,"nsec":0},"frame_id":"imu"}"#);
        out.message(json, START_NS, b"{\"timestamp\":");
        out.message(json, START_NS, b"{}");
    });
    let (source, collected) = support::collected(&bytes);
    let topics = &bag(&collected).topics;
    let unread = topics["/no_descriptor"].unread.as_deref().unwrap();
    assert!(
        unread.starts_with("the descriptor of `foxglove.PointCloud` cannot be decoded"),
        "{unread}"
    );
    let json = &topics["/json"];
    assert_eq!((json.count, json.malformed, json.stamps.count), (3, 1, 1));
    assert_eq!(source.status, ReadStatus::Partial);
    let problems: Vec<&str> = source.problems.iter().map(|problem| problem.message.as_str()).collect();
    let [malformed, unread] = problems.as_slice() else {
        panic!("{problems:?}");
    };
    assert!(
        malformed.starts_with("1 of 3 messages on `/json` do not decode: not valid JSON: EOF while parsing"),
        "{problems:?}"
    );
    assert!(
        unread.starts_with("1 messages of `foxglove.PointCloud`: the descriptor"),
        "{problems:?}"
    );
}

#[test]
fn recordings_in_json_of_others_are_read() {
    let Some(folder) = support::real_bags() else { return };
    let folder = folder.join("lichtblick-suite+lichtblick");
    if !folder.is_dir() {
        support::left_out("no recordings in JSON among the real recordings");
        return;
    }
    for path in support::files(&folder, ".mcap") {
        let (source, collected) = support::collected_from(&path);
        assert_eq!(
            (source.status, source.problems.len()),
            (ReadStatus::Read, 0),
            "{path:?}"
        );
        let bag = bag(&collected);
        for topic in bag.topics.values() {
            assert_eq!((topic.unread.as_deref(), topic.malformed), (None, 0), "{}", topic.topic);
            let framed = matches!(
                topic.message_type.as_str(),
                "foxglove.CompressedImage" | "foxglove.CameraCalibration"
            );
            let expected = if framed { topic.count } else { 0 };
            assert_eq!(topic.stamps.count, expected, "{}", topic.topic);
        }
    }
}
