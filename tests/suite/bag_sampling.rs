//! A recording read by samples: what decides the tree is always there, the sample says how large it is, and what was
//! left out between two stretches is no gap.

#![allow(
    clippy::field_reassign_with_default,
    clippy::unwrap_used,
    clippy::indexing_slicing,
    clippy::cast_possible_truncation
)]

use std::collections::BTreeSet;
use std::path::Path;

use crate::support;
use crate::support::damage::cut;
use crate::support::{bag, build, edge, names};
use frames_lint::collect::{CollectOptions, Collection, collect};
use frames_lint::engine;
use frames_lint::read::bag::{RunExtension, Sampling};
use frames_lint::source::{Confidence, ReadStatus, Source, SourceId, SourceKind};
use frames_lint::verdict::Severity;

/// Ten minutes; a description once, a rare topic, one that speaks late, static transforms at the start.
const DRIVE: &str = "
duration_s: 600
chunk_size_bytes: 20000
topics:
  - topic: /tf_static
    transforms:
      - {parent: base_link, child: lidar, xyz: [0.3, 0, 1.2]}
  - topic: /robot_description
    text: <robot name='r'><link name='base_link'/></robot>
  - topic: /tf
    rate_hz: 20
    transforms:
      - {parent: odom, child: base_link, velocity: [1.0, 0, 0]}
  - {topic: /imu, type: sensor_msgs/msg/Imu, rate_hz: 50, frame_id: base_link}
  - {topic: /fix, type: sensor_msgs/msg/NavSatFix, rate_hz: 0.1, frame_id: gps}
  - {topic: /late, type: sensor_msgs/msg/PointCloud2, rate_hz: 2, frame_id: late_lidar, from_s: 431, until_s: 433}
";

const SAMPLING: Sampling = Sampling {
    windows: 5,
    seconds: 2.0,
    bytes: 600_000,
    carried: None,
};

fn read(bytes: &[u8], sampling: Option<Sampling>) -> (Source, Collection) {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("drive.mcap");
    std::fs::write(&path, bytes).unwrap();
    let mut source = Source::new(SourceId(0), "drive.mcap", SourceKind::Mcap);
    let mut how = CollectOptions::default();
    how.sampling = sampling;
    let collected = collect(&path, &how, &mut source, &|_, _| {});
    (source, collected)
}

#[test]
fn a_sample_holds_what_decides_the_tree_and_every_topic() {
    let bytes = build(DRIVE);
    let (source, sampled) = read(&bytes, Some(SAMPLING));
    let (_, whole) = read(&bytes, None);
    assert_eq!(source.status, ReadStatus::Read, "{source:?}");
    let (sample, all) = (bag(&sampled), bag(&whole));
    assert!(!sample.share.whole && all.share.whole);
    assert!(
        sample.messages < all.messages / 4,
        "{} of {}",
        sample.messages,
        all.messages
    );
    assert_eq!(
        names(sample.tf.iter().map(|edge| &edge.child)),
        names(all.tf.iter().map(|edge| &edge.child))
    );
    assert_eq!(edge(sample, "base_link", "lidar").count, 1);
    assert_eq!(sampled.descriptions.len(), 1);
    for (name, topic) in &all.topics {
        let sampled = &sample.topics[name];
        assert!(sampled.count > 0, "{name}");
        assert_eq!(sampled.total, Some(topic.count), "{name}");
        assert_eq!(sampled.has_more(), sampled.count < topic.count);
        assert_eq!(
            names(sampled.header_frames.keys()),
            names(topic.header_frames.keys()),
            "{name}"
        );
    }
    assert!(sample.topics["/fix"].count >= 5, "rare topics are looked for");
}

#[test]
fn the_sample_reaches_from_the_beginning_to_the_end_and_says_how_large_it_is() {
    let bytes = build(DRIVE);
    let (source, sampled) = read(&bytes, Some(SAMPLING));
    let bag = bag(&sampled);
    let (start, end) = bag.share.span_ns.unwrap();
    assert!(end - start > 599_000_000_000, "{start} {end}");
    let stretches = &bag.share.stretches_ns;
    assert!(stretches.len() >= 5, "{stretches:?}");
    assert_eq!(stretches.first().unwrap().0, start);
    assert!(end - stretches.last().unwrap().1 < 100_000_000);
    assert!(stretches.windows(2).all(|pair| pair[0].1 <= pair[1].0), "{stretches:?}");
    let share = bag.share_of_messages().unwrap();
    assert!(share > 0.01 && share < 0.25, "{share}");
    let examined = source.examined;
    assert_eq!(examined.messages, Some(bag.messages));
    assert_eq!(examined.messages_total, bag.share.messages_total);
    assert_eq!(examined.windows, Some(stretches.len() as u64));
    assert!(examined.bytes < examined.bytes_total / 4);
    assert!(examined.time_ns.unwrap() < examined.time_total_ns.unwrap() / 4);
}

