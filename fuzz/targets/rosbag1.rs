//! Any bytes as a ROS 1 bag, read wholly and in samples: no panic, bounded memory, and a status that says what was read.
use std::io::Write;

use frames_lint::collect::{How, collect};
use frames_lint::read::bag::Sampling;
use frames_lint::source::{ReadStatus, Source, SourceId, SourceKind};

const MAGIC: &[u8] = b"#ROSBAG V2.0\n";

/// Runs the target.
pub fn run(bytes: &[u8]) {
    let mut file = tempfile::NamedTempFile::new().expect("a temporary file");
    // The magic is given: the interesting bytes come after it.
    file.write_all(MAGIC).expect("writable");
    file.write_all(bytes).expect("writable");
    let sampling = Sampling {
        windows: 2,
        seconds: 0.1,
        bytes: 100,
        carried: None,
    };
    for sampling in [None, Some(sampling)] {
        let mut source = Source::new(SourceId(0), "fuzz.bag", SourceKind::Rosbag1);
        let how = How {
            sampling,
            ..How::default()
        };
        let collected = collect(file.path(), &how, &mut source, &|_, _| {});
        assert!(source.status == ReadStatus::Read || !source.problems.is_empty());
        drop(collected);
    }
}
