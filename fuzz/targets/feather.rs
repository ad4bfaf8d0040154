//! Any bytes as a feather table: no uncaught panic, bounded memory.
use frames_lint::read::feather;

/// Runs the target.
pub fn run(bytes: &[u8]) {
    let _ = feather::to_csv(bytes.to_vec());
}
