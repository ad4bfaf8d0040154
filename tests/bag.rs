//! Recordings: recipe to MCAP to evidence.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::indexing_slicing, clippy::panic)]

mod support;

use frames_lint::collect::{Collected, collect};
use frames_lint::source::{ReadStatus, Source, SourceId, SourceKind};

fn of(bytes: &[u8]) -> (Source, Collected) {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("drive.mcap");
    std::fs::write(&path, bytes).unwrap();
    let mut source = Source::new(SourceId(0), "drive.mcap", SourceKind::Mcap);
    let collected = collect(&path, &mut source, &|_, _| {});
    (source, collected)
}

#[test]
fn smoke() {
    let bytes = support::build("topics:\n  - {topic: /imu, type: sensor_msgs/msg/Imu, rate_hz: 100, frame_id: imu}");
    let (source, collected) = of(&bytes);
    assert_eq!(source.status, ReadStatus::Read, "{source:?}");
    assert_eq!(collected.facts.bags[0].messages, 1000);
}
