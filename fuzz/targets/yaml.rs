//! Any bytes as YAML: no panic, bounded work.
use frames_lint::read::{calibration, text};
use frames_lint::source::{Source, SourceId, SourceKind};
use frames_lint::tables::Tables;

/// Runs the target.
pub fn run(bytes: &[u8]) {
    let Ok((text, _note)) = text::decode(bytes.to_vec()) else {
        return;
    };
    let mut source = Source::new(SourceId(0), "fuzz.yaml", SourceKind::Yaml);
    source.text = text;
    calibration::read_yaml(&mut source, Tables::default().dialects());
}
