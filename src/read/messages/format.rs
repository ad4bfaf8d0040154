//! What is known about the messages of a channel.

use super::definition::plain_name;
use super::standard::{Standard, TopicWord};

/// What is known about the messages of a channel before the first one.
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

impl Format<'_> {
    /// What the topic decides about how its messages are read.
    pub(super) fn topic_word(&self) -> Option<TopicWord> {
        TopicWord::of(self.topic)
    }

    /// Whether the messages would contain something that rules need, by the name of their type.
    pub fn is_asked_for(&self) -> bool {
        let name = plain_name(self.message_type);
        Standard::of(&name, self.topic_word()).is_some() || name.starts_with("foxglove.")
    }
}
