//! Reading a large database in part: first messages, messages that matter throughout, and windows of time.
//!
//! Owns the choice of rows. The index of a database knows times and not topics, so what belongs to a topic is looked for
//! row by row: that reads each row's header and none of its data, and is bounded.

use std::collections::BTreeMap;
use std::time::Duration;

use rusqlite::Connection;
use rusqlite::types::ValueRef;

use super::super::{Extent, Sampling, Selection};
use super::number;
use super::pass::{Flow, Pass, row_number, select, time};

/// Rows that are read for the topics they belong to.
const MAX_LOOKED_AT: u64 = 2_000_000;
/// Messages that are read from the start of each topic.
const FIRST: u64 = 4;
/// Bound on messages that are read to cover their topic.
const MAX_PICKS: usize = 20_000;

/// First and last log time, nanoseconds, by the index.
pub(super) fn span(connection: &Connection) -> Option<(i64, i64)> {
    Some((
        number(connection, "SELECT min(timestamp) FROM messages")?,
        number(connection, "SELECT max(timestamp) FROM messages")?,
    ))
}

/// Reads a database in part, in order of time. The channels are announced with their totals as far as these are known.
pub(super) fn read(pass: &mut Pass<'_, '_>, sampling: &Sampling, wanted: &Selection<'_>) -> Extent {
    let mut look = FirstRows::default();
    if let Err(why) = look.run(pass, sampling.bytes, wanted) {
        pass.stopped = Some(why);
    }
    if look.saw_all {
        for (topic, channel) in &mut pass.tables.channels {
            channel.total = Some(look.seen.get(topic).copied().unwrap_or(0));
        }
    }
    pass.announce_channels();
    look.picks.sort_unstable();
    let span_ns = span(pass.connection);
    let mut picks = look.picks.iter().copied().peekable();
    let mut left_out = false;
    let windows = span_ns.map(|span| windows(span, sampling)).unwrap_or_default();
    let sampling = Sampling {
        windows: u32::try_from(windows.len()).unwrap_or(u32::MAX),
        ..*sampling
    };
    let is_in_a_row = pass.tables.channels.values().any(|channel| (wanted.in_a_row)(channel));
    for (number, (start, end)) in (0..).zip(windows) {
        while let Some(pick) = picks.next_if(|(at, _)| *at < start) {
            single(pass, pick, &mut left_out);
        }
        let (share, carried) = sampling.bounds(number);
        let bound = if is_in_a_row { carried } else { share };
        window(pass, (start, end), bound, &mut left_out);
    }
    for pick in picks {
        single(pass, pick, &mut left_out);
    }
    let messages_total = if look.saw_all {
        Some(look.seen.values().sum())
    } else {
        rows(pass.connection)
    };
    Extent {
        whole: messages_total == Some(pass.messages + pass.too_large + pass.unfit + pass.orphans),
        messages_total,
        span_ns,
        ..Extent::default()
    }
}

/// Rows of a table that nothing was deleted from; recorders delete nothing. Counting them would read all their pages.
fn rows(connection: &Connection) -> Option<u64> {
    let first = number(connection, "SELECT min(rowid) FROM messages")?;
    let last = number(connection, "SELECT max(rowid) FROM messages")?;
    u64::try_from(last.checked_sub(first)?.checked_add(1)?).ok()
}

/// What is found by reading rows from the first on.
#[derive(Default)]
struct FirstRows {
    /// Messages seen by topic.
    seen: BTreeMap<i64, u64>,
    /// Time and row of the messages that are read to cover their topic.
    picks: Vec<(i64, i64)>,
    /// Whether every row was read.
    saw_all: bool,
}