/// A cloud that is larger than a stretch may be has neighbours all the same, so that rules on motion by scans can judge.
#[test]
fn scans_have_neighbours_in_a_sample() {
    let bytes = build(
        "
duration_s: 60
chunk_size_bytes: 20000
drive: {vehicle: car, motion: turning, seed: 3}
topics:
  - {topic: /odom, from_drive: odometry, rate_hz: 20, frame_id: odom, child_frame_id: base_link}
  - {topic: /points, from_drive: lidar, rate_hz: 10, frame_id: lidar, xyz: [0, 0, 1.8], lidar: {beams: 8, columns: 180, driver: velodyne}}
",
    );
    let runs = |carried: Option<RunExtension>| -> Vec<usize> {
        let sampling = Sampling {
            bytes: 100_000,
            carried,
            ..SAMPLING
        };
        let (_, sampled) = read(&bytes, Some(sampling));
        let clouds = bag(&sampled).topics["/points"].content.clouds.as_ref().unwrap();
        clouds.runs.iter().map(Vec::len).collect()
    };
    let without = runs(None);
    assert!(without.iter().all(|length| *length < 4), "{without:?}");
    let with = runs(Some(RunExtension {
        runs: 5,
        bytes: 10 << 20,
    }));
    assert_eq!(with.iter().filter(|length| **length == 16).count(), 5, "{with:?}");
}

#[test]
fn what_was_left_out_is_no_gap() {
    let bytes = build(DRIVE);
    let (_, sampled) = read(&bytes, Some(SAMPLING));
    for topic in ["/imu", "/late"] {
        let stamps = &bag(&sampled).topics[topic].stamps;
        assert_eq!((stamps.backward, stamps.long_gaps), (0, 0), "{topic}");
        let largest = stamps.largest_gap.as_ref().unwrap().0;
        assert!(largest <= 600_000_000, "{topic}: {largest}");
    }
    let moving = edge(bag(&sampled), "odom", "base_link");
    assert!(moving.stamps.largest_gap.as_ref().unwrap().0 < 60_000_000);
}

#[test]
fn a_recording_that_is_small_enough_is_read_wholly() {
    let bytes = build(DRIVE);
    let large = Sampling {
        bytes: 1 << 30,
        ..SAMPLING
    };
    let (source, sampled) = read(&bytes, Some(large));
    assert!(bag(&sampled).share.whole);
    assert_eq!(source.examined.windows, None);
    let whole = read(&bytes, None).1;
    assert!(support::written(bag(&sampled)) == support::written(bag(&whole)));
}

#[test]
fn an_index_that_lies_is_not_followed() {
    let bytes = build(DRIVE);
    let (_, whole) = read(&bytes, None);
    // The bytes of the first chunk are the same in a file whose chunks were moved by a record in between.
    let header_end = 8 + 9 + u64::from_le_bytes(bytes[9..17].try_into().unwrap()) as usize;
    let mut moved = bytes[..header_end].to_vec();
    // An attachment-like record of an unknown kind: readers step over it.
    moved.push(0x80);
    moved.extend(3_u64.to_le_bytes());
    moved.extend([1, 2, 3]);
    moved.extend(&bytes[header_end..]);
    let (source, sampled) = read(&moved, Some(SAMPLING));
    assert!(bag(&sampled).share.whole, "{source:?}");
    assert_eq!(bag(&sampled).messages, bag(&whole).messages);
    assert!(source.detail.is_some(), "the index is said to be of no use");
}

