//! Any bytes as a URDF or an unexpanded xacro: no panic, and a problem or a robot.
use frames_lint::read::{text, urdf, xacro};
use frames_lint::source::{Source, SourceId, SourceKind};

/// Runs the target.
pub fn run(bytes: &[u8]) {
    let Ok((text, _note)) = text::decode(bytes.to_vec()) else {
        return;
    };
    let lookup = urdf::MeshLookup::default();
    let mut source = Source::new(SourceId(0), "fuzz.urdf", SourceKind::Urdf);
    source.text.clone_from(&text);
    let facts = urdf::read(&mut source, &lookup);
    assert!(!facts.robots.is_empty() || !source.problems.is_empty());
    let mut source = Source::new(SourceId(0), "fuzz.xacro", SourceKind::Xacro);
    source.text = text;
    xacro::read_unexpanded(&mut source, &lookup);
}
