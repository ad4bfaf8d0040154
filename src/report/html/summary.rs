//! The first page: the verdict with its counts, the facts of the run, and the fields for the signature. Then requirements that are not met,
//! and the recordings.

use std::cmp::Reverse;
use std::collections::BTreeSet;

use maud::{Markup, html};

use crate::run::{Recording, RequirementKind, UnmetRequirement, VerdictWord};
use crate::source::{Coverage, Source, SourceKind};
use crate::verdict::{Acceptance, Severity};

use super::super::place::Locator;
use super::super::terminal::{examined_words, plain_ending};
use super::super::text::plural;
use super::Page;
use super::hashes::hashes;
use super::words::{badge, plain, words};

/// Maximum number of inputs named in the head.
const NAMED: usize = 4;
/// Maximum number of reasons per recording.
const REASONS: usize = 5;
/// Maximum number of required rules shown.
const MAX_UNMET: usize = 200;

/// The title of the page.
pub(super) fn title(page: &Page) -> String {
    let (_, _, word) = signed(page.run.summary(page.fail_on).verdict);
    let name = given(page).next().map_or_else(String::new, |input| {
        let path = plain(&input.path);
        let last = path.rsplit('/').next().unwrap_or(&path);
        format!(": {last}")
    });
    format!("{word}{name} – frames-lint acceptance report")
}

/// The given files, without configurations and extracted texts.
fn given<'a>(page: &Page<'a>) -> impl Iterator<Item = &'a Source> {
    let is_input = |source: &&Source| source.derived.is_none() && source.kind != SourceKind::Configuration;
    let mut known = BTreeSet::new();
    page.run
        .sources
        .iter()
        .map(AsRef::as_ref)
        .filter(is_input)
        .filter(move |source| known.insert(&source.path))
}

/// The verdict, the counts and the facts.
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
        ("note", summary.hints, "hints"),
        ("pass", summary.passed, "checks passed"),
        ("open", summary.not_evaluated, "not evaluated"),
        ("waived", summary.waived, "waived"),
        ("crashed", summary.crashed, "crashed"),
    ];
    // Counts of zero are omitted, except for faults and passes.
    let is_shown = |count: usize, name: &str| count > 0 || !["hints", "waived", "crashed"].contains(&name);
    html! {
        header class={ "verdict " (class) } {
            p class="kind" { "frames-lint " (env!("CARGO_PKG_VERSION")) " acceptance report" }
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
            dl class="facts" { @for (name, fact) in facts(page) { div { dt { (name) } dd { (fact) } } } }
        }
    }
}

/// What the verdict is about, for the person who signs it.
fn facts(page: &Page) -> Vec<(&'static str, Markup)> {
    let run = page.run;
    let summary = run.summary(page.fail_on);
    let count = given(page).count();
    let inputs = html! {
        @for (index, input) in given(page).take(NAMED).enumerate() {
            @if index > 0 { ", " }
            code { (plain(&input.path)) }
        }
        @if count > NAMED { " and " a href="#inputs" { (count - NAMED) " more" } }
        @if count == 0 { "none" }
    };
    let made = html! {
        (summary.judged) " of " (summary.applicable) " applicable"
        @if summary.applicable > 0 { (format!(" ({:.1} %)", summary.judged as f64 / summary.applicable as f64 * 100.0)) }
    };
    let mut facts = vec![("Platform", platform(page)), ("Inputs", inputs)];
    if let Some(day) = &page.call.day {
        facts.insert(0, ("Date of the run", html! { (day) " (UTC)" }));
    }
    if let Some(examined) = examined(page) {
        let parts = examined_words(&examined).join(", ");
        facts.push(("Examined", html! { (parts) }));
    }
    facts.push(("Checks evaluated", made));
    facts.push(("Configuration", configuration(page)));
    facts
}

/// The names of the robots, or the folder of the files.
fn platform(page: &Page) -> Markup {
    let robots = page.run.worlds.iter().flat_map(|world| &world.robots);
    let robots: BTreeSet<&str> = robots.map(|robot| robot.name.value.as_str()).collect();
    let located = Locator::inside(&page.run.sources);
    let folder = located.folder().trim_end_matches('/');
    html! {
        @for (index, robot) in robots.iter().take(NAMED).enumerate() {
            @if index > 0 { ", " }
            "robot " code { (plain(robot)) }
        }
        @if robots.len() > NAMED { " and " (plural(robots.len() - NAMED, "more robot")) }
        @if robots.is_empty() { "no robot description was read" }
        @if !folder.is_empty() { "; files in " code { (plain(folder)) } }
    }
}

/// How much of all inputs was read; messages if every recording states its number of messages.
fn examined(page: &Page) -> Option<Coverage> {
    let inputs = page.run.sources.iter().filter(|source| source.derived.is_none());
    let parts = inputs
        .filter(|source| source.kind != SourceKind::Configuration)
        .map(|source| &source.examined);
    let mut all: Option<Coverage> = None;
    for part in parts {
        let all = all.get_or_insert_with(Coverage::default);
        all.bytes += part.bytes;
        all.bytes_total += part.bytes_total;
        let Some(messages) = part.messages else { continue };
        all.messages_total = match (all.messages, all.messages_total, part.messages_total) {
            (None, _, total) => total,
            (_, Some(so_far), Some(total)) => Some(so_far + total),
            _ => None,
        };
        all.messages = Some(all.messages.unwrap_or_default() + messages);
    }
    all
}

