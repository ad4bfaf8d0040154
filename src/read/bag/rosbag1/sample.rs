//! Some of the chunks of a bag, where not all of it is read.
//!
//! Owns the part of the index that the choice needs, and the reading of the chosen chunks. Must not choose.

use crate::read::bag::chunks::{self, ChunkInfo, MarkedChannels};
use crate::read::bag::inflate::Compression;
use crate::read::bag::{Extent, Sampling, Selection};
use crate::source::{Place, ReadStatus, Source};

use super::Pass;
use super::chunk::Chunk;
use super::index::Index;
use super::record::{Fault, op};

/// Chunks that are read to estimate how far chunks are compressed.
const PROBED: usize = 32;

/// How many times longer bzip2 takes for a byte than others do: 40 MB a second.
const SLOW: u64 = 16;

/// What a few chunks show about all of them.
struct Probe {
    /// By what factor chunks grow when they are decompressed: the index does not say.
    growth: f64,
    /// Whether some are packed with bzip2.
    is_slow: bool,
}

impl Pass<'_, '_> {
    /// The chunks that are read, where that is less than all of them. `None` as well where the index is wrong.
    pub(super) fn choose(&mut self, sampling: &Sampling, wanted: &Selection<'_>) -> Option<Vec<usize>> {
        let index = self.sink.index.clone()?;
        let Probe { growth, is_slow } = self.probed(&index)?;
        let mut sampling = *sampling;
        if let Some(carried) = sampling.carried.as_mut().filter(|_| is_slow) {
            carried.bytes /= SLOW;
        }
        let infos: Vec<ChunkInfo> = (0..index.chunks.len())
            .filter_map(|number| info(&index, number, growth))
            .collect();
        let marked = MarkedChannels::of(wanted, |is_wanted| self.sink.connections.wanted(is_wanted));
        let chosen = chunks::choose(&infos, &sampling, &marked);
        if chosen.len() == index.chunks.len() {
            return None;
        }
        // Before the first message is used: is there a chunk that fits into memory at each place of the index?
        let are_there = chosen
            .iter()
            .all(|number| self.chunk_at(&index, *number).is_ok_and(|(_, chunk)| chunk.is_held()));
        are_there.then_some(chosen)
    }

    fn probed(&mut self, index: &Index) -> Option<Probe> {
        let count = index.chunks.len();
        let (mut packed, mut size, mut is_slow) = (0, 0, false);
        for probe in 0..PROBED.min(count) {
            let (_, chunk) = self.chunk_at(index, probe * count / PROBED.min(count)).ok()?;
            packed += chunk.len;
            size += chunk.size;
            is_slow |= chunk.compression == Compression::Bz2;
        }
        Some(Probe {
            growth: (size as f64 / packed.max(1) as f64).max(1.0),
            is_slow,
        })
    }

    /// Goes to a chunk of the index and reads its frame. It must end before the next entry of the index.
    fn chunk_at(&mut self, index: &Index, number: usize) -> Result<(u64, Chunk), Fault> {
        let wrong = || Fault::Wrong("there is no such chunk where the index says".to_owned());
        let at = index.chunks.get(number).ok_or_else(wrong)?.at;
        self.tape.seek_anew(at)?;
        let frame = self.tape.frame()?;
        let fields = frame.fields()?;
        if fields.op() != op::CHUNK || self.tape.at + frame.len > end(index, number) {
            return Err(wrong());
        }
        Ok((at, Chunk::of(&fields, frame.len).map_err(Fault::Wrong)?))
    }

    /// Reads the chosen chunks.
    pub(super) fn sample(&mut self, chosen: &[usize], source: &mut Source) -> Extent {
        let Some(index) = self.sink.index.clone() else {
            return crate::read::bag::NOTHING;
        };
        let mut read = self.tape.total - index.at;
        let (mut previous, mut failed) = (None, None);
        for (done, number) in chosen.iter().enumerate() {
            let seam = *number > previous.map_or(0, |previous: usize| previous + 1);
            previous = Some(*number);
            let result = self.chunk_at(&index, *number).and_then(|(at, chunk)| {
                read += chunk.len;
                self.pack(at, &chunk, seam)
            });
            if let Err(fault) = result {
                failed = Some(super::index::words(fault));
                break;
            }
            let part = (done as u64 + 1) * self.tape.total / chosen.len() as u64;
            (self.progress)(part, self.tape.total);
        }
        self.flush();
        source.examined.bytes = read;
        source.examined.messages = Some(self.sink.connections.messages);
        let status = if self.sink.connections.messages == 0 {
            ReadStatus::Unreadable
        } else {
            ReadStatus::Partial
        };
        let lost = !self.sink.losses.is_empty() || failed.is_some();
        let lines = self.sink.losses.lines(self.tape.total);
        for line in failed.into_iter().chain(lines) {
            source.problem(status, Place::whole(source.id), line);
        }
        self.report_oddities(chosen.len(), source);
        Extent {
            truncated: lost,
            whole: false,
            indexed: true,
            messages_total: Some(index.messages()),
            span_ns: index.span_ns(),
        }
    }
}

/// Where what follows a chunk begins.
fn end(index: &Index, number: usize) -> u64 {
    index.chunks.get(number + 1).map_or(index.at, |chunk| chunk.at)
}

fn info(index: &Index, number: usize, growth: f64) -> Option<ChunkInfo> {
    let chunk = index.chunks.get(number)?;
    let packed = end(index, number).saturating_sub(chunk.at);
    let mut channels: Vec<u32> = chunk.counts.iter().map(|(connection, _)| *connection).collect();
    channels.sort_unstable();
    // The size of a file times a factor: an overflow counts as unlimited.
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss)]
    let bytes = (packed as f64 * growth) as u64;
    Some(ChunkInfo {
        start_ns: chunk.start_ns,
        end_ns: chunk.end_ns,
        bytes,
        channels,
    })
}
