//! The writers of messages, where the format records them.
//!
//! Owns the names of writers; counts hold their numbers, so that no message needs a string.

use std::collections::BTreeMap;

/// Bound on the writers of a recording that are kept apart.
const MAX_WRITERS: usize = 10_000;
/// Bound on the writers of one topic or edge that are kept apart.
const MAX_WRITERS_OF_ONE: usize = 64;

/// A writer's number.
pub(super) type Writer = u32;

/// Every writer of a recording.
#[derive(Default)]
pub(super) struct Writers {
    names: Vec<String>,
    numbers: BTreeMap<String, Writer>,
}

impl Writers {
    /// The number of a name; `None` where there is no room for a new one.
    pub(super) fn number(&mut self, name: &str) -> Option<Writer> {
        if let Some(known) = self.numbers.get(name) {
            return Some(*known);
        }
        let next = Writer::try_from(self.names.len()).ok()?;
        if self.names.len() >= MAX_WRITERS {
            return None;
        }
        self.names.push(name.to_owned());
        self.numbers.insert(name.to_owned(), next);
        Some(next)
    }
}

/// Counts by writer: a topic or an edge has one, rarely two.
#[derive(Clone, Debug, Default)]
pub(super) struct WriterCounts(Vec<(Writer, u64)>);

impl WriterCounts {
    pub(super) fn push(&mut self, writer: Option<Writer>) {
        let Some(writer) = writer else { return };
        if let Some((_, count)) = self.0.iter_mut().find(|(known, _)| *known == writer) {
            *count += 1;
        } else if self.0.len() < MAX_WRITERS_OF_ONE {
            self.0.push((writer, 1));
        }
    }

    /// The counts by name.
    pub(super) fn finish(self, writers: &Writers) -> BTreeMap<String, u64> {
        let named = |(writer, count): (Writer, u64)| Some((writers.names.get(writer as usize)?.clone(), count));
        self.0.into_iter().filter_map(named).collect()
    }
}
