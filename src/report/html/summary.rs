//! The head of the page and its foot: the verdict in words with its counts, what was required and not judged, and where the
//! person who decides signs.

use maud::{Markup, html};

use crate::run::{Recording, Unmet, VerdictWord};
use crate::source::{Source, SourceKind};
use crate::verdict::Waived;

use super::super::terminal::plain_ending;
use super::super::text::plural;
use super::Page;
use super::words::{badge, plain, words};

/// Inputs that the head names.
const NAMED: usize = 4;
/// Required rules that are shown.
const MAX_UNMET: usize = 200;

/// What the page is called.
pub(super) fn title(page: &Page) -> String {
    let (_, _, word) = signed(page.run.summary(page.fail_on).verdict);
    let name = inputs(page).next().map_or_else(String::new, |input| {
        let path = plain(&input.path);
        let last = path.rsplit('/').next().unwrap_or(&path);
        format!(": {last}")
    });
    format!("{word}{name} – frames-lint acceptance report")
}

/// Files that were given, without those of the tool itself and what came out of others.
fn inputs<'a>(page: &Page<'a>) -> impl Iterator<Item = &'a Source> {
    let is_input = |source: &&Source| source.derived.is_none() && source.kind != SourceKind::Configuration;
    let mut known = std::collections::BTreeSet::new();
    page.run
        .sources
        .iter()
        .filter(is_input)
        .filter(move |source| known.insert(&source.path))
}

/// The verdict, the counts, and what they are of.
pub(super) fn header(page: &Page) -> Markup {
    let run = page.run;
    let summary = run.summary(page.fail_on);
    let (class, sign, word) = signed(summary.verdict);
    let ending = plain_ending(run, page.fail_on);
    let (_, sentence) = ending.split_once('\n').unwrap_or(("", &ending));
    let tiles = [
        ("fail", summary.errors, "errors"),
        ("warning", summary.warnings, "warnings"),
        ("note", summary.notes, "notes"),
        ("pass", summary.passed, "checks passed"),
        ("open", summary.not_evaluated, "not evaluated"),
        ("waived", summary.waived, "waived"),
        ("crashed", summary.crashed, "crashed"),
    ];
    // What there is nothing of need not be looked at, but for faults and passes.
    let is_shown = |count: usize, name: &str| count > 0 || !["waived", "crashed"].contains(&name);
    let count = inputs(page).count();
    html! {
        header class={ "verdict " (class) } {
            p class="kind" { "frames-lint acceptance report" }
            h1 {
                span class="sign" aria-hidden="true" { (sign) } " " (word)
            }
            p class="ending" { (words(sentence.trim())) }
            dl class="counts" {
                @for (class, count, name) in tiles.iter().filter(|tile| is_shown(tile.1, tile.2)) {
                    div class={ (class) @if *count == 0 { " none" } } {
                        dt { (name) }
                        dd { (count) }
                    }
                }
            }
            p class="of" {
                span class="label" { (plural(count, "input")) ": " }
                @for (index, input) in inputs(page).take(NAMED).enumerate() {
                    @if index > 0 { ", " }
                    code { (plain(&input.path)) }
                }
                @if count > NAMED { " and " a href="#inputs" { (count - NAMED) " more" } }
            }
            @if let Some(day) = &page.call.day { p class="of" { span class="label" { "Day: " } (day) } }
        }
    }
}

/// The verdict of each recording, where there are several.
pub(super) fn recordings(page: &Page) -> Option<Markup> {
    let recordings = &page.run.recordings;
    if recordings.is_empty() {
        return None;
    }
    Some(html! {
        p class="hint" {
            "Each recording was judged with the files that belong to its platform, and without the other recordings. What was found in \
             those files counts for each of them, and stands once below."
        }
        div class="wide" role="region" aria-label="Recordings" tabindex="0" {
            table {
                thead {
                    tr {
                        th scope="col" { "Recording" }
                        th scope="col" { "Verdict" }
                        th scope="col" { "Errors" }
                        th scope="col" { "Warnings" }
                        th scope="col" { "Passed" }
                        th scope="col" { "Not evaluated" }
                        th scope="col" { "Because" }
                    }
                }
                tbody { @for recording in recordings { (recording_row(recording)) } }
            }
        }
    })
}

