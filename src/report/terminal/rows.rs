//! Outcomes without a finding: what was not evaluated and why, and what crashed.

use std::collections::{BTreeMap, BTreeSet};
use std::fmt::Write;

use crate::run::Run;
use crate::verdict::{NotEvaluated, Outcome, Row};

use super::super::Style;
use super::super::style::Ink;
use super::super::text::{one_line, plural, wrap};
use super::{Options, heading};

fn rows(run: &Run, outcome: Outcome) -> Vec<&Row> {
    run.verdict.rows.iter().filter(|row| row.outcome == outcome).collect()
}

fn reason(row: &Row) -> &str {
    row.reason.as_deref().unwrap_or("no reason was given")
}

/// Why checks were not made: for each reason the rules, and how many checks.
pub(in crate::report) fn reasons(run: &Run) -> BTreeMap<&str, (BTreeSet<&str>, usize)> {
    let mut reasons: BTreeMap<&str, (BTreeSet<&str>, usize)> = BTreeMap::new();
    for row in rows(run, Outcome::NotEvaluated) {
        let (rules, checks) = reasons.entry(reason(row)).or_default();
        rules.insert(&row.rule);
        *checks += 1;
    }
    reasons
}

/// Rows that were not evaluated: in one line, or every one with `--verbose`.
pub(super) fn not_evaluated(run: &Run, options: &Options, out: &mut String) {
    let rows = rows(run, Outcome::NotEvaluated);
    if rows.is_empty() && run.verdict.dropped.not_applicable_count() == 0 {
        return;
    }
    if options.verbose {
        heading(options.style, "Not evaluated", rows.len(), "check", out);
        for row in rows {
            let line = format!("{} {}, {}: {}", row.rule, row.name, row.subject, reason(row));
            let _ = writeln!(out, "{}", wrap(&one_line(&line), options.style.width, "  ", "      "));
        }
    } else {
        let _ = writeln!(
            out,
            "{}",
            options.style.paint(Ink::Faint, &brief(run, &rows, options.style))
        );
    }
    out.push('\n');
}

/// One line: how many checks for what reason, and which input would help most.
fn brief(run: &Run, rows: &[&Row], style: Style) -> String {
    let count = |kind: NotEvaluated| {
        let counted = if kind == NotEvaluated::NotApplicable {
            run.verdict.dropped.not_applicable_count()
        } else {
            0
        };
        counted + rows.iter().filter(|row| row.why_not() == Some(kind)).count()
    };
    let kinds = [
        (NotEvaluated::NotApplicable, "with nothing to judge"),
        (NotEvaluated::TooLittleEvidence, "with too little evidence"),
        (NotEvaluated::InputBroken, "on broken inputs"),
        (NotEvaluated::MissingInput, "without an input"),
    ];
    let kinds = kinds.map(|(kind, words)| (count(kind), words));
    let kinds = kinds.iter().filter(|(count, _)| *count > 0);
    let mut parts: Vec<String> = kinds.map(|(count, words)| format!("{count} {words}")).collect();
    let mut lacking: BTreeMap<&str, usize> = BTreeMap::new();
    let missing = format!("{}: no ", NotEvaluated::MissingInput.word());
    for row in rows {
        let input = reason(row)
            .strip_prefix(&missing)
            .and_then(|rest| rest.split([',', ';', ':']).next());
        if let Some(input) = input {
            *lacking.entry(input).or_default() += 1;
        }
    }
    if let Some((input, count)) = lacking
        .into_iter()
        .max_by_key(|(input, count)| (*count, std::cmp::Reverse(*input)))
    {
        let input = input.replace(" and no ", " or ");
        parts.push(format!(
            "what would help most: {input} ({})",
            plural(count, "more check")
        ));
    }
    let line = format!("Not evaluated: {}; --verbose lists them", parts.join(", "));
    wrap(&one_line(&line), style.width, "", "  ")
}

/// Rules that broke: a fault of ours.
pub(super) fn crashed(run: &Run, style: Style, out: &mut String) {
    let rows = rows(run, Outcome::Crashed);
    if rows.is_empty() {
        return;
    }
    heading(
        style,
        "Crashed: a fault of frames-lint, not of the files",
        rows.len(),
        "check",
        out,
    );
    for row in rows {
        let line = format!("{} {}, {}: {}", row.rule, row.name, row.subject, reason(row));
        let _ = writeln!(out, "{}", wrap(&one_line(&line), style.width, "  ", "      "));
    }
    let _ = writeln!(
        out,
        "  help: report this with the input that causes it; --ignore leaves the rule out\n"
    );
}
