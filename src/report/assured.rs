//! What became of known mistakes, in groups, as rows of JSON and as sections of a text: for every report.

use std::collections::BTreeMap;
use std::fmt::Write;

use serde::Serialize;

use crate::assure::{Assurance, Miss, Trial, TrialOutcome};

use super::smallest::SmallestRow;
use super::style::{Ink, Style};
use super::text::{list, one_line, plural, wrap};

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
        // What is about the same subjects comes together.
        let order: Vec<Vec<String>> = groups.iter().map(|group| group.subjects.clone()).collect();
        groups.sort_by_key(|group| order.iter().position(|subjects| *subjects == group.subjects));
        groups
    }

    /// The subjects, at most a number of them.
    pub(super) fn subjects(&self, most: usize) -> String {
        shortened(self.subjects.iter().map(String::as_str), "; ", most)
    }

    /// The mistakes, at most a number of them.
    pub(super) fn faults(&self, most: usize) -> String {
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
fn why(trial: &Trial) -> (Option<&Miss>, &[String]) {
    (trial.miss.as_ref(), &trial.rules)
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
pub(super) const SECTIONS: [(TrialOutcome, &str); 4] = [
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
    let mut headed: &[String] = &[];
    for group in groups.iter().take(most) {
        if group.subjects != headed {
            headed = &group.subjects;
            let subjects = one_line(&group.subjects(named));
            let _ = writeln!(out, "{}", wrap(&subjects, style.width, "  ", "    "));
        }
        let mut line = |text: &str| {
            let _ = writeln!(out, "{}", wrap(&one_line(text), style.width, "    ", "      "));
        };
        line(&group.faults(named));
        if let Some(miss) = &group.first.miss {
            line(&format!("why: {}", miss.reason));
            line(&format!("record or add: {}", miss.record));
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

/// The totals in a sentence or three.
pub(super) fn totals(assurance: &Assurance) -> String {
    let mut sentences = Vec::new();
    let omitted = match assurance.omitted.values().sum() {
        0_usize => String::new(),
        count => format!(" and were tried ({count} more were not: check fewer files in one run)"),
    };
    if !assurance.trials.is_empty() {
        let [missed, noticed, present, named] = SECTIONS.map(|(outcome, _)| assurance.count(outcome));
        let present = if present > 0 {
            format!(", {present} already present")
        } else {
            String::new()
        };
        sentences.push(format!(
            "Of {} that apply{omitted}: {named} named, {noticed} noticed, {missed} missed{present}.",
            plural(assurance.trials.len(), "mistake")
        ));
    }
    if !assurance.smallest.is_empty() {
        let found = assurance.smallest.iter().filter(|error| error.found.is_ok()).count();
        sentences.push(format!(
            "Of {} with a size, {found} would have been found from some size on.",
            plural(assurance.smallest.len(), "mistake")
        ));
    }
    if sentences.is_empty() {
        return "No known mistake applies to these data: nothing was tried. This is no assurance.".to_owned();
    }
    match assurance.inapplicable().len() {
        0 => {}
        count => sentences.push(format!(
            "{count} of the catalogue apply to nothing here: these data do not have what they are made in."
        )),
    }
    sentences.join(" ")
}

/// What became of known mistakes.
#[derive(Serialize)]
pub(super) struct AssuranceRows<'a> {
    faults: Vec<TrialRow<'a>>,
    smallest: Vec<SmallestRow<'a>>,
    inapplicable: Vec<&'a str>,
    summary: Counts,
}

impl<'a> AssuranceRows<'a> {
    pub(super) fn of(assurance: &'a Assurance) -> Self {
        let [missed, noticed, present, named] = SECTIONS.map(|(outcome, _)| assurance.count(outcome));
        let inapplicable: Vec<&str> = assurance.inapplicable().iter().map(|fault| fault.name).collect();
        Self {
            faults: assurance.trials.iter().map(TrialRow::of).collect(),
            smallest: assurance.smallest.iter().map(SmallestRow::of).collect(),
            summary: Counts {
                tried: assurance.trials.len(),
                named,
                noticed,
                missed,
                present,
                omitted: assurance.omitted.values().sum(),
                inapplicable: inapplicable.len(),
            },
            inapplicable,
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
            reason: trial.miss.as_ref().map(|miss| miss.reason.as_str()),
            record: trial.miss.as_ref().map(|miss| miss.record.as_str()),
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
    omitted: usize,
    inapplicable: usize,
}
