//! ROS 1 bags: what was written is read, in every compression and with every kind of ending.

#![allow(clippy::unwrap_used, clippy::indexing_slicing, clippy::panic, clippy::print_stderr)]

use std::path::Path;

use crate::support;
use crate::support::heard::{Delivery, TopicMessage, are_some_of, read, read_from, wanted};
use crate::support::rosbag1::{BagFile, Compression, Connection, Ending, Layout, Rosbag1};
use crate::support::rosbag1_drive::{drive, layouts};
use frames_lint::read::bag::{Extent, RunExtension, Sampling, Selection};
use frames_lint::source::ReadStatus;

#[test]
fn what_was_written_is_read_in_every_compression() {
    for layout in layouts() {
        let (bag, written) = drive(layout);
        let (source, extent, heard) = read(&bag.bytes);
        assert_eq!(
            (source.status, &source.problems),
            (ReadStatus::Read, &vec![]),
            "{layout:?}"
        );
        assert_eq!(source.examined.bytes, source.examined.bytes_total);
        assert!(heard.messages == written && heard.seams == 0, "{layout:?}");
        let expected = Extent {
            truncated: false,
            whole: true,
            indexed: true,
            messages_total: Some(300),
            span_ns: Some((written[0].1, written[299].1)),
        };
        assert_eq!(extent, expected);
    }
}

#[test]
fn a_connection_becomes_a_channel() {
    let (bag, _) = drive(Layout::default());
    let (_, _, heard) = read(&bag.bytes);
    let [imu, map, other] = heard.channels.as_slice() else {
        panic!("{:?}", heard.channels);
    };
    assert_eq!(
        (imu.topic.as_str(), imu.message_type.as_str()),
        ("/imu", "sensor_msgs/msg/Imu")
    );
    assert_eq!(
        (&*imu.schema, imu.schema_encoding.as_str()),
        (&b"Header header\n"[..], "ros1msg")
    );
    assert_eq!((imu.message_encoding.as_str(), imu.latched), ("ros1", false));
    assert_eq!((imu.writer.as_deref(), imu.total), (Some("/imu_driver"), Some(240)));
    assert_eq!(imu.metadata["md5sum"], "0123456789abcdef0123456789abcdef");
    assert_eq!(
        (map.topic.as_str(), map.message_type.as_str()),
        ("map", "tf/msg/tfMessage")
    );
    assert_eq!((map.schema.len(), map.schema_encoding.as_str()), (0, ""));
    assert_eq!((map.writer.as_deref(), map.total, map.latched), (None, Some(30), true));
    assert_eq!(
        (other.topic.as_str(), other.message_type.as_str()),
        ("/imu", "acme_msgs/msg/Imu")
    );
}

#[test]
fn a_recording_that_was_not_closed_is_scanned() {
    for layout in layouts() {
        for ending in [Ending::Unindexed, Ending::Active] {
            let (bag, written) = drive(Layout { ending, ..layout });
            let (source, extent, heard) = read(&bag.bytes);
            let what = format!("{layout:?} {ending:?} {source:?}");
            assert_eq!(source.status, ReadStatus::Partial, "{what}");
            let is_reported = |text: &str| source.problems.iter().any(|problem| problem.message.contains(text));
            assert!(
                is_reported("the recording was not closed and has no index; the bag was scanned from its start"),
                "{what}"
            );
            assert!(extent.truncated && !extent.indexed && extent.whole && extent.messages_total.is_none());
            // A block of bz2 is nothing without its end.
            if ending == Ending::Active && layout.compression != Compression::None {
                assert!(is_reported("the last chunk was not closed"), "{what}");
                assert!(written.starts_with(&heard.messages), "{what}");
                assert!(
                    layout.compression == Compression::Bz2 || heard.messages.len() == 300,
                    "{what}"
                );
            } else {
                assert_eq!(source.problems.len(), 1, "{what}");
                assert!(heard.messages == written, "{what}");
            }
            assert!(heard.channels.iter().all(|channel| channel.total.is_none()));
        }
    }
}

