//! The verdicts of several recordings: a line each, and the reason below if it is not clean.

use std::fmt::Write;

use crate::run::{Recording, Run, VerdictWord};

use super::super::Style;
use super::super::style::Ink;
use super::super::text::{list, one_line, plural};
use super::heading;

/// The reason is cut after this many characters, or at the width of the terminal: it is shown in full above.
const WIDTH: usize = 120;
/// The width of the numbers of a line.
const NUMBERS: usize = 55;
/// The indent of the reason.
const INDENT: &str = "              ";

/// The table; nothing for fewer than two recordings.
pub(super) fn table(run: &Run, style: Style, out: &mut String) {
    if run.recordings.is_empty() {
        return;
    }
    heading(style, "recordings", run.recordings.len(), "recording", out);
    let _ = writeln!(
        out,
        "  {:<10}  {:>6}  {:>8}  {:>6}  {:>13}  recording",
        "verdict", "errors", "warnings", "passed", "not evaluated"
    );
    for recording in &run.recordings {
        let summary = &recording.summary;
        let ink = match summary.verdict {
            VerdictWord::Clean => Ink::Good,
            VerdictWord::Findings => Ink::Error,
            VerdictWord::Incomplete => Ink::Warning,
        };
        let word = summary.verdict.word();
        let label = one_line(&recording.label);
        let is_wide = style.width.is_none_or(|width| NUMBERS + label.chars().count() <= width);
        let label = if is_wide {
            format!("  {label}")
        } else {
            format!("\n{INDENT}{label}")
        };
        let _ = writeln!(
            out,
            "  {}  {:>6}  {:>8}  {:>6}  {:>13}{label}",
            style.paint(ink, &format!("{word:<10}")),
            summary.errors,
            summary.warnings,
            summary.passed,
            summary.not_evaluated,
        );
        if let Some(because) = &recording.because {
            let because = one_line(because);
            let dots = style.pick("…", "...");
            let room = style.width.map_or(WIDTH, |width| {
                width.saturating_sub(INDENT.len() + dots.len()).max(WIDTH / 4)
            });
            let mut words: String = because.chars().take(room.min(WIDTH)).collect();
            if words.len() < because.len() {
                words.push_str(dots);
            }
            let _ = writeln!(out, "{INDENT}{words}");
        }
    }
    out.push('\n');
}

/// `Of 12 recordings 9 are clean, 2 have findings and 1 is incomplete.`
pub(super) fn sentence(run: &Run) -> Option<String> {
    let count = |word: VerdictWord| {
        let is_it = |recording: &&Recording| recording.summary.verdict == word;
        run.recordings.iter().filter(is_it).count()
    };
    let parts = [
        (VerdictWord::Clean, "is clean", "are clean"),
        (VerdictWord::Findings, "has findings", "have findings"),
        (VerdictWord::Incomplete, "is incomplete", "are incomplete"),
    ];
    let parts: Vec<String> = parts
        .into_iter()
        .map(|(word, one, many)| (count(word), one, many))
        .filter(|(count, _, _)| *count > 0)
        .map(|(count, one, many)| format!("{count} {}", if count == 1 { one } else { many }))
        .collect();
    let of = plural(run.recordings.len(), "recording");
    (!parts.is_empty()).then(|| format!("Of {of} {}.", list(&parts)))
}
