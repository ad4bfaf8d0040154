//! Memory and time on large recordings; measured by hand, for it writes 1.5 GB.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::indexing_slicing, clippy::panic)]

mod support;

use std::io::Write as _;

use frames_lint::source::ReadStatus;
use support::bag;
use support::encode::{Body, Endian, Header, Transform};
use support::raw::{Layout, RawBag, RawChannel};

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

/// Measures memory and speed on large files: `cargo test --test bag_large -- --ignored --nocapture`.
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
        assert_eq!(measured(&path, what).status, ReadStatus::Read);
    }
}
