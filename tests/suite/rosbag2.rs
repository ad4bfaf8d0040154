//! rosbag2 recordings: databases of every distribution, their compression and what stands beside them.

#![allow(clippy::unwrap_used, clippy::indexing_slicing)]

use std::fs;
use std::path::{Path, PathBuf};

use crate::support;
use crate::support::damage::cut;
use crate::support::reading::{folder, found, messages};
use crate::support::recipe::{DRIVE, MESSAGES};
use crate::support::rosbag2::{Db3, Drive, Schema, Yaml, write_parts, zstd_file};
use crate::support::{bag, collected_from};
use frames_lint::source::ReadStatus;
use frames_lint::world::bag::BagEvidence;

/// What must not depend on how a drive was stored.
fn essence(bag: &BagEvidence) -> String {
    let topics: Vec<_> = bag
        .topics
        .values()
        .map(|topic| {
            (
                topic.topic.clone(),
                topic.message_type.clone(),
                topic.count,
                topic.latched,
                topic.stamps.clone(),
            )
        })
        .collect();
    said(&(topics, &bag.tf, bag.start_ns, bag.end_ns, bag.messages))
}

/// Evidence as text: some of its numbers are NaN, which equals nothing.
fn said(evidence: &impl std::fmt::Debug) -> String {
    format!("{evidence:?}")
}

#[test]
fn a_database_of_every_distribution_shows_what_the_mcap_shows() {
    let folder = folder();
    let drive = Drive::of(DRIVE);
    drive.write_mcap(&folder.path().join("drive.mcap"));
    let (_, mcap) = collected_from(&folder.path().join("drive.mcap"));
    for indexed in [true, false] {
        for schema in [Schema::Dashing, Schema::Humble, Schema::Jazzy] {
            for page_size in [512, 4096, 65_536] {
                let layout = Db3 {
                    schema,
                    indexed,
                    page_size,
                };
                let path = folder.path().join(format!("{schema:?}-{indexed}-{page_size}.db3"));
                drive.write_db3(&path, layout);
                let (source, collected) = found(&path);
                assert_eq!(source.status, ReadStatus::Read, "{layout:?}: {source:?}");
                assert_eq!(source.examined.bytes, fs::metadata(&path).unwrap().len());
                let (is, should) = (bag(&collected), bag(&mcap));
                assert_eq!((is.messages, is.truncated), (MESSAGES, false), "{layout:?}");
                assert!(said(&is.tf) == said(&should.tf), "{layout:?}");
                if schema == Schema::Jazzy {
                    assert!(essence(is) == essence(should), "{layout:?}");
                }
            }
        }
    }
}

#[test]
fn messages_come_in_order_of_time_whatever_order_they_were_written_in() {
    let folder = folder();
    let drive = Drive::of(DRIVE);
    let mut shuffled = drive.clone();
    shuffled
        .messages
        .sort_by_key(|message| message.log_ns.wrapping_mul(2_654_435_761) % 1009);
    assert_ne!(drive.messages, shuffled.messages);
    for indexed in [true, false] {
        let path = folder.path().join(format!("{indexed}.db3"));
        let layout = Db3 {
            indexed,
            ..Db3::default()
        };
        shuffled.write_db3(&path, layout);
        let (_, collected) = found(&path);
        let imu = &bag(&collected).topics["/imu"].stamps;
        assert_eq!((imu.count, imu.backward), (600, 0));
    }
}

