//! Any bytes as JSON: no panic, bounded work.
use frames_lint::read::calibration;
use frames_lint::source::SourceKind;
use frames_lint::tables::Tables;

/// Runs the target.
pub fn run(bytes: &[u8]) {
    if let Some(mut source) = super::source(bytes, "fuzz.json", SourceKind::Json) {
        calibration::read_json(&mut source, Tables::default().dialects());
    }
}
