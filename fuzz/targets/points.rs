//! Any bytes as a file of points: no uncaught panic, bounded memory, and a problem where nothing was read.
use std::io::Cursor;

use frames_lint::read::points;
use frames_lint::source::{ReadStatus, Source, SourceId, SourceKind};

/// Runs the target.
pub fn run(bytes: &[u8]) {
    let mut source = Source::new(SourceId(0), "fuzz", SourceKind::Points);
    let facts = points::read(Cursor::new(bytes), &mut source);
    assert!(source.status == ReadStatus::Read || !source.problems.is_empty());
    assert!(!facts.point_files.is_empty() || source.status == ReadStatus::Unreadable);
}
