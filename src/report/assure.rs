//! Which mistakes the data would have shown: for people, as JSON, Markdown and HTML. Blind spots come first.

use std::collections::BTreeMap;
use std::fmt::Write;

use serde::Serialize;

use crate::assure::{Assurance, Trial, TrialOutcome};
use crate::faults::{Fault, catalogue};
use crate::visible::pretty_json;

use super::json::Producer;
use super::markdown::{code, escaped};
use super::style::{Ink, Style};
use super::text::{list, one_line, plural, wrap};

/// Name of the document's schema.
pub const SCHEMA: &str = "frames-lint-assure/1";

/// Maximum number of groups of one outcome in a text.
const MAX_GROUPS: usize = 60;
/// Maximum number of subjects and of mistakes of a group in a text.
const MAX_NAMED: usize = 8;

/// Mistakes with the same outcome for the same reason, and the subjects that they were tried on.
pub(super) struct Group<'a> {
    pub(super) first: &'a Trial,
    /// Not all of them apply to each of the subjects.
    pub(super) faults: Vec<&'static str>,
    pub(super) subjects: Vec<String>,
}

impl<'a> Group<'a> {
    /// The trials with this outcome, in the order of the first of each group.
    pub(super) fn of(assurance: &'a Assurance, outcome: TrialOutcome) -> Vec<Self> {
        let mut groups: Vec<Self> = Vec::new();
        let mut numbers = BTreeMap::new();
        let first = assurance.trials.first().map(|trial| &trial.platform);
        let are_several = assurance.trials.iter().any(|trial| Some(&trial.platform) != first);
        for trial in assurance.trials.iter().filter(|trial| trial.outcome == outcome) {
            let number = *numbers.entry(why(trial)).or_insert_with(|| {
                groups.push(Self {
                    first: trial,
                    faults: Vec::new(),
                    subjects: Vec::new(),
                });
                groups.len() - 1
            });
            if let Some(group) = groups.get_mut(number) {
                add(&mut group.faults, trial.fault.name);
                add(&mut group.subjects, subject(trial, are_several));
            }
        }
        groups
    }

    /// The subjects, at most a number of them.
    fn subjects(&self, most: usize) -> String {
        shortened(self.subjects.iter().map(String::as_str), "; ", most)
    }

    /// The mistakes, at most a number of them.
    fn faults(&self, most: usize) -> String {
        let names = shortened(self.faults.iter().copied(), ", ", most);
        match self.faults.len() {
            count if count > 3 => format!("{count} mistakes: {names}"),
            _ => names,
        }
    }
}

/// Adds what is not there yet.
fn add<T: PartialEq>(list: &mut Vec<T>, item: T) {
    if !list.contains(&item) {
        list.push(item);
    }
}

/// The first items, and how many more there are.
fn shortened<'t>(items: impl ExactSizeIterator<Item = &'t str>, separator: &str, most: usize) -> String {
    let more = items.len().saturating_sub(most);
    let mut shown: Vec<String> = items.take(most).map(str::to_owned).collect();
    if more > 0 {
        shown.push(format!("and {more} more"));
    }
    shown.join(separator)
}

/// What trials of one group have in common.
fn why(trial: &Trial) -> (Option<&str>, &[String], &str) {
    (trial.reason.as_deref(), &trial.rules, trial.fault.record)
}

/// A subject, with its platform if there are several.
fn subject(trial: &Trial, are_several: bool) -> String {
    if are_several {
        format!("{}: {}", trial.platform, trial.subject)
    } else {
        trial.subject.clone()
    }
}

/// The outcomes in the order of a report, with a title.
const SECTIONS: [(TrialOutcome, &str); 4] = [
    (
        TrialOutcome::Missed,
        "Missed: no finding would have shown these mistakes",
    ),
    (
        TrialOutcome::Noticed,
        "Noticed: a finding would have shown them, without their name",
    ),
    (
        TrialOutcome::Present,
        "Present: the data already have the finding that would name them",
    ),
    (TrialOutcome::Named, "Named: a finding would have named them"),
];

/// For people. `all`: with the mistakes that would have been named.
pub fn text(assurance: &Assurance, all: bool, style: Style) -> String {
    let mut out = String::new();
    let most = if all { usize::MAX } else { MAX_GROUPS };
    for (outcome, title) in SECTIONS {
        if outcome != TrialOutcome::Named || all {
            section(assurance, outcome, (title, most), style, &mut out);
        }
    }
    let ink = if assurance.count(TrialOutcome::Missed) > 0 || assurance.trials.is_empty() {
        Ink::Warning
    } else {
        Ink::Good
    };
    let _ = writeln!(out, "{}", style.paint(ink, &totals(assurance)));
    out
}

