//! Damaged, hostile and strange recordings: read up to the fault, said as such, no panic, bounded memory.

#![allow(
    clippy::unwrap_used,
    clippy::expect_used,
    clippy::indexing_slicing,
    clippy::panic,
    clippy::cast_possible_truncation
)]

mod support;

use std::io::Write as _;

use frames_lint::collect::Collected;
use frames_lint::source::{ReadStatus, Source};
use frames_lint::world::bag::BagEvidence;
use support::encode::{Body, Endian, Header, Transform};
use support::raw::{Layout, RawChannel, in_memory};

const DRIVE: &str = "
duration_s: 4
chunk_size_bytes: 4000
topics:
  - {topic: /tf_static, transforms: [{parent: base_link, child: imu}]}
  - topic: /tf
    rate_hz: 50
    transforms: [{parent: odom, child: base_link, velocity: [1, 0, 0], yaw_rate_deg_s: 5}]
  - {topic: /imu, type: sensor_msgs/msg/Imu, rate_hz: 100, frame_id: imu}
";

fn bag(collected: &Collected) -> &BagEvidence {
    &collected.facts.bags[0]
}

/// The same recording in the layouts that fail in different ways.
fn layouts() -> Vec<(&'static str, Vec<u8>)> {
    let unchunked = in_memory(
        Layout {
            chunks: false,
            ..Layout::default()
        },
        |out| {
            let schema = support::schemas::definition("sensor_msgs/msg/Imu");
            let imu = out.channel(&RawChannel {
                topic: "/imu",
                message_type: "sensor_msgs/msg/Imu",
                schema: &schema,
                ..RawChannel::default()
            });
            for tick in 0..100 {
                let header = Header {
                    stamp_ns: tick * 1_000_000,
                    frame_id: "imu",
                };
                out.message(imu, tick * 1_000_000, &Body::Imu(header).encode(Endian::Little));
            }
        },
    );
    vec![
        ("zstd", support::build(DRIVE)),
        ("lz4", support::build(&format!("compression: lz4{DRIVE}"))),
        ("none", support::build(&format!("compression: none{DRIVE}"))),
        ("one chunk", support::build(&DRIVE.replace("4000", "40000000"))),
        ("no chunks", unchunked),
    ]
}

/// Byte offset of the record that ends the data: what stands behind it is only an index.
fn data_end(bytes: &[u8]) -> usize {
    // Footer: magic 8, then summary CRC 4, offset start 8, summary start 8.
    let at = bytes.len() - 8 - 20;
    let summary = u64::from_le_bytes(bytes[at..at + 8].try_into().unwrap()) as usize;
    summary - 13
}

#[test]
fn a_file_cut_at_any_percent_gives_what_stands_before_the_cut() {
    for (name, bytes) in layouts() {
        let (_, whole) = support::collected(&bytes);
        let whole = bag(&whole);
        let mut before = 0;
        for percent in 0..100 {
            let cut = bytes.len() * percent / 100;
            let (source, collected) = support::collected(&bytes[..cut]);
            let part = bag(&collected);
            let what = format!("{name} cut at {percent} %: {source:?}");
            let expected = if part.messages > 0 {
                ReadStatus::Partial
            } else {
                ReadStatus::Unreadable
            };
            assert_eq!(source.status, expected, "{what}");
            assert_eq!(part.truncated, cut <= data_end(&bytes), "{what}");
            assert_eq!(source.examined.messages, Some(part.messages), "{what}");
            assert!(part.messages >= before && part.messages <= whole.messages, "{what}");
            before = part.messages;
            if cut >= 8 {
                let detail = source.detail.unwrap();
                assert!(
                    detail.starts_with("read up to byte ") && detail.contains(" %): the file ends"),
                    "{detail}"
                );
            }
            for edge in &part.tf {
                let known = whole.tf.iter().find(|known| known.child == edge.child).unwrap();
                assert_eq!(edge.samples[..], known.samples[..edge.samples.len()], "{what}");
            }
            for (topic, known) in part.topics.iter().map(|(name, topic)| (topic, &whole.topics[name])) {
                let samples = &topic.stamps.samples;
                assert_eq!(samples[..], known.stamps.samples[..samples.len()], "{what}");
            }
        }
        assert!(
            before * 10 >= whole.messages * 8,
            "{name}: {before} of {}",
            whole.messages
        );
    }
}

