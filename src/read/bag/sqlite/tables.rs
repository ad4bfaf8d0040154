//! The tables of a rosbag2 database, as the distributions write them.
//!
//! `topics(id, name, type, serialization_format)` and `messages(id, topic_id, timestamp, data)` always; since Foxy
//! `topics.offered_qos_profiles`; since Iron `topics.type_description_hash` and `message_definitions(topic_type, encoding,
//! encoded_message_definition)`. Owns names and bounds. Must not read messages.

use std::collections::{BTreeMap, BTreeSet};
use std::sync::Arc;

use rusqlite::types::ValueRef;
use rusqlite::{Connection, Row};

use crate::world::qos;

use super::super::Channel;
use super::super::metadata::Metadata;

/// Bound on topics and definitions, each.
const MAX_ROWS: usize = 1 << 16;
/// Bound on all their texts together, bytes.
const MAX_BYTES: usize = 64 << 20;
/// Tables that are named if the database is not a recording.
const MAX_NAMED: usize = 5;

/// What is known before the first message.
pub(super) struct Tables {
    /// Channels by the topic's id in the database, numbered in the order of ids.
    pub(super) channels: BTreeMap<i64, Channel>,
    /// Whether messages can be read in order of time through an index.
    pub(super) indexed: bool,
    /// What is wrong with the tables of topics and definitions; the channels before it are there.
    pub(super) fault: Option<String>,
}

struct Definition {
    encoding: String,
    text: Arc<[u8]>,
}

/// Reads the schema, the topics and the definitions. The error says why this is not a recording.
pub(super) fn read(connection: &Connection, metadata: Option<&Metadata>) -> Result<Tables, String> {
    let names = tables(connection)?;
    if !(names.contains("topics") && names.contains("messages")) {
        let listed: Vec<String> = names
            .iter()
            .take(MAX_NAMED)
            .map(|name| format!("`{name:.40}`"))
            .collect();
        let what = match (listed.is_empty(), names.len() > MAX_NAMED) {
            (true, _) => "it holds no tables".to_owned(),
            (false, more) => format!(
                "its tables are {}{}",
                listed.join(", "),
                if more { ", ..." } else { "" }
            ),
        };
        return Err(format!("an SQLite database, but not a rosbag2 recording: {what}"));
    }
    let messages = columns(connection, "messages")?;
    let topics = columns(connection, "topics")?;
    let lacks = |table: &str, known: &BTreeSet<String>, wanted: &[&str]| {
        let missing = wanted.iter().find(|name| !known.contains(**name))?;
        Some(format!(
            "an SQLite database, but not a rosbag2 recording: `{table}` has no column `{missing}`"
        ))
    };
    let missing = lacks("messages", &messages, &["topic_id", "timestamp", "data"])
        .or_else(|| lacks("topics", &topics, &["id", "name", "type"]));
    if let Some(missing) = missing {
        return Err(missing);
    }
    if ["rowid", "_rowid_", "oid"].iter().any(|name| messages.contains(*name)) {
        return Err(
            "an SQLite database, but not a rosbag2 recording: a column of `messages` hides the row numbers".to_owned(),
        );
    }
    let mut bytes = 0;
    let (definitions, fault) = if names.contains("message_definitions") {
        definitions(connection, &mut bytes)
    } else {
        (BTreeMap::new(), None)
    };
    let (channels, topics_fault) = channels(connection, &topics, &definitions, metadata, &mut bytes);
    Ok(Tables {
        channels,
        indexed: is_indexed(connection),
        fault: topics_fault.or(fault),
    })
}

/// Names of the ordinary tables. Views and virtual tables compute what they show: neither is a recording.
fn tables(connection: &Connection) -> Result<BTreeSet<String>, String> {
    let mut names = BTreeSet::new();
    let fault = each(
        connection,
        "SELECT name, sql FROM sqlite_schema WHERE type = 'table'",
        &mut |row| {
            let (name, sql) = (text(row, 0)?, text(row, 1)?);
            let is_ordinary = sql
                .get(..12)
                .is_some_and(|start| start.eq_ignore_ascii_case("CREATE TABLE"));
            if is_ordinary && !name.starts_with("sqlite_") {
                names.insert(name);
            }
            Ok(())
        },
    );
    match fault {
        Some(why) if names.is_empty() => Err(format!("an SQLite database whose tables cannot be listed: {why}")),
        _ => Ok(names),
    }
}

fn columns(connection: &Connection, table: &str) -> Result<BTreeSet<String>, String> {
    let mut names = BTreeSet::new();
    let fault = each(connection, &format!("PRAGMA table_info({table})"), &mut |row| {
        names.insert(text(row, 1)?.to_lowercase());
        Ok(())
    });
    fault.map_or(Ok(names), Err)
}

