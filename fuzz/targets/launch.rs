//! Any bytes as a launch file in XML and Python, and as a shell script: no panic, bounded work.
use frames_lint::read::{launch, text};
use frames_lint::source::{Source, SourceId, SourceKind};

/// Runs the target.
pub fn run(bytes: &[u8]) {
    let Ok((text, _note)) = text::decode(bytes.to_vec()) else {
        return;
    };
    for name in ["a.launch", "a.launch.py", "a.sh"] {
        let mut source = Source::new(SourceId(0), name, SourceKind::Launch);
        source.text.clone_from(&text);
        launch::read(&mut source);
    }
}
