//! The report of a run for people: findings with their source lines, unread inputs, checks that were not evaluated, a verdict.
//!
//! Owns the order of the parts and how much is shown. Only `snippet` uses miette.

mod ending;
mod finding;
mod fitness;
mod inputs;
mod policy;
mod recordings;
mod rows;
mod snippet;
#[cfg(test)]
mod tests;

use std::collections::BTreeMap;
use std::fmt::Write;

use crate::assure::TrialOutcome;
use crate::run::{FailOn, Run};
use crate::source::{ReadStatus, SourcePart};

use super::Style;
use super::place::Locator;
use super::style::Ink;
use super::text::{one_line, plural, wrap};
use super::{assured as trials, smallest};
use snippet::Painter;

pub(super) use finding::{NumberText, measured_words, message_words};
pub(super) use inputs::examined_words;
pub(super) use rows::reasons;

/// Maximum number of findings shown in full; rendering a snippet costs far more than a line.
const FULL: usize = 100;
/// Maximum number of findings shown, without --all.
const SHOWN: usize = 200;
/// Number of findings of each rule shown in full, regardless of the findings of other rules before them.
const FULL_PER_RULE: usize = 3;

/// What to show, and how.
#[derive(Clone, Copy, Debug)]
pub struct Options {
    /// Colours, characters and width.
    pub style: Style,
    /// The lowest severity that fails the run, for the verdict.
    pub fail_on: FailOn,
    /// Every row that was not evaluated, instead of a summary by reason.
    pub verbose: bool,
    /// Every finding, instead of the first few hundred.
    pub all: bool,
    /// Which parts of the report.
    pub parts: Parts,
}

/// Groups of missed mistakes that are shown.
const MAX_MISSED: usize = 10;

/// The parts of the report that are shown.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Parts {
    /// All of them.
    #[default]
    All,
    /// Findings and inputs with problems.
    Findings,
    /// All, with the number of findings of each rule instead of the findings.
    Statistics,
}

/// The whole report.
pub fn render(run: &Run, options: &Options) -> String {
    if let Some(line) = nothing_read(run, options) {
        return line;
    }
    let locator = Locator::new(&run.sources);
    let painter = Painter::new(&locator, options.style);
    let mut out = String::new();
    if options.parts == Parts::Statistics {
        statistics(run, options.style, &mut out);
    } else {
        findings(run, options, &locator, &painter, &mut out);
    }
    if options.parts == Parts::Findings {
        policy::unmet(run, options.style, &mut out);
        inputs::unread(run, &locator, &painter, options.style, &mut out);
        return out;
    }
    policy::waived(run, options, &locator, &mut out);
    policy::unmet(run, options.style, &mut out);
    inputs::unread(run, &locator, &painter, options.style, &mut out);
    inputs::taken(run, options, &locator, &mut out);
    inputs::partly_examined(run, options.style, &mut out);
    inputs::skipped(run, options, &mut out);
    inputs::judged_apart(run, options.style, &mut out);
    rows::not_evaluated(run, options, &mut out);
    rows::crashed(run, options.style, &mut out);
    assured(run, options, &mut out);
    fitness::section(run, options.style, &mut out);
    recordings::table(run, options.style, &mut out);
    explain(run, options.style, &mut out);
    ending::ending(run, options, &mut out);
    out
}

/// Known mistakes that the data would not have shown.
fn assured(run: &Run, options: &Options, out: &mut String) {
    let Some(assurance) = &run.assurance else { return };
    let title = "Known mistakes that these data would not have shown";
    let most = if options.all { usize::MAX } else { MAX_MISSED };
    trials::section(assurance, TrialOutcome::Missed, (title, most), options.style, out);
    smallest::section(&assurance.smallest, options.style, out);
    for line in wrap(&trials::totals(assurance), options.style.width, "", "  ").lines() {
        let _ = writeln!(out, "{line}");
    }
    out.push('\n');
}

/// Points to the page of the first finding's rule.
fn explain(run: &Run, style: Style, out: &mut String) {
    let Some(first) = run.verdict.open().next() else { return };
    let words = format!(
        "`frames-lint explain {}` shows how the rule decides, why it matters and how to fix it",
        one_line(&first.rule)
    );
    for line in wrap(&words, style.width, "", "  ").lines() {
        let _ = writeln!(out, "{}", style.paint(Ink::Faint, line));
    }
    out.push('\n');
}

