//! What the tests of this room share: readers of descriptors and messages that are made by hand.

// Numbers must come out as they went in, to the bit.
#![allow(clippy::float_cmp)]

mod cdr;
mod hostile;
mod json;
#[path = "../../../../tests/support/foxglove.rs"]
mod made;
mod protobuf;

use prost_types::FileDescriptorProto;

use made::{FrameTransform, FrameTransforms, Numbers, Stamped, at, declared, descriptor, file, numbers};

use super::Reader;
use crate::read::messages::DecodeError;
use crate::read::messages::content::Content;
use crate::read::messages::format::Format;

fn reader_of(message_type: &str, schema: &[u8]) -> Result<Reader, String> {
    let format = Format {
        topic: "/topic",
        message_type,
        message_encoding: "protobuf",
        schema,
        schema_encoding: "protobuf",
    };
    Reader::of(&format).unwrap()
}

/// The reader of one of Foxglove's types.
fn reader(message_type: &str) -> Reader {
    reader_of(message_type, &descriptor(FileDescriptorProto::default())).unwrap()
}

fn json<'m>(message_type: &str, message: &'m str) -> Result<Content<'m>, DecodeError> {
    let format = Format {
        topic: "/topic",
        message_type,
        message_encoding: "json",
        schema: b"{}",
        schema_encoding: "jsonschema",
    };
    Reader::of(&format).unwrap().unwrap().decode(message.as_bytes())
}

fn mount() -> FrameTransform {
    FrameTransform {
        timestamp: at(1_700_000_000, 250),
        parent: "base_link".to_owned(),
        child: "lidar".to_owned(),
        translation: numbers(0.3, 0.0, 1.2, 0.0),
        rotation: numbers(0.0, 0.0, 0.6, 0.8),
    }
}
