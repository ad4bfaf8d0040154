//! Recordings that were split into several files, known by the files' names and times.
//!
//! `rosbag2` numbers its files `name_0.mcap`, `name_1.mcap`, ...; `rosbag record --split` writes the date of each file in
//! front of the number. Separate drives are numbered in the same way: only files that continue each other in time are joined.
//! Owns that decision. Must not read messages.

use std::fs::File;
use std::io::{BufReader, Read, Seek, SeekFrom};
use std::path::PathBuf;

use super::{Extent, Task, parts};

/// How long after the end of a file the next one may begin, nanoseconds. Recorders close one file and open the next
/// within a second; people need longer to begin another drive.
const MAX_GAP_NS: i64 = 5_000_000_000;
/// How long before the end of a file the next one may begin, nanoseconds: messages of several threads reach the recorder
/// slightly out of order.
const MAX_OVERLAP_NS: i64 = 100_000_000;
/// Bound on the records of a ROS 1 index that are read.
const MAX_RECORDS: usize = 2_000_000;
/// Bound on the header of one of them, bytes.
const MAX_HEAD: u32 = 1 << 16;

/// Reads the files of a split recording as one.
pub(super) fn read(files: &[PathBuf], mut task: Task<'_>) -> Extent {
    let extent = parts::read(files, None, task.lent()).extent;
    let source = task.source;
    if let (Some(first), Some(last)) = (files.first(), files.last())
        && source.detail.is_none()
    {
        let (first, last) = (parts::name(first), parts::name(last));
        source.detail = Some(format!(
            "{} files read as one recording: {first} ... {last}",
            files.len()
        ));
    }
    extent
}

/// Groups files by what belongs together: the same name, numbers that run from 0 or 1, times that continue each other.
/// `files` are in one folder, have one name and one ending, and are sorted by number. A file with an unknown end time,
/// as the last one has after a crash, ends its group.
pub(in crate::read) fn runs(files: &[(u64, PathBuf)]) -> Vec<Vec<PathBuf>> {
    let from_the_start = files.first().is_some_and(|(number, _)| *number <= 1);
    let mut runs: Vec<Vec<PathBuf>> = Vec::new();
    let mut previous: Option<(u64, i64)> = None;
    for (number, file) in files {
        let times = from_the_start.then(|| super::span(file).ok()).flatten();
        let follows = previous.is_some_and(|(before, end)| {
            let in_time = match times {
                Some(Some((start, _))) => {
                    let gap = start.saturating_sub(end);
                    (-MAX_OVERLAP_NS..=MAX_GAP_NS).contains(&gap)
                }
                // It was not closed: only its number is known.
                Some(None) => true,
                None => false,
            };
            *number == before + 1 && in_time
        });
        match runs.last_mut().filter(|_| follows) {
            Some(run) => run.push(file.clone()),
            None => runs.push(vec![file.clone()]),
        }
        previous = times.flatten().map(|(_, end)| (*number, end));
    }
    runs
}

/// First and last time in the index of a ROS 1 bag, nanoseconds; `None` where it has none.
pub(super) fn rosbag1_span(file: &File, total: u64) -> Option<(i64, i64)> {
    let mut input = BufReader::new(file);
    input.seek(SeekFrom::Start(13)).ok()?;
    let (head, _) = record(&mut input)?;
    let index = u64::from_le_bytes(*field(&head, b"index_pos")?.first_chunk()?);
    if index == 0 || index >= total {
        return None;
    }
    input.seek(SeekFrom::Start(index)).ok()?;
    let mut span: Option<(i64, i64)> = None;
    for _ in 0..MAX_RECORDS {
        let Some((head, data)) = record(&mut input) else { break };
        if field(&head, b"op") == Some(&[6]) {
            let (start, end) = (time(field(&head, b"start_time")?)?, time(field(&head, b"end_time")?)?);
            span = Some(span.map_or((start, end), |(first, last)| (first.min(start), last.max(end))));
        }
        input.seek_relative(i64::from(data)).ok()?;
    }
    span
}

/// The header of a record, and the number of bytes that follow it.
fn record(input: &mut impl Read) -> Option<(Vec<u8>, u32)> {
    let mut length = [0; 4];
    input.read_exact(&mut length).ok()?;
    let head = u32::from_le_bytes(length);
    if head > MAX_HEAD {
        return None;
    }
    let mut bytes = vec![0; usize::try_from(head).ok()?];
    input.read_exact(&mut bytes).ok()?;
    input.read_exact(&mut length).ok()?;
    Some((bytes, u32::from_le_bytes(length)))
}

/// The value of a field in a record's header: each is a length and `name=value`.
fn field<'a>(head: &'a [u8], name: &[u8]) -> Option<&'a [u8]> {
    let mut rest = head;
    loop {
        let (length, after) = rest.split_first_chunk::<4>()?;
        let length = usize::try_from(u32::from_le_bytes(*length)).ok()?;
        let (field, after) = after.split_at_checked(length)?;
        if let Some(value) = field.strip_prefix(name).and_then(|value| value.strip_prefix(b"=")) {
            return Some(value);
        }
        rest = after;
    }
}

/// Seconds and nanoseconds, four bytes each, as nanoseconds.
fn time(value: &[u8]) -> Option<i64> {
    let (seconds, rest) = value.split_first_chunk::<4>()?;
    let nanoseconds = rest.first_chunk::<4>()?;
    let seconds = i64::from(u32::from_le_bytes(*seconds));
    Some(seconds * 1_000_000_000 + i64::from(u32::from_le_bytes(*nanoseconds)))
}
