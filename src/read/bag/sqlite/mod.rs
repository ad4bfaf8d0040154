//! rosbag2 databases (`.db3`), through SQLite.
//!
//! Owns the order of messages (time, then row), what is read of a large database, and the messages about a damaged one. Must
//! not know what is inside messages.

mod open;
mod pass;
mod sample;
mod tables;

use std::fs::File;
use std::io::{Read, Seek, SeekFrom};
use std::path::Path;

use rusqlite::Connection;

use crate::source::{Place, ReadStatus, Source};

use super::metadata::Metadata;
use super::{Extent, Task};

use pass::{LastPage, Pass};

/// Reads a database that starts with SQLite's magic; see [`super::read`]. `metadata` is what `metadata.yaml` says about the
/// recording that the file belongs to.
pub(super) fn read(path: &Path, total: u64, metadata: Option<&Metadata>, task: Task<'_>) -> Extent {
    let Task {
        wanted,
        source,
        progress,
        visit,
    } = task;
    let opened =
        open::open(path, total, source).and_then(|connection| Ok((tables::read(&connection, metadata)?, connection)));
    let (tables, connection) = match opened {
        Ok(opened) => opened,
        Err(why) => {
            let message = missing_end(path, total).map_or_else(|| why.clone(), |missing| format!("{why}; {missing}"));
            source.problem(ReadStatus::Unreadable, Place::whole(source.id), message);
            return Extent {
                truncated: true,
                ..Extent::default()
            };
        }
    };
    let mut pass = Pass::new(&connection, tables, total, progress, visit);
    pass.last_page = cut_page(path, total);
    let sampling = wanted
        .sampling
        .filter(|sampling| total > sampling.bytes && pass.tables.indexed);
    // Not every page of a file is read if it is read in windows.
    let damage = if sampling.is_none() {
        inconsistency(&connection)
    } else {
        None
    };
    pass.damaged_page = damage.as_ref().map(|_| page_size(&connection));
    let extent = if let Some(sampling) = sampling {
        sample::read(&mut pass, &sampling, &wanted)
    } else {
        pass.announce_channels();
        pass.whole();
        let all = pass.messages + pass.orphans + pass.too_large + pass.unfit + pass.cut_off + pass.doubted;
        Extent {
            whole: true,
            messages_total: pass.stopped.is_none().then_some(all),
            ..Extent::default()
        }
    };
    let truncated = report(&pass, path, extent.whole, source) | damage.is_some();
    if let Some(damage) = damage.filter(|_| pass.stopped.is_none()) {
        let message = format!("SQLite reports damage, messages may contain bytes of other messages: {damage}");
        source.problem_with_help(
            ReadStatus::Partial,
            Place::whole(source.id),
            message,
            Some(RESCUE.to_owned()),
        );
    }
    (pass.progress)(total, total);
    Extent {
        truncated,
        indexed: pass.tables.indexed,
        ..extent
    }
}

/// First and last log time of a database, nanoseconds, if its index states it.
pub(super) fn span(path: &Path, total: u64) -> Option<(i64, i64)> {
    let mut nobody = Source::new(crate::source::SourceId(0), "", crate::source::SourceKind::Sqlite);
    let connection = open::open(path, total, &mut nobody).ok()?;
    let tables = tables::read(&connection, None).ok()?;
    tables.indexed.then(|| sample::span(&connection))?
}

/// What SQLite's own check of the pages reports, if anything: overwritten pages of a long message are otherwise read without an error.
fn inconsistency(connection: &Connection) -> Option<String> {
    let said = connection.query_row("PRAGMA quick_check(1)", [], |row| row.get::<_, String>(0));
    match said {
        Ok(said) if said == "ok" => None,
        Ok(said) => Some(said.split_whitespace().collect::<Vec<_>>().join(" ")),
        Err(error) => Some(error.to_string()),
    }
}

/// Bytes of a page; of the largest possible one where the size is not known.
fn page_size(connection: &Connection) -> usize {
    let size = connection.query_row("PRAGMA page_size", [], |row| row.get::<_, u32>(0));
    size.unwrap_or(1 << 16) as usize
}

/// What to do with a damaged database.
const RESCUE: &str = "run `sqlite3 damaged.db3 .recover | sqlite3 repaired.db3` to save what is readable; record again if the rest matters";

