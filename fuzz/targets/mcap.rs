//! Any bytes as an MCAP file: no panic, bounded memory, and a status that states what was read.
use frames_lint::source::SourceKind;

/// Runs the target.
pub fn run(bytes: &[u8]) {
    super::recorded(b"\x89MCAP0\r\n", bytes, SourceKind::Mcap, None);
}
