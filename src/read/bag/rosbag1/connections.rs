//! The connections of a ROS 1 bag as channels, and the visitor that receives their messages.
//!
//! Owns connections by their numbers in the file, with bounds on the memory that a hostile file can use.

use std::collections::{BTreeMap, BTreeSet};

use crate::read::bag::{Channel, Message, Visit};

use super::connection::connection;
use super::index::Index;
use super::record::{Fields, kind, op};

/// Bound on connections; large systems have some hundred, long recordings with nodes that come and go some thousand.
const MAX_CONNECTIONS: usize = 1 << 16;
/// Bound on the definitions and names of all connections together, bytes: a definition has up to 20 KB.
const MAX_BYTES: usize = 128 << 20;

struct ConnectionState {
    channel: Channel,
    /// Messages found.
    read: u64,
}

/// Takes in the records that matter: connections and messages.
pub(super) struct Connections<'v> {
    by_number: BTreeMap<u32, ConnectionState>,
    bytes: usize,
    pub(super) visit: &'v mut dyn Visit,
    announced: usize,
    /// First and last log time of the chunk that is being read, as the index says.
    pub(super) span_ns: Option<(i64, i64)>,
    /// Messages passed on.
    pub(super) messages: u64,
    /// Messages whose connection the file does not define.
    pub(super) orphans: u64,
    /// Connections defined again, differently.
    pub(super) redefined: u64,
    /// Messages with a log time outside of the range that the index gives for their chunk.
    pub(super) outside: u64,
}

impl<'v> Connections<'v> {
    pub(super) fn new(visit: &'v mut dyn Visit) -> Self {
        Self {
            by_number: BTreeMap::new(),
            bytes: 0,
            visit,
            announced: 0,
            span_ns: None,
            messages: 0,
            orphans: 0,
            redefined: 0,
            outside: 0,
        }
    }

    /// Announces the connections of an index, with the number of their messages.
    pub(super) fn announce(&mut self, index: &Index) -> Result<(), String> {
        for (number, channel) in &index.connections {
            let total = index.totals.get(number).copied().unwrap_or(0);
            self.connection(
                *number,
                Channel {
                    total: Some(total),
                    ..channel.clone()
                },
            )?;
        }
        Ok(())
    }

    /// Numbers of the connections announced so far that are wanted.
    pub(super) fn wanted(&self, wanted: &dyn Fn(&Channel) -> bool) -> BTreeSet<u32> {
        let chosen = self.by_number.iter().filter(|(_, known)| wanted(&known.channel));
        chosen.map(|(number, _)| *number).collect()
    }

    /// Takes in one record. The error says what is wrong with it.
    pub(super) fn record(&mut self, fields: &Fields<'_>, data: &[u8]) -> Result<(), String> {
        match fields.op() {
            op::MESSAGE => self.message(fields, data),
            op::CONNECTION => {
                let (number, channel) = connection(fields, data)?;
                self.connection(number, channel)
            }
            other => Err(format!("a record of kind {} among messages", kind(other))),
        }
    }

    fn message(&mut self, fields: &Fields<'_>, data: &[u8]) -> Result<(), String> {
        let log_ns = fields.time_ns("time")?;
        let Some(known) = self.by_number.get_mut(&fields.u32("conn")?) else {
            self.orphans += 1;
            return Ok(());
        };
        let is_inside = self.span_ns.is_none_or(|(from, to)| (from..=to).contains(&log_ns));
        self.outside += u64::from(!is_inside);
        self.messages += 1;
        known.read += 1;
        self.visit.message(&known.channel, &Message { log_ns, data });
        Ok(())
    }

    fn connection(&mut self, number: u32, mut channel: Channel) -> Result<(), String> {
        if let Some(ConnectionState { channel: known, .. }) = self.by_number.get(&number) {
            // Every connection is written once among the messages and once in the index.
            channel.number = known.number;
            channel.total = known.total;
            if *known == channel {
                return Ok(());
            }
            self.redefined += 1;
            channel.total = None;
        }
        self.bytes += size(&channel);
        if self.announced >= MAX_CONNECTIONS || self.bytes > MAX_BYTES {
            return Err(format!(
                "more than {MAX_CONNECTIONS} connections, or {MAX_BYTES} bytes of them"
            ));
        }
        channel.number = self.announced;
        self.announced += 1;
        self.visit.channel(&channel);
        self.by_number.insert(number, ConnectionState { channel, read: 0 });
        Ok(())
    }

    /// Connections with fewer, and with more messages than the index says: how many messages are missing, and surplus.
    pub(super) fn against(&self, index: &Index) -> (u64, u64) {
        let (mut missing, mut surplus) = (0, 0);
        for (number, known) in &self.by_number {
            let total = index.totals.get(number).copied().unwrap_or(0);
            missing += total.saturating_sub(known.read);
            surplus += known.read.saturating_sub(total);
        }
        let unknown = index
            .totals
            .iter()
            .filter(|(number, _)| !self.by_number.contains_key(number));
        missing += unknown.map(|(_, total)| total).sum::<u64>();
        (missing, surplus)
    }
}

fn size(channel: &Channel) -> usize {
    let metadata: usize = channel.metadata.values().map(String::len).sum();
    let writer = channel.writer.as_ref().map_or(0, String::len);
    channel.topic.len() + channel.message_type.len() + channel.schema.len() + metadata + writer
}