#[test]
fn quirks_of_old_recorders_are_no_faults() {
    for layout in layouts() {
        let (bag, written) = drive(Layout { zeros: 49, ..layout });
        let (source, extent, heard) = read(&bag.bytes);
        assert_eq!((source.status, &source.problems), (ReadStatus::Read, &vec![]));
        assert!(heard.messages == written && heard.seams == 0 && !extent.truncated);
        let claims = Layout {
            index_claim: 20,
            ..layout
        };
        let (bag, written) = drive(claims);
        let (source, extent, heard) = read(&bag.bytes);
        assert_eq!(
            (source.status, source.problems.len()),
            (ReadStatus::Read, 1),
            "{source:?}"
        );
        assert!(
            source
                .detail
                .unwrap()
                .contains("index records differ in length from what they say")
        );
        assert!(heard.messages == written && heard.seams == 0 && !extent.truncated);
    }
}

#[test]
fn bags_without_messages_say_so() {
    let mut bag = Rosbag1::new(Layout::default());
    let (source, extent, heard) = read(&Rosbag1::new(Layout::default()).finish().bytes);
    assert_eq!(
        (source.status, source.detail.as_deref()),
        (ReadStatus::Read, Some("no messages"))
    );
    assert_eq!(
        (extent.truncated, extent.span_ns, extent.messages_total),
        (false, None, Some(0))
    );
    assert_eq!(heard, Delivery::default());
    bag.connection(&Connection::default());
    let bytes = bag.finish().bytes;
    let (source, _, heard) = read(&bytes);
    assert_eq!(
        (source.status, source.detail.as_deref()),
        (ReadStatus::Read, Some("no messages"))
    );
    assert_eq!((heard.channels.len(), heard.channels[0].total), (1, Some(0)));
    let (source, collected) = support::collected(&bytes);
    assert_eq!(
        (source.status, support::bag(&collected).topics.len()),
        (ReadStatus::Partial, 1)
    );
    assert_eq!(source.problems[0].message, "no messages");
}

#[test]
fn other_versions_are_refused_with_a_word_of_help() {
    for (magic, version) in [
        ("#ROSRECORD V1.2", "V1.2"),
        ("#ROSBAG V1.3", "V1.3"),
        ("#ROSBAG V", "V"),
    ] {
        let (source, extent, _) = read(format!("{magic}\nmore").as_bytes());
        let expected = format!("this ROS 1 bag has version {version}; only V2.0 is read");
        assert_eq!(
            (source.status, source.detail.as_deref()),
            (ReadStatus::Unreadable, Some(expected.as_str()))
        );
        assert!(source.problems[0].help.as_ref().unwrap().contains("rosbag filter"));
        assert!(extent.truncated);
    }
    let (source, _, _) = read(&[0; 100]);
    assert_eq!(
        source.detail.as_deref(),
        Some("not a ROS 1 bag: the magic bytes at byte 0 are missing")
    );
}

#[test]
fn an_encrypted_bag_is_refused() {
    let mut bytes = b"#ROSBAG V2.0\n".to_vec();
    let fields: [(&str, &[u8]); 5] = [
        ("op", &[3]),
        ("index_pos", &[0; 8]),
        ("conn_count", &[0; 4]),
        ("chunk_count", &[0; 4]),
        ("encryptor", b"rosbag/AesCbcEncryptor"),
    ];
    bytes.extend(support::rosbag1::record(&fields, &[b' '; 100]));
    let (source, _, _) = read(&bytes);
    let expected = "the bag is encrypted with `rosbag/AesCbcEncryptor`";
    assert_eq!(
        (source.status, source.detail.as_deref()),
        (ReadStatus::Unreadable, Some(expected))
    );
}

