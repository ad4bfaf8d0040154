//! Any bytes as a launch file in XML and Python, and as a shell script: no panic, bounded work.
use frames_lint::read::launch;
use frames_lint::source::SourceKind;

/// Runs the target.
pub fn run(bytes: &[u8]) {
    for name in ["a.launch", "a.launch.py", "a.sh"] {
        if let Some(mut source) = super::source(bytes, name, SourceKind::Launch) {
            launch::read(&mut source);
        }
    }
}
