//! Large rosbag2 recordings, read in part.

#![allow(clippy::unwrap_used, clippy::indexing_slicing)]

use std::fs;

use crate::support::reading::{folder, read};
use crate::support::recipe::DRIVE;
use crate::support::rosbag2::{Db3, Drive, Message, Topic, Yaml, write_parts};
use frames_lint::read::bag::{RunExtension, Sampling};
use frames_lint::source::ReadStatus;

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
        drive.messages.push(Message {
            topic: points,
            log_ns,
            data,
        });
    }
    for minute in 1..9 {
        drive.messages.push(Message {
            log_ns: late.log_ns + minute * 60_000_000_000,
            ..late.clone()
        });
    }
    drive.messages.sort_by_key(|message| message.log_ns);
    drive
}

#[test]
fn a_large_database_is_read_in_windows() {
    let folder = folder();
    let path = folder.path().join("drive.db3");
    let drive = long();
    drive.write_db3(&path, Db3::default());
    let sampling = Sampling {
        windows: 6,
        seconds: 5.0,
        bytes: 2_000_000,
        carried: None,
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
    let folder = folder();
    let path = folder.path().join("drive.db3");
    let drive = Drive::of(DRIVE);
    drive.write_db3(&path, Db3::default());
    let size = fs::metadata(&path).unwrap().len();
    for windows in [1, 4, 1000] {
        let sampling = Sampling {
            windows,
            seconds: 100.0,
            bytes: size - 1,
            carried: None,
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
fn messages_that_are_wanted_in_a_row_are_read_on() {
    let folder = folder();
    let drive = long();
    let whole = folder.path().join("drive.db3");
    drive.write_db3(&whole, Db3::default());
    let mut paths = vec![whole];
    for ending in ["db3", "mcap"] {
        let folder = folder.path().join(ending);
        fs::create_dir(&folder).unwrap();
        Yaml::of(&write_parts(&drive.split(4), &folder, ending)).write(&drive, &folder);
        paths.push(folder);
    }
    for path in paths {
        // A window of the first four holds no two clouds: they are a second apart and have 20 kB.
        let clouds_in_a_row = |runs: u32, bytes: u64| {
            let sampling = Sampling {
                windows: 8,
                seconds: 5.0,
                bytes: 160_000,
                carried: Some(RunExtension { runs, bytes }),
            };
            let (_, _, heard) = read(&path, Some(sampling));
            heard.check();
            let times = heard
                .messages
                .iter()
                .filter(|(name, ..)| name == "/points")
                .map(|(_, at, _)| *at);
            let times: Vec<i64> = times.collect();
            let steps = times.windows(2).filter(|pair| pair[1] - pair[0] == 1_000_000_000);
            steps.count()
        };
        let counts =
            [(0, 0), (4, 1 << 20), (8, 1 << 20), (8, 45_000)].map(|(runs, bytes)| clouds_in_a_row(runs, bytes));
        let [none, half, all, bounded] = counts;
        // What one chunk of an MCAP holds is read in any case.
        assert!(none + 8 <= half && half + 8 <= all, "{}: {counts:?}", path.display());
        assert!(none <= bounded && bounded < all, "{}: {counts:?}", path.display());
    }
}

#[test]
fn a_split_recording_is_sampled_as_one() {
    let folder = folder();
    let drive = long();
    for ending in ["db3", "mcap"] {
        let folder = folder.path().join(ending);
        fs::create_dir(&folder).unwrap();
        let paths = write_parts(&drive.split(5), &folder, ending);
        Yaml::of(&paths).write(&drive, &folder);
        let size: u64 = paths.iter().map(|path| fs::metadata(path).unwrap().len()).sum();
        let sampling = Sampling {
            windows: 10,
            seconds: 2.0,
            bytes: size / 8,
            carried: None,
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
