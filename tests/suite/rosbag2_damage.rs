//! Databases that are damaged or hostile: read as far as they go, and never twice.

#![allow(clippy::unwrap_used, clippy::indexing_slicing, clippy::cast_possible_wrap)]

use std::collections::BTreeSet;
use std::fs;
use std::path::PathBuf;

use crate::support;
use crate::support::damage::{cut, patched};
use crate::support::reading::{folder, read, sparse};
use crate::support::recipe::DRIVE;
use crate::support::rosbag2::{Db3, Drive, Schema};
use frames_lint::source::ReadStatus;

/// The drive as a database: the folder it lies in, its path and its bytes.
fn database(layout: Db3) -> (tempfile::TempDir, PathBuf, Vec<u8>) {
    let folder = folder();
    let path = folder.path().join("drive.db3");
    Drive::of(DRIVE).write_db3(&path, layout);
    let bytes = fs::read(&path).unwrap();
    (folder, path, bytes)
}

#[test]
fn a_database_cut_at_any_percent_gives_what_can_be_reached() {
    for layout in [
        Db3 {
            page_size: 512,
            ..Db3::default()
        },
        Db3::default(),
        Db3 {
            indexed: false,
            ..Db3::default()
        },
    ] {
        let (_folder, path, bytes) = database(layout);
        let mut most = 0;
        for percent in 0..100 {
            fs::write(&path, cut(&bytes, percent)).unwrap();
            let (source, extent, heard) = read(&path, None);
            let what = format!("{layout:?} cut at {percent} %: {source:?}");
            assert_ne!(source.status, ReadStatus::Read, "{what}");
            assert!(extent.truncated, "{what}");
            assert_eq!(
                source.status == ReadStatus::Unreadable,
                heard.messages.is_empty(),
                "{what}"
            );
            let said = &source.problems[0].message;
            assert!(percent < 2 || said.contains("bytes that its header claims"), "{what}");
            assert!(heard.messages.len() < 901, "{what}");
            assert!(source.examined.bytes <= source.examined.bytes_total, "{what}");
            let different: BTreeSet<_> = heard.messages.iter().collect();
            assert_eq!(different.len(), heard.messages.len(), "{what}");
            most = most.max(heard.messages.len());
        }
        assert!(most > 700, "{layout:?}: at most {most} messages of a cut file");
    }
}

#[test]
fn a_cut_in_the_middle_keeps_the_first_half() {
    let (_folder, path, bytes) = database(Db3::default());
    fs::write(&path, cut(&bytes, 50)).unwrap();
    let (source, _, heard) = read(&path, None);
    assert_eq!(source.status, ReadStatus::Partial, "{source:?}");
    assert!((350..600).contains(&heard.messages.len()), "{}", heard.messages.len());
}

#[test]
fn flipped_bits_and_missing_pages_never_break_the_reader() {
    let (_folder, path, bytes) = database(Db3::default());
    let mut rng = fastrand::Rng::with_seed(1);
    let mut random = |below: usize| rng.usize(..below);
    for round in 0..300 {
        let mut damaged = bytes.clone();
        if round % 3 == 0 {
            let page = random(bytes.len() / 4096) * 4096;
            damaged[page..page + 4096].fill(if round % 2 == 0 { 0 } else { 0xff });
        } else {
            // Heads of pages decide more than messages do.
            let at = if round % 3 == 1 {
                random(bytes.len())
            } else {
                random(bytes.len() / 4096) * 4096 + random(100)
            };
            damaged[at] ^= 1 << random(8);
        }
        fs::write(&path, &damaged).unwrap();
        for sampling in [None, Some(sparse())] {
            let (source, extent, heard) = read(&path, sampling);
            assert!(heard.messages.len() <= 901);
            assert!(source.status == ReadStatus::Read || extent.truncated, "{source:?}");
            assert!(source.status == ReadStatus::Read || !source.problems.is_empty());
        }
    }
}

#[test]
fn a_damaged_index_costs_no_messages() {
    let (_folder, path, bytes) = database(Db3::default());
    let root: u32 = {
        let database = rusqlite::Connection::open(&path).unwrap();
        let sql = "SELECT rootpage FROM sqlite_schema WHERE name = 'timestamp_idx'";
        database.query_row(sql, [], |row| row.get(0)).unwrap()
    };
    let spoilt = patched(&bytes, (root as usize - 1) * 4096, &[0xff; 4096]);
    fs::write(&path, spoilt).unwrap();
    let (source, extent, heard) = read(&path, None);
    assert_eq!((source.status, extent.truncated), (ReadStatus::Partial, true));
    assert_eq!(heard.messages.len(), 901);
}