fn definitions(connection: &Connection, bytes: &mut usize) -> (BTreeMap<String, Definition>, Option<String>) {
    let (mut found, mut last) = (BTreeMap::new(), None);
    let sql = "SELECT topic_type, encoding, encoded_message_definition, rowid FROM message_definitions";
    let fault = each(connection, sql, &mut |row| {
        let (of, encoding, body) = (text(row, 0)?, text(row, 1)?, text(row, 2)?);
        let number = row.get::<_, i64>(3).map_err(|error| error.to_string())?;
        if last.replace(number).is_some_and(|last| number <= last) {
            return Err("definitions are out of order".to_owned());
        }
        fits(bytes, of.len() + encoding.len() + body.len())?;
        let definition = Definition {
            // rosbag2 says `unknown` and leaves the text empty where it found no definition.
            encoding: if body.is_empty() { String::new() } else { encoding },
            text: body.into_bytes().into(),
        };
        found.insert(of, definition);
        Ok(())
    });
    (found, fault)
}

fn channels(
    connection: &Connection,
    columns: &BTreeSet<String>,
    definitions: &BTreeMap<String, Definition>,
    metadata: Option<&Metadata>,
    bytes: &mut usize,
) -> (BTreeMap<i64, Channel>, Option<String>) {
    let optional = |name: &'static str| if columns.contains(name) { name } else { "''" };
    let sql = format!(
        "SELECT id, name, type, {}, {}, {} FROM topics",
        optional("serialization_format"),
        optional("offered_qos_profiles"),
        optional("type_description_hash")
    );
    let mut found = BTreeMap::new();
    let fault = each(connection, &sql, &mut |row| {
        let Ok(ValueRef::Integer(id)) = row.get_ref(0) else {
            return Err("a topic has no number".to_owned());
        };
        let (topic, message_type, format) = (text(row, 1)?, text(row, 2)?, text(row, 3)?);
        let (mut qos, hash) = (text(row, 4)?, text(row, 5)?);
        let said = metadata.and_then(|metadata| metadata.topics.get(&topic));
        if qos.trim().is_empty() {
            qos = said.map(|said| said.offered_qos_profiles.clone()).unwrap_or_default();
        }
        fits(
            bytes,
            topic.len() + message_type.len() + format.len() + qos.len() + hash.len(),
        )?;
        let noted: BTreeMap<String, String> = [("offered_qos_profiles", qos), ("topic_type_hash", hash)]
            .into_iter()
            .filter(|(_, value)| !value.is_empty())
            .map(|(key, value)| (key.to_owned(), value))
            .collect();
        let definition = definitions.get(&message_type);
        let channel = Channel {
            number: 0,
            schema: definition.map_or_else(|| Arc::from([]), |definition| Arc::clone(&definition.text)),
            schema_encoding: definition.map_or_else(String::new, |definition| definition.encoding.clone()),
            // Converters omit the format; rosbag2 uses no other.
            message_encoding: if format.is_empty() { "cdr".to_owned() } else { format },
            writer: None,
            latched: noted
                .get("offered_qos_profiles")
                .is_some_and(|profiles| qos::is_transient_local(profiles)),
            total: None,
            metadata: noted,
            topic,
            message_type,
        };
        if found.insert(id, channel).is_some() {
            return Err(format!("two topics have the number {id}"));
        }
        Ok(())
    });
    for (number, channel) in found.values_mut().enumerate() {
        channel.number = number;
    }
    (found, fault)
}

fn fits(bytes: &mut usize, more: usize) -> Result<(), String> {
    *bytes += more;
    if *bytes > MAX_BYTES {
        return Err(format!("topics and definitions take more than {MAX_BYTES} bytes"));
    }
    Ok(())
}

/// Whether the messages come in order of time without being sorted first.
fn is_indexed(connection: &Connection) -> bool {
    let mut sorted = false;
    let sql = "EXPLAIN QUERY PLAN SELECT data FROM messages ORDER BY timestamp, rowid";
    let fault = each(connection, sql, &mut |row| {
        sorted |= text(row, 3)?.contains("TEMP B-TREE");
        Ok(())
    });
    fault.is_none() && !sorted
}

/// Runs one of our queries over a small table. Returns the reason if it ended early.
fn each(connection: &Connection, sql: &str, take: &mut dyn FnMut(&Row<'_>) -> Result<(), String>) -> Option<String> {
    let mut run = || -> Result<(), String> {
        let words = |error: rusqlite::Error| error.to_string();
        let mut statement = connection.prepare(sql).map_err(words)?;
        let mut rows = statement.query([]).map_err(words)?;
        let mut count = 0;
        while let Some(row) = rows.next().map_err(words)? {
            count += 1;
            if count > MAX_ROWS {
                return Err(format!("more than {MAX_ROWS} rows"));
            }
            take(row)?;
        }
        Ok(())
    };
    run().err()
}

/// A column as text; empty for other types.
fn text(row: &Row<'_>, column: usize) -> Result<String, String> {
    Ok(match row.get_ref(column).map_err(|error| error.to_string())? {
        ValueRef::Text(bytes) | ValueRef::Blob(bytes) => String::from_utf8_lossy(bytes).into_owned(),
        ValueRef::Integer(number) => number.to_string(),
        ValueRef::Null | ValueRef::Real(_) => String::new(),
    })
}