#[test]
fn a_missing_summary_costs_no_data() {
    for (name, bytes) in layouts() {
        let end = data_end(&bytes) + 13;
        let (source, collected) = support::collected(&bytes[..end]);
        assert_eq!(source.status, ReadStatus::Partial, "{name}");
        assert!(
            source
                .detail
                .unwrap()
                .ends_with("the file ends without a footer: the recording was not closed")
        );
        assert!(!bag(&collected).truncated);
        let (_, whole) = support::collected(&bytes);
        assert_eq!(bag(&collected), bag(&whole), "{name}");
    }
}

#[test]
fn a_flipped_bit_is_seen_wherever_it_touches_the_evidence() {
    for (name, bytes) in layouts() {
        let (_, whole) = support::collected(&bytes);
        let mut seen = 0;
        for place in 0..100 {
            let mut broken = bytes.clone();
            let at = (bytes.len() - 1) * place / 99;
            broken[at] ^= 1 << (place % 8);
            let (source, collected) = support::collected(&broken);
            seen += u32::from(source.status != ReadStatus::Read);
            // Without chunks there is no checksum to see it by.
            let same = bag(&collected) == bag(&whole) || name == "no chunks";
            assert!(
                same || source.status != ReadStatus::Read,
                "{name}, byte {at}: {source:?}"
            );
        }
        assert!(seen > 5, "{name}: {seen} of 100 were seen");
    }
}

/// The first chunk of a file: offset of its frame.
fn first_chunk(bytes: &[u8]) -> usize {
    let mut at = 8;
    while bytes[at] != 6 {
        at += 9 + u64::from_le_bytes(bytes[at + 1..at + 9].try_into().unwrap()) as usize;
    }
    at
}

fn patched(bytes: &[u8], at: usize, value: u64) -> Vec<u8> {
    let mut bytes = bytes.to_vec();
    bytes[at..at + 8].copy_from_slice(&value.to_le_bytes());
    bytes
}

#[test]
fn lying_sizes_are_refused() {
    for (name, bytes) in layouts().into_iter().filter(|(name, _)| *name != "no chunks") {
        let chunk = first_chunk(&bytes);
        let name_len = u32::from_le_bytes(bytes[chunk + 37..chunk + 41].try_into().unwrap()) as usize;
        let (length, uncompressed, compressed) = (chunk + 1, chunk + 25, chunk + 41 + name_len);
        for lie in [0, 1, 7, 1 << 20, 1 << 29, 1 << 31, 1 << 62, u64::MAX] {
            for (what, at) in [
                ("length", length),
                ("uncompressed", uncompressed),
                ("compressed", compressed),
            ] {
                // The size before compression is nobody's claim in a chunk that is not compressed.
                if name == "none" && what == "uncompressed" && lie <= 1 << 30 {
                    continue;
                }
                let (source, collected) = support::collected(&patched(&bytes, at, lie));
                assert_ne!(source.status, ReadStatus::Read, "{name}: {what} = {lie}: {source:?}");
                assert!(bag(&collected).truncated);
                assert!(
                    source.detail.unwrap().starts_with("read up to byte"),
                    "{name}: {what} = {lie}"
                );
            }
        }
    }
    let (source, _) = support::collected(&patched(
        &support::build(DRIVE),
        first_chunk(&support::build(DRIVE)) + 25,
        1 << 62,
    ));
    let detail = source.detail.unwrap();
    assert!(
        detail.ends_with("a chunk claims 4611686018427387904 bytes of messages, above the limit of 1073741824"),
        "{detail}"
    );
}

#[test]
fn a_record_that_claims_more_than_its_chunk_is_refused() {
    let bytes = support::build(&format!("compression: none{DRIVE}"));
    let header = first_chunk(&bytes) + 9 + 40;
    for lie in [1 << 20, 1 << 40, u64::MAX] {
        let (source, _) = support::collected(&patched(&bytes, header + 1, lie));
        assert_eq!(source.status, ReadStatus::Unreadable, "{lie}: {source:?}");
    }
    // Without a checksum to fail first.
    let loose = Layout {
        compression: None,
        checksums: false,
        ..Layout::default()
    };
    let bytes = in_memory(loose, |out| {
        let channel = out.channel(&RawChannel::default());
        (0..10).for_each(|tick| out.message(channel, tick, b"0123456789"));
    });
    let record = first_chunk(&bytes) + 9 + 40;
    for lie in [30, 1 << 20, 1 << 40, u64::MAX] {
        let (source, _) = support::collected(&patched(&bytes, record + 1, lie));
        assert_ne!(source.status, ReadStatus::Read, "{lie}: {source:?}");
    }
}

