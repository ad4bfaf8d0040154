//! A topic of a recipe: its knobs, its channel, its stamps and its messages. The head of `recipe.rs` explains them.

use serde::Deserialize;

use super::camera::{Camera, Grid};
use super::clouds::Lidar;
use super::drive::nmea::Kind;
use super::drive::rows::PoseRow;
use super::drive::{Error, Place};
use super::driven::{DriveRows, DriveSource, Offset, sentence_ns};
use super::encode::{Body, Endian, Header, Transform as RawTransform};
use super::motion::{Motion, PublishedPose, even};
use super::radars::{Laser, Radar};
use super::raw::RawChannel;
use super::schemas;

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
    /// Parts in a million by which the stamp's clock runs fast.
    #[serde(default)]
    pub stamp_drift_ppm: f64,
    /// Seeded scatter of the stamp to both sides, seconds.
    #[serde(default)]
    pub stamp_jitter_s: f64,
    /// How many messages in a row carry the same stamp.
    #[serde(default = "default_repeat")]
    pub stamp_repeat: u64,
    /// `offered_qos_profiles`. By default as rosbag2 writes it: `transient_local` for static topics and descriptions,
    /// `volatile` for the others. An empty text leaves it out.
    pub qos: Option<Qos>,
    /// Only the durability of the default `qos`: `volatile` or `transient_local`.
    pub durability: Option<String>,
    /// Short for durability `transient_local`.
    #[serde(default)]
    pub latched: bool,
    /// The node that publishes; such a topic has a channel of its own.
    pub writer: Option<String>,
    /// The type's definition, where it should be another than the published one.
    pub schema: Option<String>,
    /// Byte order of the messages.
    #[serde(default)]
    pub big_endian: bool,

    /// Where the body is that its messages tell of.
    #[serde(flatten)]
    pub(super) motion: Motion,

    /// Which sensor of the recipe's drive this is. The knobs up to `sentences` belong to it.
    pub from_drive: Option<DriveSource>,
    #[serde(default)]
    pub(super) errors: Vec<Error>,
    #[serde(default)]
    pub(super) late_s: f64,
    pub(super) orientation_lag_s: Option<f64>,
    #[serde(default = "default_scale")]
    pub(super) noise: f64,
    #[serde(default = "default_scale")]
    pub(super) covariance_scale: f64,
    pub(super) datum: Option<Place>,
    pub(super) world_from_enu: Option<Offset>,
    #[serde(default = "all_sentences")]
    pub(super) sentences: Vec<Kind>,

    // Numbers of messages, as published.
    pub(super) twist: Option<Twist>,
    pub(super) pose_covariance: Option<Vec<f64>>,
    pub(super) twist_covariance: Option<Vec<f64>>,
    pub(super) covariance: Option<Vec<f64>>,
    pub(super) orientation: Option<[f64; 4]>,
    pub(super) orientation_covariance: Option<Vec<f64>>,
    #[serde(default)]
    pub(super) angular_velocity: [f64; 3],
    pub(super) angular_velocity_covariance: Option<Vec<f64>>,
    pub(super) linear_acceleration: Option<[f64; 3]>,
    pub(super) acceleration_covariance: Option<Vec<f64>>,
    #[serde(default = "default_latitude")]
    pub(super) latitude: f64,
    #[serde(default = "default_longitude")]
    pub(super) longitude: f64,
    #[serde(default = "default_altitude")]
    pub(super) altitude: f64,
    #[serde(default)]
    pub(super) status: i8,
    #[serde(default)]
    pub(super) east_velocity: f64,
    #[serde(default)]
    pub(super) north_velocity: f64,
    pub(super) nan_from_s: Option<f64>,
    pub(super) camera: Option<Camera>,
    pub(super) grid: Option<Grid>,
    pub(super) lidar: Option<Lidar>,
    pub(super) radar: Option<Radar>,
    pub(super) laser: Option<Laser>,
}

