//! Recordings that are sound and strange: other encodings, unknown types, wrong messages, ever new names.

#![allow(clippy::unwrap_used, clippy::indexing_slicing)]

use std::fmt::Write;

use crate::support;
use crate::support::bag;
use crate::support::encode::{Body, Endian, Header, Transform};
use crate::support::raw::{Layout, RawChannel, in_memory};
use frames_lint::collect::Collection;
use frames_lint::engine::Rules;
use frames_lint::source::{ReadStatus, Source};
use frames_lint::world::World;

/// A recording with one channel and these messages, one a second.
fn one_topic(channel: &RawChannel<'_>, messages: &[Vec<u8>]) -> (Source, Collection) {
    support::collected(&in_memory(Layout::default(), |out| {
        let id = out.channel(channel);
        for (second, message) in (0..).zip(messages) {
            out.message(id, second * 1_000_000_000, message);
        }
    }))
}

fn stamped(stamp_ns: i64) -> Vec<u8> {
    let header = Header {
        stamp_ns,
        frame_id: "frame",
    };
    Body::Padded(header).encode(Endian::Little)
}

#[test]
fn a_header_is_read_by_definition_not_by_name() {
    let cases = [
        (
            "acme_msgs/msg/Radar",
            "cdr",
            "ros2msg",
            "# radar\nuint8 A=1\nstd_msgs/Header header\nfloat32 x\n",
            Ok(1),
        ),
        (
            "acme_msgs/msg/Radar",
            "cdr",
            "ros2msg",
            "float32 x\nstd_msgs/Header header\n",
            Ok(1),
        ),
        ("acme_msgs/msg/Radar", "cdr", "ros2msg", "float32 x\n", Ok(0)),
        (
            "acme_msgs/msg/Radar",
            "cdr",
            "ros2idl",
            "IDL: acme_msgs/msg/Radar\nmodule acme_msgs { module msg { struct Radar { std_msgs::msg::Header h; }; }; };",
            Ok(1),
        ),
        (
            "acme_msgs/msg/Radar",
            "cdr",
            "ros2msg",
            "",
            Err("the recording holds no definition of acme_msgs/msg/Radar"),
        ),
        (
            "acme_msgs/msg/Radar",
            "cdr",
            "ros2idl",
            "struct Radar {};",
            Err("its definition does not contain the type itself"),
        ),
        (
            "acme_msgs/msg/Radar",
            "cdr",
            "ros2msg",
            "wstring name\nstd_msgs/Header header\n",
            Err("its header cannot be read: the size of a `wstring` differs between writers"),
        ),
        (
            "foxglove.FrameTransform",
            "protobuf",
            "protobuf",
            "",
            Err("the recording holds no descriptor of `foxglove.FrameTransform`"),
        ),
        (
            "std_msgs/Header",
            "ros1",
            "ros1msg",
            "uint32 seq\ntime stamp\nstring frame_id",
            Ok(0),
        ),
        ("", "cbor", "", "", Err("cbor messages are not read")),
        ("", "cdr", "", "", Err("the recording holds no definition of the type")),
    ];
    for (message_type, message_encoding, schema_encoding, schema, expected) in cases {
        let channel = RawChannel {
            message_type,
            schema_encoding,
            schema,
            message_encoding,
            ..RawChannel::default()
        };
        let mut message = stamped(7);
        if schema.starts_with("float32 x\nstd_msgs") {
            message.splice(4..4, [0; 4]);
        }
        let (source, collected) = one_topic(&channel, &[message]);
        let topic = &bag(&collected).topics["/topic"];
        // A recording that nothing can be read of is no recording that was read.
        let status = if expected.is_ok() {
            ReadStatus::Read
        } else {
            ReadStatus::Partial
        };
        assert_eq!(
            (source.status, topic.count, topic.malformed),
            (status, 1, 0),
            "{channel:?}"
        );
        assert_eq!(source.problems.len(), usize::from(expected.is_err()), "{channel:?}");
        assert_eq!(topic.unread.as_deref(), expected.err(), "{channel:?}");
        assert_eq!(topic.stamps.count, expected.unwrap_or(0), "{channel:?}");
    }
}

