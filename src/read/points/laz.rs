//! Points of a LAZ file, unpacked by the crate `laz` chunk by chunk: some of them, spread over the file. Sizes in the file are checked before
//! anything is unpacked. Source: Isenburg, LASzip, 2013; the layout of chunks in `laszip/chunk_table.rs` of the crate.

use std::io::{Cursor, Read, Seek};

use laz::laszip::ChunkTable;
use laz::{LasZipDecompressor, LazVlr};

use super::Fault;
use super::sample::{MAX_POINTS, Tape, spread};

/// Chunks that are unpacked.
const CHUNKS: u64 = 40;
/// Most chunks of a file: more than 50 thousand million points.
const MAX_CHUNKS: u32 = 1 << 20;
/// Largest table of chunks, and largest chunk, bytes.
const MAX_BYTES: usize = 32 << 20;
/// How the points of a chunk lie: one behind the other, or each of their fields by itself.
const CHUNKED: u16 = 2;
const LAYERED: u16 = 3;

/// Points from byte `start` on; `count` of `size` bytes each by the header.
pub(super) fn read(
    tape: &mut Tape<impl Read + Seek>,
    start: u64,
    (count, size): (u64, u16),
    parameters: &[u8],
    take: &mut impl FnMut(&[u8]),
) -> Result<(), Fault> {
    let damaged = || Fault::new("the compressed points are damaged or cut off");
    let number = |bytes: &[u8], at: usize| {
        let bytes = bytes.get(at..).and_then(|bytes| bytes.first_chunk());
        bytes.map(|bytes| u32::from_le_bytes(*bytes))
    };
    let kind = parameters.first_chunk().map(|bytes| u16::from_le_bytes(*bytes));
    let Some(kind) = kind.filter(|kind| [CHUNKED, LAYERED].contains(kind)) else {
        return Err(Fault::new(
            "the points are compressed without chunks: only the header was read",
        ));
    };
    // A size of 0 or of all ones: each chunk has its own.
    let in_chunk = number(parameters, 12).ok_or_else(damaged)?;
    let is_variable = in_chunk == 0 || in_chunk == u32::MAX;
    let table = table(tape, start, is_variable).ok_or_else(damaged)?;
    let mut fixed = parameters.to_vec();
    fixed.splice(12..16, (u32::MAX - 1).to_le_bytes());
    let mut at = start + 8;
    let mut places = Vec::new();
    let mut left = count;
    for entry in table.as_ref() {
        let points = if is_variable {
            entry.point_count
        } else {
            in_chunk.into()
        }
        .min(left);
        places.push((at, entry.byte_count, points));
        at = at.saturating_add(entry.byte_count);
        left -= points;
    }
    let chunks = (places.len() as u64).min(CHUNKS);
    for index in 0..chunks {
        let wanted = spread(index, chunks, (places.len() as u64).saturating_sub(1));
        let place = usize::try_from(wanted).ok().and_then(|wanted| places.get(wanted));
        let &(at, bytes, points) = place.ok_or_else(damaged)?;
        let bytes = usize::try_from(bytes).ok().filter(|bytes| *bytes <= MAX_BYTES);
        let chunk = tape.at(at, bytes.ok_or_else(damaged)?)?;
        let points = points.min(MAX_POINTS / chunks);
        let parameters = fixed.clone();
        // The decoder checks little of its input.
        let unpacked = std::panic::catch_unwind(move || unpack(&chunk, kind, points, size, &parameters));
        let unpacked = unpacked.ok().flatten().ok_or_else(damaged)?;
        unpacked.chunks_exact(usize::from(size)).for_each(&mut *take);
    }
    if left > 0 {
        return Err(Fault::new(format!(
            "the header states {count} points, but {left} of them are in no chunk"
        )));
    }
    Ok(())
}

fn table(tape: &mut Tape<impl Read + Seek>, start: u64, is_variable: bool) -> Option<ChunkTable> {
    let size = tape.size;
    let mut offset = |at: u64| {
        let bytes = tape.at(at, 8).ok()?;
        let offset = bytes.first_chunk().map(|bytes| u64::from_le_bytes(*bytes))?;
        (start < offset && offset < size).then_some(offset)
    };
    // A writer that could not go back put the offset at the end.
    let at = offset(start).or_else(|| offset(size.saturating_sub(8)))?;
    let bytes = tape.at(at, MAX_BYTES).ok()?;
    let count = bytes.get(4..)?.first_chunk().map(|bytes| u32::from_le_bytes(*bytes))?;
    if count > MAX_CHUNKS {
        return None;
    }
    let read = std::panic::catch_unwind(move || ChunkTable::read(&mut Cursor::new(bytes), is_variable));
    read.ok()?.ok()
}

/// The first points of a chunk: a file is made of it alone, with an empty table of chunks.
fn unpack(chunk: &[u8], kind: u16, points: u64, size: u16, parameters: &[u8]) -> Option<Vec<u8>> {
    let layout = LazVlr::from_buffer(parameters).ok()?;
    if layout.items_size() != u64::from(size) {
        return None;
    }
    if kind == LAYERED {
        // Behind the first point and the number of points, the sizes of the layers: 9 for the point, and at most one for each other byte.
        let sizes = chunk.get(usize::from(size) + 4..)?.chunks_exact(4);
        let layers = 9 + layout
            .items()
            .iter()
            .skip(1)
            .map(|item| layers(item.size()))
            .sum::<usize>();
        let mut sizes = sizes.take(layers).filter_map(<[u8]>::first_chunk);
        if sizes.any(|bytes| u32::from_le_bytes(*bytes) as usize > chunk.len()) {
            return None;
        }
    }
    let end = 8 + chunk.len() as u64;
    let file = [&end.to_le_bytes(), chunk, &[0; 8]].concat();
    let mut decoder = LasZipDecompressor::new(Cursor::new(file), layout).ok()?;
    let mut out = vec![0; usize::try_from(points).ok()?.checked_mul(usize::from(size))?];
    decoder.decompress_many(&mut out).ok()?;
    Some(out)
}

/// The layers of colours (6 or 8 bytes), of a wave packet (29), or of other bytes, one each.
fn layers(size: u16) -> usize {
    match size {
        6 | 29 => 1,
        8 => 2,
        other => usize::from(other),
    }
}
