//! Damage in the middle of a recording: what is read around it gives no finding that the whole recording does not give.

#![allow(clippy::unwrap_used, clippy::indexing_slicing)]

use std::collections::BTreeSet;
use std::fs;
use std::path::Path;

use frames_lint::engine::{self, Options};
use frames_lint::run::Run;
use frames_lint::source::ReadStatus;
use frames_lint::verdict::Row;
use rayon::prelude::*;

use crate::support;
use crate::support::damage::behind;
use crate::support::ros1;
use crate::support::rosbag1::{self, Compression};
use crate::support::rosbag2::{Db3, Drive, Yaml, write_parts};

/// What rules on absence and continuity look at: latched and moving transforms, corrections of the map, stamps, rates, and topics that begin
/// late, end early, or are slow.
fn drive(knobs: &str) -> String {
    format!(
        "
duration_s: 24
drive: {{vehicle: car, motion: turning, seed: 5}}
{knobs}
topics:
  - {{topic: /tf_static, transforms: [{{parent: base_link, child: imu_link}}, {{parent: base_link, child: gps, xyz: [0, 0, 1.5]}}, {{parent: base_link, child: laser, xyz: [1.2, 0, 0.4]}}]}}
  - topic: /tf
    rate_hz: 20
    transforms:
      - {{parent: odom, child: base_link, from_drive: odometry}}
      - {{parent: map, child: odom, from_drive: map_odom}}
  - {{topic: /odom, from_drive: odometry, rate_hz: 20, frame_id: odom, child_frame_id: base_link}}
  - {{topic: /imu, from_drive: imu, rate_hz: 50, frame_id: imu_link}}
  - {{topic: /fix, from_drive: fix, rate_hz: 2, frame_id: gps, xyz: [0, 0, 1.5]}}
  - {{topic: /scan, from_drive: laser, rate_hz: 2, frame_id: laser, xyz: [1.2, 0, 0.4], laser: {{rays: 91}}}}
  - {{topic: /late, type: sensor_msgs/msg/Temperature, rate_hz: 5, from_s: 14, frame_id: base_link}}
  - {{topic: /early, type: sensor_msgs/msg/Temperature, rate_hz: 5, until_s: 9, frame_id: base_link}}
"
    )
}

fn check(path: &Path) -> Run {
    engine::check(&Options {
        paths: vec![path.to_path_buf()],
        ..Options::default()
    })
    .unwrap()
}

/// The findings of a run, by what they are about.
fn found(run: &Run) -> BTreeSet<(String, String)> {
    let all = run.verdict.findings.iter().chain(&run.verdict.explained);
    let folder = Path::new(&run.sources[0].path).parent().unwrap().display().to_string();
    let about = |subject: &str| subject.replace(&folder, "");
    all.map(|finding| (finding.rule.clone(), about(&finding.subject)))
        .collect()
}

/// Where the chunks of an MCAP stand, and where their bytes end.
fn chunks(bytes: &[u8]) -> Vec<(usize, usize)> {
    let (mut at, mut chunks) = (8, Vec::new());
    while bytes[at] != 0x0f {
        let end = behind(bytes, at);
        if bytes[at] == 6 {
            chunks.push((at, end));
        }
        at = end;
    }
    chunks
}

/// The damaged copies of a recording, each with its name.
type DamagedCopies = Vec<(String, Vec<u8>)>;