/// Two minutes of an IMU at 100 Hz, a map every half minute, and one word of a third connection near the end.
fn long(compression: Compression) -> (BagFile, Vec<TopicMessage>) {
    let mut bag = Rosbag1::new(Layout {
        compression,
        ..Layout::default()
    });
    let [imu, map, word] = ["/imu", "/map", "/word"].map(|topic| {
        bag.connection(&Connection {
            topic,
            latching: topic == "/map",
            ..Connection::default()
        })
    });
    let mut written = Vec::new();
    for tick in 0..12_000 {
        let mut say = |number, topic: &str| {
            let data: Vec<u8> = (0..60).map(|byte| u8::try_from((byte * tick) % 251).unwrap()).collect();
            bag.message(number, tick * 10_000_000, &data);
            written.push((topic.to_owned(), tick * 10_000_000, data));
        };
        say(imu, "/imu");
        if tick % 3000 == 0 {
            say(map, "/map");
        }
        if tick == 9_321 {
            say(word, "/word");
        }
    }
    (bag.finish(), written)
}

const SAMPLING: Sampling = Sampling {
    windows: 4,
    seconds: 2.0,
    bytes: 200_000,
    carried: None,
};

#[test]
fn some_of_a_bag_is_read_by_its_index() {
    let some = Selection {
        sampling: Some(SAMPLING),
        throughout: &|channel| channel.latched,
        in_a_row: &|_| false,
    };
    for compression in Compression::ALL {
        let (bag, written) = long(compression);
        let (source, extent, heard) = wanted(&bag.bytes, &some);
        assert_eq!((source.status, &source.problems), (ReadStatus::Read, &vec![]));
        let expected = Extent {
            truncated: false,
            whole: false,
            indexed: true,
            messages_total: Some(12_005),
            span_ns: Some((0, 119_990_000_000)),
        };
        assert_eq!(extent, expected);
        let share = heard.messages.len();
        assert!((700..3000).contains(&share) && source.examined.bytes < source.examined.bytes_total / 2);
        assert!(heard.seams >= 4, "{}", heard.seams);
        assert_eq!(
            (heard.messages.first(), heard.messages.last()),
            (written.first(), written.last())
        );
        let of = |topic: &str| heard.messages.iter().filter(|said| said.0 == topic).count();
        assert_eq!((of("/map"), of("/word")), (4, 1));
        assert_eq!(heard.channels[0].total, Some(12_000));
        assert!(are_some_of(&heard.messages, &written));
        // What fits is read wholly.
        let all = Selection {
            sampling: Some(Sampling {
                bytes: 1 << 30,
                ..SAMPLING
            }),
            ..some
        };
        let (_, extent, heard) = wanted(&bag.bytes, &all);
        assert!(extent.whole && heard.messages == written && heard.seams == 0);
    }
}

/// Stretches go on for messages that are wanted in a row, and less far where decompression is slow.
#[test]
fn messages_that_are_wanted_in_a_row_are_read_on() {
    for compression in Compression::ALL {
        let (bag, _) = long(compression);
        let count = |carried: Option<RunExtension>| {
            let some = Selection {
                sampling: Some(Sampling {
                    bytes: 20_000,
                    carried,
                    ..SAMPLING
                }),
                throughout: &|channel| channel.latched,
                in_a_row: &|channel| channel.topic == "/imu",
            };
            wanted(&bag.bytes, &some).2.messages.len()
        };
        let carried = count(Some(RunExtension {
            runs: 4,
            bytes: 100_000,
        }));
        if compression == Compression::Bz2 {
            assert!(carried < 800, "{carried}");
        } else {
            assert!(carried >= 800 && carried > count(None) + 100, "{carried}");
        }
    }
}

