//! A connection record of a ROS 1 bag.

use crate::read::bag::Channel;

use super::record::Fields;

/// A connection by its number, not yet announced.
pub(super) type Connection = (u32, Channel);

/// Reads a connection record: the topic is in the header, the rest in the data.
pub(super) fn connection(fields: &Fields<'_>, data: &[u8]) -> Result<Connection, String> {
    let number = fields.u32("conn")?;
    let topic = fields.text("topic").ok_or("a connection record without a topic")?;
    let fields = Fields::plain(data).map_err(|why| format!("a connection of `{topic}` cannot be parsed: {why}"))?;
    let schema = fields.get("message_definition").unwrap_or_default();
    let metadata = fields.text("md5sum").map(|sum| ("md5sum".to_owned(), sum));
    let channel = Channel {
        number: 0,
        topic,
        message_type: message_type(&fields.text("type").unwrap_or_default()),
        schema: schema.into(),
        schema_encoding: if schema.is_empty() { "" } else { "ros1msg" }.to_owned(),
        message_encoding: "ros1".to_owned(),
        metadata: metadata.into_iter().collect(),
        writer: fields.text("callerid").filter(|name| !name.is_empty()),
        latched: fields.get("latching") == Some(b"1"),
        total: None,
    };
    Ok((number, channel))
}

/// The name of a type as ROS 2 spells it, so that rules meet one spelling: `pkg/Type` has become `pkg/msg/Type`.
fn message_type(recorded: &str) -> String {
    match recorded.split_once('/') {
        Some((package, name)) if !name.contains('/') => format!("{package}/msg/{name}"),
        _ => recorded.to_owned(),
    }
}
