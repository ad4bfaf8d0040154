//! rosbag2 folders: one recording in several files, with metadata that is right, wrong, broken or missing.

#![allow(clippy::unwrap_used, clippy::indexing_slicing, clippy::panic)]

use std::fs;

use crate::support;
use crate::support::bag;
use crate::support::reading::{collect_input, folder, found, messages};
use crate::support::recipe::{DRIVE, MESSAGES};
use crate::support::rosbag2::{Db3, Drive, Schema, Yaml, write_parts};
use frames_lint::collect::Collection;
use frames_lint::read::discover::discover;
use frames_lint::source::{ReadStatus, Source, SourceKind, SourcePart};

#[test]
fn a_folder_is_one_recording_however_it_is_named() {
    for ending in ["db3", "mcap"] {
        let outer = folder();
        let inner = outer.path().join("runs/drive");
        fs::create_dir_all(&inner).unwrap();
        let drive = Drive::of(DRIVE);
        let paths = write_parts(&drive.split(3), &inner, ending);
        Yaml::of(&paths).write(&drive, &inner);
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
            let [a, b, c] = [0, 1, 2].map(|number| format!("drive_{number}.{ending}"));
            assert_eq!(parts, [(a, 301, true), (b, 301, false), (c, 299, false)]);
            assert!(bag.parts.windows(2).all(|pair| pair[0].end_ns <= pair[1].start_ns));
            assert_eq!(bag.tf.len(), 2);
            assert_eq!(bag.topics["/imu"].stamps.long_gaps, 0);
        }

        let inputs = discover(&[outer.path().to_path_buf(), paths[1].clone(), inner.clone()]).files;
        let kinds: Vec<_> = inputs.iter().map(|input| input.kind).collect();
        assert_eq!(kinds, [SourceKind::Yaml, SourceKind::Rosbag2], "{inputs:#?}");

        let (source, collected) = found(&paths[1]);
        assert_eq!((source.status, bag(&collected).messages), (ReadStatus::Read, 301));
        let detail = source.detail.unwrap();
        assert!(
            detail.starts_with("one of the 3 files that the `metadata.yaml` next to it lists"),
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
        yaml.write(&drive, folder.path());
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
fn with_yaml(change: impl Fn(&str) -> String) -> (tempfile::TempDir, Source, Collection) {
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
            "the metadata counts 1000 messages, but the files hold 901",
            true,
        ),
        (
            "message_count: 901",
            "message_count: 800",
            "the metadata counts 800 messages, but the files hold 901",
            false,
        ),
        (
            "type: sensor_msgs/msg/Imu",
            "type: sensor_msgs/msg/Image",
            "`/imu` has type `sensor_msgs/msg/Image` in the metadata",
            false,
        ),
        (
            "name: /imu",
            "name: /gps",
            "lists messages on `/gps`, but the files do not contain this topic",
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
            "version 12 of the metadata is newer than the newest supported one (9)",
            false,
        ),
        (
            "format: \"\"",
            "format: \"lz4\"",
            "compressed with `lz4`; only zstd is supported",
            false,
        ),
        (
            "- drive_0.db3",
            "- drive_0.db3\n    - drive_1.db3",
            "lists `drive_1.db3`, which does not exist",
            true,
        ),
        (
            "- drive_0.db3",
            "- drive_0.db3\n    - ./drive_0.db3",
            "`./drive_0.db3` is listed twice",
            false,
        ),
        (
            "since_epoch: 17",
            "since_epoch: 16",
            "the start time in the metadata differs",
            false,
        ),
        (
            "duration:\n    nanoseconds: 5",
            "duration:\n    nanoseconds: 9",
            "but its messages span 5.990 s",
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
        let SourcePart::Text(span) = problem.place.at else {
            panic!("{expected} has no place in the text")
        };
        let quoted = &source.text[span.start..span.end];
        let word = to.rsplit(['-', ' ', '\n']).next().unwrap();
        assert!(
            quoted.contains(word.trim_matches('"')) || word.contains(quoted),
            "{expected}: {quoted}"
        );
        let status = [ReadStatus::Read, ReadStatus::Partial][usize::from(is_partial)];
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
    Yaml::of(&paths).write(&drive, folder.path());
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
    yaml.write(&first, &inner);
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
        messages(&source)[0].starts_with("`drive_1.db3` is in the folder but not listed here"),
        "{source:?}"
    );
}

#[test]
fn the_program_reads_a_folder_and_says_so() {
    let folder = folder();
    let drive = Drive::of(DRIVE);
    write_parts(&drive.split(2), folder.path(), "mcap");
    let yaml = Yaml::new("mcap", &["drive_0.mcap", "drive_1.mcap", "drive_2.mcap"]);
    yaml.write(&drive, folder.path());
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

/// A ROS 1 bag of these seconds, with one message a tenth of a second.
fn rosbag1(from_s: i64, until_s: i64) -> Vec<u8> {
    let mut bag = support::rosbag1::Rosbag1::new(support::rosbag1::Layout::default());
    let connection = bag.connection(&support::rosbag1::Connection {
        topic: "/label",
        message_type: "std_msgs/String",
        definition: "string data\n",
        ..support::rosbag1::Connection::default()
    });
    for tick in from_s * 10..until_s * 10 {
        bag.message(connection, tick * 100_000_000, &[0; 4]);
    }
    bag.finish().bytes
}

#[test]
fn ros_1_bags_that_were_split_are_one_recording() {
    let folder = folder();
    let path = |name: &str| folder.path().join(name);
    fs::write(path("drive_2020-01-31-10-00-00_0.bag"), rosbag1(1000, 1010)).unwrap();
    fs::write(path("drive_2020-01-31-10-00-10_1.bag"), rosbag1(1010, 1020)).unwrap();
    let (source, collected) = found(folder.path());
    assert_eq!(
        (source.kind, source.status),
        (SourceKind::Rosbag1, ReadStatus::Read),
        "{source:?}"
    );
    assert_eq!((bag(&collected).messages, bag(&collected).parts.len()), (200, 2));
    let stretches = &bag(&collected).share.stretches_ns;
    assert_eq!(stretches.len(), 1, "{stretches:?}");

    fs::write(path("drive_2020-01-31-11-00-00_2.bag"), rosbag1(4600, 4610)).unwrap();
    assert_eq!(discover(&[folder.path().to_path_buf()]).files.len(), 2, "an hour later");

    let packed = support::rosbag2::zstd_file(&path("drive_2020-01-31-11-00-00_2.bag"));
    let (source, collected) = found(&packed);
    assert_eq!(
        (source.status, bag(&collected).messages),
        (ReadStatus::Read, 100),
        "{source:?}"
    );
}
