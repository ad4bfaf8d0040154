//! Findings in full: message, places with their source lines, numbers, help, edits, and acceptance.

use std::collections::BTreeMap;

use maud::{Markup, html};

use crate::source::{Confidence, Place, SourcePart};
use crate::verdict::{Bound, Finding, Fix, Label, Measured, Safety, Severity};

use super::super::terminal::{NumberText, message_words};
use super::super::text::plural;
use super::plots::PlotMarkup;
use super::shown::ShownFindings;
use super::words::{badge, plain, words};
use super::{Page, snippet, summary};

/// Maximum number of places, numbers and edits of a finding; more are only counted.
const MAX_PLACES: usize = 12;
const MAX_MEASURED: usize = 20;
const MAX_EDITS: usize = 12;

/// The findings that are not accepted.
pub(super) fn open(page: &Page, shown: &ShownFindings, drawn: &PlotMarkup) -> Markup {
    let part = part(page, shown, drawn, |finding| finding.waived.is_none());
    part.unwrap_or_else(|| html! { p { "No findings." } })
}

/// The accepted findings, which do not count.
pub(super) fn waived(page: &Page, shown: &ShownFindings, drawn: &PlotMarkup) -> Option<Markup> {
    let part = part(page, shown, drawn, |finding| finding.waived.is_some())?;
    Some(html! {
        p class="hint" { "These findings are accepted and do not count. Signing this report accepts them as well." }
        (part)
    })
}

fn part(page: &Page, shown: &ShownFindings, drawn: &PlotMarkup, is_meant: impl Fn(&Finding) -> bool) -> Option<Markup> {
    let findings: Vec<(usize, &Finding)> = page
        .run
        .verdict
        .findings
        .iter()
        .enumerate()
        .filter(|(_, finding)| is_meant(finding))
        .collect();
    if findings.is_empty() {
        return None;
    }
    let listed: Vec<_> = findings.iter().filter(|(number, _)| shown.is_listed(*number)).collect();
    let mut left: BTreeMap<(&str, &str), usize> = BTreeMap::new();
    for (_, finding) in findings.iter().filter(|(number, _)| !shown.has(*number)) {
        *left.entry((&finding.rule, &finding.name)).or_default() += 1;
    }
    let count: usize = left.values().sum();
    Some(html! {
        @for (number, finding) in findings.iter().filter(|(number, _)| shown.is_full(*number)) {
            (full(page, drawn, *number, finding))
        }
        @if !listed.is_empty() {
            h3 { "Further findings, one line each" }
            ul class="listed" { @for (number, finding) in listed { (line(page, *number, finding)) } }
        }
        @if count > 0 {
            p class="left-out" {
                (plural(count, "more finding")) " not shown here: "
                @for (index, ((rule, name), count)) in left.iter().enumerate() {
                    @if index > 0 { ", " }
                    (count) " of " (rule) " " (name)
                }
                ". The JSON report lists all of them."
            }
        }
    })
}

/// The class and the sign of a finding: hints look like notes.
fn look(finding: &Finding) -> (&'static str, &'static str) {
    match finding.loudness() {
        _ if finding.waived.is_some() => ("waived", "⊘"),
        Severity::Note => ("note", "i"),
        Severity::Error => ("fail", "✗"),
        Severity::Warning => ("warning", "!"),
    }
}

/// Severity and confidence of a finding, with their sign.
pub(super) fn severity(finding: &Finding) -> Markup {
    let (class, sign) = look(finding);
    let word = finding.word();
    match finding.confidence {
        Confidence::Likely => badge(class, sign, &format!("{word}, {}", Confidence::Likely.word())),
        Confidence::Certain | Confidence::Hint => badge(class, sign, word),
    }
}

fn line(page: &Page, number: usize, finding: &Finding) -> Markup {
    html! {
        li id={ "finding-" (number + 1) } {
            (severity(finding)) " " a href={ "#rule-" (finding.rule) } { (finding.rule) } " " (words(&finding.message))
            @if let Some(label) = finding.places.first() { " – " code { (plain(&page.locator.short(&label.place))) } }
        }
    }
}