/// `offered_qos_profiles`.
#[derive(Clone, Debug, Deserialize)]
#[serde(untagged)]
pub enum Qos {
    /// The whole text.
    Text(String),
    /// The default text with this durability.
    Parts(QosParts),
}

/// What may be said of the default text.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct QosParts {
    /// `volatile` or `transient_local`.
    pub durability: String,
}

/// A twist as published.
#[derive(Clone, Copy, Debug, Default, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Twist {
    /// m/s.
    #[serde(default)]
    pub linear: [f64; 3],
    /// rad/s.
    #[serde(default)]
    pub angular: [f64; 3],
}

/// A transform `parent_from_child` of a TF topic.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Transform {
    /// `header.frame_id`.
    pub parent: String,
    /// `child_frame_id`.
    pub child: String,
    /// Where the child is.
    #[serde(flatten)]
    pub motion: Motion,
    /// First second of activity.
    #[serde(default)]
    pub from_s: f64,
    /// End of activity, not included.
    pub until_s: Option<f64>,

    /// Which edge of the recipe's drive this is. The knobs below belong to it.
    pub from_drive: Option<DriveSource>,
    #[serde(default)]
    pub(super) errors: Vec<Error>,
    #[serde(default)]
    pub(super) late_s: f64,
    #[serde(default = "default_scale")]
    pub(super) noise: f64,
    pub(super) datum: Option<Place>,
    pub(super) world_from_enu: Option<Offset>,
}

fn default_scale() -> f64 {
    1.0
}

fn all_sentences() -> Vec<Kind> {
    vec![Kind::Gga, Kind::Rmc, Kind::Hdt]
}

fn default_repeat() -> u64 {
    1
}

fn default_latitude() -> f64 {
    48.0
}

fn default_longitude() -> f64 {
    11.0
}

fn default_altitude() -> f64 {
    500.0
}

pub(super) fn active(from_s: f64, until_s: Option<f64>, at_s: f64) -> bool {
    at_s >= from_s && until_s.is_none_or(|until| at_s < until)
}

pub(super) fn nanoseconds(seconds: f64) -> i64 {
    (seconds * 1e9).round() as i64
}

impl Topic {
    fn last_segment(&self) -> &str {
        self.name.rsplit('/').next().unwrap()
    }

    pub(super) fn message_type(&self) -> String {
        if let Some(message_type) = &self.message_type {
            return message_type.clone();
        }
        let known = match self.last_segment() {
            "tf" | "tf_static" => "tf2_msgs/msg/TFMessage",
            _ if !self.transforms.is_empty() => "tf2_msgs/msg/TFMessage",
            _ if self.text.is_some() => "std_msgs/msg/String",
            _ if self.lidar.is_some() => self.lidar.as_ref().unwrap().message_type(),
            _ if self.radar.is_some() => self.radar.as_ref().unwrap().message_type(),
            _ if self.from_drive.is_some() => self.from_drive.unwrap().message_type(),
            _ => panic!("`{}` needs a type", self.name),
        };
        known.to_owned()
    }

