//! The inputs: format, status, share that was read, and hash of each.

use maud::{Markup, html};

use crate::source::{Problem, ReadStatus, Source, SourceKind};

use super::super::terminal::examined_words;
use super::super::text::{bytes, plural};
use super::Page;
use super::findings::place;
use super::hashes::hashes;
use super::snippet;
use super::words::{badge, plain, words};

/// Maximum number of inputs shown; those with problems come first.
const MAX_INPUTS: usize = 500;
/// Maximum number of problems shown per input.
const MAX_PROBLEMS: usize = 10;
/// Maximum number of kinds of skipped files that are named.
const MAX_SKIPPED: usize = 40;

pub(super) fn render(page: &Page) -> Option<Markup> {
    let mut sources: Vec<&Source> = page.run.sources.iter().map(AsRef::as_ref).collect();
    let skipped = &page.run.skipped;
    if sources.is_empty() && skipped.is_empty() {
        return None;
    }
    sources.sort_by_key(|source| (rank(source), source.id));
    Some(html! {
        table class="inputs cards" {
            thead {
                tr {
                    th scope="col" { "Input" } th scope="col" { "Read" } th scope="col" { "Size" }
                    th scope="col" { "Examined" } th scope="col" { "SHA-256" }
                }
            }
            tbody { @for source in sources.iter().take(MAX_INPUTS) { (row(page, source)) } }
        }
        @if sources.len() > MAX_INPUTS { p class="left-out" { "… and " (plural(sources.len() - MAX_INPUTS, "more input")) } }
        @if !skipped.is_empty() {
            p {
                span class="label" { "Skipped (format not supported): " }
                @for (index, (kind, count)) in skipped.iter().take(MAX_SKIPPED).enumerate() {
                    @if index > 0 { ", " }
                    (count) " " code { (plain(kind)) }
                }
                @if skipped.len() > MAX_SKIPPED { " and " (plural(skipped.len() - MAX_SKIPPED, "more kind")) }
            }
        }
    })
}

/// Inputs that could not be read first, then the others, then configurations.
fn rank(source: &Source) -> u8 {
    match (source.status, source.kind) {
        (ReadStatus::Read, SourceKind::Configuration) => 2,
        (ReadStatus::Read, _) => 1,
        _ if source.required => 0,
        _ => 3,
    }
}

fn row(page: &Page, source: &Source) -> Markup {
    let (class, sign) = match (source.status, source.required) {
        (ReadStatus::Read, _) => ("pass", "✓"),
        (_, false) => ("open", "–"),
        (ReadStatus::Partial, true) => ("warning", "!"),
        (ReadStatus::Unreadable, true) => ("fail", "✗"),
    };
    // A text extracted from another source was read with it.
    let own = source.derived.is_none();
    let said = source
        .problems
        .iter()
        .any(|problem| Some(&problem.message) == source.detail.as_ref());
    html! {
        tr {
            th scope="row" { code { (plain(&page.locator.name(source.id))) } p class="small" { (source.kind.word()) } }
            td {
                (badge(class, sign, source.status.word()))
                @if let Some(detail) = source.detail.as_ref().filter(|_| !said) { p { (words(detail)) } }
                @if let Some(understood) = source.understood() { p { (words(&understood)) } }
                @for note in &source.notes { p { (words(note)) } }
                @for problem in source.problems.iter().take(MAX_PROBLEMS) { (fault(page, problem)) }
                @if source.problems.len() > MAX_PROBLEMS {
                    p { "… and " (plural(source.problems.len() - MAX_PROBLEMS, "more problem")) }
                }
            }
            td class="number" data-name="Size" { @if own { (bytes(source.examined.bytes_total)) } @else { "–" } }
            td data-name="Examined" {
                @if own { ul class="bare" { @for part in examined_words(&source.examined) { li { (part) } } } } @else { "with its source" }
            }
            td class="hash" data-name="SHA-256" { (hashes(source)) }
        }
    }
}

fn fault(page: &Page, problem: &Problem) -> Markup {
    html! {
        div class="problem" {
            p { (words(&problem.message)) }
            @if problem.place.at != crate::source::SourcePart::Whole { p { code { (place(page, &problem.place)) } } }
            @if let Some(lines) = snippet::render(&problem.place, &page.locator) { (lines) }
            @if let Some(help) = &problem.help { p { span class="label" { "What to do: " } (words(help)) } }
        }
    }
}
