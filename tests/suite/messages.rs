//! Definitions that a recording does not carry: said once for each type, and taken from `--msg-path`.

#![allow(clippy::unwrap_used, clippy::indexing_slicing)]

use crate::support;
use crate::support::encode::{Body, Endian, Header, Transform};
use crate::support::program;
use crate::support::raw::{Layout, RawChannel, in_memory};

/// A recording without definitions, as older ones of rosbag2 are: TF, a laser, and two topics of a type of its own.
fn recording() -> Vec<u8> {
    let head = |frame_id| Header { stamp_ns: 5, frame_id };
    let transform = Transform {
        header: head("base_link"),
        child: "gps",
        translation: [0.0; 3],
        rotation: [0.0, 0.0, 0.0, 1.0],
    };
    let scan = Body::Padded(head("laser")).encode(Endian::Little);
    // `uint8 quality`, padding, then the header.
    let mut own = Body::Padded(head("antenna")).encode(Endian::Little);
    own.splice(4..4, [9, 0, 0, 0]);
    in_memory(Layout::default(), |out| {
        let mut channel = |topic, message_type| {
            out.channel(&RawChannel {
                topic,
                message_type,
                schema_encoding: "",
                schema: "",
                message_encoding: "cdr",
                ..RawChannel::default()
            })
        };
        let (tf, scans) = (
            channel("/tf", "tf2_msgs/msg/TFMessage"),
            channel("/scan", "sensor_msgs/msg/LaserScan"),
        );
        let (left, right) = (
            channel("/left", "gps_driver/msg/Fix"),
            channel("/right", "gps_driver/msg/Fix"),
        );
        for second in 0..3 {
            let log_ns = second * 1_000_000_000;
            out.message(tf, log_ns, &Body::Tf(&[transform]).encode(Endian::Little));
            out.message(scans, log_ns, &scan);
            out.message(left, log_ns, &own);
            out.message(right, log_ns, &own);
        }
    })
}

#[test]
fn a_type_without_definition_is_said_once_and_the_standard_ones_are_read() {
    let (source, collected) = support::collected(&recording());
    let problems: Vec<_> = source
        .problems
        .iter()
        .map(|problem| (problem.message.as_str(), problem.help.as_deref()))
        .collect();
    let message = "6 messages of `gps_driver/msg/Fix`: the recording holds no definition of gps_driver/msg/Fix";
    let help = "pass the folder of the package that defines it with --msg-path";
    assert_eq!(problems, [(message, Some(help))]);
    let bag = support::bag(&collected);
    let frames: Vec<_> = bag.topics["/scan"]
        .header_frames
        .keys()
        .map(ToString::to_string)
        .collect();
    assert_eq!(frames, ["laser"]);
    assert_eq!((bag.tf.len(), bag.tf[0].count), (1, 3));
    assert!(bag.topics["/left"].unread.is_some() && bag.topics["/tf"].unread.is_none());
}

#[test]
fn the_folder_of_a_package_makes_its_types_readable() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("drive.mcap"), recording()).unwrap();
    let messages = folder.path().join("src/gps_driver/msg");
    std::fs::create_dir_all(&messages).unwrap();
    let call = |msg_path: &str| {
        let arguments = ["check", "--format", "json", "--msg-path", msg_path, "drive.mcap"];
        program::run(folder.path(), arguments)
    };
    let refused = call("src");
    assert_eq!(refused.code, 2);
    assert!(
        refused.err.contains("--msg-path: `src` contains no message definition"),
        "{}",
        refused.err
    );

    let file = messages.join("Fix.msg");
    std::fs::write(&file, "uint8 quality\nstd_msgs/Header\n").unwrap();
    let wrong = call("src").text();
    assert!(
        wrong.contains("gps_driver/msg/Fix.msg, line 2: `std_msgs/Header` is not a field"),
        "{wrong}"
    );

    std::fs::write(&file, "uint8 quality\nstd_msgs/Header header\n").unwrap();
    let right = call("src").text();
    assert!(!right.contains("gps_driver") && right.contains("antenna"), "{right}");
}

#[test]
fn a_driver_that_wraps_standard_types_is_read_through_its_definition() {
    let head = |frame_id| Header { stamp_ns: 5, frame_id };
    let imu = Body::Imu(head("")).encode(Endian::Little);
    let mut wrapped = Body::Padded(head("imu1_frame")).encode(Endian::Little);
    // `header`, 8 and 4 bytes and a text of 11, is padded to 24 bytes; then the member as it stands alone.
    wrapped.truncate(4 + 24);
    wrapped.extend(&imu[4..]);
    let short = wrapped.get(..100).unwrap().to_vec();
    let bytes = in_memory(Layout::default(), |out| {
        let channel = out.channel(&RawChannel {
            topic: "/imu",
            message_type: "vn_driver/msg/Vectornav",
            schema: "std_msgs/Header header\nsensor_msgs/Imu imu\nstring read\n",
            ..RawChannel::default()
        });
        out.message(channel, 1, &wrapped);
        out.message(channel, 2, &short);
    });
    let (source, collected) = support::collected(&bytes);
    let problems: Vec<_> = source.problems.iter().map(|problem| problem.message.as_str()).collect();
    let cut = "1 of 2 messages on `/imu` do not decode: 8 bytes at byte 100 run past the end of the message of 100";
    assert_eq!(problems, [cut]);
    let topic = &support::bag(&collected).topics["/imu"];
    let frames: Vec<_> = topic.header_frames.keys().map(ToString::to_string).collect();
    assert_eq!((frames, topic.unread.as_deref()), (vec!["imu1_frame".to_owned()], None));
}

#[test]
fn a_type_that_rules_ask_for_and_that_is_not_read_makes_the_recording_partial() {
    let transform = Transform {
        header: Header {
            stamp_ns: 5,
            frame_id: "base_link",
        },
        child: "imu",
        translation: [0.1, 0.2, 0.3],
        rotation: [0.0, 0.0, 0.0, 1.0],
    };
    for (message_type, status) in [("sensor_msgs/msg/Imu", "partial"), ("acme_msgs/msg/Thing", "read")] {
        let bytes = in_memory(Layout::default(), |out| {
            let tf = out.channel(&RawChannel {
                topic: "/tf",
                message_type: "tf2_msgs/msg/TFMessage",
                ..RawChannel::default()
            });
            let other = out.channel(&RawChannel {
                topic: "/imu",
                message_type,
                message_encoding: "flexbuffers",
                ..RawChannel::default()
            });
            out.message(tf, 5, &Body::Tf(&[transform]).encode(Endian::Little));
            out.message(other, 6, &[1, 2, 3]);
        });
        let folder = tempfile::tempdir().unwrap();
        std::fs::write(folder.path().join("a.mcap"), bytes).unwrap();
        let ran = program::run(folder.path(), ["check", "a.mcap", "--format", "json"]);
        let report = ran.report();
        assert_eq!(report["inputs"][0]["status"], status, "{report:#}");
        assert_eq!(ran.code == 3, status == "partial", "{}", ran.code);
        let why = report["inputs"][0]["problems"][0]["message"].as_str().unwrap();
        assert!(why.contains("flexbuffers"), "{why}");
    }
}