/// The configurations with their hashes.
pub(super) fn configuration(page: &Page) -> Markup {
    let run = page.run;
    let is_one = |source: &&Source| source.kind == SourceKind::Configuration;
    let configurations: Vec<&Source> = run.sources.iter().map(AsRef::as_ref).filter(is_one).collect();
    html! {
        @if configurations.is_empty() { "none: default limits of the rules" }
        @else {
            ul class="bare" {
                @for source in configurations.iter().take(NAMED) {
                    li { code { (plain(&source.path)) } " – SHA-256 " (hashes(source)) }
                }
                @if configurations.len() > NAMED { li { "and " a href="#inputs" { (configurations.len() - NAMED) " more" } } }
            }
        }
    }
}

/// The verdict of each recording, if there are several.
pub(super) fn recordings(page: &Page) -> Option<Markup> {
    let recordings = &page.run.recordings;
    if recordings.is_empty() {
        return None;
    }
    let mut recordings: Vec<&Recording> = recordings.iter().collect();
    recordings.sort_by_key(|recording| {
        let summary = &recording.summary;
        let rank = match summary.verdict {
            VerdictWord::Findings => 0,
            VerdictWord::Incomplete => 1,
            VerdictWord::Clean => 2,
        };
        (rank, Reverse((summary.errors, summary.warnings)))
    });
    Some(html! {
        p class="hint" {
            "The worst comes first. Each recording was checked with the files of its platform, without the other \
             recordings. Findings in those files count for each recording, and are listed once below."
        }
        table class="cards" {
            thead { tr { @for name in OF_RECORDING { th scope="col" { (name) } } } }
            tbody { @for recording in recordings { (recording_row(recording)) } }
        }
    })
}

/// The columns of the table of recordings.
const OF_RECORDING: [&str; 7] = [
    "Recording",
    "Verdict",
    "Errors",
    "Warnings",
    "Passed",
    "Not evaluated",
    "Because",
];

fn recording_row(recording: &Recording) -> Markup {
    let summary = &recording.summary;
    let (class, sign, word) = signed(summary.verdict);
    let [_, _, errors, warnings, passed, not_evaluated, _] = OF_RECORDING;
    let (reasons, more) = recording.reasons.split_at(recording.reasons.len().min(REASONS));
    // The reason of the verdict is one of the reasons, except for what could not be read.
    let is_among = |because: &&String| reasons.iter().any(|(_, reason)| reason == *because);
    let because = recording.because.as_ref().filter(|because| !is_among(because));
    html! {
        tr {
            th scope="row" { code { (plain(&recording.label)) } }
            td { (badge(class, sign, word)) }
            td data-name=(errors) { (summary.errors) }
            td data-name=(warnings) { (summary.warnings) }
            td data-name=(passed) { (summary.passed) }
            td data-name=(not_evaluated) { (summary.not_evaluated) }
            td {
                ul class="bare" {
                    @if let Some(because) = because { li { (words(because)) } }
                    @for (severity, reason) in reasons {
                        @let (class, sign) = if *severity == Severity::Error { ("fail", "✗") } else { ("warning", "!") };
                        li { (badge(class, sign, severity.word())) " " (words(reason)) }
                    }
                    @if !more.is_empty() { li { "and " (plural(more.len(), "more rule")) } }
                }
            }
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

/// Requirements that are not met: unchecked properties must not be accepted unnoticed.
pub(super) fn required(page: &Page) -> Option<Markup> {
    let unmet = &page.run.unmet;
    if unmet.is_empty() {
        return None;
    }
    Some(html! {
        p class="hint" { "The configuration requires these checks, but they could not be evaluated." }
        table class="cards" {
            thead { tr { th scope="col" { "Check" } th scope="col" { "Why it was not evaluated" } th scope="col" { "What to do" } } }
            tbody { @for unmet in unmet.iter().take(MAX_UNMET) { (row(unmet)) } }
        }
        @if unmet.len() > MAX_UNMET { p { "… and " (plural(unmet.len() - MAX_UNMET, "more check")) } }
    })
}

fn row(unmet: &UnmetRequirement) -> Markup {
    html! {
        tr {
            th scope="row" {
                @if unmet.kind != RequirementKind::Rule { (unmet.rule) } @else { a href={ "#rule-" (unmet.rule) } { (unmet.rule) } }
                " " (unmet.name)
                @if let Some(subject) = &unmet.subject { " of " code { (plain(subject)) } }
                p class="small" { "required in " (plain(&unmet.origin)) }
            }
            td data-name="Why it was not evaluated" { ul class="bare" { @for why in unmet.reasons() { li { (words(&why)) } } } }
            td data-name="What to do" {
                @if let Some(waived) = &unmet.waived { (accepted(waived)) }
                @else if let Some(record) = &unmet.record { (words(record)) }
                @else { "Add the missing input and check again." }
            }
        }
    }
}

/// An acceptance: why, by whom, until when, and where it is declared.
pub(super) fn accepted(waived: &Acceptance) -> Markup {
    html! {
        p class="accepted" {
            (badge("waived", "⊘", "waived")) " " (words(&waived.reason))
            @if let Some(by) = &waived.by { ", by " strong { (plain(by)) } }
            @if let Some(until) = &waived.until { ", until " (until.as_str()) }
            " (" (plain(&waived.origin)) ")"
        }
    }
}

/// The fields for the signature.
pub(super) fn decision(page: &Page) -> Markup {
    let summary = page.run.summary(page.fail_on);
    let advice = match summary.verdict {
        VerdictWord::Clean => "No finding counts.",
        VerdictWord::Findings => {
            "Findings count against this dataset: fix each, or accept it with a reason, before the data are used."
        }
        VerdictWord::Incomplete => "Required inputs or checks are missing: this is not a pass.",
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
