//! Outcomes without a finding: checks that were not evaluated, with the reasons, and crashes.

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
    row.reason.as_deref().unwrap_or("no reason given")
}

/// Why checks were not evaluated: for each reason the rules, and the number of checks.
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

/// One line: the number of checks by reason, and the missing input that most checks need.
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
        (NotEvaluated::NotApplicable, "not applicable"),
        (NotEvaluated::TooLittleEvidence, "with too little evidence"),
        (NotEvaluated::InputBroken, "with a broken input"),
        (NotEvaluated::MissingInput, "with a missing input"),
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
        parts.push(format!("most needed: {input} ({})", plural(count, "check")));
    }
    let line = format!("Not evaluated: {}; list with --verbose", parts.join(", "));
    wrap(&one_line(&line), style.width, "", "  ")
}

/// Rules that crashed: bugs.
pub(super) fn crashed(run: &Run, style: Style, out: &mut String) {
    let rows = rows(run, Outcome::Crashed);
    if rows.is_empty() {
        return;
    }
    heading(
        style,
        "Crashed (a bug in frames-lint, not a problem of your files)",
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
        "  help: report this together with the input; skip the rule with --ignore\n"
    );
}
