//! Which messages can be read, and how: one decoder for each channel.
//!
//! Owns the choice by type, definition and encoding. Must not know recordings.

use std::borrow::Cow;

use super::content::{Body, Content, Odometry};
use super::header::{self, Header};
use super::{Cdr, DecodeError, foxglove, tf};

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
    Tf,
    Odometry,
    Description,
    Header,
    Foxglove(Box<foxglove::Reader>),
    Nothing,
    Unread(String),
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
        let content = |header, body| Content { header, body };
        Ok(match &self.way {
            Way::Tf => content(
                None,
                Body::Transforms(tf::transforms(message)?.collect::<Result<_, _>>()?),
            ),
            Way::Odometry => {
                let mut cdr = Cdr::new(message)?;
                let header = Header::read(&mut cdr)?;
                let odometry = Odometry {
                    child: cdr.name()?.into(),
                    position: cdr.f64s()?,
                    orientation: cdr.f64s()?,
                    pose_covariance: cdr.f64s()?,
                    linear: cdr.f64s()?,
                    angular: cdr.f64s()?,
                    twist_covariance: cdr.f64s()?,
                };
                content(Some(header), Body::Odometry(Box::new(odometry)))
            }
            Way::Description => content(None, Body::Description(Cow::Borrowed(Cdr::new(message)?.str()?))),
            Way::Header => content(Some(Header::of(message)?), Body::Nothing),
            Way::Foxglove(reader) => reader.decode(message)?,
            Way::Nothing | Way::Unread(_) => content(None, Body::Nothing),
        })
    }
}

impl Way {
    fn of(format: &Format<'_>) -> Self {
        if let Some(reader) = foxglove::Reader::of(format) {
            return reader.map_or_else(Self::Unread, |reader| Self::Foxglove(Box::new(reader)));
        }
        if format.message_encoding != "cdr" {
            let encoding = named(format.message_encoding, "unnamed");
            return Self::Unread(format!("{encoding} messages are not read"));
        }
        // These are read by their published layout, so a missing definition does no harm.
        // Some writers leave the `msg` out of the name.
        match format.message_type.replacen("/msg/", "/", 1).as_str() {
            "tf2_msgs/TFMessage" => return Self::Tf,
            "nav_msgs/Odometry" => return Self::Odometry,
            "std_msgs/String" if format.topic.rsplit('/').next() == Some("robot_description") => {
                return Self::Description;
            }
            _ => {}
        }
        let text = std::str::from_utf8(format.schema).unwrap_or_default();
        if text.trim().is_empty() {
            let name = named(format.message_type, "the type");
            return Self::Unread(format!("the recording holds no definition of {name}"));
        }
        match format.schema_encoding {
            "ros2msg" if header::comes_first(text) => Self::Header,
            "ros2msg" => Self::Nothing,
            other => Self::Unread(format!(
                "definitions in {} are not read",
                named(other, "an unnamed encoding")
            )),
        }
    }
}

fn named<'a>(name: &'a str, otherwise: &'a str) -> &'a str {
    if name.is_empty() { otherwise } else { name }
}
