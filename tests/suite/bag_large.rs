//! Memory and time on large recordings; measured by hand, for it writes 1.5 GB.

#![allow(clippy::unwrap_used, clippy::indexing_slicing, clippy::print_stderr)]

use std::io::Write as _;

use crate::support;
use crate::support::bag;
use crate::support::encode::{Body, Endian, Header, Transform};
use crate::support::raw::{Layout, RawBag, RawChannel};
use crate::support::rosbag1::{self, Rosbag1};
use frames_lint::source::ReadStatus;

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

/// Collects a file, writes down time and peak memory, and holds the peak under 300 MB.
fn measure(path: &std::path::Path, what: &str) -> ReadStatus {
    measure_under(300, path, what)
}

fn measure_under(limit_mb: u64, path: &std::path::Path, what: &str) -> ReadStatus {
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
    eprintln!("{report}");
    assert!(peak < limit_mb, "{report}");
    source.status
}

/// Measures memory and speed on large files: `cargo test --test suite -- --ignored bag_large --nocapture`.
#[test]
#[ignore = "writes 1.5 GB"]
fn large_files_take_little_memory() {
    let folder = tempfile::tempdir().unwrap();
    let zeros = folder.path().join("zeros.mcap");
    std::fs::File::create(&zeros)
        .unwrap()
        .write_all(&vec![0; 1 << 30])
        .unwrap();
    assert_eq!(measure(&zeros, "zeros"), ReadStatus::Unreadable);
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
        let mut out = RawBag::new(std::fs::File::create(&path).unwrap(), layout);
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
            let mut cloud = Body::Padded(Header {
                stamp_ns: log_ns,
                frame_id: "lidar",
            })
            .encode(Endian::Little);
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
        assert_eq!(measure(&path, what), ReadStatus::Read);
    }
}

/// As many edges and topics as are kept, each with long names, every fault and more samples than its share.
#[test]
#[ignore = "takes a minute"]
fn a_hostile_recording_takes_little_memory() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("hostile.mcap");
    let mut out = RawBag::new(std::fs::File::create(&path).unwrap(), Layout::default());
    let long = "x".repeat(240);
    let tf = out.channel(&RawChannel {
        topic: &format!("/{long}/tf"),
        message_type: "tf2_msgs/msg/TFMessage",
        ..RawChannel::default()
    });
    let topics: Vec<u16> = (0..10_000)
        .map(|topic| {
            out.channel(&RawChannel {
                topic: &format!("/{long}/{topic}"),
                message_type: "acme/msg/A",
                schema: "std_msgs/Header header",
                ..RawChannel::default()
            })
        })
        .collect();
    for tick in 0..40 {
        for (edge, number) in (0..20_000).zip(0_i64..) {
            let child = format!("{long}{edge}");
            let stamp_ns = tick * 1_000_000_000 + number;
            let header = Header {
                stamp_ns,
                frame_id: &long,
            };
            let transform = Transform {
                header,
                child: &child,
                translation: [if tick % 4 == 1 { f64::NAN } else { tick as f64 }, 0.0, 0.0],
                rotation: [0.0, 0.0, 0.0, [1.0, 1.0, 0.0, 2.0][usize::try_from(tick % 4).unwrap()]],
            };
            out.message(tf, stamp_ns, &Body::Tf(&[transform]).encode(Endian::Little));
            let name = format!("{long}{}", tick % 5);
            let message = Body::Padded(Header {
                stamp_ns,
                frame_id: &name,
            })
            .encode(Endian::Little);
            out.message(topics[edge % topics.len()], stamp_ns, &message);
        }
    }
    out.finish();
    assert_eq!(measure(&path, "hostile"), ReadStatus::Partial);
}

/// A small ROS 1 bag whose chunks decompress to a gigabyte each, in messages of a hundred megabytes.
#[test]
#[ignore = "decompresses 3 GB"]
fn a_bag_that_decompresses_to_gigabytes_takes_little_memory() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("bomb.bag");
    let mut out = Rosbag1::new(rosbag1::Layout {
        compression: rosbag1::Compression::Lz4,
        chunk_bytes: 900 << 20,
        ..rosbag1::Layout::default()
    });
    let zeros = out.connection(&rosbag1::Connection::default());
    let message = vec![0; 100 << 20];
    for tick in 0..27 {
        out.message(zeros, tick * 1_000_000_000, &message);
    }
    drop(message);
    std::fs::write(&path, out.finish().bytes).unwrap();
    assert_ne!(measure(&path, "bomb"), ReadStatus::Unreadable);
}

/// As many topics as are kept, each with poses that jump and covariances that never repeat.
#[test]
#[ignore = "takes a minute"]
fn ten_thousand_odometries_take_little_memory() {
    use support::encode::Field;

    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("odometries.mcap");
    let mut out = RawBag::new(std::fs::File::create(&path).unwrap(), Layout::default());
    let long = "x".repeat(240);
    let schema = support::schemas::definition("nav_msgs/msg/Odometry");
    let topics: Vec<u16> = (0..10_000)
        .map(|topic| {
            out.channel(&RawChannel {
                topic: &format!("/{long}/{topic}"),
                message_type: "nav_msgs/msg/Odometry",
                schema: &schema,
                ..RawChannel::default()
            })
        })
        .collect();
    for tick in 0..30 {
        let value = f64::from(tick);
        let stamp_ns = i64::from(tick) * 1_000_000_000;
        let header = Header {
            stamp_ns,
            frame_id: &long,
        };
        let mut matrix = vec![0.0; 36];
        matrix[1] = value + 1.0;
        matrix[35] = if tick % 5 == 0 { f64::NAN } else { 1.0 };
        let fields = vec![
            Field::Text("base_link"),
            Field::F64s(vec![value * value, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0]),
            Field::F64s(matrix.clone()),
            Field::F64s(vec![value; 6]),
            Field::F64s(matrix),
        ];
        let message = Body::Fields(header, fields).encode(Endian::Little);
        for topic in &topics {
            out.message(*topic, stamp_ns, &message);
        }
    }
    out.finish();
    // Much of it is the topic's name, of 240 bytes, in every reference to a message.
    assert_eq!(measure_under(400, &path, "odometries"), ReadStatus::Read);
}