/// If the only input cannot be read: one line that says so.
fn nothing_read(run: &Run, options: &Options) -> Option<String> {
    let [only] = run.sources.as_slice() else {
        return None;
    };
    let is_plain = only
        .problems
        .iter()
        .all(|problem| problem.place.at == SourcePart::Whole);
    if options.verbose
        || !run.fitness.is_empty()
        || only.status != ReadStatus::Unreadable
        || !is_plain
        || run.verdict.open().next().is_some()
    {
        return None;
    }
    let line = format!(
        "{}: {}. Nothing was checked; this is not a pass.",
        only.path,
        only.shortfall()
    );
    Some(options.style.paint(Ink::Error, &one_line(&line)) + "\n")
}

/// The number of findings of each rule, the largest first.
fn statistics(run: &Run, style: Style, out: &mut String) {
    let mut counts: BTreeMap<(&str, &str, &str), usize> = BTreeMap::new();
    for finding in run.verdict.open() {
        *counts
            .entry((&finding.rule, &finding.name, finding.word()))
            .or_default() += 1;
    }
    let mut counts: Vec<_> = counts.into_iter().collect();
    counts.sort_by(|a, b| (b.1, a.0).cmp(&(a.1, b.0)));
    for ((rule, name, word), count) in counts {
        let _ = writeln!(out, "{count:>6}  {}  {name} ({word})", style.paint(Ink::Strong, rule));
    }
    if !out.is_empty() {
        out.push('\n');
    }
}

/// A line for each finding, and the ending.
pub fn render_concise(run: &Run, options: &Options) -> String {
    let locator = Locator::new(&run.sources);
    let mut out = String::new();
    for finding in run.verdict.open() {
        finding::line(finding, &locator, options.style, &mut out);
    }
    if options.parts != Parts::Findings {
        policy::concise(run, &locator, options.style, &mut out);
    }
    for source in run.unread() {
        let detail = source.shortfall();
        let _ = writeln!(out, "{}: {}", one_line(&locator.name(source.id)), one_line(detail));
    }
    if options.parts != Parts::Findings {
        ending::ending(run, options, &mut out);
    }
    out
}

/// The last two lines of the report, without colour and line breaks.
pub fn plain_ending(run: &Run, fail_on: FailOn) -> String {
    render_ending(
        run,
        &Options {
            style: Style::PLAIN,
            fail_on,
            verbose: false,
            all: false,
            parts: Parts::All,
        },
    )
}

/// The last two lines of the report: the counts and the verdict in plain words.
pub fn render_ending(run: &Run, options: &Options) -> String {
    let mut out = String::new();
    ending::ending(run, options, &mut out);
    out
}

/// The inputs that could not be read, or not in full; empty if there are none.
pub fn render_unread(run: &Run, style: Style) -> String {
    let locator = Locator::new(&run.sources);
    let mut out = String::new();
    inputs::unread(run, &locator, &Painter::new(&locator, style), style, &mut out);
    out
}

fn findings(run: &Run, options: &Options, locator: &Locator, painter: &Painter, out: &mut String) {
    let mut of_rule: BTreeMap<&str, usize> = BTreeMap::new();
    let mut hidden: BTreeMap<(&str, &str), usize> = BTreeMap::new();
    let mut in_list = false;
    for (position, finding) in run.verdict.open().enumerate() {
        let before = of_rule.entry(&finding.rule).or_default();
        let in_full = position < FULL || *before < FULL_PER_RULE;
        *before += 1;
        if in_full {
            if std::mem::take(&mut in_list) {
                out.push('\n');
            }
            finding::full(finding, locator, painter, options.style, out);
            out.push('\n');
        } else if position < SHOWN || options.all {
            in_list = true;
            finding::line(finding, locator, options.style, out);
        } else {
            *hidden.entry((&finding.rule, &finding.name)).or_default() += 1;
        }
    }
    for ((rule, name), count) in &hidden {
        in_list = true;
        let more = format!("... and {count} more of {rule} {name}");
        out.push_str(&options.style.paint(Ink::Strong, &more));
        out.push_str(" (show with --all)\n");
    }
    if in_list {
        out.push('\n');
    }
}

/// A heading of a part, with the number of its items.
fn heading(style: Style, title: &str, count: usize, noun: &str, out: &mut String) {
    let heading = format!("{title} ({})", plural(count, noun));
    out.push_str(&style.paint(Ink::Strong, &heading));
    out.push('\n');
}