#[test]
fn messages_that_do_not_decode_are_counted_with_the_first_ones_place() {
    let tf = |transforms: &[Transform<'_>]| Body::Tf(transforms).encode(Endian::Little);
    let good = Transform {
        header: Header {
            stamp_ns: 5,
            frame_id: "a",
        },
        child: "b",
        translation: [0.0; 3],
        rotation: [0.0, 0.0, 0.0, 1.0],
    };
    let mut lying = tf(&[good]);
    lying[4..8].copy_from_slice(&u32::MAX.to_le_bytes());
    let mut cut = tf(&[good, good]);
    cut.truncate(cut.len() - 1);
    let channel = RawChannel {
        topic: "/tf",
        message_type: "tf2_msgs/msg/TFMessage",
        ..RawChannel::default()
    };
    let messages = [tf(&[good]), lying, cut, Vec::new(), vec![0, 9, 0, 0, 1], tf(&[good])];
    let (source, collected) = one_topic(&channel, &messages);
    let topic = &bag(&collected).topics["/tf"];
    assert_eq!((topic.count, topic.malformed), (6, 4));
    let (first, error) = topic.first_malformed.clone().unwrap();
    assert_eq!((first.index, first.log_ns), (1, 1_000_000_000));
    assert!(error.contains("run past the end of the message"), "{error}");
    // Nothing of a message that no listener would get, not even its sound transforms.
    assert_eq!(bag(&collected).tf[0].count, 2);
    assert_eq!(source.status, ReadStatus::Partial);
    assert!(
        source
            .detail
            .unwrap()
            .starts_with("4 of 6 messages on `/tf` do not decode: ")
    );
}

#[test]
fn ever_new_names_are_bounded_and_said() {
    let bytes = in_memory(Layout::default(), |out| {
        let tf = out.channel(&RawChannel {
            topic: "/tf",
            message_type: "tf2_msgs/msg/TFMessage",
            ..RawChannel::default()
        });
        let imu = out.channel(&RawChannel {
            topic: "/imu",
            message_type: "acme/msg/Imu",
            schema: "std_msgs/Header header",
            ..RawChannel::default()
        });
        for tick in 0..22_000 {
            let name = format!("frame_{tick}");
            let header = Header {
                stamp_ns: tick,
                frame_id: &name,
            };
            let transform = Transform {
                header: Header {
                    stamp_ns: tick,
                    frame_id: "a",
                },
                child: &name,
                translation: [0.0; 3],
                rotation: [0.0, 0.0, 0.0, 1.0],
            };
            out.message(tf, tick, &Body::Tf(&[transform]).encode(Endian::Little));
            out.message(imu, tick, &Body::Padded(header).encode(Endian::Little));
        }
        for topic in 0..10_500 {
            let topic = format!("/topic_{topic}");
            out.channel(&RawChannel {
                topic: &topic,
                ..RawChannel::default()
            });
        }
    });
    let (source, collected) = support::collected(&bytes);
    let bag = bag(&collected);
    assert_eq!(
        (bag.tf.len(), bag.topics.len(), bag.topics["/imu"].header_frames.len()),
        (10_000, 10_000, 256)
    );
    assert_eq!(
        (bag.topics["/tf"].count, bag.topics["/imu"].stamps.count),
        (22_000, 22_000)
    );
    let problems: Vec<&str> = source.problems.iter().map(|problem| problem.message.as_str()).collect();
    let expected = [
        "502 channels beyond the first 10000 topics, or with very long names were left out",
        "12000 transforms beyond the first 10000 edges of TF were left out",
        "21744 message headers beyond the limit of different frame names were left out",
    ];
    assert_eq!((source.status, problems), (ReadStatus::Partial, expected.to_vec()));
}

#[test]
fn a_topic_of_two_types_is_said() {
    let bytes = in_memory(Layout::default(), |out| {
        for (message_type, message_encoding) in [("acme/msg/A", "cdr"), ("acme/msg/B", "cdr"), ("acme/msg/C", "cbor")] {
            let id = out.channel(&RawChannel {
                message_type,
                schema: "std_msgs/Header header",
                message_encoding,
                ..RawChannel::default()
            });
            out.message(id, 1, &stamped(7));
        }
    });
    let (source, collected) = support::collected(&bytes);
    let topic = &bag(&collected).topics["/topic"];
    assert_eq!((topic.count, topic.stamps.count), (3, 2));
    let problems: Vec<&str> = source.problems.iter().map(|problem| problem.message.as_str()).collect();
    let expected = [
        "`/topic` is recorded as two types: `acme/msg/A` and `acme/msg/B`",
        "`/topic` is recorded as two types: `acme/msg/A` and `acme/msg/C`",
    ];
    assert_eq!((source.status, problems), (ReadStatus::Partial, expected.to_vec()));
}

#[test]
fn streams_that_were_not_asked_where_the_platform_went_are_counted() {
    let mut recipe = [
        "duration_s: 5",
        "drive: {vehicle: car, motion: still, seed: 3}",
        "topics:",
        "  - {topic: /imu, from_drive: imu, rate_hz: 50, frame_id: base_link}\n",
    ]
    .join("\n");
    let why = |recipe: &str| {
        let mut world = World::default();
        world.bags = vec![support::evidence(recipe)];
        let verdict = Rules::select(&["AXES05"]).unwrap().judge(&world);
        verdict.rows[0].reason.clone().unwrap()
    };
    for stream in 0..18 {
        let odometry = "from_drive: odometry, rate_hz: 5, child_frame_id: base_link";
        writeln!(
            recipe,
            "  - {{topic: /odom{stream}, {odometry}, frame_id: odom{stream}}}"
        )
        .unwrap();
        let is_said = why(&recipe).contains("streams with a track, 16 were used");
        assert_eq!(is_said, stream >= 16, "{stream}: {}", why(&recipe));
    }
}
