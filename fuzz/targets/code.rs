//! Any bytes as source code in each language: no panic, bounded work.
use frames_lint::read::code;
use frames_lint::source::SourceKind;

/// Runs the target.
pub fn run(bytes: &[u8]) {
    for name in ["a.cpp", "a.py", "a.rs"] {
        if let Some(mut source) = super::source(bytes, name, SourceKind::Code) {
            code::read(&mut source);
        }
    }
}
