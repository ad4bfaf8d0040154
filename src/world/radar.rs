//! Evidence of radars: runs of neighbouring scans, thinned. Bounded, as published.

use serde::{Deserialize, Serialize};

use crate::source::MessageRef;

/// Detections of a scan that are kept.
pub const SWEEP_ECHOES: usize = 128;
/// Scans of a run.
pub const RUN_SWEEPS: usize = 8;

/// The kind of message that contains the detections.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum RadarForm {
    /// A list of them: `radar_msgs/msg/RadarScan`, or a driver's own.
    Scan,
    /// Objects that a tracker made of them: `radar_msgs/msg/RadarTracks`.
    Tracks,
    /// One detection a message.
    Single,
    /// The points of a cloud.
    Cloud,
}

/// The meaning of a number that is named a speed.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum SpeedForm {
    /// Along the line of sight, by its name.
    Radial,
    /// Named `velocity` or similar.
    Plain,
    /// Components along axes.
    Components,
}

/// Detections of one scan.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct RadarSweep {
    /// Stamp of its header, nanoseconds; none if that is zero.
    pub stamp_ns: Option<i64>,
    /// Log time, nanoseconds.
    pub log_ns: i64,
    /// How many the scan has.
    pub total: u32,
    /// x, y and z in the frame of the header, metres, and the speed along the line of sight, m/s, as published (that of components
    /// along it): finite, and not at the origin.
    pub echoes: Vec<[f64; 4]>,
}

/// The detections of one topic, or of a member of its messages.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct RadarEvidence {
    /// Scans.
    pub count: u64,
    /// The first of them.
    pub first: MessageRef,
    /// The kind of their message.
    pub form: RadarForm,
    /// The names of the speeds, in the first message.
    pub field: String,
    /// Their meaning.
    pub speeds: SpeedForm,
    /// Detections that were examined.
    pub looked_at: u64,
    /// Of these, those with a number that is not finite, or at the origin.
    pub broken: u64,
    /// Of these, those with components whose second is not zero.
    pub sideways: u64,
    /// Evenly thinned runs of scans that follow each other.
    pub runs: Vec<Vec<RadarSweep>>,
}