#[test]
fn a_damaged_chunk_of_the_sample_costs_no_other() {
    let mut bytes = build(DRIVE);
    let (_, before) = read(&bytes, Some(SAMPLING));
    // A bit in every kilobyte of the second fifth: some of its chunks are in the sample.
    let end = bytes.len();
    for at in (end / 5..end * 2 / 5).step_by(1000) {
        bytes[at] ^= 0x40;
    }
    let (source, after) = read(&bytes, Some(SAMPLING));
    assert_eq!(source.status, ReadStatus::Partial, "{source:?}");
    assert!(source.detail.as_ref().unwrap().contains("damaged"), "{source:?}");
    assert!(bag(&after).truncated);
    let (read, of) = (bag(&after).messages, bag(&before).messages);
    assert!(read < of && read > of / 2, "{read} of {of}");
}

/// Findings that gate: rule and severity of each, without those at `hint`.
fn gating(path: &Path, bytes: Option<u64>) -> (bool, BTreeSet<(String, &'static str, String)>) {
    let run = engine::check(&engine::Options {
        paths: vec![path.to_owned()],
        extent: engine::Extent {
            full: bytes.is_none(),
            bytes,
            ..engine::Extent::default()
        },
        ..engine::Options::default()
    })
    .unwrap();
    let whole = run
        .worlds
        .iter()
        .flat_map(|world| &world.bags)
        .all(|bag| bag.share.whole);
    let findings = run.verdict.findings.iter();
    let findings =
        findings.filter(|finding| finding.confidence > Confidence::Hint && finding.severity > Severity::Note);
    let named = findings.map(|finding| (finding.rule.clone(), finding.severity.word(), finding.subject.clone()));
    (whole, named.collect())
}

#[test]
fn a_sample_leads_to_the_verdict_of_the_whole() {
    let faults = [
        "",
        "  - {topic: /points, type: sensor_msgs/msg/PointCloud2, rate_hz: 5, frame_id: Lidar}\n",
        "  - {topic: /shifted, type: sensor_msgs/msg/Imu, rate_hz: 50, frame_id: lidar, stamp_offset_s: 18}\n",
        "  - topic: /other/tf\n    rate_hz: 5\n    transforms:\n      - {parent: map, child: lidar, xyz: [0, 0, 1]}\n",
        "  - {topic: /dead, type: sensor_msgs/msg/Imu, rate_hz: 20, frame_id: lidar, stamp_s: 0}\n",
    ];
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("drive.mcap");
    for fault in faults {
        std::fs::write(&path, build(&format!("{DRIVE}{fault}"))).unwrap();
        let (sampled_whole, sampled) = gating(&path, Some(SAMPLING.bytes));
        let (whole, all) = gating(&path, None);
        assert!(whole && !sampled_whole, "{fault}");
        assert_eq!(sampled, all, "{fault}");
    }
}

#[test]
fn real_recordings_are_judged_alike_by_a_sample() {
    let Some(folder) = support::real_bags() else { return };
    let mut sampled_at_all = 0;
    for path in support::files(&folder, ".") {
        let name = path.to_string_lossy();
        if !["bag", "mcap", "db3"].iter().any(|ending| name.ends_with(ending)) {
            continue;
        }
        let (whole, sampled) = gating(&path, Some(100_000));
        sampled_at_all += usize::from(!whole);
        let (_, all) = gating(&path, None);
        assert_eq!(sampled, all, "{name}");
    }
    assert!(sampled_at_all > 0, "nothing was sampled");
}

#[test]
fn a_sampled_file_may_be_cut_or_damaged_anywhere() {
    let bytes = build(DRIVE);
    let all = bag(&read(&bytes, None).1).messages;
    for percent in 0..100 {
        let (source, collected) = read(cut(&bytes, percent), Some(SAMPLING));
        assert_ne!(source.status, ReadStatus::Read, "{percent} %");
        // Behind the data stands the summary.
        assert!(
            bag(&collected).truncated || bag(&collected).messages == all,
            "{percent} %"
        );
        let mut flipped = bytes.clone();
        let at = (bytes.len() - 1) * percent / 99;
        flipped[at] ^= 1 << (percent % 8);
        let (source, collected) = read(&flipped, Some(SAMPLING));
        assert!(
            source.status == ReadStatus::Read || !source.problems.is_empty(),
            "byte {at}"
        );
        assert!(
            bag(&collected).messages > 0 || source.status == ReadStatus::Unreadable,
            "byte {at}"
        );
    }
}