#[test]
fn a_database_of_something_else_is_told_apart() {
    let folder = folder();
    let cases = [
        (
            "CREATE TABLE users(id INTEGER); CREATE TABLE orders(id INTEGER);",
            "its tables are `orders`, `users`",
        ),
        (
            "CREATE TABLE topics(id, name, type); CREATE TABLE messages(id, body);",
            "`messages` has no column",
        ),
        (
            "CREATE TABLE topics(id); CREATE TABLE messages(topic_id, timestamp, data);",
            "`topics` has no column `name`",
        ),
        (
            "CREATE TABLE topics(id, name, type); CREATE VIEW messages AS WITH RECURSIVE n(i) AS (SELECT 1 UNION ALL \
             SELECT i + 1 FROM n) SELECT i AS topic_id, i AS timestamp, i AS data FROM n;",
            "its tables are `topics`",
        ),
        ("CREATE TABLE t(x); DROP TABLE t;", "it holds no tables"),
    ];
    for (number, (sql, expected)) in cases.into_iter().enumerate() {
        let path = folder.path().join(format!("{number}.db3"));
        rusqlite::Connection::open(&path).unwrap().execute_batch(sql).unwrap();
        let (source, collected) = found(&path);
        assert_eq!(source.status, ReadStatus::Unreadable, "{source:?}");
        let detail = source.detail.unwrap();
        assert!(
            detail.starts_with("an SQLite database, but not a rosbag2 recording"),
            "{detail}"
        );
        assert!(detail.contains(expected), "{detail}");
        assert!(bag(&collected).truncated);
    }
    let words: [(&[u8], &str); 4] = [
        (b"", "the file is empty"),
        (
            b"version https://git-lfs.github.com/spec/v1\n",
            "not a rosbag2 database: this is a Git LFS pointer",
        ),
        (
            b"BZh91AY",
            "not a rosbag2 database: this is a file compressed with bzip2",
        ),
        (
            &[7; 600],
            "not a rosbag2 database: the magic bytes at byte 0 are missing",
        ),
    ];
    for (bytes, expected) in words {
        let path = folder.path().join("x.db3");
        fs::write(&path, bytes).unwrap();
        let (source, _) = found(&path);
        let detail = source.detail.unwrap();
        assert!(detail.starts_with(expected), "{detail}");
    }
}

#[test]
fn rows_that_are_no_messages_are_counted_and_left_out() {
    let folder = folder();
    let path = folder.path().join("odd.db3");
    let drive = Drive::of(DRIVE);
    let database = Db3::default().create(&path);
    drive.fill(&database, Db3::default());
    let sql = "CREATE TABLE odd AS SELECT * FROM messages; DROP TABLE messages; ALTER TABLE odd RENAME TO messages;
               INSERT INTO messages VALUES(5000, 77, 1, x'00010000');
               INSERT INTO messages VALUES(5001, 1, NULL, x'00010000');
               INSERT INTO messages VALUES(5002, 1, 'noon', x'00010000');
               INSERT INTO messages VALUES(5003, 1, 2, NULL);
               INSERT INTO messages VALUES(5004, 1, 2, zeroblob(134217729));";
    database.execute_batch(sql).unwrap();
    drop(database);
    let (source, collected) = found(&path);
    assert_eq!(
        (source.status, bag(&collected).messages),
        (ReadStatus::Partial, MESSAGES)
    );
    let said = messages(&source).join("\n");
    for expected in [
        "1 messages belong to topics that the database does not define",
        "1 messages are larger than 128 MB and were skipped",
        "3 messages have no time or no data and were skipped",
    ] {
        assert!(said.contains(expected), "{said}");
    }
}

/// Names and contents of a folder.
fn contents(folder: &Path) -> Vec<(PathBuf, Vec<u8>)> {
    let paths = support::files(folder, "");
    paths
        .into_iter()
        .map(|path| (path.clone(), fs::read(path).unwrap()))
        .collect()
}

#[test]
fn a_recorder_that_was_stopped_leaves_a_log_which_is_read_and_nothing_is_written() {
    let (live, copy) = (folder(), folder());
    let path = live.path().join("drive_0.db3");
    let drive = Drive::of(DRIVE);
    let database = Db3::default().create(&path);
    database
        .execute_batch("PRAGMA journal_mode = WAL; PRAGMA wal_autocheckpoint = 0;")
        .unwrap();
    drive.fill(&database, Db3::default());
    for ending in ["db3", "db3-wal"] {
        let name = format!("drive_0.{ending}");
        fs::copy(live.path().join(&name), copy.path().join(&name)).unwrap();
    }
    let path = copy.path().join("drive_0.db3");
    let before = contents(copy.path());
    let (source, collected) = found(&path);
    assert_eq!(
        (source.status, bag(&collected).messages),
        (ReadStatus::Read, MESSAGES),
        "{source:?}"
    );
    assert_eq!(contents(copy.path()), before);

    // Without the log only the tables are there.
    fs::remove_file(copy.path().join("drive_0.db3-wal")).unwrap();
    let (_, collected) = found(&path);
    assert_eq!(bag(&collected).messages, 0);
    assert_eq!(support::files(copy.path(), "").len(), 1);

    fs::write(copy.path().join("drive_0.db3-journal"), [1; 512]).unwrap();
    let (source, _) = found(&path);
    assert!(
        messages(&source)[0].starts_with("a rollback journal is next to it"),
        "{source:?}"
    );
    drop(database);
}

