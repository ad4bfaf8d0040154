//! Messages of Foxglove's schemas: Protocol Buffers, JSON, and CDR by `foxglove_msgs`.
//!
//! Owns which channels these are and the way from bytes to content. A message becomes a small tree of the fields that
//! are wanted (`wanted.rs`), in any encoding; the tree is converted to content in one place. Everything else in a message
//! is skipped by its length. Must not know recordings.
//!
//! Sources: the schemas at <https://docs.foxglove.dev/docs/visualization/message-schemas/introduction>, MCAP's registry of
//! well-known encodings <https://mcap.dev/spec/registry>.

mod cdr;
mod content;
mod descriptor;
mod json;
mod protobuf;
mod time;
mod value;
mod wanted;
mod wire;

#[cfg(test)]
mod tests;

use super::DecodeError;
use super::content::Content;
use super::format::Format;
use descriptor::Layout;
use wanted::Kind;

/// Reads the messages of one channel.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Reader {
    kind: Kind,
    encoding: Encoding,
}

#[derive(Clone, Debug, PartialEq, Eq)]
enum Encoding {
    Protobuf(Layout),
    Json,
    Cdr,
}

impl Reader {
    /// The reader of a channel with messages in Protocol Buffers, in JSON, or of `foxglove_msgs` in CDR; `None` for every
    /// other channel, or why nothing can be read if the definition cannot be used.
    pub fn of(format: &Format<'_>) -> Option<Result<Self, String>> {
        let kind = Kind::of(format.message_type);
        let encoding = match format.message_encoding {
            "protobuf" => descriptor::layout(format, kind.wanted()).map(Encoding::Protobuf),
            "json" => Ok(Encoding::Json),
            "cdr" if cdr::is_read(format, kind) => Ok(Encoding::Cdr),
            _ => return None,
        };
        Some(encoding.map(|encoding| Self { kind, encoding }))
    }

    /// Reads one message.
    pub fn decode<'m>(&self, message: &'m [u8]) -> Result<Content<'m>, DecodeError> {
        let value = match &self.encoding {
            Encoding::Cdr => return cdr::decode(self.kind, message),
            Encoding::Json => json::read(self.kind.wanted(), message)?,
            Encoding::Protobuf(layout) => protobuf::read(layout, message)?,
        };
        content::of(self.kind, value)
    }
}