impl FirstRows {
    /// Looks until every topic has what it needs, or the bounds are met. `bytes` bounds what is picked.
    fn run(&mut self, pass: &mut Pass<'_, '_>, bytes: u64, wanted: &Selection<'_>) -> Result<(), String> {
        // What each topic still needs: `None` where it is wanted throughout and its total is not known.
        let mut needs: BTreeMap<i64, Option<u64>> = pass
            .tables
            .channels
            .iter()
            .map(|(topic, channel)| {
                let throughout = (wanted.throughout)(channel);
                let need = if throughout {
                    channel.total
                } else {
                    Some(channel.total.map_or(FIRST, |total| total.min(FIRST)))
                };
                (*topic, need)
            })
            .collect();
        let mut hungry = needs.values().filter(|need| **need != Some(0)).count();
        let (mut looked_at, mut picked, mut last) = (0, 0, None);
        let mut enough = false;
        let sql = "SELECT rowid, topic_id, timestamp, octet_length(data) FROM messages ORDER BY rowid";
        pass.run(sql, [], |_, row| {
            let at = row_number(row)?;
            if last.is_some_and(|last| at <= last) {
                return Err("its rows are out of order".to_owned());
            }
            last = Some(at);
            looked_at += 1;
            if looked_at > MAX_LOOKED_AT || hungry == 0 {
                enough = true;
                return Ok(Flow::Enough);
            }
            let (Ok(ValueRef::Integer(topic)), Some(time)) = (row.get_ref(1), time(row)) else {
                return Ok(Flow::Go);
            };
            *self.seen.entry(topic).or_default() += 1;
            let Some(need) = needs.get_mut(&topic).filter(|need| **need != Some(0)) else {
                return Ok(Flow::Go);
            };
            let size = match row.get_ref(3) {
                Ok(ValueRef::Integer(size)) => u64::try_from(size).unwrap_or(0),
                _ => 0,
            };
            // The first message of a topic is read at any cost.
            let is_first = self.seen.get(&topic) == Some(&1);
            if is_first || (self.picks.len() < MAX_PICKS && picked + size <= bytes) {
                self.picks.push((time, at));
                picked += size;
            }
            if let Some(left) = need {
                *left -= 1;
                hungry -= usize::from(*left == 0);
            }
            Ok(Flow::Go)
        })?;
        self.saw_all = !enough;
        Ok(())
    }
}

/// Half-open windows of time, spread evenly from the first to the last message, nanoseconds.
fn windows((first, last): (i64, i64), sampling: &Sampling) -> Vec<(i64, i64)> {
    let count = i128::from(sampling.windows.max(1));
    let length = Duration::try_from_secs_f64(sampling.seconds).map_or(0, |length| length.as_nanos());
    let length = i128::try_from(length).unwrap_or(i128::MAX);
    let (first, end) = (i128::from(first), i128::from(last) + 1);
    let length = length.clamp(1, (end - first).max(1));
    let free = end - first - length;
    let mut windows: Vec<(i64, i64)> = Vec::new();
    let mut reached = first;
    for number in 0..count {
        let start = if count == 1 {
            first
        } else {
            first + free * number / (count - 1)
        };
        let (start, stop) = (start.max(reached), start + length);
        if start < stop {
            let fit = |time: i128| i64::try_from(time).unwrap_or(i64::MAX);
            windows.push((fit(start), fit(stop)));
            reached = stop;
        }
    }
    windows
}

/// Reads one message by its row.
fn single(pass: &mut Pass<'_, '_>, pick: (i64, i64), left_out: &mut bool) {
    if pass.last.is_some_and(|last| pick <= last) {
        return;
    }
    let follows = pass.last.is_none_or(|(_, row)| row.checked_add(1) == Some(pick.1));
    if *left_out || !follows {
        pass.seam();
    }
    // Whether there are more messages between this one and the next is not known.
    *left_out = false;
    let sql = select("WHERE rowid = ?1");
    let result = pass.run(&sql, [pick.1], Pass::in_order);
    note(pass, result);
}

/// Reads a window of time up to its share of bytes.
fn window(pass: &mut Pass<'_, '_>, (start, end): (i64, i64), share: u64, left_out: &mut bool) {
    let bound = pass.bytes + share;
    let mut at_start = true;
    let sql = select("WHERE timestamp >= ?1 AND timestamp < ?2 ORDER BY timestamp, rowid");
    let result = pass.run(&sql, [start, end], |pass, row| {
        // A damaged index leads to other rows.
        if time(row).is_none_or(|time| time < start || time >= end) {
            return Err("its messages are out of order".to_owned());
        }
        if pass.bytes >= bound {
            *left_out = true;
            return Ok(Flow::Enough);
        }
        let row_number = row_number(row).ok();
        let follows = pass.last.is_none_or(|(_, row)| row.checked_add(1) == row_number);
        if at_start && (*left_out || !follows) {
            pass.seam();
        }
        (at_start, *left_out) = (false, false);
        pass.in_order(row)
    });
    note(pass, result);
}

/// Keeps the first reason for which something could not be read; other places may still be intact.
fn note(pass: &mut Pass<'_, '_>, result: Result<(), String>) {
    if let Err(why) = result {
        pass.stopped.get_or_insert(why);
    }
}