/// Checks a recording whole and damaged: nothing is found that the whole does not show, and most of the messages are read.
fn adds_nothing(ending: &str, bytes: &[u8], damaged: &DamagedCopies) {
    let checked = |bytes: &[u8]| {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join(format!("drive.{ending}"));
        fs::write(&path, bytes).unwrap();
        check(&path)
    };
    let whole = checked(bytes);
    let (known, messages) = (found(&whole), whole.sources[0].examined.messages.unwrap());
    for rule in ON_ABSENCE {
        let judged = |row: &Row| row.rule == rule && row.outcome.is_judged();
        assert!(
            whole.verdict.rows.iter().any(judged),
            "{ending}: {rule} judges nothing of the whole drive"
        );
    }
    let added: Vec<String> = damaged
        .par_iter()
        .flat_map_iter(|(damage, bytes)| {
            let run = checked(bytes);
            let source = &run.sources[0];
            assert_eq!(source.status, ReadStatus::Partial, "{damage}");
            let read = source.examined.messages.unwrap();
            assert!(
                read * 10 > messages * 7,
                "{damage}: {read} of {messages} messages: {source:?}"
            );
            let new: Vec<_> = found(&run).difference(&known).cloned().collect();
            new.into_iter().map(move |new| format!("{ending}, {damage}: {new:?}"))
        })
        .collect();
    assert!(added.is_empty(), "{added:#?}");
}

/// The recording with other bytes in the middle of each of these stretches.
fn bent(bytes: &[u8], stretches: &[(usize, usize)]) -> DamagedCopies {
    let one = |(at, end): &(usize, usize)| {
        let middle = at.midpoint(*end);
        let mut damaged = bytes.to_vec();
        for byte in &mut damaged[middle..(middle + 64).min(*end)] {
            *byte ^= 0x5a;
        }
        (format!("bytes {at} to {end}"), damaged)
    };
    stretches.iter().map(one).collect()
}

/// Those that judge whether something is missing, comes late, ends, jumps or is slow.
const ON_ABSENCE: [&str; 13] = [
    "AUTH01", "TIME02", "TIME03", "TIME10", "TREE01", "TREE05", "TREE07", "TREE08", "TREE09", "TREE10", "TREE14",
    "TREE15", "TREE16",
];

#[test]
fn a_damaged_chunk_of_an_mcap_adds_no_finding() {
    for compression in ["zstd", "lz4", "none"] {
        let knobs = format!("chunk_size_bytes: 100000\ncompression: {compression}");
        let bytes = support::build(&drive(&knobs));
        let chunks = chunks(&bytes);
        assert!(chunks.len() > 7, "{}", chunks.len());
        adds_nothing("mcap", &bytes, &bent(&bytes, &chunks));
    }
}

#[test]
fn zeros_in_a_chunk_without_a_checksum_add_no_finding() {
    for compression in ["zstd", "lz4", "none"] {
        let knobs = format!("chunk_size_bytes: 100000\ncompression: {compression}\nchecksums: false");
        let bytes = support::build(&drive(&knobs));
        let zeroed = chunks(&bytes).into_iter().map(|(at, end)| {
            let middle = at.midpoint(end);
            let mut damaged = bytes.clone();
            damaged[middle..(middle + 4096).min(end)].fill(0);
            (format!("{compression}, zeros in bytes {at} to {end}"), damaged)
        });
        adds_nothing("mcap", &bytes, &zeroed.collect());
    }
}

#[test]
fn a_damaged_chunk_of_a_ros_1_bag_adds_no_finding() {
    let drive = Drive::of(&drive(""));
    for compression in Compression::ALL {
        let layout = rosbag1::Layout {
            compression,
            chunk_bytes: 100_000,
            ..rosbag1::Layout::default()
        };
        let written = ros1::bag_of(&drive, layout);
        let ends = written.chunks[1..].iter().chain([&written.index]);
        let chunks: Vec<(usize, usize)> = written.chunks.iter().copied().zip(ends.copied()).collect();
        assert!(chunks.len() > 7, "{}", chunks.len());
        let damaged = match compression {
            // Nothing guards the bytes of a message: what is broken is the record around them.
            Compression::None => chunks
                .iter()
                .map(|chunk| without_records(&written.bytes, *chunk))
                .collect(),
            _ => bent(&written.bytes, &chunks),
        };
        adds_nothing("bag", &written.bytes, &damaged);
    }
}

