//! Any text as a rosbag2 folder's `metadata.yaml`, beside a file that is not a recording: no panic, and a status that states
//! what was read.
use frames_lint::collect::{CollectOptions, collect};
use frames_lint::read::discover::discover;
use frames_lint::source::{Source, SourceId, SourceKind, SourcePart};

/// Runs the target.
pub fn run(bytes: &[u8]) {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let path = folder.path().join("metadata.yaml");
    std::fs::write(&path, bytes).expect("writable");
    std::fs::write(folder.path().join("drive_0.mcap"), b"\x89MCAP0\r\n").expect("writable");
    let inputs = discover(&[folder.path().to_path_buf()]);
    assert!(!inputs.files.is_empty());
    let mut source = Source::new(SourceId(0), "metadata.yaml", SourceKind::Rosbag2);
    let collected = collect(&path, &CollectOptions::default(), &mut source, &|_, _| {});
    // A file that was not closed is never read completely.
    assert!(!source.problems.is_empty());
    for problem in &source.problems {
        if let SourcePart::Text(span) = problem.place.at {
            assert!(source.text.get(span.start..span.end).is_some());
        }
    }
    drop(collected);
}
