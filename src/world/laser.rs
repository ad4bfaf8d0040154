//! Evidence of planar scanners. Bounded, as published.

use serde::{Deserialize, Serialize};

use crate::source::MessageRef;

use super::cloud::CloudEvidence;

/// Scans of one topic whose numbers are kept.
pub const MAX_SCANS: usize = 64;

/// The numbers of one scan besides its ranges, `sensor_msgs/msg/LaserScan` as published.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct LaserScanAt {
    /// Zero-based index of the message on its topic.
    pub index: u64,
    /// Angles of the first and the last ray, and from one to the next, radians from x towards y.
    #[serde(with = "super::number::array")]
    pub angles: [f64; 3],
    /// From one ray to the next, seconds; NaN if the type does not have it.
    #[serde(with = "super::number")]
    pub time_increment_s: f64,
    /// From one scan to the next, seconds; NaN if the type does not have it.
    #[serde(with = "super::number")]
    pub scan_time_s: f64,
    /// The smallest and the largest valid range, metres; NaN if the type does not have it.
    #[serde(with = "super::number::array")]
    pub range_m: [f64; 2],
    /// Rays.
    pub rays: u32,
    /// Rays with a valid range.
    pub returns: u32,
}

/// The scans of one topic.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct LaserEvidence {
    /// Messages.
    pub count: u64,
    /// The first of them.
    pub first: MessageRef,
    /// Evenly thinned scans, the first and the last among them.
    pub scans: Vec<LaserScanAt>,
    /// Runs of neighbouring scans as clouds of points in the plane, z being zero; nothing else of a cloud.
    pub projected: CloudEvidence,
}