/// The groups with one outcome, at most a number of them, under a title.
pub(super) fn section(
    assurance: &Assurance,
    outcome: TrialOutcome,
    (title, most): (&str, usize),
    style: Style,
    out: &mut String,
) {
    let groups = Group::of(assurance, outcome);
    if groups.is_empty() {
        return;
    }
    let _ = writeln!(out, "{}", style.paint(Ink::Strong, title));
    let named = if most == usize::MAX { most } else { MAX_NAMED };
    for group in groups.iter().take(most) {
        let subjects = one_line(&group.subjects(named));
        let _ = writeln!(out, "{}", wrap(&subjects, style.width, "  ", "    "));
        let mut line = |text: &str| {
            let _ = writeln!(out, "{}", wrap(&one_line(text), style.width, "    ", "      "));
        };
        line(&group.faults(named));
        if let Some(reason) = &group.first.reason {
            line(&format!("why: {reason}"));
            line(&format!("record or add: {}", group.first.fault.record));
        } else {
            line(&format!("by {}", list(&group.first.rules)));
        }
    }
    if groups.len() > most {
        let more = plural(groups.len() - most, "more group");
        let _ = writeln!(out, "  ... and {more} (--all shows them)");
    }
    out.push('\n');
}

/// The totals in one sentence.
pub(super) fn totals(assurance: &Assurance) -> String {
    let inapplicable = assurance.inapplicable.len();
    if assurance.trials.is_empty() {
        return "No known mistake applies to these data: nothing was tried. This is no assurance.".to_owned();
    }
    let [missed, noticed, present, named] = SECTIONS.map(|(outcome, _)| assurance.count(outcome));
    let present = if present > 0 {
        format!(", {present} already present")
    } else {
        String::new()
    };
    format!(
        "Of {} that apply: {named} named, {noticed} noticed, {missed} missed{present}. {} of the catalogue apply to nothing here.",
        plural(assurance.trials.len(), "mistake"),
        inapplicable
    )
}

#[derive(Serialize)]
struct Document<'a> {
    #[serde(flatten)]
    made: Producer,
    #[serde(flatten)]
    rows: AssuranceRows<'a>,
}

/// What became of known mistakes.
#[derive(Serialize)]
pub(super) struct AssuranceRows<'a> {
    faults: Vec<TrialRow<'a>>,
    inapplicable: Vec<&'a str>,
    summary: Counts,
}

impl<'a> AssuranceRows<'a> {
    pub(super) fn of(assurance: &'a Assurance) -> Self {
        let [missed, noticed, present, named] = SECTIONS.map(|(outcome, _)| assurance.count(outcome));
        Self {
            faults: assurance.trials.iter().map(TrialRow::of).collect(),
            inapplicable: assurance.inapplicable.iter().map(|fault| fault.name).collect(),
            summary: Counts {
                tried: assurance.trials.len(),
                named,
                noticed,
                missed,
                present,
                inapplicable: assurance.inapplicable.len(),
            },
        }
    }
}

#[derive(Serialize)]
struct TrialRow<'a> {
    fault: &'a str,
    family: &'static str,
    sentence: &'a str,
    platform: &'a str,
    subject: &'a str,
    outcome: &'static str,
    rules: &'a [String],
    relation: Option<&'a str>,
    reason: Option<&'a str>,
    record: Option<&'a str>,
}

impl<'a> TrialRow<'a> {
    fn of(trial: &'a Trial) -> Self {
        Self {
            fault: trial.fault.name,
            family: trial.fault.family.word(),
            sentence: trial.fault.sentence,
            platform: &trial.platform,
            subject: &trial.subject,
            outcome: trial.outcome.word(),
            rules: &trial.rules,
            relation: trial.relation.as_deref(),
            reason: trial.reason.as_deref(),
            record: (trial.outcome == TrialOutcome::Missed).then_some(trial.fault.record),
        }
    }
}

#[derive(Serialize)]
struct Counts {
    tried: usize,
    named: usize,
    noticed: usize,
    missed: usize,
    present: usize,
    inapplicable: usize,
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
            let _ = match &group.first.reason {
                Some(reason) => writeln!(out, " {} | {} |", escaped(reason), escaped(group.first.fault.record)),
                None => writeln!(out, " {} |", escaped(&list(&group.first.rules))),
            };
        }
        out.push_str(close);
    }
    out
}

/// One page with the blind spots and a matrix of mistakes by subjects.
pub fn html(assurance: &Assurance) -> String {
    super::html::assured(assurance)
}

/// The catalogue of mistakes, for people: a line each, by family.
pub fn list_text(faults: &[&Fault], style: Style) -> String {
    let mut out = String::new();
    let mut family = None;
    for fault in faults {
        if family != Some(fault.family) {
            let gap = if family.is_some() { "\n" } else { "" };
            let _ = writeln!(out, "{gap}{}", style.paint(Ink::Strong, fault.family.word()));
            family = Some(fault.family);
        }
        let line = format!("{}: {}", fault.name, fault.sentence);
        let _ = writeln!(out, "{}", wrap(&line, style.width, "  ", "    "));
    }
    let _ = writeln!(out, "\n{} of {}.", plural(faults.len(), "mistake"), catalogue().count());
    out
}