#[test]
fn what_is_no_mcap_is_told_apart() {
    let cases: [(&[u8], &str); 10] = [
        (b"", "the file is empty"),
        (&[0; 4096], "not an MCAP: magic missing at byte 0"),
        (b"<robot name='x'/>", "not an MCAP: magic missing at byte 0"),
        (b"#ROSBAG V2.0\n", "not an MCAP: this is a ROS 1 bag, which is not read"),
        (
            b"SQLite format 3\0 etc",
            "not an MCAP: this is an SQLite database (rosbag2 `.db3`), which is not read",
        ),
        (&[0x1f, 0x8b, 8, 0], "not an MCAP: this is a file compressed with gzip"),
        (
            &[0x28, 0xb5, 0x2f, 0xfd, 0],
            "not an MCAP: this is a file compressed with zstd",
        ),
        (b"PK\x03\x04zip", "not an MCAP: this is a ZIP archive"),
        (
            b"version https://git-lfs.github.com/spec/v1\noid sha256:00\nsize 12\n",
            "not an MCAP: this is a Git LFS pointer, the recording itself was not downloaded",
        ),
        (b"\x89MCA", "not an MCAP: magic missing at byte 0"),
    ];
    for (bytes, expected) in cases {
        let (source, collected) = support::collected(bytes);
        assert_eq!(
            (source.status, source.detail.as_deref()),
            (ReadStatus::Unreadable, Some(expected))
        );
        assert!(bag(&collected).truncated && bag(&collected).topics.is_empty());
    }
    let folder = tempfile::tempdir().unwrap();
    let (source, _) = support::collected_from(folder.path());
    assert_eq!(source.detail.as_deref(), Some("is not a regular file"));
    let (source, _) = support::collected_from(&folder.path().join("absent.mcap"));
    assert!(source.detail.unwrap().starts_with("cannot be opened: "));
}

#[test]
fn zeros_and_rubbish_behind_the_magic_end_the_reading_at_once() {
    let bytes = support::build(DRIVE);
    let chunk = first_chunk(&bytes);
    for filler in [0, 0xff] {
        let mut broken = bytes[..chunk].to_vec();
        broken.resize(1 << 20, filler);
        let (source, _) = support::collected(&broken);
        assert_eq!(
            (source.status, source.examined.bytes),
            (ReadStatus::Unreadable, chunk as u64),
            "{source:?}"
        );
    }
    let mut longer = bytes.clone();
    longer.extend(&bytes);
    let (source, collected) = support::collected(&longer);
    assert_eq!((source.status, bag(&collected).messages), (ReadStatus::Partial, 601));
    assert!(
        source
            .detail
            .unwrap()
            .ends_with(&format!("{} bytes follow the end of the recording", bytes.len()))
    );
}

#[test]
fn an_empty_recording_is_read_and_says_so() {
    let (source, collected) = support::collected(&in_memory(Layout::default(), |_| {}));
    assert_eq!(
        (source.status, source.detail.as_deref()),
        (ReadStatus::Read, Some("no messages"))
    );
    assert_eq!((bag(&collected).truncated, bag(&collected).start_ns), (false, None));
}

/// A recording with one channel and these messages, one a second.
fn one_topic(channel: &RawChannel<'_>, messages: &[Vec<u8>]) -> (Source, Collected) {
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
            Ok(0),
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
            Err("definitions in ros2idl are not read"),
        ),
        (
            "foxglove.FrameTransform",
            "protobuf",
            "protobuf",
            "x",
            Err("protobuf messages are not read"),
        ),
        (
            "std_msgs/Header",
            "ros1",
            "ros1msg",
            "uint32 seq",
            Err("ros1 messages are not read"),
        ),
        ("", "json", "", "", Err("json messages are not read")),
        ("", "cdr", "", "", Err("the recording holds no definition of the type")),
    ];
    for (message_type, message_encoding, schema_encoding, schema, expected) in cases {
        let channel = RawChannel {
            message_type,
            message_encoding,
            schema_encoding,
            schema,
            ..RawChannel::default()
        };
        let (source, collected) = one_topic(&channel, &[stamped(7)]);
        let topic = &bag(&collected).topics["/topic"];
        assert_eq!(
            (source.status, topic.count, topic.malformed),
            (ReadStatus::Read, 1, 0),
            "{channel:?}"
        );
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
        (20_000, 10_000, 256)
    );
    assert_eq!(
        (bag.topics["/tf"].count, bag.topics["/imu"].stamps.count),
        (22_000, 22_000)
    );
    let problems: Vec<&str> = source.problems.iter().map(|problem| problem.message.as_str()).collect();
    let expected = [
        "502 channels beyond the first 10000 topics, or with very long names are not in the evidence",
        "2000 transforms beyond the first 20000 edges of TF are not in the evidence",
        "21744 message headers with ever new frame names are not in the evidence",
    ];
    assert_eq!((source.status, problems), (ReadStatus::Partial, expected.to_vec()));
}