fn recording_row(recording: &Recording) -> Markup {
    let summary = &recording.summary;
    let (class, sign, word) = signed(summary.verdict);
    html! {
        tr {
            th scope="row" { code { (plain(&recording.label)) } }
            td { (badge(class, sign, word)) }
            td { (summary.errors) }
            td { (summary.warnings) }
            td { (summary.passed) }
            td { (summary.not_evaluated) }
            td { @if let Some(because) = &recording.because { (words(because)) } }
        }
    }
}

/// Class, sign and word of a verdict.
fn signed(verdict: VerdictWord) -> (&'static str, &'static str, &'static str) {
    match verdict {
        VerdictWord::Clean => ("pass", "✓", "Clean"),
        VerdictWord::Findings => ("fail", "✗", "Findings"),
        VerdictWord::Incomplete => ("open", "!", "Incomplete"),
    }
}

/// Requirements that are not met: the dataset may not be accepted by what nobody looked at.
pub(super) fn required(page: &Page) -> Option<Markup> {
    let unmet = &page.run.unmet;
    if unmet.is_empty() {
        return None;
    }
    Some(html! {
        p class="hint" { "These checks are required by the configuration. Nothing is known of them until they have been made." }
        div class="wide" role="region" aria-label="Required checks" tabindex="0" {
            table {
                thead { tr { th scope="col" { "Check" } th scope="col" { "Why it was not made" } th scope="col" { "What to do" } } }
                tbody { @for unmet in unmet.iter().take(MAX_UNMET) { (row(unmet)) } }
            }
        }
        @if unmet.len() > MAX_UNMET { p { "… and " (plural(unmet.len() - MAX_UNMET, "more check")) } }
    })
}

fn row(unmet: &Unmet) -> Markup {
    html! {
        tr {
            th scope="row" {
                @if unmet.is_share() { (unmet.rule) } @else { a href={ "#rule-" (unmet.rule) } { (unmet.rule) } }
                " " (unmet.name)
                @if let Some(subject) = &unmet.subject { " of " code { (plain(subject)) } }
                p class="small" { "required in " (plain(&unmet.origin)) }
            }
            td { ul class="bare" { @for why in unmet.reasons() { li { (words(&why)) } } } }
            td {
                @if let Some(waived) = &unmet.waived { (accepted(waived)) }
                @else if let Some(record) = &unmet.record { (words(record)) }
                @else { "Add what is missing and check again." }
            }
        }
    }
}

/// That somebody accepts something: why, who, until when, and where that stands.
pub(super) fn accepted(waived: &Waived) -> Markup {
    html! {
        p class="accepted" {
            (badge("waived", "⊘", "waived")) " " (words(&waived.reason))
            @if let Some(by) = &waived.by { ", by " strong { (plain(by)) } }
            @if let Some(until) = &waived.until { ", until " (until.as_str()) }
            " (" (plain(&waived.origin)) ")"
        }
    }
}

/// Where the person who decides signs.
pub(super) fn decision(page: &Page) -> Markup {
    let summary = page.run.summary(page.fail_on);
    let advice = match summary.verdict {
        VerdictWord::Clean => "Every check that counts passed.",
        VerdictWord::Findings => {
            "Findings count against this dataset: fix them or accept each with a reason before it is used."
        }
        VerdictWord::Incomplete => "Something that had to be looked at was not: the result is no pass.",
    };
    html! {
        p { (advice) }
        div class="sign-off" {
            ul class="bare boxes" {
                li { span class="blank" aria-hidden="true" { } " accepted" }
                li { span class="blank" aria-hidden="true" { } " accepted with the conditions below" }
                li { span class="blank" aria-hidden="true" { } " rejected" }
            }
            dl {
                div class="tall" { dt { "Conditions and remarks" } dd { } }
                div { dt { "Name" } dd { } }
                div { dt { "Date" } dd { } }
                div { dt { "Signature" } dd { } }
            }
        }
    }
}
