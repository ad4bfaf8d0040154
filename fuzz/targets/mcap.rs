//! Any bytes as an MCAP file: no panic, bounded memory, and a status that says what was read.
use std::io::Write;

use frames_lint::collect::{How, collect};
use frames_lint::source::{ReadStatus, Source, SourceId, SourceKind};

const MAGIC: &[u8] = b"\x89MCAP0\r\n";

/// Runs the target.
pub fn run(bytes: &[u8]) {
    let mut file = tempfile::NamedTempFile::new().expect("a temporary file");
    // The magic is given: the interesting bytes come after it.
    file.write_all(MAGIC).expect("writable");
    file.write_all(bytes).expect("writable");
    let mut source = Source::new(SourceId(0), "fuzz.mcap", SourceKind::Mcap);
    let collected = collect(file.path(), &How::default(), &mut source, &|_, _| {});
    assert!(source.status == ReadStatus::Read || !source.problems.is_empty());
    drop(collected);
}