#[test]
fn zstd_by_file_and_by_message_changes_nothing() {
    let drive = Drive::of(DRIVE);
    for ending in ["db3", "mcap"] {
        for mode in ["", "FILE", "MESSAGE"] {
            let folder = folder();
            let inner = if mode == "MESSAGE" {
                drive.zstd_by_message()
            } else {
                drive.clone()
            };
            let mut paths = write_parts(&inner.split(2), folder.path(), ending);
            if mode == "FILE" {
                paths = paths.iter().map(|path| zstd_file(path)).collect();
            }
            let mut yaml = Yaml::of(&paths);
            yaml.mode = mode;
            yaml.write(&drive, folder.path());
            let (source, collected) = found(folder.path());
            assert_eq!(source.status, ReadStatus::Read, "{ending} {mode}: {source:?}");
            assert_eq!((bag(&collected).messages, bag(&collected).tf.len()), (MESSAGES, 2));
            let sizes: u64 = paths.iter().map(|path| fs::metadata(path).unwrap().len()).sum();
            assert_eq!((source.examined.bytes, source.examined.bytes_total), (sizes, sizes));

            let (source, collected) = found(&paths[0]);
            assert_eq!(
                (source.status, bag(&collected).messages),
                (ReadStatus::Read, 451),
                "{source:?}"
            );
        }
    }
}

#[test]
fn compressed_messages_that_are_damaged_are_counted() {
    let folder = folder();
    let path = folder.path().join("drive.db3");
    let mut drive = Drive::of(DRIVE).zstd_by_message();
    for (number, message) in drive
        .messages
        .iter_mut()
        .enumerate()
        .filter(|(number, _)| number % 100 == 0)
    {
        match number % 300 {
            0 => message.data.truncate(message.data.len() / 2),
            // The frame claims 2^60 bytes: an eight-byte size in one segment.
            100 => message.data = [&[0x28, 0xb5, 0x2f, 0xfd, 0xe0][..], &(1_u64 << 60).to_le_bytes()].concat(),
            _ => message.data.truncate(5),
        }
    }
    drive.write_db3(&path, Db3::default());
    let (source, collected) = found(&path);
    assert_eq!(
        (source.status, bag(&collected).messages),
        (ReadStatus::Partial, MESSAGES - 10)
    );
    assert_eq!(source.examined.messages, Some(MESSAGES - 10));
    let said = messages(&source)[0];
    assert!(
        said.starts_with("10 of 901 compressed messages cannot be decompressed"),
        "{said}"
    );
}

#[test]
fn a_compressed_file_that_was_cut_is_read_up_to_the_cut() {
    let folder = folder();
    for ending in ["db3", "mcap"] {
        let path = folder.path().join(format!("x.{ending}"));
        match ending {
            "db3" => Drive::of(DRIVE).write_db3(&path, Db3::default()),
            _ => Drive::of(DRIVE).write_mcap(&path),
        }
        let packed = zstd_file(&path);
        let bytes = fs::read(&packed).unwrap();
        for percent in [0, 1, 10, 50, 90, 99] {
            fs::write(&packed, cut(&bytes, percent)).unwrap();
            let (source, collected) = found(&packed);
            assert_ne!(source.status, ReadStatus::Read, "{ending} {percent}");
            assert!(bag(&collected).truncated, "{ending} {percent}");
            assert!(source.examined.bytes <= source.examined.bytes_total);
        }
        fs::write(&packed, zstd::encode_all(&b"a letter"[..], 1).unwrap()).unwrap();
        let (source, _) = found(&packed);
        let detail = source.detail.unwrap();
        assert_eq!(detail, "the file is compressed with zstd but contains no recording");
    }
}
