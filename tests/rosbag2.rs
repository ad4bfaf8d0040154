//! rosbag2 recordings: databases of every distribution, folders with metadata, compression, splits.

#![allow(
    clippy::unwrap_used,
    clippy::expect_used,
    clippy::indexing_slicing,
    clippy::panic,
    clippy::cast_possible_truncation,
    clippy::cast_possible_wrap
)]

mod support;

use std::fs;
use std::path::{Path, PathBuf};

use frames_lint::collect::{Collected, How, collect};
use frames_lint::read::discover::{Input, discover};
use frames_lint::source::{At, ReadStatus, Source, SourceId, SourceKind};
use frames_lint::world::bag::BagEvidence;
use support::rosbag2::{Db3, Drive, Schema, Yaml, write_parts, zstd_file};
use support::{bag, collected_from};

const DRIVE: &str = "
duration_s: 6
topics:
  - {topic: /tf_static, transforms: [{parent: base_link, child: imu}]}
  - topic: /tf
    rate_hz: 50
    transforms: [{parent: odom, child: base_link, velocity: [1, 0, 0], yaw_rate_deg_s: 5}]
  - {topic: /imu, type: sensor_msgs/msg/Imu, rate_hz: 100, frame_id: imu}
";
/// 1 + 300 + 600.
const MESSAGES: u64 = 901;

fn folder() -> tempfile::TempDir {
    tempfile::tempdir().unwrap()
}

/// Collects an input as the engine does.
fn collect_input(input: &Input) -> (Source, Collected) {
    let mut source = Source::new(SourceId(0), input.display.clone(), input.kind);
    let parts = if input.kind == SourceKind::Rosbag2 {
        Vec::new()
    } else {
        input.parts.clone()
    };
    let how = How {
        parts,
        ..How::default()
    };
    let collected = collect(&input.path, &how, &mut source, &|_, _| {});
    (source, collected)
}

/// The one input that is found at a path, collected.
fn found(path: &Path) -> (Source, Collected) {
    let inputs = discover(&[path.to_path_buf()]).files;
    assert_eq!(inputs.len(), 1, "{inputs:#?}");
    collect_input(&inputs[0])
}

fn messages(source: &Source) -> Vec<&str> {
    source.problems.iter().map(|problem| problem.message.as_str()).collect()
}

/// What must not depend on how a drive was stored.
fn essence(bag: &BagEvidence) -> impl PartialEq + std::fmt::Debug + use<> {
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
    (topics, bag.tf.clone(), bag.start_ns, bag.end_ns, bag.messages)
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
                assert_eq!(is.tf, should.tf, "{layout:?}");
                if schema == Schema::Jazzy {
                    assert_eq!(essence(is), essence(should), "{layout:?}");
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
            detail.starts_with("an SQLite database, but no rosbag2 recording"),
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
        (&[7; 600], "not a rosbag2 database: magic missing at byte 0"),
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
        "1 messages are larger than 128 MB and were left out",
        "3 messages have no time or no bytes and were left out",
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
        messages(&source)[0].starts_with("a rollback journal stands beside it"),
        "{source:?}"
    );
    drop(database);
}

