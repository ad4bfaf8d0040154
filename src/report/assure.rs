//! The reports of `frames-lint assure`: for people, as JSON, Markdown and HTML. Blind spots come first.

use std::fmt::Write;

use serde::Serialize;

use crate::assure::{Assurance, TrialOutcome};
use crate::faults::{SIZES, Selection};
use crate::visible::pretty_json;

use super::assured::{AssuranceRows, Group, SECTIONS, section, totals};
use super::json::Producer;
use super::markdown::{code, escaped};
use super::smallest::{self, OfSubject};
use super::style::{Ink, Style};
use super::text::{list, plural, wrap};

/// Name of the document's schema.
pub const SCHEMA: &str = "frames-lint-assure/1";

/// Maximum number of groups of one outcome in a text.
const MAX_GROUPS: usize = 60;

/// For people. `all`: with the mistakes that would have been named.
pub fn text(assurance: &Assurance, all: bool, style: Style) -> String {
    let mut out = String::new();
    let most = if all { usize::MAX } else { MAX_GROUPS };
    for (outcome, title) in SECTIONS {
        if outcome != TrialOutcome::Named || all {
            section(assurance, outcome, (title, most), style, &mut out);
        }
    }
    smallest::section(&assurance.smallest, style, &mut out);
    let is_blind = assurance.smallest.iter().any(|error| error.found.is_err());
    let ink = if assurance.count(TrialOutcome::Missed) > 0 || assurance.trials.is_empty() || is_blind {
        Ink::Warning
    } else {
        Ink::Good
    };
    let _ = writeln!(out, "{}", style.paint(ink, &totals(assurance)));
    out
}

#[derive(Serialize)]
struct Document<'a> {
    #[serde(flatten)]
    made: Producer,
    #[serde(flatten)]
    rows: AssuranceRows<'a>,
}

/// One document, described by `schema/frames-lint-assure-1.json`.
pub fn json(assurance: &Assurance) -> Result<String, serde_json::Error> {
    pretty_json(&Document {
        made: Producer::new(SCHEMA),
        rows: AssuranceRows::of(assurance),
    })
}

/// For comments and job summaries.
pub fn markdown(assurance: &Assurance) -> String {
    let mut out = format!("## frames-lint assure\n\n{}\n", escaped(&totals(assurance)));
    for (outcome, title) in SECTIONS {
        let groups = Group::of(assurance, outcome);
        if groups.is_empty() {
            continue;
        }
        let is_missed = outcome == TrialOutcome::Missed;
        let (open, close) = if is_missed {
            (format!("\n### {title}\n\n"), "")
        } else {
            (format!("\n<details><summary>{title}</summary>\n\n"), "\n</details>\n")
        };
        out.push_str(&open);
        out.push_str(if is_missed {
            "| subject | mistakes | why | record or add |\n|---|---|---|---|\n"
        } else {
            "| subject | mistakes | rules |\n|---|---|---|\n"
        });
        for group in groups {
            let faults: Vec<String> = group.faults.iter().map(|name| code(name)).collect();
            let _ = write!(
                out,
                "| {} | {} |",
                escaped(&group.subjects(usize::MAX)),
                faults.join(", ")
            );
            let _ = match &group.first.miss {
                Some(miss) => writeln!(out, " {} | {} |", escaped(&miss.reason), escaped(&miss.record)),
                None => writeln!(out, " {} |", escaped(&list(&group.first.rules))),
            };
        }
        out.push_str(close);
    }
    if !assurance.smallest.is_empty() {
        let _ = write!(out, "\n### {}\n\n", smallest::TITLE);
        out.push_str("| subject | error | smallest size | 5 % to 95 % | at 50 m | rule, or why at no size |\n|---|---|---|---|---|---|\n");
    }
    for of_subject in OfSubject::of(&assurance.smallest) {
        let subject = escaped(&of_subject.subject);
        for (error, found) in &of_subject.found {
            let _ = writeln!(
                out,
                "| {subject} | {} | {} | {} | {} | {} |",
                error.fault.name,
                smallest::size(error, found),
                smallest::range(found),
                smallest::at_50_m(found),
                found.rule
            );
        }
        for unseen in &of_subject.unseen {
            let _ = writeln!(
                out,
                "| {subject} | {} | none | | | {}; record or add: {} |",
                list(&unseen.names),
                escaped(&unseen.miss.reason),
                escaped(&unseen.miss.record)
            );
        }
    }
    out
}

/// One page with the blind spots and a matrix of mistakes by subjects.
pub fn html(assurance: &Assurance) -> String {
    super::html::assured(assurance)
}

/// The catalogue of mistakes, for people: a line each, by family.
pub fn list_text(selection: &Selection, style: Style) -> String {
    let mut out = String::new();
    let mut family = None;
    for fault in &selection.faults {
        if family != Some(fault.family) {
            let gap = if family.is_some() { "\n" } else { "" };
            let _ = writeln!(out, "{gap}{}", style.paint(Ink::Strong, fault.family.word()));
            family = Some(fault.family);
        }
        let line = format!("{}: {}", fault.name, fault.sentence);
        let _ = writeln!(out, "{}", wrap(&line, style.width, "  ", "    "));
    }
    if !selection.sizes.is_empty() {
        let gap = if family.is_some() { "\n" } else { "" };
        let _ = writeln!(out, "{gap}{}", style.paint(Ink::Strong, SIZES));
    }
    for fault in &selection.sizes {
        let line = format!("{} ({}): {}", fault.name, fault.unit, fault.sentence);
        let _ = writeln!(out, "{}", wrap(&line, style.width, "  ", "    "));
    }
    let all = Selection::all();
    let of = |selection: &Selection| selection.faults.len() + selection.sizes.len();
    let _ = writeln!(out, "\n{} of {}.", plural(of(selection), "mistake"), of(&all));
    out
}
