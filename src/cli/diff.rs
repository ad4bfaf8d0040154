//! `frames-lint diff`.

use crate::compare::compare;
use crate::engine;
use crate::report::{Style, diff, terminal};
use crate::run::{EXIT_CLEAN, EXIT_CRASHED, EXIT_FINDINGS, EXIT_INCOMPLETE};
use crate::verdict::Outcome;

use super::args::{Diff, DiffFormat};
use super::{Answer, Failure, Surroundings};

/// Compares two platforms. 0: no changes; 1: changes; 3: they have nothing in common, or no changes were found and an input could not be
/// read in full; 70: internal error.
pub(super) fn run(asked: &Diff, surroundings: Surroundings) -> Result<Answer, Failure> {
    let read = |path: &std::path::Path| {
        engine::check(&engine::Options {
            config: asked.config.clone(),
            verdicts: engine::VerdictScope::One,
            ..asked.reading.clone().options(vec![path.to_path_buf()], surroundings)
        })
    };
    let (a, b) = (read(&asked.before)?, read(&asked.after)?);
    let comparison = compare(&a, &b);
    let names = [asked.before.display().to_string(), asked.after.display().to_string()];
    let names = [names[0].as_str(), names[1].as_str()];
    let style = Style {
        color: false,
        ..surroundings.style
    };
    let has_crashed = [&a, &b].iter().any(|run| run.verdict.count(Outcome::Crashed) > 0);
    let is_unread = a.unread().chain(b.unread()).next().is_some();
    Ok(Answer {
        out: match asked.format {
            DiffFormat::Text => diff::text(&comparison, names, surroundings.style),
            DiffFormat::Json => diff::json(&comparison, names)?,
        },
        err: terminal::render_unread(&a, style) + &terminal::render_unread(&b, style),
        code: match () {
            () if has_crashed => EXIT_CRASHED,
            () if comparison.is_empty() => EXIT_INCOMPLETE,
            () if !comparison.changes.is_empty() => EXIT_FINDINGS,
            () if is_unread => EXIT_INCOMPLETE,
            () => EXIT_CLEAN,
        },
        ..Answer::default()
    })
}
