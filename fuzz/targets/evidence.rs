//! Any bytes as saved evidence: no panic, what was read is written and read again the same, and every rule can judge it.
use std::sync::LazyLock;

use frames_lint::engine::{Rules, evidence};
use frames_lint::run::Run;

static RULES: LazyLock<Rules> = LazyLock::new(|| Rules::select(&[]).expect("all rules can be selected"));

/// A document, read and written again.
fn rewritten(bytes: &[u8]) -> Result<String, String> {
    let saved = evidence::parse(bytes)?;
    for world in &saved.worlds {
        // Any panic ends the run, also that of a rule, which in the program would be an outcome.
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
