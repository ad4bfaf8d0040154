//! Any bytes as saved evidence: no panic, and what was read is written and read again the same.
#![no_main]

use frames_lint::engine::evidence;
use frames_lint::run::Run;
use libfuzzer_sys::fuzz_target;

/// What a document says, as a document of ours.
fn rewritten(bytes: &[u8]) -> Result<String, String> {
    let saved = evidence::parse(bytes)?;
    let run = Run {
        worlds: saved.worlds,
        sources: saved.sources.to_vec(),
        skipped: saved.skipped,
        ..Run::default()
    };
    Ok(evidence::write(&run).expect("what was read can be written"))
}

fuzz_target!(|bytes: &[u8]| {
    if let Ok(text) = rewritten(bytes) {
        let again = rewritten(text.as_bytes()).expect("what was written can be read");
        assert_eq!(text, again);
    }
});
