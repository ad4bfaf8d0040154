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
//! (a static transform that changes: the same topic again with a later `at_s`).

use std::collections::BTreeMap;

use serde::Deserialize;

use super::encode::{Body, Endian, Header, Transform as RawTransform};
use super::raw::{self, Layout, RawChannel};
use super::schemas;

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

/// A topic, or one publisher on it.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Topic {
    /// Its name.
    #[serde(rename = "topic")]
    pub name: String,
    /// Type of its messages. TF topics and topics with `text` know their own.
    #[serde(rename = "type")]
    pub message_type: Option<String>,
    /// Ticks a second. Without it one message is written, at `at_s`.
    pub rate_hz: Option<f64>,
    /// When the message of a topic without a rate is written, seconds after the start.
    #[serde(default)]
    pub at_s: f64,
    /// First second of activity.
    #[serde(default)]
    pub from_s: f64,
    /// End of activity, not included.
    pub until_s: Option<f64>,
    /// `header.frame_id`.
    #[serde(default)]
    pub frame_id: String,
    /// `child_frame_id` of odometry.
    #[serde(default)]
    pub child_frame_id: String,
    /// Text of a `std_msgs/msg/String`.
    pub text: Option<String>,
    /// Transforms of a TF topic.
    #[serde(default)]
    pub transforms: Vec<Transform>,
    /// Header stamp minus log time, seconds.
    #[serde(default)]
    pub stamp_offset_s: f64,
    /// A stamp that never changes, seconds.
    pub stamp_s: Option<f64>,
    /// Multiplies the stamp, before the offset is added.
    #[serde(default = "default_scale")]
    pub stamp_scale: f64,
    /// What the stamp's clock shows at the start, in place of `start_s` (an uptime clock: a few seconds).
    pub stamp_start_s: Option<f64>,
    /// `offered_qos_profiles`. By default as rosbag2 writes it: `transient_local` for static topics and descriptions,
    /// `volatile` for the others. An empty text leaves it out.
    pub qos: Option<String>,
    /// Only the durability of the default `qos`: `volatile` or `transient_local`.
    pub durability: Option<String>,
    /// The type's definition, where it should be another than the published one.
    pub schema: Option<String>,
    /// Byte order of the messages.
    #[serde(default)]
    pub big_endian: bool,
}

/// A transform `parent_from_child` of a TF topic.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Transform {
    /// `header.frame_id`.
    pub parent: String,
    /// `child_frame_id`.
    pub child: String,
    /// Position of the child in the parent at the start, metres.
    #[serde(default)]
    pub xyz: [f64; 3],
    /// Roll, pitch, yaw about fixed axes at the start, degrees.
    #[serde(default)]
    pub rpy_deg: [f64; 3],
    /// `x y z w` as published, in place of `rpy_deg`. Such a transform does not turn.
    pub quaternion: Option<[f64; 4]>,
    /// Velocity of the child in its own axes turned by yaw alone (a vehicle's), metres a second.
    #[serde(default)]
    pub velocity: [f64; 3],
    /// Yaw rate, degrees a second.
    #[serde(default)]
    pub yaw_rate_deg_s: f64,
    /// First second of activity.
    #[serde(default)]
    pub from_s: f64,
    /// End of activity, not included.
    pub until_s: Option<f64>,
}

fn default_start() -> f64 {
    1_700_000_000.0
}

fn default_duration() -> f64 {
    10.0
}

fn default_scale() -> f64 {
    1.0
}

fn active(from_s: f64, until_s: Option<f64>, at_s: f64) -> bool {
    at_s >= from_s && until_s.is_none_or(|until| at_s < until)
}

