//! Databases that are damaged, hostile or large: read as far as they go, in part, and never twice.

#![allow(
    clippy::unwrap_used,
    clippy::expect_used,
    clippy::indexing_slicing,
    clippy::panic,
    clippy::cast_possible_truncation,
    clippy::cast_possible_wrap
)]

mod support;

use std::collections::BTreeSet;
use std::fs;
use std::path::Path;

use frames_lint::read::bag::{self, Channel, Extent, Message, Recording, Sampling, Visit, Wanted};
use frames_lint::source::{ReadStatus, Source, SourceId, SourceKind};
use support::rosbag2::{Db3, Drive, Schema, Topic, write_parts};

const DRIVE: &str = "
duration_s: 6
topics:
  - {topic: /tf_static, transforms: [{parent: base_link, child: imu}]}
  - topic: /tf
    rate_hz: 50
    transforms: [{parent: odom, child: base_link, velocity: [1, 0, 0], yaw_rate_deg_s: 5}]
  - {topic: /imu, type: sensor_msgs/msg/Imu, rate_hz: 100, frame_id: imu}
";

/// What a reader told, in order.
#[derive(Default)]
struct Heard {
    channels: Vec<Channel>,
    /// Topic, time, first bytes.
    messages: Vec<(String, i64, Vec<u8>)>,
    /// Numbers of the messages in front of which something was left out.
    seams: Vec<usize>,
}

impl Visit for Heard {
    fn channel(&mut self, channel: &Channel) {
        assert_eq!(channel.number, self.channels.len());
        self.channels.push(channel.clone());
    }

    fn message(&mut self, channel: &Channel, message: &Message<'_>) {
        assert_eq!(channel.topic, self.channels[channel.number].topic);
        let start = message.data.iter().take(16).copied().collect();
        self.messages.push((channel.topic.clone(), message.log_ns, start));
    }

    fn seam(&mut self) {
        self.seams.push(self.messages.len());
    }
}

impl Heard {
    fn count(&self, topic: &str) -> usize {
        self.messages.iter().filter(|(name, ..)| name == topic).count()
    }

    /// No message twice, all in order of time.
    fn check(&self) {
        assert!(self.messages.is_sorted_by_key(|(_, at, _)| *at));
        let different: BTreeSet<_> = self.messages.iter().collect();
        assert_eq!(different.len(), self.messages.len(), "a message was delivered twice");
    }
}

fn read(path: &Path, sampling: Option<Sampling>) -> (Source, Extent, Heard) {
    let mut source = Source::new(SourceId(0), path.display().to_string(), SourceKind::Sqlite);
    let mut heard = Heard::default();
    let wanted = Wanted {
        sampling,
        throughout: &|channel| channel.topic.ends_with("tf_static"),
    };
    let recording = Recording { path, parts: &[] };
    let extent = bag::read(&recording, &wanted, &mut source, &|_, _| {}, &mut heard);
    (source, extent, heard)
}

#[test]
fn a_database_cut_at_any_percent_gives_what_can_be_reached() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("drive.db3");
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
        let _ = fs::remove_file(&path);
        Drive::of(DRIVE).write_db3(&path, layout);
        let bytes = fs::read(&path).unwrap();
        let mut most = 0;
        for percent in 0..100 {
            fs::write(&path, &bytes[..bytes.len() * percent / 100]).unwrap();
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
            assert!(percent < 2 || said.contains("the file ends at byte"), "{what}");
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
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("drive.db3");
    Drive::of(DRIVE).write_db3(&path, Db3::default());
    let bytes = fs::read(&path).unwrap();
    fs::write(&path, &bytes[..bytes.len() / 2]).unwrap();
    let (source, _, heard) = read(&path, None);
    assert_eq!(source.status, ReadStatus::Partial, "{source:?}");
    assert!((350..600).contains(&heard.messages.len()), "{}", heard.messages.len());
}

