//! Any bytes as source code in each language: no panic, bounded work.
use frames_lint::read::{code, text};
use frames_lint::source::{Source, SourceId, SourceKind};

/// Runs the target.
pub fn run(bytes: &[u8]) {
    let Ok((text, _note)) = text::decode(bytes.to_vec()) else {
        return;
    };
    for name in ["a.cpp", "a.py", "a.rs"] {
        let mut source = Source::new(SourceId(0), name, SourceKind::Code);
        source.text.clone_from(&text);
        code::read(&mut source);
    }
}
