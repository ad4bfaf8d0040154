//! Any bytes as packets of a lidar, of each maker: no panic, finite points, and not more of them than the bytes hold.
use std::sync::Arc;

use frames_lint::read::packets::{Correction, Maker, Packet, Unit, boundary, decode_with};

/// Runs the target: the first two bytes are the length of every packet, the rest are the packets.
pub fn run(bytes: &[u8]) {
    let Some((length, bytes)) = bytes.split_first_chunk() else {
        return;
    };
    let length = usize::from(u16::from_le_bytes(*length)).max(1);
    let corrected = |read| Unit::corrected(Arc::new(read));
    let mut unit = Correction::read(bytes).map_or_else(Unit::default, corrected);
    for packet in bytes.chunks(length) {
        unit.take(packet);
        let _ = Maker::of(packet);
    }
    for maker in [Maker::Velodyne, Maker::Hesai, Maker::RoboSense, Maker::Livox] {
        let mut scans = boundary(maker);
        let begun = bytes.chunks(length).filter(|packet| scans.begins(packet) == Some(true));
        assert!(begun.count() < bytes.len().max(1));
        for received_ns in [0, i64::MIN, 1_700_000_000_000_000_000, i64::MAX] {
            let packets = bytes.chunks(length).map(|bytes| Packet { received_ns, bytes });
            let count = packets.len();
            let Ok(scan) = decode_with(maker, packets, &unit) else {
                continue;
            };
            // A return has two bytes at least.
            assert!(scan.returns.len() <= bytes.len() / 2);
            assert!(scan.refused < count && (scan.refused > 0) == scan.reason.is_some());
            let finite = scan
                .returns
                .iter()
                .all(|point| [point.x, point.y, point.z].iter().all(|value| value.is_finite()));
            assert!(finite && !scan.model.is_empty());
        }
    }
}
