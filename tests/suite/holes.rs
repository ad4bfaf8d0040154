//! Damage in the middle of a recording: what is read around it gives no finding that the whole recording does not give.

#![allow(clippy::unwrap_used, clippy::indexing_slicing)]

use std::collections::BTreeSet;
use std::fs;
use std::path::Path;

use frames_lint::engine::{self, Options};
use frames_lint::run::Run;
use frames_lint::source::ReadStatus;
use rayon::prelude::*;

use crate::support;
use crate::support::damage::behind;

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

#[test]
fn a_damaged_chunk_of_an_mcap_adds_no_finding() {
    let bytes = support::build(&drive("chunk_size_bytes: 100000"));
    let checked = |bytes: &[u8]| {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("drive.mcap");
        fs::write(&path, bytes).unwrap();
        check(&path)
    };
    let whole = checked(&bytes);
    let (known, messages) = (found(&whole), whole.sources[0].examined.messages.unwrap());
    let chunks = chunks(&bytes);
    assert!(chunks.len() > 7, "{}", chunks.len());
    let added: Vec<String> = chunks
        .par_iter()
        .flat_map_iter(|(at, end)| {
            let mut damaged = bytes.clone();
            let middle = (at + 60).midpoint(*end);
            for byte in &mut damaged[middle..middle + 64] {
                *byte ^= 0x5a;
            }
            let run = checked(&damaged);
            let source = &run.sources[0];
            assert_eq!(source.status, ReadStatus::Partial);
            let read = source.examined.messages.unwrap();
            assert!(read * 10 > messages * 7, "{read} of {messages} messages: {source:?}");
            let new: Vec<_> = found(&run).difference(&known).cloned().collect();
            new.into_iter().map(move |new| format!("bytes {at} to {end}: {new:?}"))
        })
        .collect();
    assert!(added.is_empty(), "{added:#?}");
}