#[test]
fn a_folder_is_one_recording_however_it_is_named() {
    for ending in ["db3", "mcap"] {
        let outer = folder();
        let inner = outer.path().join("runs/drive");
        fs::create_dir_all(&inner).unwrap();
        let drive = Drive::of(DRIVE);
        write_parts(&drive.split(3), &inner, ending);
        let names = [0, 1, 2].map(|number| format!("drive_{number}.{ending}"));
        let storage = if ending == "db3" { "sqlite3" } else { "mcap" };
        let yaml = Yaml::new(storage, &names.each_ref().map(String::as_str));
        fs::write(inner.join("metadata.yaml"), yaml.text(&drive)).unwrap();
        fs::write(outer.path().join("calib.yaml"), "base_from_lidar: {x: 1}\n").unwrap();

        for named in [inner.clone(), inner.join("metadata.yaml")] {
            let (source, collected) = found(&named);
            assert_eq!(
                (source.kind, source.status),
                (SourceKind::Rosbag2, ReadStatus::Read),
                "{source:?}"
            );
            assert!(source.path.ends_with("drive/metadata.yaml"), "{}", source.path);
            assert_eq!(source.detail.as_deref(), Some("3 files read as one recording"));
            assert_eq!(source.examined.bytes, source.examined.bytes_total);
            let bag = bag(&collected);
            assert_eq!((bag.messages, bag.truncated, bag.share.whole), (MESSAGES, false, true));
            let parts = bag
                .parts
                .iter()
                .map(|part| (part.path.clone(), part.messages, part.static_transforms));
            let parts: Vec<_> = parts.collect();
            let [a, b, c] = names.clone();
            assert_eq!(parts, [(a, 301, true), (b, 301, false), (c, 299, false)]);
            assert!(bag.parts.windows(2).all(|pair| pair[0].end_ns <= pair[1].start_ns));
            assert_eq!(bag.tf.len(), 2);
            assert_eq!(bag.topics["/imu"].stamps.long_gaps, 0);
        }

        let inputs = discover(&[outer.path().to_path_buf(), inner.join(&names[1]), inner.clone()]).files;
        let kinds: Vec<_> = inputs.iter().map(|input| input.kind).collect();
        assert_eq!(kinds, [SourceKind::Yaml, SourceKind::Rosbag2], "{inputs:#?}");

        let (source, collected) = found(&inner.join(&names[1]));
        assert_eq!((source.status, bag(&collected).messages), (ReadStatus::Read, 301));
        let detail = source.detail.unwrap();
        assert!(
            detail.starts_with("one of the 3 files that `metadata.yaml` beside it names"),
            "{detail}"
        );
    }
}

#[test]
fn qos_profiles_come_from_the_metadata_where_the_database_has_none() {
    let drive = Drive::of(DRIVE);
    for version in [4, 9] {
        let folder = folder();
        let path = folder.path().join("drive_0.db3");
        let layout = Db3 {
            schema: Schema::Dashing,
            ..Db3::default()
        };
        drive.write_db3(&path, layout);
        let (_, bare) = found(&path);
        assert!(bag(&bare).topics.values().all(|topic| !topic.latched));
        let mut yaml = Yaml::new("sqlite3", &["drive_0.db3"]);
        yaml.version = version;
        fs::write(folder.path().join("metadata.yaml"), yaml.text(&drive)).unwrap();
        for named in [folder.path().to_path_buf(), path] {
            let (source, collected) = found(&named);
            assert_eq!(source.status, ReadStatus::Read, "{source:?}");
            let topics = &bag(&collected).topics;
            assert!(
                topics["/tf_static"].latched && !topics["/tf"].latched,
                "version {version}"
            );
            let said = topics["/tf"].offered_qos_profiles.clone().unwrap();
            let wanted = drive.topics.iter().find(|topic| topic.name == "/tf").unwrap();
            assert_eq!(said.trim(), wanted.qos.trim(), "version {version}");
        }
    }
}

#[test]
fn zstd_by_file_and_by_message_changes_nothing() {
    let drive = Drive::of(DRIVE);
    for ending in ["db3", "mcap"] {
        let storage = if ending == "db3" { "sqlite3" } else { "mcap" };
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
            let names: Vec<_> = paths
                .iter()
                .map(|path| path.file_name().unwrap().to_str().unwrap())
                .collect();
            let mut yaml = Yaml::new(storage, &names);
            yaml.mode = mode;
            fs::write(folder.path().join("metadata.yaml"), yaml.text(&drive)).unwrap();
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
        said.starts_with("10 of 901 compressed messages do not decompress"),
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
            fs::write(&packed, &bytes[..bytes.len() * percent / 100]).unwrap();
            let (source, collected) = found(&packed);
            assert_ne!(source.status, ReadStatus::Read, "{ending} {percent}");
            assert!(bag(&collected).truncated, "{ending} {percent}");
            assert!(source.examined.bytes <= source.examined.bytes_total);
        }
        fs::write(&packed, zstd::encode_all(&b"a letter"[..], 1).unwrap()).unwrap();
        let (source, _) = found(&packed);
        let detail = source.detail.unwrap();
        assert_eq!(detail, "the file is compressed with zstd and holds no recording");
    }
}