/// The bag with a chunk whose records in the middle have lost the names of their fields.
fn without_records(bytes: &[u8], (at, end): (usize, usize)) -> (String, Vec<u8>) {
    let mut damaged = bytes.to_vec();
    let middle = at.midpoint(end);
    let field = memchr::memmem::find(&bytes[middle..end], b"conn=").unwrap() + middle;
    damaged[field..field + 4].copy_from_slice(b"\0\0\0\0");
    (format!("bytes {at} to {end}"), damaged)
}

#[test]
fn a_damaged_page_of_a_database_adds_no_finding() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("drive.db3");
    for indexed in [true, false] {
        let layout = Db3 {
            indexed,
            ..Db3::default()
        };
        let _ = fs::remove_file(&path);
        Drive::of(&drive("")).write_db3(&path, layout);
        let bytes = fs::read(&path).unwrap();
        let page = layout.page_size as usize;
        // Behind the tables of topics and definitions.
        let pages = (20..bytes.len() / page).filter(|number| number % 17 == 3);
        // Of a leaf of a table the kind, and where its rows stand.
        let without = |number: usize| {
            let mut damaged = bytes.clone();
            damaged[number * page..number * page + 64].fill(0xa5);
            (format!("page {number}"), damaged)
        };
        let leaves = pages.filter(|number| bytes[number * page] == 0x0d);
        adds_nothing("db3", &bytes, &leaves.map(without).collect());
    }
}

#[test]
fn a_missing_file_of_a_split_recording_adds_no_finding() {
    let parts = Drive::of(&drive("")).split(4);
    let whole = tempfile::tempdir().unwrap();
    for (folder, gone) in [(&whole, None), (&tempfile::tempdir().unwrap(), Some(1))] {
        let paths = write_parts(&parts, folder.path(), "mcap");
        Yaml::of(&paths).write(&Drive::of(&drive("")), folder.path());
        let run = match gone {
            Some(gone) => {
                fs::remove_file(&paths[gone]).unwrap();
                check(folder.path())
            }
            None => check(folder.path()),
        };
        let new: Vec<_> = found(&run).into_iter().filter(|(rule, _)| rule == "TIME03").collect();
        assert!(new.is_empty(), "{gone:?}: {new:?}");
        assert_eq!(
            run.sources[0].status == ReadStatus::Partial,
            gone.is_some(),
            "{:?}",
            run.sources[0]
        );
    }
}

#[test]
fn a_recording_that_ends_early_adds_no_finding() {
    // What connects the arm comes late.
    let arm = "
  - {topic: /tf, rate_hz: 20, transforms: [{parent: arm, child: gripper, xyz: [0.2, 0, 0]}]}
  - {topic: /tf, rate_hz: 20, from_s: 14, transforms: [{parent: base_link, child: arm, xyz: [0, 0, 0.8]}]}
";
    let recipe = drive("") + arm.trim_start_matches('\n');
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("drive.db3");
    Drive::of(&recipe).write_db3(&path, Db3::default());
    let recordings = [
        ("mcap", support::build(&recipe)),
        (
            "bag",
            ros1::bag_of(&Drive::of(&recipe), rosbag1::Layout::default()).bytes,
        ),
        ("db3", fs::read(&path).unwrap()),
    ];
    for (ending, bytes) in recordings {
        let checked = |bytes: &[u8]| {
            let path = folder.path().join(format!("cut.{ending}"));
            fs::write(&path, bytes).unwrap();
            found(&check(&path))
        };
        let known = checked(&bytes);
        assert!(!known.iter().any(|(rule, _)| rule == "TREE01"), "{ending}: {known:?}");
        for percent in [3, 10, 25, 45, 80] {
            let cut = checked(support::damage::cut(&bytes, percent));
            let new: Vec<_> = cut.difference(&known).collect();
            assert!(new.is_empty(), "{ending}, {percent} %: {new:?}");
        }
    }
}
