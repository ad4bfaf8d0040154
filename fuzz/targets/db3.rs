//! Any bytes as a rosbag2 database: no panic, bounded work and memory, and a status that states what was read.
use frames_lint::read::bag::Sampling;
use frames_lint::source::SourceKind;

/// Runs the target.
pub fn run(bytes: &[u8]) {
    let part = Sampling {
        windows: 3,
        seconds: 1.0,
        bytes: 1000,
        carried: None,
    };
    for sampling in [None, Some(part)] {
        super::recorded(b"SQLite format 3\0", bytes, SourceKind::Sqlite, sampling);
    }
}
