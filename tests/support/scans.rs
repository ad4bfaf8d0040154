//! What is collected of the clouds that a driver makes of scans: they are written as a recording, and read as one.

use frames_lint::world::bag::TopicEvidence;

use super::clouds::Lidar;
use super::drive::lidar::Ray;
use super::encode::{Body, Endian, Header};
use super::raw::{self, Layout, RawChannel};
use super::schemas;

/// Scans of a second.
pub const SCANS_HZ: f64 = 10.0;

/// The topic `/points`, in a frame. `stamp_and_log_ns` of a scan is by its number.
pub fn collected(
    lidar: &Lidar,
    frame: &str,
    scans: &[Vec<Ray>],
    stamp_and_log_ns: impl Fn(usize) -> [i64; 2],
) -> TopicEvidence {
    let layout = Layout {
        compression: None,
        chunk_bytes: 4 << 20,
        checksums: false,
        ..Layout::default()
    };
    let message_type = lidar.message_type();
    let bytes = raw::in_memory(layout, |bag| {
        let channel = bag.channel(&RawChannel {
            topic: "/points",
            message_type,
            schema: &schemas::definition(message_type),
            ..RawChannel::default()
        });
        for (number, scan) in scans.iter().enumerate() {
            let [stamp_ns, log_ns] = stamp_and_log_ns(number);
            let header = Header {
                stamp_ns,
                frame_id: frame,
            };
            let message = Body::Fields(header, lidar.fields(scan, stamp_ns)).encode(Endian::Little);
            bag.message(channel, log_ns, &message);
        }
    });
    let (_, collected) = super::collected(&bytes);
    super::bag(&collected).topics["/points"].clone()
}
