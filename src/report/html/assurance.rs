//! Which known mistakes the data would have shown: blind spots first, then a matrix of each family, mistakes by subjects.

use std::cmp::Reverse;
use std::collections::{BTreeMap, BTreeSet};

use maud::{Markup, html};

use crate::assure::{Assurance, SmallestError, Trial, TrialOutcome};
use crate::faults::Family;

use super::super::assured::{Group, totals};
use super::super::smallest::{self, OfSubject};
use super::super::text::plural;
use super::words::{badge, plain, words};

/// Maximum number of blind spots in the list.
const MAX_GROUPS: usize = 100;
/// Maximum number of subjects in a matrix: a wider one is not readable.
const MAX_SUBJECTS: usize = 24;

/// A subject of a platform.
type Column<'a> = (&'a str, &'a str);

pub(super) fn render(assurance: &Assurance) -> Markup {
    let families: BTreeSet<Family> = assurance.trials.iter().map(|trial| trial.fault.family).collect();
    html! {
        p { (totals(assurance)) }
        p class="hint" {
            "Each known mistake was put into a copy of these data, and the copy was checked. What is missed there would not have been found here."
        }
        (blind_spots(&Group::of(assurance, TrialOutcome::Missed)))
        (smallest_errors(&assurance.smallest))
        @for family in families { (matrix(assurance, family)) }
    }
}

fn blind_spots(missed: &[Group]) -> Markup {
    html! {
        @if !missed.is_empty() {
            table class="cards" {
                thead { tr {
                    th scope="col" { "Blind spot" } th scope="col" { "Why it would be missed" } th scope="col" { "What to record or add" }
                } }
                tbody { @for group in missed.iter().take(MAX_GROUPS) { tr {
                    th scope="row" {
                        ul class="bare" { @for subject in &group.subjects { li { (words(subject)) } } }
                        p class="small" { (plain(&group.faults.join(", "))) }
                    }
                    td data-name="Why it would be missed" { @if let Some(miss) = &group.first.miss { (words(&miss.reason)) } }
                    td data-name="What to record or add" { @if let Some(miss) = &group.first.miss { (words(&miss.record)) } }
                } } }
            }
            @if missed.len() > MAX_GROUPS { p { "… and " (plural(missed.len() - MAX_GROUPS, "more blind spot")) } }
        }
    }
}

fn smallest_errors(errors: &[SmallestError]) -> Markup {
    html! {
        @if !errors.is_empty() {
            h3 { (smallest::TITLE) }
            table class="cards" {
                thead { tr {
                    th scope="col" { "Subject" } th scope="col" { "Error" } th scope="col" { "Smallest size" } th scope="col" { "5 % to 95 %" }
                    th scope="col" { "At 50 m" } th scope="col" { "By, or why at no size" }
                } }
                tbody { @for of_subject in OfSubject::of(errors) {
                    @for (error, found) in &of_subject.found { tr {
                        th scope="row" { (words(&of_subject.subject)) }
                        td data-name="Error" { (error.fault.name) }
                        td data-name="Smallest size" { (smallest::size(error, found)) }
                        td data-name="5 % to 95 %" { (smallest::range(found)) }
                        td data-name="At 50 m" { (smallest::at_50_m(found)) }
                        td data-name="By" { (found.rule) }
                    } }
                    @for unseen in &of_subject.unseen { tr {
                        th scope="row" { (words(&of_subject.subject)) }
                        td data-name="Error" { (unseen.names.join(", ")) }
                        td data-name="Smallest size" { "none" } td {} td {}
                        td data-name="Why at no size" { (words(&unseen.miss.reason)) "; record or add: " (words(&unseen.miss.record)) }
                    } }
                } }
            }
        }
    }
}

/// The mistakes of a family by its subjects, each with its outcome; the mistakes that are missed most come first.
fn matrix(assurance: &Assurance, family: Family) -> Markup {
    let (mut columns, mut missed): (Vec<Column>, BTreeMap<&str, usize>) = Default::default();
    let mut cells: BTreeMap<(&str, Column), &Trial> = BTreeMap::new();
    for trial in assurance.trials.iter().filter(|trial| trial.fault.family == family) {
        let column = (trial.platform.as_str(), trial.subject.as_str());
        if !columns.contains(&column) {
            columns.push(column);
        }
        *missed.entry(trial.fault.name).or_default() += usize::from(trial.outcome == TrialOutcome::Missed);
        cells.insert((trial.fault.name, column), trial);
    }
    let mut rows: Vec<(&str, usize)> = missed.into_iter().collect();
    rows.sort_by_key(|(_, missed)| Reverse(*missed));
    let shown = columns.get(..MAX_SUBJECTS).unwrap_or(&columns);
    html! {
        details open[rows.iter().any(|(_, missed)| *missed > 0)] {
            summary { (family.word()) ": " (plural(rows.len(), "mistake")) " on " (plural(columns.len(), "subject")) }
            div class="wide" { table class="matrix" {
                thead { tr {
                    th scope="col" { "Mistake" }
                    @for (_, subject) in shown { th scope="col" { (words(subject)) } }
                } }
                tbody { @for (fault, _) in &rows { tr {
                    th scope="row" { (fault) }
                    @for column in shown { td { @if let Some(trial) = cells.get(&(*fault, *column)) { (cell(trial)) } } }
                } } }
            } }
            @if columns.len() > shown.len() {
                p { "… and " (plural(columns.len() - shown.len(), "more subject")) ", which the JSON report lists" }
            }
        }
    }
}

fn cell(trial: &Trial) -> Markup {
    let (class, sign) = match trial.outcome {
        TrialOutcome::Named => ("pass", "✓"),
        TrialOutcome::Noticed => ("waived", "~"),
        TrialOutcome::Missed => ("fail", "✗"),
        TrialOutcome::Present => ("open", "!"),
    };
    badge(class, sign, trial.outcome.word())
}
