//! Where the records of a bag go: to the visitor, or, damaged, to the list of losses.
//!
//! Owns the order in which chunks that are decompressed in parallel come back, and what the index says of each. Must not
//! know the file.

use std::collections::VecDeque;
use std::sync::Arc;

use crate::read::bag::inflate::UnpackedChunk;

use super::connections::Connections;
use super::index::Index;
use super::record::{self, Fault};
use crate::read::bag::losses::{Loss, Losses};

/// What becomes of the bytes of a bag.
pub(super) struct Sink<'v> {
    pub(super) connections: Connections<'v>,
    pub(super) losses: Losses,
    /// The index, where it is sound.
    pub(super) index: Option<Arc<Index>>,
    /// Chunks that are where the index says.
    pub(super) met_chunks: usize,
    /// Chunks that are not in the index.
    pub(super) unlisted_chunks: u64,
    /// Where the chunks end that are being decompressed.
    pub(super) ends: VecDeque<u64>,
}

impl<'v> Sink<'v> {
    pub(super) fn new(connections: Connections<'v>) -> Self {
        Self {
            connections,
            losses: Losses::default(),
            index: None,
            met_chunks: 0,
            unlisted_chunks: 0,
            ends: VecDeque::new(),
        }
    }

    /// Looks up the index entry of the chunk at a byte, whose messages come next.
    pub(super) fn expect(&mut self, at: u64) {
        self.connections.span_ns = None;
        let Some(index) = &self.index else {
            return;
        };
        if let Some(info) = index.chunk_at(at) {
            self.met_chunks += 1;
            self.connections.span_ns = Some((info.start_ns, info.end_ns));
        } else {
            self.unlisted_chunks += 1;
        }
    }

    /// Takes in a chunk. Nothing is used of one that cannot be decompressed: no checksum covers the part before the fault.
    pub(super) fn chunk(&mut self, chunk: &UnpackedChunk) {
        let end = self.ends.pop_front();
        self.expect(chunk.at);
        if chunk.seam {
            self.connections.visit.seam();
        }
        let result = chunk.data.as_deref().map_err(Clone::clone);
        if let Err(why) = result.and_then(|bytes| self.records(bytes)) {
            self.lose(chunk.at, end, why);
        }
    }

    /// A record is used only when the next one begins correctly: bytes that were lost or inserted are in the record before the fault.
    fn records(&mut self, mut bytes: &[u8]) -> Result<(), String> {
        let mut held = None;
        while let Some((fields, data)) = record::next(&mut bytes).map_err(inside)? {
            if let Some((fields, data)) = held.replace((fields, data)) {
                self.connections.record(&fields, data)?;
            }
        }
        held.map_or(Ok(()), |(fields, data)| self.connections.record(&fields, data))
    }

    /// A part of the file is skipped.
    pub(super) fn lose(&mut self, from: u64, to: Option<u64>, why: String) {
        self.losses.add(Loss { from, to, why });
        self.connections.visit.seam();
    }
}

/// A fault inside a chunk that is whole.
pub(super) fn inside(fault: Fault) -> String {
    match fault {
        Fault::Ended => "a chunk ends inside a record".to_owned(),
        Fault::Wrong(why) => why,
    }
}
