//! The acceptance report: one page that states what was checked, with which evidence and result, for a person who accepts or rejects
//! a dataset and signs it.
//!
//! Owns the frame of the page and the order of its parts. The page loads nothing: style, script and drawings are part of it, and its
//! content security policy allows nothing else. It is complete without the script, and contains no time: the same run on the same date
//! gives the same bytes.

mod assurance;
mod checklist;
mod findings;
mod fitness;
mod hashes;
mod inputs;
mod made;
mod plots;
mod scale;
mod shown;
mod snippet;
mod summary;
#[cfg(test)]
mod tests;
mod words;

use std::collections::BTreeMap;

use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use maud::{DOCTYPE, Markup, PreEscaped, html};
use sha2::{Digest, Sha256};

use crate::assure::Assurance;
use crate::run::{FailOn, Run};
use crate::verdict::Finding;

use super::Call;
use super::place::Locator;
use super::text::plural;
use super::tree::svg;

const STYLE: &str = include_str!("style.css");
const SCRIPT: &str = include_str!("script.js");

/// Maximum number of frames drawn: larger trees are unreadable, and a hostile file may have a hundred thousand frames.
const MAX_FRAMES: usize = 600;

/// Maximum width, in pixels, of a tree with a column for each depth: the width of a sheet of paper.
const WIDEST: u32 = 700;

/// Up to this width the tree is scaled down in a narrower window; a wider one is scrolled.
const FITTING: u32 = 1500;

/// Maximum height of a part of the tree on a sheet of paper.
const SHEET: u32 = 880;

/// Data for every part of the page.
struct Page<'a> {
    run: &'a Run,
    fail_on: FailOn,
    locator: Locator<'a>,
    call: &'a Call,
    /// Numbers of the findings of a rule and a subject.
    found: BTreeMap<(&'a str, &'a str), Vec<usize>>,
}

impl<'a> Page<'a> {
    fn new(run: &'a Run, fail_on: FailOn, call: &'a Call) -> Self {
        let mut found: BTreeMap<(&str, &str), Vec<usize>> = BTreeMap::new();
        for (number, finding) in run.verdict.findings.iter().enumerate() {
            found.entry((&finding.rule, &finding.subject)).or_default().push(number);
        }
        Self {
            run,
            fail_on,
            locator: Locator::new(&run.sources),
            call,
            found,
        }
    }

    /// The findings of a rule on a subject, with their numbers.
    fn findings_of(&self, rule: &str, subject: &str) -> Vec<(usize, &'a Finding)> {
        let numbers = self.found.get(&(rule, subject)).map_or(&[] as &[usize], Vec::as_slice);
        numbers
            .iter()
            .filter_map(|number| Some((*number, self.run.verdict.findings.get(*number)?)))
            .collect()
    }
}

/// The whole page.
pub(super) fn render(run: &Run, fail_on: FailOn, call: &Call) -> String {
    let page = Page::new(run, fail_on, call);
    let shown = shown::ShownFindings::new(run);
    let drawn = plots::PlotMarkup::new(&page, &shown);
    let parts = [
        ("decision", "Decision", Some(summary::decision(&page))),
        ("required", "Requirements not met", summary::required(&page)),
        (
            "assurance",
            "Known mistakes",
            run.assurance.as_ref().map(assurance::render),
        ),
        ("fitness", "Fit for calibration", fitness::render(run)),
        ("recordings", "Recordings", summary::recordings(&page)),
        ("findings", "Findings", Some(findings::open(&page, &shown, &drawn))),
        ("waived", "Waived findings", findings::waived(&page, &shown, &drawn)),
        ("checklist", "Checklist", checklist::render(&page, &shown, &drawn)),
        ("plots", "Plots", drawn.others()),
        ("tree", "Frame tree", tree(run)),
        ("inputs", "Inputs", inputs::render(&page)),
        ("made", "How this report was made", Some(made::render(&page))),
    ];
    let parts: Vec<(&str, &str, Markup)> = parts
        .into_iter()
        .filter_map(|(id, title, part)| Some((id, title, part?)))
        .collect();
    document(&summary::title(&page), &summary::header(&page), &parts)
}

