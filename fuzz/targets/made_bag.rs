//! A recording made from any bytes, in every format: read completely, then damaged. Truncation adds no finding; other damage breaks nothing.

use std::collections::BTreeSet;
use std::path::Path;

use frames_lint::engine::{Options, check};
use frames_lint::run::{EXIT_CRASHED, FailOn, Run};
use frames_lint::source::ReadStatus;

use super::choices::Choices;
use crate::support::encode::{Body, Endian, Field, Header, Transform};
use crate::support::raw;
use crate::support::ros1;
use crate::support::rosbag1::{self, Compression};
use crate::support::rosbag2::{Db3, Drive, Message, Schema, Topic};

const FRAMES: [&str; 9] = [
    "base_link",
    "odom",
    "map",
    "imu",
    "lidar",
    "Base_Link",
    "/lidar",
    "gps",
    "a b",
];
const TYPES: [&str; 4] = [
    "tf2_msgs/msg/TFMessage",
    "sensor_msgs/msg/Imu",
    "nav_msgs/msg/Odometry",
    "sensor_msgs/msg/NavSatFix",
];
const TOPICS: [[&str; 2]; 4] = [
    ["/tf", "/tf_static"],
    ["/imu", "/imu/data"],
    ["/odom", "/odometry"],
    ["/fix", "/gps/fix"],
];

/// Runs the target.
pub fn run(bytes: &[u8]) {
    let mut choices = Choices::new(bytes);
    let drive = drive(&mut choices);
    if drive.messages.is_empty() {
        return;
    }
    let folder = tempfile::tempdir().expect("a temporary folder");
    let (ending, whole) = file(&drive, &mut choices, folder.path());
    let path = folder.path().join(format!("drive.{ending}"));
    let checked = |bytes: &[u8]| {
        std::fs::write(&path, bytes).expect("writable");
        let paths = vec![path.clone()];
        check(&Options {
            paths,
            ..Options::default()
        })
        .expect("a path is given")
    };
    let run = checked(&whole);
    assert_eq!(run.sources[0].status, ReadStatus::Read, "{:?}", run.sources[0]);
    assert_eq!(run.sources[0].examined.messages, Some(drive.messages.len() as u64));
    let known = found(&run);
    let cut = checked(&whole[..whole.len() * choices.below(1000) / 1000]);
    assert_ne!(cut.sources[0].status, ReadStatus::Read, "{:?}", cut.sources[0]);
    let new: Vec<_> = found(&cut).difference(&known).cloned().collect();
    assert!(new.is_empty(), "cut off, it has {new:?}: {:?}", cut.verdict.findings);
    let mut bent = whole;
    choices.bend(&mut bent);
    let bent = checked(&bent);
    let source = &bent.sources[0];
    assert!(source.status == ReadStatus::Read || !source.problems.is_empty());
    assert!(source.examined.bytes <= source.examined.bytes_total, "{source:?}");
    assert_ne!(bent.exit_code(FailOn::Error), EXIT_CRASHED, "{:?}", bent.verdict.rows);
}

/// The rules that found something: of two spellings, which one is reported depends on what is read.
fn found(run: &Run) -> BTreeSet<String> {
    let all = run.verdict.findings.iter().chain(&run.verdict.explained);
    all.map(|finding| finding.rule.clone()).collect()
}

/// Up to six topics with up to 40 messages each.
fn drive(choices: &mut Choices<'_>) -> Drive {
    let mut drive = Drive::default();
    let start = 1_700_000_000_000_000_000;
    for number in 0..=choices.below(6) {
        let kind = choices.below(TYPES.len());
        let name = choices.of(&TOPICS[kind]);
        if drive.topics.iter().any(|topic| topic.name == name) {
            continue;
        }
        drive.topics.push(Topic {
            name: name.to_owned(),
            message_type: TYPES[kind].to_owned(),
            ..Topic::default()
        });
        let topic = drive.topics.len() - 1;
        let frames = [choices.of(&FRAMES), choices.of(&FRAMES)];
        let period = choices.of(&[10_000_000, 50_000_000, 100_000_000, 1_000_000_000]);
        let late = choices.of(&[0, 0, 3_000_000, 200_000_000, 18_000_000_000]);
        let from = start + number as i64 + period * choices.below(40) as i64;
        for tick in 0..choices.below(40) as i64 {
            let log_ns = from + tick * period;
            let data = message(kind, log_ns - late, frames, choices);
            drive.messages.push(Message { topic, log_ns, data });
        }
    }
    drive.messages.sort_by_key(|message| message.log_ns);
    drive
}

/// A message of this type.
fn message(kind: usize, stamp_ns: i64, [frame_id, child]: [&str; 2], choices: &mut Choices<'_>) -> Vec<u8> {
    let header = Header { stamp_ns, frame_id };
    let body = match kind {
        0 => {
            let transform = Transform {
                header,
                child,
                translation: choices.vector(),
                rotation: choices.quaternion(),
            };
            return Body::Tf(&[transform]).encode(Endian::Little);
        }
        1 => Body::Imu(header),
        2 => Body::Odometry(header, child),
        _ => {
            let place = vec![48.0 + choices.number() / 1e3, 11.0 + choices.number() / 1e3, 500.0];
            let fields = vec![
                Field::I8(0),
                Field::U16(1),
                Field::F64s(place),
                Field::F64s(vec![0.0; 9]),
                Field::U8(0),
            ];
            Body::Fields(header, fields)
        }
    };
    body.encode(Endian::Little)
}

/// The drive as a file of one of the formats: the ending of its name, and its bytes.
fn file(drive: &Drive, choices: &mut Choices<'_>, folder: &Path) -> (&'static str, Vec<u8>) {
    let chunk = choices.of(&[200, 1000, 4000, 1 << 20]);
    match choices.below(3) {
        0 => {
            let layout = raw::Layout {
                compression: choices.of(&[None, Some(mcap::Compression::Lz4), Some(mcap::Compression::Zstd)]),
                chunk_bytes: chunk as u64,
                chunks: choices.below(4) != 0,
                checksums: choices.below(4) != 0,
            };
            ("mcap", drive.mcap(layout))
        }
        1 => {
            let layout = rosbag1::Layout {
                compression: choices.of(&Compression::ALL),
                chunk_bytes: chunk,
                ..rosbag1::Layout::default()
            };
            ("bag", ros1::bag_of(drive, layout).bytes)
        }
        _ => {
            let path = folder.join("made.db3");
            let layout = Db3 {
                schema: choices.of(&[Schema::Dashing, Schema::Humble, Schema::Jazzy]),
                indexed: choices.below(2) == 0,
                page_size: choices.of(&[512, 4096]),
            };
            drive.write_db3(&path, layout);
            let bytes = std::fs::read(&path).expect("it was written");
            std::fs::remove_file(path).expect("it is there");
            ("db3", bytes)
        }
    }
}