#[test]
fn files_that_continue_each_other_are_one_recording_without_metadata() {
    let drive = Drive::of(DRIVE);
    for ending in ["db3", "mcap"] {
        let folder = folder();
        let paths = write_parts(&drive.split(4), folder.path(), ending);
        let (source, collected) = found(folder.path());
        assert_eq!(
            (source.status, bag(&collected).messages),
            (ReadStatus::Read, MESSAGES),
            "{source:?}"
        );
        let detail = source.detail.unwrap();
        assert_eq!(
            detail,
            format!("4 files read as one recording: drive_0.{ending} ... drive_3.{ending}")
        );
        assert_eq!(bag(&collected).parts.len(), 4);
        // Named one by one, as a shell does with `drive_*`.
        let named = discover(&paths).files;
        assert_eq!(named.len(), 1, "{named:#?}");
        let (source, _) = found(&paths[2]);
        assert_eq!((source.status, source.examined.messages), (ReadStatus::Read, Some(226)));

        // The recorder crashed while it wrote the last file.
        let last = fs::read(&paths[3]).unwrap();
        fs::write(&paths[3], &last[..last.len() * 2 / 3]).unwrap();
        let (source, collected) = found(folder.path());
        assert_eq!(source.status, ReadStatus::Partial);
        assert!(bag(&collected).truncated && bag(&collected).messages > MESSAGES * 3 / 4);
        assert!(
            messages(&source)[0].starts_with(&format!("drive_3.{ending}: ")),
            "{source:?}"
        );
    }
}

#[test]
fn separate_drives_that_are_numbered_stay_separate() {
    let drive = Drive::of(DRIVE);
    let count = |parts: &[Drive]| {
        let folder = folder();
        write_parts(parts, folder.path(), "mcap");
        discover(&[folder.path().to_path_buf()]).files.len()
    };
    let [first, second] = <[Drive; 2]>::try_from(drive.split(2)).unwrap();
    assert_eq!(count(&[first.clone(), second.clone()]), 1);
    assert_eq!(count(&[first.clone(), second.later(60)]), 2, "a pause of a minute");
    assert_eq!(count(&[drive.clone(), drive.later(2)]), 2, "at the same time");
    assert_eq!(count(&[second.clone(), first.clone()]), 2, "backwards");
    assert_eq!(
        count(&[first.clone(), second.clone(), drive.later(600)]),
        2,
        "two, and one"
    );
    let gap = folder();
    let paths = write_parts(&drive.split(3), gap.path(), "mcap");
    fs::remove_file(&paths[1]).unwrap();
    assert_eq!(
        discover(&[gap.path().to_path_buf()]).files.len(),
        2,
        "a number is missing"
    );
    fs::remove_file(&paths[0]).unwrap();
    assert_eq!(discover(&[gap.path().to_path_buf()]).files.len(), 1);
}

/// A folder with one database and this metadata.
fn with_yaml(change: impl Fn(&str) -> String) -> (tempfile::TempDir, Source, Collected) {
    let folder = folder();
    let drive = Drive::of(DRIVE);
    drive.write_db3(&folder.path().join("drive_0.db3"), Db3::default());
    let text = Yaml::new("sqlite3", &["drive_0.db3"]).text(&drive);
    let changed = change(&text);
    fs::write(folder.path().join("metadata.yaml"), changed).unwrap();
    let (source, collected) = found(folder.path());
    (folder, source, collected)
}

