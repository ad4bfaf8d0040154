//! Any bytes as a calibration in plain text, in every format: no panic, bounded work.
use frames_lint::read::calibration;
use frames_lint::source::SourceKind;
use frames_lint::tables::Tables;

/// Runs the target.
pub fn run(bytes: &[u8]) {
    for name in [
        "calib_velo_to_cam.txt",
        "robot.ini",
        "rovio.info",
        "robot.lua",
        "poses.tum",
        "beams.csv",
    ] {
        if let Some(mut source) = super::source(bytes, name, SourceKind::Text) {
            calibration::read_plain(&mut source, Tables::default().dialects());
        }
    }
}
