//! Recordings as readable YAML.
//!
//! ```yaml
//! start_s: 1700000000          # log clock at the start, Unix seconds (the default)
//! duration_s: 10               # ticks run from 0 up to, not including, this (the default)
//! topics:
//!   - topic: /tf_static        # static topics are written once, at `at_s`, unless they have a rate
//!     transforms:
//!       - {parent: base_link, child: lidar, xyz: [0.3, 0, 1.2], rpy_deg: [0, 0, 90]}
//!       - {parent: base_link, child: imu, quaternion: [0, 0, 0, 1]}          # x y z w, as published; .nan allowed
//!   - topic: /tf               # one message a tick, with every transform that is active then
//!     rate_hz: 50
//!     transforms:
//!       - {parent: odom, child: base_link, velocity: [1, 0, 0], yaw_rate_deg_s: 5, until_s: 5}
//!   - {topic: /imu, type: sensor_msgs/msg/Imu, rate_hz: 100, frame_id: imu}  # level, at rest, gravity +9.81 along z
//!   - {topic: /odom, type: nav_msgs/msg/Odometry, rate_hz: 20, frame_id: odom, child_frame_id: base_link}
//!   - {topic: /robot_description, text: "<robot name='r'/>"}
//!   - {topic: /points, type: sensor_msgs/msg/PointCloud2, rate_hz: 10, frame_id: lidar}
//! ```
//!
//! Any type name works: unknown ones get a definition that begins with a header. A topic may be listed several times
//! (a static transform that changes: the same topic again with a later `at_s`; two writers: each with its `writer`).
//!
//! **Motion**, of TF transforms and of topics of type Odometry, PoseStamped and PoseWithCovarianceStamped: `xyz`,
//! `rpy_deg` or `quaternion` (as published) at the start, `velocity: [vx, vy, vz]` in the body's axes (m/s),
//! `yaw_rate_deg_s`; `jumps: [{at_s: 3, by: [1, 0, 0], yaw_deg: 20}]` (the rest of the drive is shifted in the parent's
//! axes and turned about the place reached), `wobble_m`, `wobble_hz` (a sinusoid along the parent's x),
//! `alternate: {by: [0.1, 0, 0], yaw_deg: 0}` (every second message is displaced), `noise_m` (seeded, normal).
//!
//! **Numbers**, as published, `.nan` and `.inf` allowed; what is left out is zero, the identity, or as said:
//! - nav_msgs/msg/Odometry: `twist: {linear: [..], angular: [..]}` (by default what the motion has),
//!   `pose_covariance: [36]`, `twist_covariance: [36]`
//! - geometry_msgs/msg/PoseWithCovarianceStamped: `covariance: [36]`; TwistStamped, TwistWithCovarianceStamped: `twist`,
//!   `covariance: [36]`
//! - sensor_msgs/msg/Imu: `orientation: [x, y, z, w]`, `orientation_covariance: [9]`, `angular_velocity: [3]`,
//!   `angular_velocity_covariance: [9]`, `linear_acceleration: [3]` (gravity +9.81 along z), `acceleration_covariance: [9]`
//! - sensor_msgs/msg/NavSatFix: `latitude`, `longitude` (48, 11), `altitude` (500), `status` (0), `covariance: [9]`,
//!   `east_velocity`, `north_velocity` (m/s), `nan_from_s` (from then on the position is NaN)
//!
//! **Stamps**: `stamp_offset_s` (header stamp minus log time), `stamp_s` (constant), `stamp_scale` (multiplies),
//! `stamp_start_s` (replaces the clock's origin), `stamp_drift_ppm` (of the time since the start), `stamp_jitter_s`
//! (seeded, even in ± that), `stamp_repeat: n` (each stamp serves n messages). `from_s`, `until_s`: the active window of
//! a topic, or of a transform.
//!
//! **Channels**: `durability: volatile` or `qos: {durability: volatile}` (a text is taken as the whole
//! `offered_qos_profiles`), `latched: true`, `writer: /node` (a channel of its own, with `callerid`), `schema`,
//! `big_endian`.
//!
//! **File**: `compression: none | lz4 | zstd`, `chunk_size_bytes`, `metadata: {name: {key: value}}` (metadata records).

use std::collections::BTreeMap;

use serde::Deserialize;

use super::raw::{self, Layout};
use super::topic::{Topic, active, nanoseconds};

