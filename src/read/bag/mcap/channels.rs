//! The channels of an MCAP as they are defined while reading, and the visitor that receives their messages.
//!
//! Owns schemas and channels by their ids in the file, with bounds on the memory that a hostile file can use.

use std::collections::{BTreeMap, BTreeSet};
use std::ops::RangeInclusive;
use std::sync::Arc;

use ::mcap::records::{Record, op};

use crate::world::qos;

use super::super::{Channel, Message, Visit};
use super::fields::Fields;

/// Bound on all definitions together, bytes: a schema of a large ROS type has 20 KB, a system some hundred types.
const MAX_SCHEMA_BYTES: usize = 64 << 20;
/// Bound on channel definitions. Ids have 16 bits, so more come only from a file that redefines them.
const MAX_CHANNELS: usize = 1 << 16;
/// Bound on the names and metadata of all channels together, bytes.
const MAX_CHANNEL_BYTES: usize = 64 << 20;

/// What is wrong with zeros: a file system leaves them in blocks that were never written, and the format reserves this opcode.
pub(super) const KIND_ZERO: &str =
    "a record has the invalid opcode 0: probably zeros in place of data that was never written";

struct Schema {
    name: String,
    encoding: String,
    data: Arc<[u8]>,
}

/// Takes in the records that matter: schemas, channels, messages.
pub(super) struct Channels<'v> {
    schemas: BTreeMap<u16, Schema>,
    by_id: BTreeMap<u16, Channel>,
    schema_bytes: usize,
    channel_bytes: usize,
    visit: &'v mut dyn Visit,
    /// Schemas and channels that the summary repeats, kind and body, in case their originals are in a damaged part.
    pub(super) repeated: Vec<(u8, Vec<u8>)>,
    /// Messages by channel id, as the file's statistics say.
    pub(super) totals: BTreeMap<u16, u64>,
    /// Channels announced so far.
    pub(super) announced: usize,
    /// Messages passed on.
    pub(super) messages: u64,
    /// Messages whose channel the file does not define.
    pub(super) orphans: u64,
    /// Topics whose channel id was defined again, differently.
    pub(super) redefined: u64,
}

impl<'v> Channels<'v> {
    pub(super) fn new(visit: &'v mut dyn Visit) -> Self {
        Self {
            schemas: BTreeMap::new(),
            by_id: BTreeMap::new(),
            schema_bytes: 0,
            channel_bytes: 0,
            visit,
            repeated: Vec::new(),
            totals: BTreeMap::new(),
            announced: 0,
            messages: 0,
            orphans: 0,
            redefined: 0,
        }
    }

    /// Takes in one record; kinds that do not matter are skipped. The error says what is wrong with it.
    pub(super) fn record(&mut self, opcode: u8, body: &[u8]) -> Result<(), String> {
        match opcode {
            op::SCHEMA | op::CHANNEL | op::MESSAGE => {}
            0 => return Err(KIND_ZERO.to_owned()),
            _ => return Ok(()),
        }
        match ::mcap::parse_record(opcode, body) {
            Ok(Record::Message { header, data }) => {
                self.message(header.channel_id, header.log_time, &data);
                Ok(())
            }
            Ok(Record::Channel(channel)) => self.channel(channel),
            Ok(Record::Schema { header, data }) => self.schema(header, &data),
            Ok(_) => Ok(()),
            Err(error) => Err(format!("a record cannot be parsed ({error})")),
        }
    }

    /// Takes in the records of a chunk whose messages were logged between `log_times`, if that is known. A record is used only when the next one
    /// begins correctly: lost or changed bytes are in the record before the fault. The error says what is wrong after the last record used.
    pub(super) fn chunk(&mut self, bytes: &[u8], log_times: Option<(u64, u64)>) -> Result<(), String> {
        if let Some((first, last)) = log_times {
            let (inside, outside) = within(bytes, first..=last);
            // If most are outside, the header of the chunk is wrong.
            if outside > 0 && inside > outside {
                return Err(format!(
                    "{outside} of the {} messages of a chunk without a checksum have a log time outside of the range in its header",
                    inside + outside
                ));
            }
        }
        let mut rest = Fields(bytes);
        let mut held = next_record(&mut rest)?;
        while let Some((kind, body)) = held {
            held = next_record(&mut rest)?;
            if kind != op::MESSAGE {
                self.record(kind, body)?;
                continue;
            }
            let (channel, log_time, data) = message(body)?;
            self.message(channel, log_time, data);
        }
        Ok(())
    }

    /// Messages were skipped here.
    pub(super) fn seam(&mut self) {
        self.visit.seam();
    }

    /// Records were lost here: messages, and perhaps definitions.
    pub(super) fn lose(&mut self) {
        for (kind, body) in std::mem::take(&mut self.repeated) {
            // A repeated record that cannot be parsed defines nothing.
            let _ = self.record(kind, &body);
        }
        self.seam();
    }

    /// Ids of the channels announced so far that are wanted.
    pub(super) fn wanted(&self, wanted: &dyn Fn(&Channel) -> bool) -> BTreeSet<u32> {
        let chosen = self.by_id.iter().filter(|(_, channel)| wanted(channel));
        chosen.map(|(id, _)| u32::from(*id)).collect()
    }