#[test]
fn progress_reaches_the_end() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("drive.mcap");
    support::write(DRIVE, &path);
    let size = std::fs::metadata(&path).unwrap().len();
    let calls = std::cell::RefCell::new(Vec::new());
    let mut source = Source::new(
        frames_lint::source::SourceId(0),
        "drive.mcap",
        frames_lint::source::SourceKind::Mcap,
    );
    frames_lint::collect::collect(&path, &mut source, &|done, total| {
        calls.borrow_mut().push((done, total))
    });
    assert_eq!(calls.into_inner().last(), Some(&(size, size)));
}

/// Peak resident memory of this process since the last call, in MB, and 0 where the system does not say.
fn peak_mb() -> u64 {
    let status = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
    let line = status
        .lines()
        .find(|line| line.starts_with("VmHWM:"))
        .unwrap_or_default();
    let kb = line.split_whitespace().nth(1).and_then(|kb| kb.parse::<u64>().ok());
    let _ = std::fs::write("/proc/self/clear_refs", "5");
    kb.unwrap_or(0) / 1024
}

/// Measures memory and speed on large files: `cargo test --test bag_damage -- --ignored --nocapture --test-threads 1`.
#[test]
#[ignore = "writes 1.5 GB"]
fn large_files_take_little_memory() {
    let folder = tempfile::tempdir().unwrap();
    let zeros = folder.path().join("zeros.mcap");
    std::fs::File::create(&zeros)
        .unwrap()
        .write_all(&vec![0; 1 << 30])
        .unwrap();
    let measured = |path: &std::path::Path, what: &str| {
        peak_mb();
        let begin = std::time::Instant::now();
        let (source, collected) = support::collected_from(path);
        let (seconds, peak) = (begin.elapsed().as_secs_f64(), peak_mb());
        let size = source.examined.bytes_total >> 20;
        let messages = bag(&collected).messages;
        let report = format!(
            "{what}: {size} MB, {messages} messages, {seconds:.2} s, peak {peak} MB, {:?}",
            source.detail
        );
        writeln!(std::io::stderr(), "{report}").unwrap();
        assert!(peak < 300, "{report}");
        source
    };
    let source = measured(&zeros, "zeros");
    assert_eq!(source.status, ReadStatus::Unreadable);
    std::fs::remove_file(&zeros).unwrap();
    for (what, compression) in [
        ("none", None),
        ("lz4", Some(mcap::Compression::Lz4)),
        ("zstd", Some(mcap::Compression::Zstd)),
    ] {
        let path = folder.path().join("large.mcap");
        let layout = Layout {
            compression,
            chunk_bytes: 768 << 10,
            ..Layout::default()
        };
        let mut out = support::raw::RawBag::new(std::fs::File::create(&path).unwrap(), layout);
        let points = support::schemas::definition("sensor_msgs/msg/PointCloud2");
        let points = out.channel(&RawChannel {
            topic: "/points",
            message_type: "sensor_msgs/msg/PointCloud2",
            schema: &points,
            ..RawChannel::default()
        });
        let tf = out.channel(&RawChannel {
            topic: "/tf",
            message_type: "tf2_msgs/msg/TFMessage",
            ..RawChannel::default()
        });
        let mut noise: u64 = 1;
        for tick in 0..500 {
            let log_ns = tick * 100_000_000;
            let mut cloud = stamped(log_ns);
            cloud.extend((0..1 << 17).flat_map(|_| {
                noise = noise.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
                (noise >> 20).to_le_bytes()
            }));
            out.message(points, log_ns, &cloud);
            for step in 0..100 {
                let stamp_ns = log_ns + step * 1_000_000;
                let transform = Transform {
                    header: Header {
                        stamp_ns,
                        frame_id: "odom",
                    },
                    child: "base_link",
                    translation: [0.0; 3],
                    rotation: [0.0, 0.0, 0.0, 1.0],
                };
                out.message(tf, stamp_ns, &Body::Tf(&[transform; 20]).encode(Endian::Little));
            }
        }
        out.finish();
        assert_eq!(measured(&path, what).status, ReadStatus::Read);
    }
}