/// A drive of 1 + 300 + 600 messages.
pub const DRIVE: &str = "
duration_s: 6
topics:
  - {topic: /tf_static, transforms: [{parent: base_link, child: imu}]}
  - topic: /tf
    rate_hz: 50
    transforms: [{parent: odom, child: base_link, velocity: [1, 0, 0], yaw_rate_deg_s: 5}]
  - {topic: /imu, type: sensor_msgs/msg/Imu, rate_hz: 100, frame_id: imu}
";
/// Messages in it.
pub const MESSAGES: u64 = 901;

/// A recording.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Recipe {
    /// Log clock at the start, Unix seconds.
    #[serde(default = "default_start")]
    pub start_s: f64,
    /// Length, seconds.
    #[serde(default = "default_duration")]
    pub duration_s: f64,
    /// Compression of chunks.
    #[serde(default)]
    pub compression: Compression,
    /// Uncompressed size at which a chunk is closed; 64 KiB by default.
    pub chunk_size_bytes: Option<u64>,
    /// Metadata records: key and value pairs by name.
    #[serde(default)]
    pub metadata: BTreeMap<String, BTreeMap<String, String>>,
    /// Topics, written in the order of log time, then in this order.
    pub topics: Vec<Topic>,
}

/// Compression of chunks.
#[derive(Clone, Copy, Debug, Default, Deserialize, PartialEq, Eq)]
#[serde(rename_all = "lowercase")]
pub enum Compression {
    /// None: messages stand in the file as they are.
    None,
    /// LZ4.
    Lz4,
    /// Zstandard.
    #[default]
    Zstd,
}

fn default_start() -> f64 {
    1_700_000_000.0
}

fn default_duration() -> f64 {
    10.0
}

impl Recipe {
    /// Reads a recipe; panics with the reason where it cannot be.
    pub fn parse(text: &str) -> Self {
        serde_yaml::from_str(text).unwrap_or_else(|error| panic!("the recipe does not parse: {error}\n{text}"))
    }

    /// The recording as an MCAP.
    pub fn to_mcap(&self) -> Vec<u8> {
        let layout = Layout {
            compression: match self.compression {
                Compression::None => None,
                Compression::Lz4 => Some(mcap::Compression::Lz4),
                Compression::Zstd => Some(mcap::Compression::Zstd),
            },
            chunk_bytes: self.chunk_size_bytes.unwrap_or(64 << 10),
            ..Layout::default()
        };
        let mut messages: Vec<(i64, usize, Vec<u8>)> = Vec::new();
        for (index, topic) in self.topics.iter().enumerate() {
            let ticks = self.ticks(topic);
            for (number, at_s) in (0..).zip(ticks.iter().copied()) {
                let log_ns = nanoseconds(self.start_s) + nanoseconds(at_s);
                let stamped = number - number % topic.stamp_repeat.max(1);
                let stamped_s = ticks[usize::try_from(stamped).unwrap()];
                let stamp_ns = topic.stamp_ns(nanoseconds(self.start_s), stamped_s, stamped);
                if let Some(message) = topic.message(at_s, number, stamp_ns) {
                    messages.push((log_ns, index, message));
                }
            }
        }
        messages.sort_by_key(|(log_ns, index, _)| (*log_ns, *index));
        raw::in_memory(layout, |bag| {
            let mut known = BTreeMap::new();
            let mut channels = Vec::new();
            for topic in &self.topics {
                let key = (topic.name.clone(), topic.message_type(), topic.writer.clone());
                let id = *known.entry(key).or_insert_with(|| bag.channel(&topic.raw_channel()));
                channels.push(id);
            }
            for (log_ns, index, message) in &messages {
                bag.message(channels[*index], *log_ns, message);
            }
            for (name, fields) in &self.metadata {
                bag.metadata(name, fields);
            }
        })
    }

    /// Times of the messages of a topic, seconds after the start.
    fn ticks(&self, topic: &Topic) -> Vec<f64> {
        let Some(rate) = topic.rate_hz else {
            return vec![topic.at_s];
        };
        (0..u32::MAX)
            .map(|tick| f64::from(tick) / rate)
            .take_while(|at_s| *at_s < self.duration_s)
            .filter(|at_s| active(topic.from_s, topic.until_s, *at_s))
            .collect()
    }
}
