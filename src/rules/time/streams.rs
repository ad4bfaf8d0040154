//! Streams of stamps: one for each topic with headers, and one for each moving TF edge.
//!
//! Latched topics and static TF are left out: their stamps are older than their log time by right.

use crate::math::stats::{mad, median};
use crate::source::{Place, SourceId};
use crate::world::BagEvidence;
use crate::world::bag::StampEvidence;

/// Stamps below this are no calendar time: a clock that counts from power-up, or the time of day (1973-03-03).
pub(super) const UPTIME_BELOW_S: f64 = 1e8;

/// One stream of stamps.
pub(super) struct Stream<'w> {
    /// The recording.
    pub(super) source: SourceId,
    /// `topic /imu`, or `TF odom from base_link on /tf`.
    pub(super) subject: String,
    /// The stamps.
    pub(super) stamps: &'w StampEvidence,
    /// Whether the stream comes from one publisher as far as can be seen: one frame id.
    pub(super) single_frame: bool,
}

impl Stream<'_> {
    /// Where the stream begins.
    pub(super) fn place(&self) -> Place {
        match &self.stamps.first {
            Some(message) => Place::message(self.source, message.clone()),
            None => Place::whole(self.source),
        }
    }

    /// `stamp - log`, seconds, of every sampled stamp that is not zero.
    pub(super) fn offsets_s(&self) -> Vec<f64> {
        self.stamps
            .samples
            .iter()
            .filter(|(stamp, _)| *stamp != 0)
            .map(|(stamp, log)| (*stamp as f64 - *log as f64) / 1e9)
            .collect()
    }

    /// Median of the stamps, seconds of the stamp's own clock.
    pub(super) fn median_stamp_s(&self) -> Option<f64> {
        let stamps: Vec<f64> = self
            .stamps
            .samples
            .iter()
            .filter(|(stamp, _)| *stamp != 0)
            .map(|(stamp, _)| *stamp as f64 / 1e9)
            .collect();
        median(&stamps)
    }

    /// Median and spread (1.4826 MAD) of `stamp - log`, seconds.
    pub(super) fn offset_s(&self) -> Option<(f64, f64)> {
        let offsets = self.offsets_s();
        // `mad` is scaled to a standard deviation already.
        Some((median(&offsets)?, mad(&offsets)?))
    }

    /// Share of stamps that are exactly zero.
    pub(super) fn zero_share(&self) -> f64 {
        if self.stamps.count == 0 {
            return 0.0;
        }
        self.stamps.zero as f64 / self.stamps.count as f64
    }
}

/// Topics that are written once and kept: their stamp is the time of making, not of sending.
fn is_latched(topic: &str, message_type: &str) -> bool {
    let last = topic.rsplit('/').next().unwrap_or(topic);
    let latched_name = matches!(
        last,
        "tf_static" | "map" | "map_metadata" | "costmap" | "robot_description"
    );
    latched_name || message_type.ends_with("/OccupancyGrid") || message_type.ends_with("/MapMetaData")
}

/// All streams of one recording, topics first, in order of name.
pub(super) fn streams(bag: &BagEvidence) -> Vec<Stream<'_>> {
    let mut streams: Vec<Stream<'_>> = bag
        .topics
        .values()
        .filter(|topic| topic.stamps.count > 0 && !is_tf(&topic.topic, &topic.message_type))
        .filter(|topic| !is_latched(&topic.topic, &topic.message_type))
        .map(|topic| Stream {
            source: bag.source,
            subject: format!("topic `{}`", topic.topic),
            stamps: &topic.stamps,
            single_frame: topic.header_frames.len() <= 1,
        })
        .collect();
    streams.extend(bag.tf.iter().filter(|edge| !edge.is_static).map(|edge| Stream {
        source: bag.source,
        subject: format!("TF `{}` from `{}` on `{}`", edge.parent, edge.child, edge.topic),
        stamps: &edge.stamps,
        single_frame: true,
    }));
    streams
}

fn is_tf(topic: &str, message_type: &str) -> bool {
    let last = topic.rsplit('/').next().unwrap_or(topic);
    message_type.ends_with("/TFMessage") || matches!(last, "tf" | "tf_static")
}

/// Whether the recording was made in simulated time: a `/clock` topic, or every stream and the log far before 1973.
pub(super) fn is_simulated(bag: &BagEvidence) -> bool {
    bag.topics.keys().any(|topic| topic.rsplit('/').next() == Some("clock"))
        || bag.start_ns.is_some_and(|start| (start as f64) / 1e9 < UPTIME_BELOW_S)
}