    pub(super) fn raw_channel(&self) -> RawChannel<'_> {
        // A recipe lives as long as the test: leaking its few definitions keeps the builder simple.
        let leak = |text: String| -> &'static str { Box::leak(text.into_boxed_str()) };
        let message_type = self.message_type();
        let schema = self.schema.clone().unwrap_or_else(|| {
            schemas::definition(self.from_drive.map_or(&message_type, |kind| kind.layout(&message_type)))
        });
        let latched = matches!(self.last_segment(), "tf_static" | "robot_description");
        let word = if latched || self.latched {
            "transient_local"
        } else {
            "volatile"
        };
        let durability = match &self.qos {
            Some(Qos::Parts(parts)) => &parts.durability,
            _ => self.durability.as_deref().unwrap_or(word),
        };
        let qos = match &self.qos {
            Some(Qos::Text(text)) => text.clone(),
            _ => format!(
                "- history: keep_last\n  depth: 10\n  reliability: reliable\n  durability: {durability}\n  deadline:\n    \
                 sec: 9223372036\n    nsec: 854775807\n  lifespan:\n    sec: 9223372036\n    nsec: 854775807\n  \
                 liveliness: automatic\n  liveliness_lease_duration:\n    sec: 9223372036\n    nsec: 854775807\n  \
                 avoid_ros_namespace_conventions: false\n"
            ),
        };
        RawChannel {
            topic: &self.name,
            message_type: leak(message_type),
            schema: leak(schema),
            qos: (!qos.is_empty()).then(|| leak(qos)),
            writer: self.writer.as_deref(),
            ..RawChannel::default()
        }
    }

    /// How much later than the first the `k`-th message of a tick is written, nanoseconds: detections of a radar that come one by
    /// one come in a burst.
    pub(super) fn later_ns(&self, k: usize) -> i64 {
        if let Some(lidar) = &self.lidar {
            return lidar.later_ns(k);
        }
        if self.radar.is_some() {
            return 50_000 * i64::try_from(k).unwrap();
        }
        sentence_ns(k)
    }

    /// The header stamp of the `number`-th message, nanoseconds.
    pub(super) fn stamp_ns(&self, start_ns: i64, at_s: f64, number: u64) -> i64 {
        if let Some(stamp_s) = self.stamp_s {
            return nanoseconds(stamp_s);
        }
        let clock_ns = self.stamp_start_s.map_or(start_ns, nanoseconds) + nanoseconds(at_s);
        // Multiplying by 1 in floating point would cost the last digits.
        let scaled = if (self.stamp_scale - 1.0).abs() < f64::EPSILON {
            clock_ns
        } else {
            (clock_ns as f64 * self.stamp_scale).round() as i64
        };
        let drift_s = at_s * self.stamp_drift_ppm * 1e-6;
        let jitter_s = self.stamp_jitter_s * (2.0 * even(&self.name, number) - 1.0);
        scaled + nanoseconds(self.stamp_offset_s) + nanoseconds(drift_s) + nanoseconds(jitter_s)
    }

    /// The `number`-th messages, at a time: one, but for sentences; none for TF without an active transform.
    pub(super) fn messages(&self, at_s: f64, number: u64, stamp_ns: i64, driven: &DriveRows) -> Vec<Vec<u8>> {
        let header = Header {
            stamp_ns,
            frame_id: &self.frame_id,
        };
        let transforms: Vec<RawTransform<'_>> = self
            .transforms
            .iter()
            .zip(&driven.edges)
            .filter(|(transform, _)| active(transform.from_s, transform.until_s, at_s))
            .map(|(transform, rows)| {
                let row = rows.as_ref().map(|rows| &rows[usize::try_from(number).unwrap()]);
                transform.at(at_s, number, stamp_ns, row.map(PoseRow::published))
            })
            .collect();
        let endian = if self.big_endian { Endian::Big } else { Endian::Little };
        let message_type = self.message_type();
        if let Some(rows) = &driven.rows {
            let bodies = rows.bodies(self, &message_type, usize::try_from(number).unwrap(), header);
            return bodies.iter().map(|body| body.encode(endian)).collect();
        }
        let body = match message_type.as_str() {
            "tf2_msgs/msg/TFMessage" if transforms.is_empty() => return Vec::new(),
            "tf2_msgs/msg/TFMessage" => Body::Tf(&transforms),
            "std_msgs/msg/String" => Body::Text(self.text.as_deref().unwrap_or_default()),
            other => match self.fields(other, at_s, number) {
                Some(fields) => Body::Fields(header, fields),
                None => Body::Padded(header),
            },
        };
        vec![body.encode(endian)]
    }
}

impl Transform {
    /// The transform of the `number`-th message.
    fn at(&self, at_s: f64, number: u64, stamp_ns: i64, driven: Option<PublishedPose>) -> RawTransform<'_> {
        let pose = driven.unwrap_or_else(|| self.motion.at(at_s, number, &self.child));
        RawTransform {
            header: Header {
                stamp_ns,
                frame_id: &self.parent,
            },
            child: &self.child,
            translation: pose.position,
            rotation: pose.orientation,
        }
    }
}