#[test]
fn flipped_bits_and_missing_pages_never_break_the_reader() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("drive.db3");
    Drive::of(DRIVE).write_db3(&path, Db3::default());
    let bytes = fs::read(&path).unwrap();
    let mut state: u64 = 1;
    let mut random = |below: usize| {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
        (state >> 33) as usize % below
    };
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
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("drive.db3");
    Drive::of(DRIVE).write_db3(&path, Db3::default());
    let root: u32 = {
        let database = rusqlite::Connection::open(&path).unwrap();
        let sql = "SELECT rootpage FROM sqlite_schema WHERE name = 'timestamp_idx'";
        database.query_row(sql, [], |row| row.get(0)).unwrap()
    };
    let mut bytes = fs::read(&path).unwrap();
    let at = (root as usize - 1) * 4096;
    bytes[at..at + 4096].fill(0xff);
    fs::write(&path, bytes).unwrap();
    let (source, extent, heard) = read(&path, None);
    assert_eq!((source.status, extent.truncated), (ReadStatus::Partial, true));
    assert_eq!(heard.messages.len(), 901);
}

#[test]
fn an_index_that_leads_in_a_circle_ends() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("drive.db3");
    Drive::of(DRIVE).write_db3(&path, Db3::default());
    let bytes = fs::read(&path).unwrap();
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
                assert!(extent.truncated && source.status != ReadStatus::Read, "{source:?}");
            }
        }
    }
}

/// A small part of a drive of some hundred kilobytes.
fn sparse() -> Sampling {
    Sampling {
        windows: 3,
        seconds: 0.5,
        bytes: 40_000,
    }
}

/// Ten minutes with a static transform late, a topic that begins late, and clouds of 20 kB.
fn long() -> Drive {
    let mut drive = Drive::of(&format!(
        "{}  - {{topic: /late, type: sensor_msgs/msg/Imu, rate_hz: 1, frame_id: imu, from_s: 500}}\n",
        DRIVE
            .replace("duration_s: 6", "duration_s: 600")
            .replace("rate_hz: 50", "rate_hz: 5")
            .replace("rate_hz: 100", "rate_hz: 10")
    ));
    let (start, _) = drive.span();
    drive.topics.push(Topic {
        name: "/points".to_owned(),
        message_type: "sensor_msgs/msg/PointCloud2".to_owned(),
        ..Topic::default()
    });
    let points = drive.topics.len() - 1;
    let late = drive.messages[0].clone();
    for second in 0..600_i64 {
        let log_ns = start + second * 1_000_000_000 + 7;
        let mut data = vec![0; 20_000];
        data[..8].copy_from_slice(&second.to_le_bytes());
        drive.messages.push(support::rosbag2::Message {
            topic: points,
            log_ns,
            data,
        });
    }
    for minute in 1..9 {
        drive.messages.push(support::rosbag2::Message {
            log_ns: late.log_ns + minute * 60_000_000_000,
            ..late.clone()
        });
    }
    drive.messages.sort_by_key(|message| message.log_ns);
    drive
}

