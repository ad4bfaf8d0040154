//! Which messages can be read, and how: one decoder for each channel.
//!
//! Owns the choice by type, definition and encoding. Must not know recordings.

use std::sync::Arc;

use super::content::{Body, Content};
use super::definition::{Definitions, Layout, Schema, TypeDefinition, plain_name};
use super::format::Format;
use super::header::Header;
use super::route::Route;
use super::standard::Standard;
use super::{DecodeError, Wire, foxglove, packets};

/// Reads the messages of one channel.
#[derive(Clone, Debug)]
pub struct Decoder {
    way: DecodeMethod,
    note: Option<String>,
}

#[derive(Clone, Debug, PartialEq, Eq)]
enum DecodeMethod {
    /// By its published layout.
    Standard(Wire, Standard),
    /// Only a header.
    Header(Wire),
    Foxglove(Box<foxglove::Reader>),
    /// By its definition.
    Route(Wire, Arc<Route>),
    Nothing,
    Unread {
        why: String,
        lacks_definition: bool,
    },
}

impl Decoder {
    /// Decides how the messages of a channel are read: the standard types by their published layout, unless the
    /// recording's definition differs; any other type by its definition, for its header and for known types
    /// in it. The definition is the recording's own; else one of `definitions`.
    pub fn of(format: &Format<'_>, definitions: &Definitions) -> Self {
        if let Some(reader) = foxglove::Reader::of(format) {
            return Self::new(
                reader.map_or_else(DecodeMethod::unread, |reader| DecodeMethod::Foxglove(Box::new(reader))),
            );
        }
        if format.message_encoding == packets::ASSEMBLED {
            let plain = ["sensor_msgs/Imu", "nmea_msgs/Sentence"].contains(&&*plain_name(format.message_type));
            let standard = plain
                .then(|| Standard::of(&plain_name(format.message_type), None))
                .flatten();
            let standard = standard.unwrap_or(Standard::Packets(packets::Carrier::Assembled));
            return Self::new(DecodeMethod::Standard(Wire::Cdr, standard));
        }
        let Some(wire) = Wire::named(format.message_encoding) else {
            let encoding = named(format.message_encoding, "unnamed");
            return Self::new(DecodeMethod::unread(format!("{encoding} messages are not read")));
        };
        let name = plain_name(format.message_type);
        let carried = TypeDefinition::read(&name, format.schema, format.schema_encoding);
        let types = match &carried {
            TypeDefinition::Types(types) => Some(types),
            TypeDefinition::Nothing | TypeDefinition::Unread(_) => None,
        };
        let schema = Schema::link(&name, types, definitions);
        if let Some(standard) = Standard::of(&name, format.topic_word()) {
            let is_defined = types.is_some() || definitions.adds(&name);
            let differs = |schema: &Schema| {
                Schema::published(&name).is_some_and(|published| schema.layout(&published, wire) == Layout::Different)
            };
            return match schema.filter(|schema| is_defined && differs(schema)) {
                None => Self::new(DecodeMethod::Standard(wire, standard)),
                Some(schema) => Self::otherwise(&name, wire, schema),
            };
        }
        let Some(schema) = schema else {
            let of = named(format.message_type, "the type");
            return Self::new(match carried {
                TypeDefinition::Unread(why) => DecodeMethod::unread(why),
                TypeDefinition::Types(_) | TypeDefinition::Nothing => DecodeMethod::Unread {
                    why: format!("the recording holds no definition of {of}"),
                    lacks_definition: true,
                },
            });
        };
        Self::new(DecodeMethod::by_definition(wire, schema))
    }

    /// A standard type whose definition differs from the published one: its header can still be read, its content cannot.
    fn otherwise(name: &str, wire: Wire, schema: Schema) -> Self {
        let differs = format!("its definition of {name} differs from the published one");
        match DecodeMethod::by_definition(wire, schema) {
            DecodeMethod::Nothing => Self::new(DecodeMethod::unread(differs)),
            DecodeMethod::Unread { why, .. } => Self::new(DecodeMethod::unread(format!("{differs}, and {why}"))),
            way => Self {
                way,
                note: Some(format!("{differs}: only headers are read")),
            },
        }
    }

    /// A decoder that reads nothing, for a reason.
    pub(super) fn refusing(why: String) -> Self {
        Self::new(DecodeMethod::unread(why))
    }

    /// How many fields of definitions are kept.
    pub(super) fn fields(&self) -> usize {
        match &self.way {
            DecodeMethod::Route(_, route) => route.fields(),
            _ => 0,
        }
    }

    fn new(way: DecodeMethod) -> Self {
        Self { way, note: None }
    }

    /// Why nothing inside the messages can be read; `None` if they can, or if they contain nothing to read.
    pub fn unread(&self) -> Option<&str> {
        match &self.way {
            DecodeMethod::Unread { why, .. } => Some(why),
            _ => None,
        }
    }

    /// Whether the messages could be read with the package that defines them.
    pub fn lacks_definition(&self) -> bool {
        matches!(
            self.way,
            DecodeMethod::Unread {
                lacks_definition: true,
                ..
            }
        )
    }

    /// What is not read of messages whose header is read, if other messages of the type contain more.
    pub fn note(&self) -> Option<&str> {
        self.note.as_deref()
    }

    /// Reads one message.
    pub fn decode<'m>(&self, message: &'m [u8]) -> Result<Content<'m>, DecodeError> {
        match &self.way {
            DecodeMethod::Standard(wire, standard) => standard.read(wire.open(message)?),
            DecodeMethod::Header(wire) => {
                let header = Header::read(&mut wire.open(message)?)?;
                Ok(Content::new(Some(header), Body::Nothing))
            }
            DecodeMethod::Foxglove(reader) => reader.decode(message),
            DecodeMethod::Route(wire, route) => route.read(wire.open(message)?),
            DecodeMethod::Nothing | DecodeMethod::Unread { .. } => Ok(Content::new(None, Body::Nothing)),
        }
    }
}

impl DecodeMethod {
    fn by_definition(wire: Wire, schema: Schema) -> Self {
        match Route::of(schema, wire) {
            Ok(None) => Self::Nothing,
            Ok(Some(route)) if route.is_header_alone(wire) => Self::Header(wire),
            Ok(Some(route)) => Self::Route(wire, Arc::new(route)),
            Err(why) => Self::unread(why),
        }
    }

    fn unread(why: String) -> Self {
        Self::Unread {
            why,
            lacks_definition: false,
        }
    }
}

fn named<'a>(name: &'a str, otherwise: &'a str) -> &'a str {
    if name.is_empty() { otherwise } else { name }
}