#[test]
fn an_index_that_leads_in_a_circle_ends() {
    let (_folder, path, bytes) = database(Db3::default());
    // Interior pages of the table (5) and of the index (2): every child becomes the first one.
    for page in (0..bytes.len()).step_by(4096) {
        let head = if page == 0 { 100 } else { page };
        if !matches!(bytes[head], 2 | 5) {
            continue;
        }
        let cells = u16::from_be_bytes([bytes[head + 3], bytes[head + 4]]) as usize;
        let cell = |number: usize| {
            let at = head + 12 + 2 * number;
            page + u16::from_be_bytes([bytes[at], bytes[at + 1]]) as usize
        };
        let mut circle = bytes.clone();
        let first: [u8; 4] = bytes[cell(0)..cell(0) + 4].try_into().unwrap();
        for number in 1..cells {
            circle[cell(number)..cell(number) + 4].copy_from_slice(&first);
        }
        circle[head + 8..head + 12].copy_from_slice(&first);
        fs::write(&path, &circle).unwrap();
        for sampling in [None, Some(sparse())] {
            let (source, extent, heard) = read(&path, sampling);
            assert!(heard.messages.len() <= 901, "{}", heard.messages.len());
            heard.check();
            if sampling.is_none() {
                assert!(
                    extent.truncated && source.status != ReadStatus::Read,
                    "page {}: {source:?}",
                    page / 4096 + 1
                );
            }
        }
    }
}

#[test]
fn real_databases_are_read_to_the_last_message() {
    let Some(folder) = support::real_bags() else { return };
    let databases = support::files(&folder, ".db3");
    assert!(databases.len() > 10);
    for path in databases {
        let uri = format!("file:{}?immutable=1", path.display().to_string().replace('+', "%2B"));
        let flags = rusqlite::OpenFlags::SQLITE_OPEN_READ_ONLY | rusqlite::OpenFlags::SQLITE_OPEN_URI;
        let database = rusqlite::Connection::open_with_flags(uri, flags).unwrap();
        let count: i64 = database
            .query_row("SELECT count(*) FROM messages", [], |row| row.get(0))
            .unwrap();
        let (source, extent, heard) = read(&path, None);
        assert_eq!(source.status, ReadStatus::Read, "{source:?}");
        assert_eq!(
            (heard.messages.len() as i64, extent.truncated),
            (count, false),
            "{}",
            path.display()
        );
        assert!(heard.messages.is_sorted_by_key(|(_, at, _)| *at));
        let (source, _, sampled) = read(&path, Some(sparse()));
        assert_eq!(source.status, ReadStatus::Read, "{source:?}");
        for channel in &heard.channels {
            assert_eq!(heard.count(&channel.topic) == 0, sampled.count(&channel.topic) == 0);
        }
    }
    for path in support::files(&folder, ".mcap.zstd") {
        let (source, _, heard) = read(&path, None);
        assert_eq!(
            (source.status, heard.messages.len()),
            (ReadStatus::Read, 693),
            "{source:?}"
        );
    }
    for path in support::files(&folder, "metadata.yaml") {
        let (source, extent, _) = read(&path, None);
        assert_eq!(
            (source.status, extent.truncated),
            (ReadStatus::Read, false),
            "{source:?}"
        );
        assert!(source.problems.is_empty(), "{source:?}");
    }
}

#[test]
fn definitions_without_end_are_bounded() {
    let folder = folder();
    let path = folder.path().join("many.db3");
    let database = Db3 {
        schema: Schema::Humble,
        ..Db3::default()
    }
    .create(&path);
    let sql = "WITH RECURSIVE n(i) AS (SELECT 1 UNION ALL SELECT i + 1 FROM n WHERE i < 70000)
               INSERT INTO topics SELECT i, '/t' || i, 'a/msg/B', 'cdr', '' FROM n;
               INSERT INTO messages VALUES(1, 69999, 5, x'00010000');";
    database.execute_batch(sql).unwrap();
    drop(database);
    let (source, extent, heard) = read(&path, None);
    assert_eq!((source.status, extent.truncated), (ReadStatus::Partial, true));
    assert_eq!((heard.channels.len(), heard.messages.len()), (65_536, 0));
}
