//! Any bytes as saved evidence: no panic, what was read is written and read again the same, and every rule can judge it.
use std::sync::LazyLock;

use frames_lint::engine::{Rules, evidence};
use frames_lint::run::Run;

static RULES: LazyLock<Rules> = LazyLock::new(|| Rules::select(&[]).expect("all rules can be selected"));

/// What a document says, as a document of ours.
fn rewritten(bytes: &[u8]) -> Result<String, String> {
    let saved = evidence::parse(bytes)?;
    for world in &saved.worlds {
        // A panic ends the run, that of a rule too, which a user would see as an outcome.
        RULES.judge(world);
    }
    let run = Run {
        worlds: saved.worlds,
        sources: saved.sources.to_vec(),
        skipped: saved.skipped,
        ..Run::default()
    };
    Ok(evidence::write(&run).expect("what was read can be written"))
}

/// Runs the target.
pub fn run(bytes: &[u8]) {
    if let Ok(text) = rewritten(bytes) {
        let again = rewritten(text.as_bytes()).expect("what was written can be read");
        assert_eq!(text, again);
    }
}