    /// Passes on what a file contains besides messages.
    pub(super) fn annotation(&mut self, name: &str, fields: &BTreeMap<String, String>) {
        self.visit.annotation(name, fields);
    }

    fn message(&mut self, channel: u16, log_time: u64, data: &[u8]) {
        let Some(channel) = self.by_id.get(&channel) else {
            self.orphans += 1;
            return;
        };
        let log_ns = i64::try_from(log_time).unwrap_or(i64::MAX);
        self.messages += 1;
        self.visit.message(channel, &Message { log_ns, data });
    }

    fn schema(&mut self, header: ::mcap::records::SchemaHeader, data: &[u8]) -> Result<(), String> {
        let same = |known: &Schema| {
            known.name == header.name && known.encoding == header.encoding && known.data.as_ref() == data
        };
        if self.schemas.get(&header.id).is_some_and(same) {
            return Ok(());
        }
        self.schema_bytes += data.len() + header.name.len() + header.encoding.len();
        if self.schema_bytes > MAX_SCHEMA_BYTES {
            return Err(format!("the definitions take more than {MAX_SCHEMA_BYTES} bytes"));
        }
        self.schemas.insert(
            header.id,
            Schema {
                name: header.name,
                encoding: header.encoding,
                data: data.into(),
            },
        );
        Ok(())
    }

    fn channel(&mut self, record: ::mcap::records::Channel) -> Result<(), String> {
        // Id 0 says that there is no schema; with a missing one the type is unknown too.
        let schema = self.schemas.get(&record.schema_id).filter(|_| record.schema_id != 0);
        let mut channel = Channel {
            number: self.announced,
            topic: record.topic,
            message_type: schema.map_or_else(String::new, |schema| schema.name.clone()),
            schema: schema.map_or_else(|| Arc::from([]), |schema| Arc::clone(&schema.data)),
            schema_encoding: schema.map_or_else(String::new, |schema| schema.encoding.clone()),
            message_encoding: record.message_encoding,
            // Converters of ROS 1 bags note the connection's header.
            writer: record.metadata.get("callerid").cloned(),
            latched: record
                .metadata
                .get("offered_qos_profiles")
                .is_some_and(|profiles| qos::is_transient_local(profiles))
                || record.metadata.get("latching").is_some_and(|latching| latching == "1"),
            total: self.totals.get(&record.id).copied(),
            metadata: record.metadata,
        };
        if let Some(known) = self.by_id.get(&record.id) {
            // Writers repeat channels in every chunk.
            channel.number = known.number;
            if *known == channel {
                return Ok(());
            }
            self.redefined += 1;
            channel.number = self.announced;
        }
        self.channel_bytes += size(&channel);
        if self.announced >= MAX_CHANNELS || self.channel_bytes > MAX_CHANNEL_BYTES {
            return Err(format!(
                "more than {MAX_CHANNELS} channel definitions, or {MAX_CHANNEL_BYTES} bytes of them"
            ));
        }
        self.announced += 1;
        self.visit.channel(&channel);
        self.by_id.insert(record.id, channel);
        Ok(())
    }
}

/// Kind and body of the next record of a chunk; `None` at its end.
fn next_record<'a>(rest: &mut Fields<'a>) -> Result<Option<(u8, &'a [u8])>, String> {
    let Some((kind, behind)) = rest.0.split_first() else {
        return Ok(None);
    };
    if *kind == 0 {
        return Err(KIND_ZERO.to_owned());
    }
    rest.0 = behind;
    let cut = |_| "a chunk ends inside a record".to_owned();
    let length = rest.u64().map_err(cut)?;
    let body = rest.bytes(u32::try_from(length).unwrap_or(u32::MAX)).map_err(cut)?;
    Ok(Some((*kind, body)))
}

/// Channel, log time and data of a message record.
fn message(body: &[u8]) -> Result<(u16, u64, &[u8]), String> {
    let mut fields = Fields(body);
    // channel, sequence, log time, publish time, data
    let short = |_| "a message record is shorter than its fields".to_owned();
    let channel = fields.u16().map_err(short)?;
    fields.u32().map_err(short)?;
    let log_time = fields.u64().map_err(short)?;
    fields.u64().map_err(short)?;
    Ok((channel, log_time, fields.0))
}

/// How many messages of a chunk were logged within these times, and how many were not; up to the first record that is damaged.
fn within(bytes: &[u8], times: RangeInclusive<u64>) -> (u64, u64) {
    let (mut rest, mut inside, mut outside) = (Fields(bytes), 0, 0);
    while let Ok(Some((kind, body))) = next_record(&mut rest) {
        match message(body).ok().filter(|_| kind == op::MESSAGE) {
            Some((_, log_time, _)) if times.contains(&log_time) => inside += 1,
            Some(_) => outside += 1,
            None => {}
        }
    }
    (inside, outside)
}

fn size(channel: &Channel) -> usize {
    let metadata: usize = channel
        .metadata
        .iter()
        .map(|(key, value)| key.len() + value.len())
        .sum();
    channel.topic.len() + channel.message_encoding.len() + channel.message_type.len() + metadata
}
