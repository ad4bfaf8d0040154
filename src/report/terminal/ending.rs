//! The end of the report: one line of counts, one line of verdict in plain words.

use std::collections::{BTreeMap, BTreeSet};
use std::fmt::Write;

use crate::run::{FailOn, Run, Summary, VerdictWord};
use crate::source::{Confidence, ReadStatus};
use crate::verdict::Outcome;

use super::super::Style;
use super::super::style::Ink;
use super::super::text::{list, one_line, plural, wrap};
use super::Options;
use super::policy::unmet_words;
use super::recordings;

pub(super) fn ending(run: &Run, options: &Options, out: &mut String) {
    let summary = run.summary(options.fail_on);
    let counts = counts(run, &summary, options.style);
    let _ = writeln!(out, "{}", wrap(&counts, options.style.width, "", "  "));
    let (ink, words) = verdict(run, &summary, options);
    let words = wrap(&words, options.style.width, "", "  ");
    // Coloured line by line, for pagers that reset colours at line ends.
    for line in words.lines() {
        let _ = writeln!(out, "{}", options.style.paint(ink, line));
    }
}

/// `3 errors, 1 warning, 0 notes · 41 checks passed · 17 not evaluated · 2 of 3 inputs read`.
fn counts(run: &Run, summary: &Summary, style: Style) -> String {
    let (read, inputs) = inputs(run);
    let mut parts = vec![
        [
            plural(summary.errors, "error"),
            plural(summary.warnings, "warning"),
            plural(summary.notes, "note"),
        ]
        .into_iter()
        .chain((summary.hints > 0).then(|| plural(summary.hints, "hint")))
        .collect::<Vec<_>>()
        .join(", "),
        format!("{} passed", plural(summary.passed, "check")),
        format!("{} not evaluated", summary.not_evaluated),
    ];
    if summary.waived > 0 {
        parts.push(format!("{} waived", summary.waived));
    }
    if summary.explained > 0 {
        parts.push(format!("{} explained by other findings", summary.explained));
    }
    if summary.crashed > 0 {
        parts.push(format!("{} crashed", summary.crashed));
    }
    parts.push(format!("{read} of {} read", plural(inputs, "input")));
    parts.join(style.pick(" · ", " | "))
}

/// The number of inputs read in full, and of inputs: files by path, without optional ones in unsupported formats. A text extracted from
/// a file counts with that file.
fn inputs(run: &Run) -> (usize, usize) {
    let mut paths: BTreeMap<&str, bool> = BTreeMap::new();
    for source in &run.sources {
        let read = source.status == ReadStatus::Read;
        if source.required || read {
            *paths.entry(&source.path).or_insert(true) &= read;
        }
    }
    (paths.values().filter(|read| **read).count(), paths.len())
}

fn verdict(run: &Run, summary: &Summary, options: &Options) -> (Ink, String) {
    let mut sentences = Vec::new();
    let crash =
        (summary.crashed > 0).then(|| format!("{} crashed (a bug in frames-lint).", plural(summary.crashed, "check")));
    let ink = match summary.verdict {
        VerdictWord::Findings => {
            let counting = counting(run, options.fail_on);
            sentences.push(if options.fail_on == FailOn::default() {
                format!("Not clean: {counting}.")
            } else {
                format!("Not clean: {counting} by {}.", fail_on_words(run, options.fail_on))
            });
            sentences.extend(recordings::sentence(run));
            sentences.extend(crash);
            sentences.extend(unread(run));
            sentences.extend(unmet_words(run));
            Ink::Error
        }
        VerdictWord::Incomplete if !run.verdict.judges_anything() => {
            sentences.push(format!(
                "Nothing was checked: {}. This is not a pass.",
                why_nothing(run)
            ));
            sentences.extend(crash);
            Ink::Error
        }
        VerdictWord::Incomplete => {
            let why = crash.into_iter().chain(unread(run)).chain(unmet_words(run));
            let why: Vec<String> = why.chain(recordings::sentence(run)).collect();
            sentences.push(format!("Incomplete: {}", why.join(" ")));
            sentences.push(format!("{} passed.", plural(summary.passed, "check")));
            Ink::Warning
        }
        VerdictWord::Clean => {
            let (_, inputs) = inputs(run);
            sentences.push(match summary.passed {
                0 => "Clean: no finding counts.".to_owned(),
                _ => looked_at(summary, inputs),
            });
            sentences.extend(recordings::sentence(run));
            Ink::Good
        }
    };
    sentences.extend(not_counting(run, options.fail_on));
    (ink, sentences.join(" "))
}