#[test]
fn metadata_that_says_other_than_the_files_is_quoted() {
    let cases = [
        (
            "message_count: 901",
            "message_count: 1000",
            "the metadata counts 1000 messages, the files hold 901",
            true,
        ),
        (
            "message_count: 901",
            "message_count: 800",
            "the metadata counts 800 messages, the files hold 901",
            false,
        ),
        (
            "type: sensor_msgs/msg/Imu",
            "type: sensor_msgs/msg/Image",
            "gives `/imu` the type `sensor_msgs/msg/Image`",
            false,
        ),
        (
            "name: /imu",
            "name: /gps",
            "names `/gps` with messages, the files do not hold the topic",
            true,
        ),
        (
            "identifier: sqlite3",
            "identifier: mcap",
            "says the files are `mcap`, but `drive_0.db3` is an SQLite database",
            false,
        ),
        (
            "version: 9",
            "version: 12",
            "version 12 of the metadata is newer than the last one known (9)",
            false,
        ),
        (
            "format: \"\"",
            "format: \"lz4\"",
            "compressed with `lz4`; only zstd is known",
            false,
        ),
        (
            "- drive_0.db3",
            "- drive_0.db3\n    - drive_1.db3",
            "names `drive_1.db3`, which is not there",
            true,
        ),
        (
            "- drive_0.db3",
            "- drive_0.db3\n    - ./drive_0.db3",
            "`./drive_0.db3` is named twice",
            false,
        ),
        ("since_epoch: 17", "since_epoch: 16", "the metadata's start is", false),
        (
            "duration:\n    nanoseconds: 5",
            "duration:\n    nanoseconds: 9",
            "the messages span 5.990 s",
            false,
        ),
    ];
    for (from, to, expected, is_partial) in cases {
        let (_folder, source, collected) = with_yaml(|text| {
            assert!(text.contains(from), "{from} in {text}");
            text.replacen(from, to, 1)
        });
        let problem = source
            .problems
            .iter()
            .find(|problem| problem.message.contains(expected));
        let problem = problem.unwrap_or_else(|| panic!("{expected}: {:#?}", source.problems));
        let At::Text(span) = problem.place.at else {
            panic!("{expected} has no place in the text")
        };
        let quoted = &source.text[span.start..span.end];
        let word = to.rsplit(['-', ' ', '\n']).next().unwrap();
        assert!(
            quoted.contains(word.trim_matches('"')) || word.contains(quoted),
            "{expected}: {quoted}"
        );
        let status = if is_partial {
            ReadStatus::Partial
        } else {
            ReadStatus::Read
        };
        assert_eq!(source.status, status, "{expected}");
        assert_eq!(bag(&collected).messages, MESSAGES);
    }
    let (_folder, source, collected) = with_yaml(str::to_owned);
    assert_eq!(
        (source.status, source.problems.len()),
        (ReadStatus::Read, 0),
        "{source:?}"
    );
    assert_eq!(bag(&collected).messages, MESSAGES);
}

#[test]
fn metadata_that_is_broken_does_not_keep_the_files_from_being_read() {
    for keep in [
        "  storage_identifier",
        "  message_count",
        "      message_count: 300",
        "  relative_file_paths",
    ] {
        let (_folder, source, collected) = with_yaml(|text| {
            let at = text.find(keep).unwrap();
            format!("{}  : [\n", &text[..at])
        });
        assert_eq!(
            (source.kind, source.status),
            (SourceKind::Rosbag2, ReadStatus::Partial),
            "{keep}"
        );
        assert!(messages(&source)[0].contains("could not be read further"), "{source:?}");
        assert_eq!(bag(&collected).messages, MESSAGES, "{keep}");
    }
    let (_folder, source, collected) = with_yaml(|_| "rosbag2_bagfile_information: 5\n".to_owned());
    assert_eq!((source.status, bag(&collected).messages), (ReadStatus::Read, MESSAGES));
}

#[test]
fn metadata_of_something_else_is_no_recording() {
    let folder = folder();
    fs::write(
        folder.path().join("metadata.yaml"),
        "base_from_lidar:\n  xyz: [1, 2, 3]\n",
    )
    .unwrap();
    Drive::of(DRIVE).write_mcap(&folder.path().join("drive.mcap"));
    let inputs = discover(&[folder.path().to_path_buf()]).files;
    let kinds: Vec<_> = inputs.iter().map(|input| input.kind).collect();
    assert_eq!(kinds, [SourceKind::Mcap, SourceKind::Yaml]);
    let (source, _) = found(&folder.path().join("drive.mcap"));
    assert_eq!((source.status, source.detail), (ReadStatus::Read, None));
}