#[test]
fn a_large_database_is_read_in_windows() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("drive.db3");
    let drive = long();
    drive.write_db3(&path, Db3::default());
    let sampling = Sampling {
        windows: 6,
        seconds: 5.0,
        bytes: 2_000_000,
    };
    let (source, extent, heard) = read(&path, Some(sampling));
    assert_eq!(source.status, ReadStatus::Read, "{source:?}");
    heard.check();
    assert_eq!(extent.messages_total, Some(drive.messages.len() as u64));
    assert_eq!(extent.span_ns, Some(drive.span()));
    assert!(!extent.whole && extent.indexed && !extent.truncated);
    assert!(source.examined.bytes < 2_200_000, "{}", source.examined.bytes);
    assert_eq!(heard.count("/tf_static"), 9, "read throughout");
    assert!(heard.count("/late") >= 4, "first messages of a topic that begins late");
    let total = |name: &str| {
        heard
            .channels
            .iter()
            .find(|channel| channel.topic == name)
            .unwrap()
            .total
    };
    assert_eq!(
        (total("/imu"), total("/points"), total("/tf_static")),
        (Some(6000), Some(600), Some(9))
    );

    // Windows lie at both ends and evenly between.
    let (start, end) = drive.span();
    let clouds: Vec<f64> = heard
        .messages
        .iter()
        .filter(|(name, ..)| name == "/imu")
        .map(|(_, at, _)| (at - start) as f64 / 1e9)
        .collect();
    for window in 0..6 {
        let from = ((end - start) as f64 / 1e9 - 5.0) * f64::from(window) / 5.0;
        let inside = clouds.iter().filter(|at| (from..from + 5.0).contains(*at)).count();
        assert!((45..=55).contains(&inside), "window {window} from {from}: {inside}");
    }
    // Between two messages that stand apart in the database there is a seam.
    let known: Vec<(String, i64)> = drive
        .messages
        .iter()
        .map(|message| (drive.topics[message.topic].name.clone(), message.log_ns))
        .collect();
    let place =
        |(topic, at, _): &(String, i64, Vec<u8>)| known.iter().position(|(t, l)| t == topic && l == at).unwrap();
    for (number, pair) in heard.messages.windows(2).enumerate() {
        let apart = place(&pair[1]) != place(&pair[0]) + 1;
        assert_eq!(
            apart,
            heard.seams.contains(&(number + 1)),
            "before message {}",
            number + 1
        );
    }

    let all = Sampling {
        bytes: 100_000_000,
        ..sampling
    };
    let (_, extent, heard) = read(&path, Some(all));
    assert!(extent.whole && heard.seams.is_empty());
    assert_eq!(heard.messages.len(), drive.messages.len());
}

#[test]
fn windows_that_cover_everything_are_everything() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("drive.db3");
    let drive = Drive::of(DRIVE);
    drive.write_db3(&path, Db3::default());
    let size = fs::metadata(&path).unwrap().len();
    for windows in [1, 4, 1000] {
        let sampling = Sampling {
            windows,
            seconds: 100.0,
            bytes: size - 1,
        };
        let (_, extent, heard) = read(&path, Some(sampling));
        heard.check();
        if windows < 1000 {
            assert!(extent.whole, "{windows} {}", heard.messages.len());
            assert!(heard.seams.is_empty(), "{windows}: {:?}", heard.seams);
        }
    }
}

#[test]
fn a_split_recording_is_sampled_as_one() {
    let folder = tempfile::tempdir().unwrap();
    let drive = long();
    for ending in ["db3", "mcap"] {
        let folder = folder.path().join(ending);
        fs::create_dir(&folder).unwrap();
        write_parts(&drive.split(5), &folder, ending);
        let names = [0, 1, 2, 3, 4].map(|number| format!("drive_{number}.{ending}"));
        let yaml = support::rosbag2::Yaml::new(
            if ending == "db3" { "sqlite3" } else { "mcap" },
            &names.each_ref().map(String::as_str),
        );
        fs::write(folder.join("metadata.yaml"), yaml.text(&drive)).unwrap();
        let size: u64 = names
            .iter()
            .map(|name| fs::metadata(folder.join(name)).unwrap().len())
            .sum();
        let sampling = Sampling {
            windows: 10,
            seconds: 2.0,
            bytes: size / 8,
        };
        let (source, extent, heard) = read(&folder, Some(sampling));
        assert_eq!(source.status, ReadStatus::Read, "{source:?}");
        heard.check();
        assert!(!extent.whole && !extent.truncated);
        assert_eq!(extent.messages_total, Some(drive.messages.len() as u64));
        assert_eq!(extent.span_ns, Some(drive.span()), "{ending}");
        // An MCAP is read by chunks, as far as the bytes go.
        let least = if ending == "db3" { 9 } else { 1 };
        assert!(heard.count("/tf_static") >= least, "{ending}");
        let total: u64 = heard
            .channels
            .iter()
            .filter(|channel| channel.topic == "/imu")
            .filter_map(|channel| channel.total)
            .sum();
        assert_eq!(total, 6000, "{ending}");
        assert!(
            source.examined.bytes < size / 2,
            "{ending}: {} of {size}",
            source.examined.bytes
        );
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
    let folder = tempfile::tempdir().unwrap();
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
