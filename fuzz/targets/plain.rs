//! Any bytes as a calibration in plain text, in every form: no panic, bounded work.
use frames_lint::read::{calibration, text};
use frames_lint::source::{Source, SourceId, SourceKind};
use frames_lint::tables::Tables;

/// Runs the target.
pub fn run(bytes: &[u8]) {
    let Ok((text, _note)) = text::decode(bytes.to_vec()) else {
        return;
    };
    for name in [
        "calib_velo_to_cam.txt",
        "robot.ini",
        "rovio.info",
        "robot.lua",
        "poses.tum",
    ] {
        let mut source = Source::new(SourceId(0), name, SourceKind::Text);
        source.text.clone_from(&text);
        calibration::read_plain(&mut source, Tables::default().dialects());
    }
}