/// Reports how far reading went; returns whether messages may be missing.
fn report(pass: &Pass<'_, '_>, path: &Path, whole: bool, source: &mut Source) -> bool {
    let place = Place::whole(source.id);
    source.examined.messages = Some(pass.messages);
    source.examined.bytes = if whole && pass.stopped.is_none() {
        pass.total
    } else {
        pass.bytes.min(pass.total)
    };
    let mut missing = false;
    let status = if pass.messages == 0 {
        ReadStatus::Unreadable
    } else {
        ReadStatus::Partial
    };
    if let Some(why) = &pass.stopped {
        missing = true;
        let after = pass.messages;
        let what = missing_end(path, pass.total).unwrap_or_else(|| "damaged".to_owned());
        let message = match pass.lost {
            None => format!("{what}: {after} messages were read, then: {why}"),
            Some(((first, last), count)) => {
                let more = if count > 1 {
                    format!(" and {} more ranges", count - 1)
                } else {
                    String::new()
                };
                format!("{what}: rows {first} to {last}{more} could not be read: {why}; {after} messages were read")
            }
        };
        source.problem_with_help(status, place.clone(), message, Some(RESCUE.to_owned()));
    } else if let Some(end) = missing_end(path, pass.total) {
        missing = true;
        let message = format!("{end}: {} messages were read", pass.messages);
        source.problem_with_help(status, place.clone(), message, Some(RESCUE.to_owned()));
    }
    if let Some(why) = &pass.tables.fault {
        missing = true;
        let message = format!("its topics or definitions could not all be read: {why}");
        source.problem(ReadStatus::Partial, place.clone(), message);
    }
    for (count, what) in [
        (
            pass.orphans,
            "messages belong to topics that the database does not define",
        ),
        (pass.too_large, "messages are larger than 128 MB and were skipped"),
        (
            pass.cut_off,
            "messages continue past the end of the file and were skipped",
        ),
        (
            pass.doubted,
            "messages just before unreadable rows were skipped: their ends may be damaged",
        ),
        (pass.unfit, "messages have no time or no data and were skipped"),
    ] {
        if count > 0 {
            missing = true;
            source.problem(ReadStatus::Partial, place.clone(), format!("{count} {what}"));
        }
    }
    missing
}

/// The remaining bytes of the page in which the file ends too early.
fn cut_page(path: &Path, total: u64) -> Option<LastPage> {
    let (size, pages) = claimed(path)?;
    let here = total % size;
    if here == 0 || size * pages <= total {
        return None;
    }
    let mut file = File::open(path).ok()?;
    file.seek(SeekFrom::Start(total - here)).ok()?;
    let mut bytes = vec![0; usize::try_from(here).ok()?];
    file.read_exact(&mut bytes).ok()?;
    Some(LastPage::new(bytes, usize::try_from(size).ok()?))
}

/// The message about a file that is shorter than its header claims: cut off, or with bytes lost inside.
fn missing_end(path: &Path, total: u64) -> Option<String> {
    let (size, pages) = claimed(path)?;
    let claimed = size * pages;
    let percent = 100.0 * total as f64 / claimed as f64;
    (claimed > total)
        .then(|| format!("the file has {total} of the {claimed} bytes that its header claims ({percent:.1} %)"))
}

/// Bytes of a page and number of pages that a database's header claims.
fn claimed(path: &Path) -> Option<(u64, u64)> {
    let mut head = [0; 32];
    File::open(path).ok()?.read_exact(&mut head).ok()?;
    // Page size at byte 16, version of the last change at 24, number of pages at 28.
    let [.., p1, p0, _, _, _, _, _, _, _, _, _, _, n3, n2, n1, n0] = head;
    let page = match u64::from(u16::from_be_bytes([p1, p0])) {
        1 => 65_536,
        size => size,
    };
    let pages = u64::from(u32::from_be_bytes([n3, n2, n1, n0]));
    (page >= 512 && page.is_power_of_two()).then_some((page, pages))
}

/// The single row of one of our queries, a number.
fn number(connection: &Connection, sql: &str) -> Option<i64> {
    connection.query_row(sql, [], |row| row.get::<_, i64>(0)).ok()
}