/// The page of known mistakes alone.
pub(super) fn assured(assurance: &Assurance) -> String {
    let header = html! { header { h1 { "Known mistakes" } } };
    let part = (
        "assurance",
        "What these data would have shown",
        assurance::render(assurance),
    );
    document("frames-lint: known mistakes", &header, &[part])
}

/// A page of a header and of parts, each with an id and a title.
fn document(title: &str, header: &Markup, parts: &[(&str, &str, Markup)]) -> String {
    let whole = html! {
        (DOCTYPE)
        html lang="en" {
            head {
                meta charset="utf-8";
                meta http-equiv="Content-Security-Policy" content=(policy());
                meta name="viewport" content="width=device-width, initial-scale=1";
                meta name="color-scheme" content="light dark";
                meta name="referrer" content="no-referrer";
                meta name="generator" content={ "frames-lint " (env!("CARGO_PKG_VERSION")) };
                title { (title) }
                style { (PreEscaped(STYLE)) }
            }
            body {
                a class="skip" href="#main" { "Skip to the report" }
                (header)
                nav aria-label="Parts of the report" {
                    ul {
                        @for (id, title, _) in parts { li { a href={ "#" (id) } { (title) } } }
                    }
                }
                main id="main" tabindex="-1" {
                    @for (id, title, part) in parts {
                        section id=(id) aria-labelledby={ (id) "-title" } {
                            h2 id={ (id) "-title" } { (title) }
                            (part)
                        }
                    }
                }
                footer {
                    p {
                        "Made by frames-lint " (env!("CARGO_PKG_VERSION"))
                        ". This file is self-contained: it loads nothing and sends nothing."
                    }
                }
                script { (PreEscaped(SCRIPT)) }
            }
        }
    };
    whole.into_string() + "\n"
}

/// The content security policy: only the style and the script of this page.
fn policy() -> String {
    let hash = |text: &str| STANDARD.encode(Sha256::digest(text.as_bytes()));
    format!(
        "default-src 'none'; style-src 'sha256-{}'; script-src 'sha256-{}'; base-uri 'none'; form-action 'none'",
        hash(STYLE),
        hash(SCRIPT)
    )
}

/// The frame tree, with the source of each transform.
fn tree(run: &Run) -> Option<Markup> {
    let frames: usize = run.worlds.iter().map(|world| world.graph().frames.len()).sum();
    let too_many = |frames: usize| {
        html! {
            p {
                (plural(frames, "frame")) ": too many to draw here. "
                code { "frames-lint tree --format svg" } " draws them into a separate file."
            }
        }
    };
    if frames > MAX_FRAMES {
        return Some(too_many(frames));
    }
    let drawing = svg::drawing(run, Some(WIDEST));
    if drawing.frames == 0 {
        return None;
    }
    if drawing.frames > MAX_FRAMES {
        return Some(too_many(drawing.frames));
    }
    let width = drawing.width;
    Some(html! {
        @if let Some(first) = run.recordings.first() {
            p { "This is the tree of " code { (words::plain(&first.label)) } ", the first recording." }
        }
        p class="hint" {
            "Parents are left of their children or above them. Each box shows the pose in the parent frame and the file or topic that states it \
             first; further sources are in the tooltip."
        }
        div class="wide" role="region" aria-label="Frame tree" tabindex="0" {
            @for (index, (from, to)) in drawing.sheets(SHEET).into_iter().enumerate() {
                svg class={ "tree" @if width <= FITTING { " fit" } } role="img" aria-label={ "Frame tree, " (plural(drawing.frames, "frame")) }
                    aria-hidden=[(index > 0).then_some("true")] width=(width) height=(to - from)
                    viewBox={ "0 " (from) " " (width) " " (to - from) } {
                    // The first sheet contains the whole drawing, and each shows its own part.
                    @if index == 0 { g id="tree-drawing" class="frames" { (PreEscaped(&drawing.body)) } } @else { (PreEscaped("<use href=\"#tree-drawing\"/>")) }
                }
            }
        }
    })
}
