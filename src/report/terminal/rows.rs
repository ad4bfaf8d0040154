//! Outcomes without a finding: what was not evaluated and why, and what crashed.

use std::collections::{BTreeMap, BTreeSet};
use std::fmt::Write;

use crate::run::Run;
use crate::verdict::{Outcome, Row};

use super::super::Style;
use super::super::style::Ink;
use super::super::text::{one_line, plural, wrap};
use super::{Options, heading};

/// More reasons are only counted, unless all rows are asked for.
const MAX_REASONS: usize = 10;

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

/// Rows that were not evaluated: by reason, or every one with `--verbose`.
pub(super) fn not_evaluated(run: &Run, options: &Options, out: &mut String) {
    let rows = rows(run, Outcome::NotEvaluated);
    if rows.is_empty() {
        return;
    }
    heading(options.style, "Not evaluated", rows.len(), "check", out);
    if options.verbose {
        for row in rows {
            let line = format!("{} {}, {}: {}", row.rule, row.name, row.subject, reason(row));
            let _ = writeln!(out, "{}", wrap(&one_line(&line), options.style.width, "  ", "      "));
        }
    } else {
        by_reason(run, options.style, out);
    }
    out.push('\n');
}

fn by_reason(run: &Run, style: Style, out: &mut String) {
    // Most rules first, then most checks.
    let mut reasons: Vec<(usize, usize, &str)> = reasons(run)
        .iter()
        .map(|(reason, (rules, checks))| (rules.len(), *checks, *reason))
        .collect();
    reasons.sort_by(|a, b| (b.0, b.1, a.2).cmp(&(a.0, a.1, b.2)));
    for (count, _, reason) in reasons.iter().take(MAX_REASONS) {
        let count = plural(*count, "rule");
        let line = wrap(
            &one_line(reason),
            style.width,
            &format!("  {count:>9}  "),
            "             ",
        );
        let _ = writeln!(out, "{line}");
    }
    let more = match reasons.len().saturating_sub(MAX_REASONS) {
        0 => String::new(),
        count => format!("... and {}; ", plural(count, "more reason")),
    };
    let _ = writeln!(
        out,
        "  {}",
        style.paint(Ink::Faint, &format!("{more}--verbose lists every check"))
    );
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