fn nanoseconds(seconds: f64) -> i64 {
    (seconds * 1e9).round() as i64
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
            for at_s in self.ticks(topic) {
                let log_ns = nanoseconds(self.start_s) + nanoseconds(at_s);
                if let Some(message) = topic.message(at_s, topic.stamp_ns(log_ns, at_s)) {
                    messages.push((log_ns, index, message));
                }
            }
        }
        messages.sort_by_key(|(log_ns, index, _)| (*log_ns, *index));
        raw::in_memory(layout, |bag| {
            let mut known: BTreeMap<(String, String), u16> = BTreeMap::new();
            let mut channels = Vec::new();
            for topic in &self.topics {
                let key = (topic.name.clone(), topic.message_type());
                let id = *known.entry(key).or_insert_with(|| bag.channel(&topic.raw_channel()));
                channels.push(id);
            }
            for (log_ns, index, message) in &messages {
                bag.message(channels[*index], *log_ns, message);
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

impl Topic {
    fn last_segment(&self) -> &str {
        self.name.rsplit('/').next().unwrap()
    }

    fn message_type(&self) -> String {
        if let Some(message_type) = &self.message_type {
            return message_type.clone();
        }
        let known = match self.last_segment() {
            "tf" | "tf_static" => "tf2_msgs/msg/TFMessage",
            _ if !self.transforms.is_empty() => "tf2_msgs/msg/TFMessage",
            _ if self.text.is_some() => "std_msgs/msg/String",
            _ => panic!("`{}` needs a type", self.name),
        };
        known.to_owned()
    }

    fn raw_channel(&self) -> RawChannel<'_> {
        // A recipe lives as long as the test: leaking its few definitions keeps the builder simple.
        let leak = |text: String| -> &'static str { Box::leak(text.into_boxed_str()) };
        let message_type = self.message_type();
        let schema = self
            .schema
            .clone()
            .unwrap_or_else(|| schemas::definition(&message_type));
        let latched = matches!(self.last_segment(), "tf_static" | "robot_description");
        let durability = self.durability.clone().unwrap_or_else(|| {
            let word = if latched { "transient_local" } else { "volatile" };
            word.to_owned()
        });
        let qos = self.qos.clone().unwrap_or_else(|| {
            format!(
                "- history: keep_last\n  depth: 10\n  reliability: reliable\n  durability: {durability}\n  deadline:\n    \
                 sec: 9223372036\n    nsec: 854775807\n  lifespan:\n    sec: 9223372036\n    nsec: 854775807\n  \
                 liveliness: automatic\n  liveliness_lease_duration:\n    sec: 9223372036\n    nsec: 854775807\n  \
                 avoid_ros_namespace_conventions: false\n"
            )
        });
        RawChannel {
            topic: &self.name,
            message_type: leak(message_type),
            schema: leak(schema),
            qos: (!qos.is_empty()).then(|| leak(qos)),
            ..RawChannel::default()
        }
    }

    /// The header stamp of a message, nanoseconds.
    fn stamp_ns(&self, log_ns: i64, at_s: f64) -> i64 {
        if let Some(stamp_s) = self.stamp_s {
            return nanoseconds(stamp_s);
        }
        let clock_ns = self
            .stamp_start_s
            .map_or(log_ns, |start| nanoseconds(start) + nanoseconds(at_s));
        // Multiplying by 1 in floating point would cost the last digits.
        let scaled = if (self.stamp_scale - 1.0).abs() < f64::EPSILON {
            clock_ns
        } else {
            (clock_ns as f64 * self.stamp_scale).round() as i64
        };
        scaled + nanoseconds(self.stamp_offset_s)
    }

    /// The message at a time; `None` for TF without an active transform.
    fn message(&self, at_s: f64, stamp_ns: i64) -> Option<Vec<u8>> {
        let header = Header {
            stamp_ns,
            frame_id: &self.frame_id,
        };
        let transforms: Vec<RawTransform<'_>> = self
            .transforms
            .iter()
            .filter(|transform| active(transform.from_s, transform.until_s, at_s))
            .map(|transform| transform.at(at_s, stamp_ns))
            .collect();
        let body = match self.message_type().as_str() {
            "tf2_msgs/msg/TFMessage" if transforms.is_empty() => return None,
            "tf2_msgs/msg/TFMessage" => Body::Tf(&transforms),
            "nav_msgs/msg/Odometry" => Body::Odometry(header, &self.child_frame_id),
            "sensor_msgs/msg/Imu" => Body::Imu(header),
            "geometry_msgs/msg/PoseStamped" => Body::Pose(header),
            "std_msgs/msg/String" => Body::Text(self.text.as_deref().unwrap_or_default()),
            _ => Body::Padded(header),
        };
        Some(body.encode(if self.big_endian { Endian::Big } else { Endian::Little }))
    }
}

impl Transform {
    /// The transform after `at_s` seconds of driving an arc at constant speed and yaw rate.
    fn at(&self, at_s: f64, stamp_ns: i64) -> RawTransform<'_> {
        let [roll, pitch, yaw0] = self.rpy_deg.map(f64::to_radians);
        let rate = self.yaw_rate_deg_s.to_radians();
        let yaw = yaw0 + rate * at_s;
        // The integral of the rotated velocity: straight ahead, or along a circle.
        let (ahead, aside) = if rate.abs() < 1e-12 {
            (yaw0.cos() * at_s, yaw0.sin() * at_s)
        } else {
            ((yaw.sin() - yaw0.sin()) / rate, (yaw0.cos() - yaw.cos()) / rate)
        };
        let [x, y, z] = self.xyz;
        let [vx, vy, vz] = self.velocity;
        RawTransform {
            header: Header {
                stamp_ns,
                frame_id: &self.parent,
            },
            child: &self.child,
            translation: [x + vx * ahead - vy * aside, y + vx * aside + vy * ahead, z + vz * at_s],
            rotation: self.quaternion.unwrap_or_else(|| quaternion(roll, pitch, yaw)),
        }
    }
}

/// `x y z w` of `Rz(yaw) Ry(pitch) Rx(roll)`.
fn quaternion(roll: f64, pitch: f64, yaw: f64) -> [f64; 4] {
    let ((sr, cr), (sp, cp), (sy, cy)) = ((roll / 2.0).sin_cos(), (pitch / 2.0).sin_cos(), (yaw / 2.0).sin_cos());
    [
        sr * cp * cy - cr * sp * sy,
        cr * sp * cy + sr * cp * sy,
        cr * cp * sy - sr * sp * cy,
        cr * cp * cy + sr * sp * sy,
    ]
}