fn full(page: &Page, drawn: &PlotMarkup, number: usize, finding: &Finding) -> Markup {
    let (class, _) = look(finding);
    html! {
        article class={ "finding " (class) } id={ "finding-" (number + 1) } {
            h3 {
                (severity(finding)) " "
                a href={ "#rule-" (finding.rule) } { (finding.rule) " " (finding.name) }
            }
            p class="message" { (words(&finding.message)) }
            @if !finding.detail.is_empty() { p class="detail" { (words(&finding.detail)) } }
            @if let Some(waived) = &finding.waived { (summary::accepted(waived)) }
            @if finding.confidence == Confidence::Hint {
                p class="small" { "A hint: it never fails a dataset." }
            }
            (places(page, &finding.places))
            @if !finding.measured.is_empty() { (numbers(&finding.measured)) }
            @if !finding.help.is_empty() {
                p class="help" { span class="label" { "What to do: " } (words(&finding.help)) }
            }
            @if let Some(fix) = &finding.fix { (edits(page, fix)) }
            (drawn.of_finding(number))
        }
    }
}

fn places(page: &Page, labels: &[Label]) -> Markup {
    html! {
        ul class="places" {
            @for label in labels.iter().take(MAX_PLACES) {
                li {
                    code { (place(page, &label.place)) }
                    @if !label.note.is_empty() { ": " (words(&label.note)) }
                    @if let Some(lines) = snippet::render(&label.place, &page.locator) { (lines) }
                }
            }
            @if labels.len() > MAX_PLACES { li { "… and " (plural(labels.len() - MAX_PLACES, "more place")) } }
        }
    }
}

/// `robot.urdf:12:5`, `drive.mcap /tf message 3, stamp ...`.
pub(super) fn place(page: &Page, place: &Place) -> String {
    match &place.at {
        SourcePart::Message(message) => {
            let path = page.locator.find(place).path;
            plain(&format!("{path} {}", message_words(message)))
        }
        _ => plain(&page.locator.short(place)),
    }
}

fn numbers(measured: &[Measured]) -> Markup {
    let shown = measured.get(..MAX_MEASURED).unwrap_or(measured);
    let spread = shown.iter().any(|one| one.spread.is_some());
    let n = shown.iter().any(|one| one.n.is_some());
    html! {
        div class="wide" {
            table class="numbers" {
                thead {
                    tr {
                        th scope="col" { "Measured" } th scope="col" { "Value" } th scope="col" { "Limit" }
                        @if spread { th scope="col" { "Spread" } }
                        @if n { th scope="col" { "Samples" } }
                    }
                }
                tbody {
                    @for one in shown {
                        @let spelled = NumberText::new(one);
                        tr {
                            th scope="row" { (words(&one.what)) }
                            td { strong { (plain(&spelled.value)) } }
                            td {
                                @if one.bound != Bound::Within { (one.bound.word()) " " }
                                (spelled.limit.as_deref().map_or_else(|| "–".to_owned(), plain))
                            }
                            @if spread { td { (spelled.spread.as_deref().map_or_else(|| "–".to_owned(), plain)) } }
                            @if n { td { (one.n.map_or_else(|| "–".to_owned(), |n| n.to_string())) } }
                        }
                    }
                }
            }
        }
        @if measured.len() > MAX_MEASURED { p { "… and " (plural(measured.len() - MAX_MEASURED, "more number")) } }
    }
}

fn edits(page: &Page, fix: &Fix) -> Markup {
    let safety = match fix.safety {
        Safety::Safe => "safe: programs read the file as before",
        Safety::ChangesBehaviour => "changes the behaviour of the robot",
    };
    html! {
        div class="fix" {
            p { span class="label" { "Fix: " } (words(&fix.title)) " (" (safety) ")" }
            ul {
                @for edit in fix.edits.iter().take(MAX_EDITS) {
                    li {
                        code { (plain(&page.locator.short(&edit.place))) } ": "
                        @if edit.replacement.trim().is_empty() { "remove the marked text" }
                        @else { "write " code class="edit" { (plain(&edit.replacement)) } }
                    }
                }
                @if fix.edits.len() > MAX_EDITS { li { "… and " (plural(fix.edits.len() - MAX_EDITS, "more edit")) } }
            }
        }
    }
}
