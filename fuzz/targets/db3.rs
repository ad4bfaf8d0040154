//! Any bytes as a rosbag2 database: no panic, an end, bounded memory, and a status that says what was read.
use std::io::Write;

use frames_lint::collect::{How, collect};
use frames_lint::read::bag::Sampling;
use frames_lint::source::{ReadStatus, Source, SourceId, SourceKind};

const MAGIC: &[u8] = b"SQLite format 3\0";

/// Runs the target.
pub fn run(bytes: &[u8]) {
    let mut file = tempfile::NamedTempFile::new().expect("a temporary file");
    // The magic is given: the interesting bytes come after it.
    file.write_all(MAGIC).expect("writable");
    file.write_all(bytes).expect("writable");
    let part = Sampling {
        windows: 3,
        seconds: 1.0,
        bytes: 1000,
        carried: None,
    };
    for sampling in [None, Some(part)] {
        let mut source = Source::new(SourceId(0), "fuzz.db3", SourceKind::Sqlite);
        let how = How {
            sampling,
            ..How::default()
        };
        let collected = collect(file.path(), &how, &mut source, &|_, _| {});
        assert!(source.status == ReadStatus::Read || !source.problems.is_empty());
        assert!(source.examined.bytes <= source.examined.bytes_total);
        drop(collected);
    }
}
