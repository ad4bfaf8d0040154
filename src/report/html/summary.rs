//! The first page: the verdict in words with its counts, of what, when and by how much, and where the person who decides signs.
//! Behind it what was required and not judged, and the recordings.

use std::cmp::Reverse;
use std::collections::BTreeSet;

use maud::{Markup, html};

use crate::run::{Recording, Unmet, VerdictWord};
use crate::source::{Examined, Source, SourceKind};
use crate::verdict::{Severity, Waived};

use super::super::place::Locator;
use super::super::terminal::{examined_words, plain_ending};
use super::super::text::plural;
use super::Page;
use super::hashes::hashes;
use super::words::{badge, plain, words};

/// Inputs that the head names.
const NAMED: usize = 4;
/// Reasons of one recording.
const REASONS: usize = 5;
/// Required rules that are shown.
const MAX_UNMET: usize = 200;

/// What the page is called.
pub(super) fn title(page: &Page) -> String {
    let (_, _, word) = signed(page.run.summary(page.fail_on).verdict);
    let name = given(page).next().map_or_else(String::new, |input| {
        let path = plain(&input.path);
        let last = path.rsplit('/').next().unwrap_or(&path);
        format!(": {last}")
    });
    format!("{word}{name} – frames-lint acceptance report")
}

/// Files that were given, without those of the tool itself and what came out of others.
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
        ("note", summary.hints, "hints"),
        ("pass", summary.passed, "checks passed"),
        ("open", summary.not_evaluated, "not evaluated"),
        ("waived", summary.waived, "waived"),
        ("crashed", summary.crashed, "crashed"),
    ];
    // What there is nothing of need not be looked at, but for faults and passes.
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

/// What the verdict is of: for whoever signs it.
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
        (summary.judged) " of " (summary.applicable) " that apply"
        @if summary.applicable > 0 { (format!(" ({:.1} %)", summary.judged as f64 / summary.applicable as f64 * 100.0)) }
    };
    let mut facts = vec![("Platform", platform(page)), ("Inputs", inputs)];
    if let Some(day) = &page.call.day {
        facts.insert(0, ("Day of the run", html! { (day) " (UTC)" }));
    }
    if let Some(examined) = examined(page) {
        let parts = examined_words(&examined).join(", ");
        facts.push(("Examined", html! { (parts) }));
    }
    facts.push(("Checks made", made));
    facts.push(("Configuration", configuration(page)));
    facts
}

/// What the robots are called, or where the files lie.
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

/// How much of all inputs was examined; messages where each recording says how many it has.
fn examined(page: &Page) -> Option<Examined> {
    let inputs = page.run.sources.iter().filter(|source| source.derived.is_none());
    let parts = inputs
        .filter(|source| source.kind != SourceKind::Configuration)
        .map(|source| &source.examined);
    let mut all: Option<Examined> = None;
    for part in parts {
        let all = all.get_or_insert_with(Examined::default);
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
        @if configurations.is_empty() { "none: the limits are those of the rules' pages" }
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

/// The verdict of each recording, where there are several.
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
            "The worst stands first. Each recording was judged with the files that belong to its platform, and without the other \
             recordings. What was found in those files counts for each of them, and stands once below."
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
    // What decides is among the reasons, but for what could not be looked at.
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
                    @if !more.is_empty() { li { "and of " (plural(more.len(), "more rule")) } }
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

/// Requirements that are not met: the dataset may not be accepted by what nobody looked at.
pub(super) fn required(page: &Page) -> Option<Markup> {
    let unmet = &page.run.unmet;
    if unmet.is_empty() {
        return None;
    }
    Some(html! {
        p class="hint" { "These checks are required by the configuration. Nothing is known of them until they have been made." }
        table class="cards" {
            thead { tr { th scope="col" { "Check" } th scope="col" { "Why it was not made" } th scope="col" { "What to do" } } }
            tbody { @for unmet in unmet.iter().take(MAX_UNMET) { (row(unmet)) } }
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
            td data-name="Why it was not made" { ul class="bare" { @for why in unmet.reasons() { li { (words(&why)) } } } }
            td data-name="What to do" {
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