#[test]
fn files_that_are_missing_or_damaged_are_named() {
    let folder = folder();
    let drive = Drive::of(DRIVE);
    let paths = write_parts(&drive.split(3), folder.path(), "db3");
    let names = ["drive_0.db3", "drive_1.db3", "drive_2.db3"];
    fs::write(
        folder.path().join("metadata.yaml"),
        Yaml::new("sqlite3", &names).text(&drive),
    )
    .unwrap();
    fs::write(&paths[1], b"version https://git-lfs.github.com/spec/v1\noid sha256:0\n").unwrap();
    let (source, collected) = found(folder.path());
    assert_eq!((source.status, bag(&collected).messages), (ReadStatus::Partial, 600));
    assert!(bag(&collected).truncated);
    assert!(
        messages(&source)[0].starts_with("drive_1.db3: not a recording: this is a Git LFS pointer"),
        "{source:?}"
    );

    fs::remove_file(&paths[1]).unwrap();
    let (source, collected) = found(folder.path());
    assert_eq!((source.status, bag(&collected).messages), (ReadStatus::Partial, 600));
    assert!(bag(&collected).truncated);

    fs::remove_file(&paths[0]).unwrap();
    fs::remove_file(&paths[2]).unwrap();
    let (source, _) = found(folder.path());
    assert_eq!(source.status, ReadStatus::Unreadable);
    assert_eq!(source.problems.len(), 4, "{source:?}");
}

#[test]
fn older_names_and_unnamed_files_are_found() {
    let outer = folder();
    let inner = outer.path().join("drive");
    fs::create_dir(&inner).unwrap();
    let drive = Drive::of(DRIVE);
    let [first, second] = <[Drive; 2]>::try_from(drive.split(2)).unwrap();
    first.write_db3(&inner.join("drive_0.db3"), Db3::default());
    let mut yaml = Yaml::new("sqlite3", &["drive/drive_0.db3"]);
    yaml.version = 2;
    fs::write(inner.join("metadata.yaml"), yaml.text(&first)).unwrap();
    let (source, collected) = found(&inner);
    assert_eq!(
        (source.status, bag(&collected).messages),
        (ReadStatus::Read, 451),
        "{source:?}"
    );

    second.write_db3(&inner.join("drive_1.db3"), Db3::default());
    let inputs = discover(std::slice::from_ref(&inner)).files;
    assert_eq!(inputs.len(), 2, "the metadata does not name the second file");
    let folder = inputs.iter().find(|input| input.kind == SourceKind::Rosbag2).unwrap();
    let (source, _) = collect_input(folder);
    assert!(
        messages(&source)[0].starts_with("`drive_1.db3` lies beside the files that are named here"),
        "{source:?}"
    );
}

#[test]
fn the_program_reads_a_folder_and_says_so() {
    let folder = folder();
    let drive = Drive::of(DRIVE);
    write_parts(&drive.split(2), folder.path(), "mcap");
    let yaml = Yaml::new("mcap", &["drive_0.mcap", "drive_1.mcap", "drive_2.mcap"]);
    fs::write(folder.path().join("metadata.yaml"), yaml.text(&drive)).unwrap();
    let ran = support::program::run(folder.path(), ["check", ".", "--format", "json"]);
    let report = ran.report();
    let input = &report["inputs"][0];
    assert_eq!(
        (input["kind"].as_str(), input["status"].as_str()),
        (Some("rosbag2"), Some("partial"))
    );
    assert_eq!(input["examined"]["messages"].as_u64(), Some(MESSAGES));
    let text = support::program::run(folder.path(), ["check", "."]).text();
    assert!(text.contains("drive_2.mcap"), "{text}");
}
