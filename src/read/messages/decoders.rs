//! The decoders of a recording: made once for each type, for all channels that carry it.
//!
//! Owns the bounds on the work and memory that a hostile recording's definitions can cause.

use std::collections::HashMap;
use std::sync::Arc;

use super::decoder::Decoder;
use super::definition::Definitions;
use super::format::Format;
use super::standard::TopicWord;

/// Bound on the fields that all decoders of a recording keep, each some hundred bytes. A decoder keeps only the fields
/// before the header; nearly all types have none.
const MAX_FIELDS: usize = 300_000;
/// Bound on decoders that are kept to be used again; large systems have some hundred types.
const MAX_KEPT: usize = 10_000;

/// Makes decoders.
#[derive(Debug, Default)]
pub struct Decoders {
    definitions: Arc<Definitions>,
    /// With the definition, so that its address stays its own.
    made: HashMap<Key, (Arc<[u8]>, Decoder)>,
    fields: usize,
}

/// What decides how a channel is read: the address of its definition identifies the definition.
#[derive(Debug, PartialEq, Eq, Hash)]
struct Key {
    schema: usize,
    schema_encoding: String,
    message_type: String,
    message_encoding: String,
    topic: Option<TopicWord>,
}

impl Decoders {
    /// With the definitions that are available if a recording carries none.
    pub fn new(definitions: Arc<Definitions>) -> Self {
        Self {
            definitions,
            ..Self::default()
        }
    }

    /// The decoder of a channel, whose definition is `schema`.
    pub fn of(&mut self, format: &Format<'_>, schema: &Arc<[u8]>) -> Decoder {
        let key = Key {
            schema: schema.as_ptr().addr(),
            schema_encoding: format.schema_encoding.to_owned(),
            message_type: format.message_type.to_owned(),
            message_encoding: format.message_encoding.to_owned(),
            topic: format.topic_word(),
        };
        if let Some((_, decoder)) = self.made.get(&key) {
            return decoder.clone();
        }
        let mut decoder = Decoder::of(format, &self.definitions);
        self.fields = self.fields.saturating_add(decoder.fields());
        if self.fields > MAX_FIELDS {
            self.fields = self.fields.saturating_sub(decoder.fields());
            decoder = Decoder::refusing(format!(
                "the definitions before it already have more than {MAX_FIELDS} fields"
            ));
        }
        if self.made.len() < MAX_KEPT {
            self.made.insert(key, (Arc::clone(schema), decoder.clone()));
        }
        decoder
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn format<'a>(topic: &'a str, message_type: &'a str, schema: &'a [u8]) -> Format<'a> {
        Format {
            topic,
            message_type,
            message_encoding: "cdr",
            schema,
            schema_encoding: "ros2msg",
        }
    }

    #[test]
    fn channels_with_one_definition_share_a_decoder_and_topics_that_matter_do_not() {
        let mut decoders = Decoders::default();
        let schema: Arc<[u8]> = b"float64 x\nstd_msgs/Header h\n".as_slice().into();
        for topic in 0..1000 {
            let topic = format!("/t{topic}/radar");
            decoders.of(&format(&topic, "acme/A", &schema), &schema);
        }
        assert_eq!(decoders.made.len(), 1);
        let empty: Arc<[u8]> = [].into();
        for topic in ["/robot_description", "/a/robot_description", "/chatter"] {
            let decoder = decoders.of(&format(topic, "std_msgs/msg/String", &empty), &empty);
            let is_read = decoder.decode(&[0, 1, 0, 0]).is_err();
            assert_eq!(is_read, topic != "/chatter");
        }
    }

    #[test]
    fn definitions_of_ever_more_fields_are_refused_at_last() {
        let mut decoders = Decoders::default();
        let large = format!("{}std_msgs/Header h\n", "int8 a\n".repeat(100_000));
        let unread: Vec<bool> = (0..5)
            .map(|_| {
                let schema: Arc<[u8]> = large.as_bytes().into();
                decoders
                    .of(&format("/t", "acme/A", &schema), &schema)
                    .unread()
                    .is_some()
            })
            .collect();
        assert_eq!(unread, [false, false, true, true, true]);
        let small: Arc<[u8]> = b"std_msgs/Header h\n".as_slice().into();
        assert_eq!(decoders.of(&format("/t", "acme/B", &small), &small).unread(), None);
    }
}
