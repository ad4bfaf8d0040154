//! Which messages can be read, and how: one decoder for each channel.
//!
//! Owns the choice by type, definition and encoding. Must not know recordings.

use std::borrow::Cow;

use super::content::{Body, Content};
use super::header::{self, Header};
use super::{Cursor, DecodeError, Wire, bodies, foxglove, tf};

/// What is known of the messages of a channel before the first one.
#[derive(Clone, Copy, Debug)]
pub struct Format<'a> {
    /// The topic: some types are read on certain topics only.
    pub topic: &'a str,
    /// Type of the messages (`sensor_msgs/msg/Imu`).
    pub message_type: &'a str,
    /// Encoding of the messages (`cdr`, `ros1`, `protobuf`, `json`).
    pub message_encoding: &'a str,
    /// The definition, text or binary; empty where the recording holds none.
    pub schema: &'a [u8],
    /// Encoding of the definition (`ros2msg`, `ros2idl`, `ros1msg`, `protobuf`, `jsonschema`).
    pub schema_encoding: &'a str,
}

/// Reads the messages of one channel.
#[derive(Clone, Debug)]
pub struct Decoder {
    way: Way,
}

#[derive(Clone, Debug, PartialEq, Eq)]
enum Way {
    /// By its published layout.
    Standard(Wire, Standard),
    Header(Wire),
    Foxglove(Box<foxglove::Reader>),
    Nothing,
    Unread(String),
}

/// The types whose content is read.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Standard {
    Tf,
    Transform,
    Odometry,
    Imu,
    Fix,
    Pose { covariance: bool },
    Twist { covariance: bool },
    Description,
    Clock,
}

impl Decoder {
    /// Decides how the messages of a channel are read.
    pub fn of(format: &Format<'_>) -> Self {
        Self { way: Way::of(format) }
    }

    /// Why nothing inside the messages can be read; `None` where they can, or hold nothing that is.
    pub fn unread(&self) -> Option<&str> {
        match &self.way {
            Way::Unread(why) => Some(why),
            _ => None,
        }
    }

    /// Reads one message.
    pub fn decode<'m>(&self, message: &'m [u8]) -> Result<Content<'m>, DecodeError> {
        match &self.way {
            Way::Standard(wire, standard) => standard.read(wire.open(message)?),
            Way::Header(wire) => Ok(Content {
                header: Some(Header::read(&mut wire.open(message)?)?),
                body: Body::Nothing,
            }),
            Way::Foxglove(reader) => reader.decode(message),
            Way::Nothing | Way::Unread(_) => Ok(Content {
                header: None,
                body: Body::Nothing,
            }),
        }
    }
}

impl Way {
    fn of(format: &Format<'_>) -> Self {
        if let Some(reader) = foxglove::Reader::of(format) {
            return reader.map_or_else(Self::Unread, |reader| Self::Foxglove(Box::new(reader)));
        }
        let Some(wire) = Wire::named(format.message_encoding) else {
            let encoding = named(format.message_encoding, "unnamed");
            return Self::Unread(format!("{encoding} messages are not read"));
        };
        // These are read by their published layout, so a missing definition does no harm.
        if let Some(standard) = Standard::of(format) {
            return Self::Standard(wire, standard);
        }
        let text = std::str::from_utf8(format.schema).unwrap_or_default();
        if text.trim().is_empty() {
            let name = named(format.message_type, "the type");
            return Self::Unread(format!("the recording holds no definition of {name}"));
        }
        match format.schema_encoding {
            "ros2msg" | "ros1msg" if header::comes_first(text) => Self::Header(wire),
            "ros2msg" | "ros1msg" => Self::Nothing,
            other => Self::Unread(format!(
                "definitions in {} are not read",
                named(other, "an unnamed encoding")
            )),
        }
    }
}

impl Standard {
    fn of(format: &Format<'_>) -> Option<Self> {
        // ROS 1, and some writers of ROS 2, leave the `msg` out of the name.
        Some(match format.message_type.replacen("/msg/", "/", 1).as_str() {
            "tf2_msgs/TFMessage" | "tf/tfMessage" => Self::Tf,
            "geometry_msgs/TransformStamped" => Self::Transform,
            "nav_msgs/Odometry" => Self::Odometry,
            "sensor_msgs/Imu" => Self::Imu,
            "sensor_msgs/NavSatFix" => Self::Fix,
            "geometry_msgs/PoseStamped" => Self::Pose { covariance: false },
            "geometry_msgs/PoseWithCovarianceStamped" => Self::Pose { covariance: true },
            "geometry_msgs/TwistStamped" => Self::Twist { covariance: false },
            "geometry_msgs/TwistWithCovarianceStamped" => Self::Twist { covariance: true },
            "rosgraph_msgs/Clock" => Self::Clock,
            "std_msgs/String" if format.topic.rsplit('/').next() == Some("robot_description") => Self::Description,
            _ => return None,
        })
    }

    fn read(self, mut cursor: Cursor<'_>) -> Result<Content<'_>, DecodeError> {
        let headless = |body| Ok(Content { header: None, body });
        match self {
            Self::Tf => {
                return headless(Body::Transforms(tf::transforms(cursor)?.collect::<Result<_, _>>()?));
            }
            Self::Transform => {
                let transform = tf::read(&mut cursor)?;
                let header = Header {
                    stamp_ns: transform.stamp_ns,
                    frame_id: transform.parent.clone(),
                };
                return Ok(Content {
                    header: Some(header),
                    body: Body::Transforms(vec![transform]),
                });
            }
            Self::Description => return headless(Body::Description(Cow::Borrowed(cursor.str()?))),
            Self::Clock => return headless(Body::Clock(cursor.time()?)),
            _ => {}
        }
        let header = Some(Header::read(&mut cursor)?);
        let body = match self {
            Self::Odometry => bodies::odometry(&mut cursor)?,
            Self::Imu => bodies::imu(&mut cursor)?,
            Self::Fix => bodies::fix(&mut cursor)?,
            Self::Pose { covariance } => bodies::pose(&mut cursor, covariance)?,
            Self::Twist { covariance } => bodies::twist(&mut cursor, covariance)?,
            Self::Tf | Self::Transform | Self::Description | Self::Clock => Body::Nothing,
        };
        Ok(Content { header, body })
    }
}

fn named<'a>(name: &'a str, otherwise: &'a str) -> &'a str {
    if name.is_empty() { otherwise } else { name }
}