/// The number of evaluated checks is part of the verdict.
fn looked_at(summary: &Summary, inputs: usize) -> String {
    let Summary { judged, applicable, .. } = summary;
    let inputs = plural(inputs, "input");
    if 2 * judged < *applicable {
        format!("Clean, but only {judged} of {applicable} applicable checks could be evaluated on {inputs}.")
    } else {
        format!("Clean: {judged} of {applicable} applicable checks were evaluated on {inputs}.")
    }
}

/// `2 errors and 1 warning`, of the findings that fail the run.
fn counting(run: &Run, fail_on: FailOn) -> String {
    let words = ["error", "warning", "note"].map(|word| {
        let count = run
            .verdict
            .findings
            .iter()
            .filter(|finding| fail_on.counts(finding) && finding.severity.word() == word)
            .count();
        (count, word)
    });
    let parts: Vec<String> = words
        .iter()
        .filter(|(count, _)| *count > 0)
        .map(|(count, word)| plural(*count, word))
        .collect();
    list(&parts)
}

/// Findings that do not fail the run, so that they are not overlooked.
fn not_counting(run: &Run, fail_on: FailOn) -> Option<String> {
    let others = || run.verdict.open().filter(|finding| !fail_on.counts(finding));
    let hints = others()
        .filter(|finding| finding.confidence == Confidence::Hint)
        .count();
    let mild = others().count() - hints;
    let mut parts = Vec::new();
    if mild > 0 {
        let relation = if fail_on == FailOn::Never { "under" } else { "below" };
        let findings = plural(mild, "finding");
        parts.push(format!("{findings} {relation} {}", fail_on_words(run, fail_on)));
    }
    if hints > 0 {
        parts.push(plural(hints, "hint"));
    }
    let verb = if mild + hints == 1 { "does" } else { "do" };
    let mut sentence = list(&parts);
    if sentence.is_empty() {
        return None;
    }
    let _ = write!(sentence, " {verb} not count.");
    Some(sentence)
}

/// The severity from which findings count, and its origin.
fn fail_on_words(run: &Run, fail_on: FailOn) -> String {
    let by = if run.fail_on == Some(fail_on) {
        " of the configuration"
    } else {
        ""
    };
    format!("--fail-on {}{by}", fail_on.word())
}

fn unread(run: &Run) -> Option<String> {
    let paths: BTreeSet<String> = run.unread().map(|source| one_line(&source.path)).collect();
    // A single path is named; several would make the last line unreadable, and are listed above with their reasons.
    let what = match (paths.len(), paths.first()) {
        (0, _) | (_, None) => return None,
        (1, Some(path)) => path.clone(),
        (count, _) => plural(count, "input"),
    };
    Some(format!("{what} could not be read in full."))
}

/// Why nothing was evaluated.
fn why_nothing(run: &Run) -> String {
    if run.sources.is_empty() {
        return if run.skipped.is_empty() {
            "no input files were found".to_owned()
        } else {
            format!(
                "frames-lint does not support the format of any of the {} found",
                plural(run.skipped.values().sum(), "file")
            )
        };
    }
    if let Some(unread) = unread(run) {
        return unread.trim_end_matches('.').to_owned();
    }
    if run.verdict.count(Outcome::Crashed) > 0 {
        return "every check crashed".to_owned();
    }
    if !run.verdict.has_rows() {
        return "no rule ran".to_owned();
    }
    let (_, count) = inputs(run);
    let what = match (run.sources.as_slice(), count) {
        ([only], _) => match &only.detail {
            Some(detail) => one_line(&format!("{} ({detail})", only.path)),
            None => one_line(&only.path),
        },
        (_, count) => plural(count, "input"),
    };
    format!("no rule could be evaluated on {what}, for the reasons above")
}