#[test]
fn an_index_that_lies_about_a_chosen_chunk_is_not_followed() {
    let some = Selection {
        sampling: Some(SAMPLING),
        throughout: &|channel| channel.latched,
        in_a_row: &|_| false,
    };
    let (bag, written) = long(Compression::Lz4);
    // The last chunk, which is always chosen, is said to stand a little earlier.
    let last = *bag.chunks.last().unwrap() as u64;
    let field = [b"chunk_pos=", last.to_le_bytes().as_slice()].concat();
    let at = bag.index
        + bag.bytes[bag.index..]
            .windows(field.len())
            .position(|window| window == field)
            .unwrap();
    let mut lying = bag.bytes.clone();
    lying[at + 10..at + 18].copy_from_slice(&(last - 3).to_le_bytes());
    let (source, extent, heard) = wanted(&lying, &some);
    assert!(extent.whole && heard.messages == written, "{source:?}");
    assert_eq!(source.status, ReadStatus::Partial);
    // A chunk that is there, and damaged.
    let mut broken = bag.bytes.clone();
    let last = *bag.chunks.last().unwrap();
    broken[last + 100..last + 120].fill(0x5a);
    let (source, extent, heard) = wanted(&broken, &some);
    assert!(
        extent.truncated && !extent.whole && heard.messages.len() > 600,
        "{source:?}"
    );
    assert_eq!(source.status, ReadStatus::Partial);
    let expected = format!("bytes {last} to ");
    assert!(source.detail.clone().unwrap().starts_with(&expected), "{source:?}");
}

#[test]
fn every_real_bag_is_read() {
    let Some(folder) = support::real_bags() else { return };
    let mut read = 0;
    for path in support::files(&folder, ".bag") {
        let (source, extent, heard) = read_from(&path);
        eprintln!(
            "{}: {} channels, {} messages, {:?}",
            path.strip_prefix(&folder).unwrap().display(),
            heard.channels.len(),
            heard.messages.len(),
            source.detail
        );
        if source.status == ReadStatus::Unreadable {
            assert!(source.detail.unwrap().starts_with("this ROS 1 bag has version V1.2"));
            continue;
        }
        read += 1;
        assert_eq!(
            (source.status, &source.problems),
            (ReadStatus::Read, &vec![]),
            "{}",
            path.display()
        );
        assert!(extent.indexed && !extent.truncated && heard.seams == 0);
        assert_eq!(extent.messages_total, Some(heard.messages.len() as u64));
        for channel in &heard.channels {
            let of = heard.messages.iter().filter(|(topic, ..)| *topic == channel.topic);
            let on_topic = heard.channels.iter().filter(|other| other.topic == channel.topic);
            let total: u64 = on_topic.map(|channel| channel.total.unwrap()).sum();
            assert_eq!(of.count() as u64, total, "{}: {}", path.display(), channel.topic);
        }
    }
    assert!(read > 0, "no bag was found in {}", folder.display());
}

/// Writes the seeds of the fuzz target, without the magic that it gives itself.
#[test]
#[ignore = "writes into fuzz/seeds"]
fn seeds_of_the_fuzz_target() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("fuzz/seeds/rosbag1");
    std::fs::create_dir_all(&folder).unwrap();
    for (name, compression, ending) in [
        ("none", Compression::None, Ending::Closed),
        ("bz2", Compression::Bz2, Ending::Closed),
        ("lz4", Compression::Lz4, Ending::Closed),
        ("unindexed", Compression::None, Ending::Unindexed),
        ("active", Compression::Lz4, Ending::Active),
    ] {
        let mut bag = Rosbag1::new(Layout {
            compression,
            ending,
            chunk_bytes: 300,
            ..Layout::default()
        });
        let numbers = ["/tf", "/b"].map(|topic| {
            bag.connection(&Connection {
                topic,
                message_type: "tf2_msgs/TFMessage",
                ..Connection::default()
            })
        });
        for tick in 0..8 {
            bag.message(numbers[usize::from(tick % 2 == 0)], tick * 1_000_000_000, &[0; 20]);
        }
        std::fs::write(folder.join(name), &bag.finish().bytes[13..]).unwrap();
    }
}
