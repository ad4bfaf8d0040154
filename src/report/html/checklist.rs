//! The checklist: every rule that ran, by family, and each of its items with the evidence, or with the reason why there is none.
//!
//! Filtering works by the style sheet alone; the script adds a search.

use std::collections::{BTreeMap, BTreeSet};
use std::fmt::Write;

use maud::{Markup, html};

use crate::page;
use crate::page::Status;
use crate::tables::views;
use crate::verdict::waiver::plain_subject;
use crate::verdict::{Measured, Outcome, Row};

use super::super::terminal::NumberText;
use super::super::text::plural;
use super::findings;
use super::plots::PlotMarkup;
use super::shown::ShownFindings;
use super::words::{badge, outcome, plain, rank, words};
use super::{Page, summary};

/// Maximum number of items per rule, and in total; more are only counted.
const MAX_OF_RULE: usize = 200;
const MAX_ITEMS: usize = 6000;
/// Maximum number of numbers per item.
const MAX_MEASURED: usize = 8;

/// The families, in the order of the registry, with their topics.
const FAMILIES: &[(&str, &str)] = &[
    ("TREE", "The frame tree"),
    ("NAME", "Names of frames"),
    ("ROT", "Rotations and transforms as written"),
    ("AXES", "Axes, compared with motion and ground"),
    ("QUAT", "Quaternions and Euler angles"),
    ("GEO", "Positions on the Earth"),
    ("TIME", "Timestamps and clocks"),
    ("SENSOR", "Conventions of sensors and datasets"),
    ("CAMERA", "Cameras"),
    ("COV", "Covariances"),
    ("AUTH", "Sources of transforms"),
    ("CROSS", "Sources compared with each other"),
    ("CONFIG", "Settings of programs"),
    ("URDF", "Robot descriptions"),
    ("PREC", "Precision of numbers"),
    ("GATE", "Waivers"),
];

/// An item of the list.
#[derive(Clone, Copy)]
struct Item<'a> {
    /// Its index in the rows.
    index: usize,
    row: &'a Row,
    /// The number of recordings that it represents.
    times: usize,
}

/// The list with the filter.
pub(super) fn render(page: &Page, shown: &ShownFindings, drawn: &PlotMarkup) -> Option<Markup> {
    let run = page.run;
    if run.verdict.rows.is_empty() {
        return None;
    }
    let mut items: BTreeMap<&str, Vec<Item>> = BTreeMap::new();
    for (index, row) in run.verdict.rows.iter().enumerate() {
        items.entry(&row.rule).or_default().push(Item { index, row, times: 1 });
    }
    if !run.recordings.is_empty() {
        for items in items.values_mut() {
            joined(items, &run.platforms);
        }
    }
    let mut families: Vec<(&str, Vec<&page::Page>)> = Vec::new();
    for rule in &run.rules {
        match families.last_mut() {
            Some((family, rules)) if *family == rule.family() => rules.push(rule),
            _ => families.push((rule.family(), vec![rule])),
        }
    }
    let place = |family: &str| FAMILIES.iter().position(|(known, _)| *known == family);
    families.sort_by_key(|(family, _)| place(family).unwrap_or(FAMILIES.len()));
    let known: BTreeSet<&str> = run.rules.iter().map(|rule| rule.code).collect();
    let strangers: Vec<(&&str, &Vec<Item>)> = items.iter().filter(|(code, _)| !known.contains(*code)).collect();
    let mut room = MAX_ITEMS;
    Some(html! {
        (choice(page))
        @for (family, rules) in &families {
            @let title = FAMILIES.iter().find(|(known, _)| known == family).map_or("", |(_, title)| title);
            (table(family, title, &html! {
                @for rule in rules {
                    (group(page, shown, drawn, (rule.code, Some(rule)), items.get(rule.code), &mut room))
                }
            }))
        }
        @if !strangers.is_empty() {
            (table("", "Other checks", &html! {
                @for (code, items) in strangers { (group(page, shown, drawn, (code, None), Some(items), &mut room)) }
            }))
        }
        p class="nothing" role="status" { "No check matches." }
    })
}

/// A check that could not be evaluated in several recordings for the same reason is one item.
fn joined(items: &mut Vec<Item>, platforms: &[String]) {
    let mut known: BTreeMap<(&str, &str), usize> = BTreeMap::new();
    let mut kept: Vec<Item> = Vec::with_capacity(items.len());
    for item in items.drain(..) {
        let subject = plain_subject(&item.row.subject, platforms);
        let reason = item.row.reason.as_deref().unwrap_or_default();
        let at =
            (item.row.outcome == Outcome::NotEvaluated).then(|| *known.entry((subject, reason)).or_insert(kept.len()));
        match at.and_then(|at| kept.get_mut(at)) {
            Some(same) => same.times += 1,
            None => kept.push(item),
        }
    }
    *items = kept;
}

fn table(family: &str, title: &str, groups: &Markup) -> Markup {
    html! {
        div class="family" {
            h3 { (family) @if !family.is_empty() && !title.is_empty() { " – " } (title) }
            table class="checks" {
                thead {
                    tr { th scope="col" { "Check" } th scope="col" { "Result" } th scope="col" { "Evidence" } }
                }
                (groups)
            }
        }
    }
}

/// The filter: items of all outcomes, or of one.
fn choice(page: &Page) -> Markup {
    let count = |wanted: &[Outcome]| wanted.iter().map(|one| page.run.verdict.count(*one)).sum::<usize>();
    let choices = [
        ("all", "all", page.run.verdict.rows.len()),
        ("fail", "✗ failed", count(&[Outcome::Fail, Outcome::Crashed])),
        ("waived", "⊘ waived", count(&[Outcome::Waived])),
        ("open", "– not evaluated", count(&[Outcome::NotEvaluated])),
        ("pass", "✓ passed", count(&[Outcome::Pass])),
    ];
    html! {
        fieldset class="choice" {
            legend { "Show" }
            @for (value, name, count) in choices {
                label {
                    input type="radio" name="show" id={ "show-" (value) } value=(value) checked[value == "all"];
                    " " (name) " (" (count) ")"
                }
            }
            label class="search" hidden { "Search " input type="search" id="search" autocomplete="off"; }
        }
    }
}

/// One rule with its items.
fn group(
    page: &Page,
    shown: &ShownFindings,
    drawn: &PlotMarkup,
    (code, rule): (&str, Option<&page::Page>),
    items: Option<&Vec<Item>>,
    room: &mut usize,
) -> Markup {
    let none = Vec::new();
    let mut items: Vec<Item> = items.unwrap_or(&none).clone();
    // Failures must not be among those that are only counted.
    items.sort_by_key(|item| (rank(item.row.outcome), item.index));
    let most = MAX_OF_RULE.min(*room);
    let left = items.split_off(most.min(items.len()));
    *room -= items.len();
    let mut classes: BTreeSet<String> = BTreeSet::new();
    for item in items.iter().chain(&left) {
        classes.insert(format!("has-{}", class(item.row.outcome)));
    }
    let classes: Vec<String> = classes.into_iter().collect();
    let name = rule.map(|rule| rule.name);
    let name = name
        .or_else(|| items.first().map(|item| &*item.row.name))
        .unwrap_or_default();
    let head = html! {
        th scope="rowgroup" id={ "rule-" (code) } {
            strong { (code) " " (name) }
            @if let Some(rule) = rule {
                p { span class="label" { "Finds: " } (words(rule.summary)) }
                p class="small" { (facts(rule)) }
                @if let Some(entity) = views::of(rule.view).and_then(views::View::words) {
                    p class="small" { "Views: " code { (entity) } }
                }
            }
        }
    };
    // A rule with one item needs no separate line.
    let whole = match items.as_slice() {
        [only] if left.is_empty() => Some(*only),
        _ => None,
    };
    html! {
        tbody class=(classes.join(" ")) {
            @if let Some(item) = whole {
                tr class={ "rule item " (class(item.row.outcome)) } {
                    (head)
                    td { (result(page, item.row)) }
                    td {
                        @if item.row.subject != "platform" { p class="label" { (subject(page, &item)) } }
                        (evidence(page, shown, drawn, &item))
                    }
                }
            } @else {
                tr class="rule" {
                    (head)
                    td colspan="2" { (counts(&items, &left)) }
                }
                @for item in &items {
                    tr class={ "item " (class(item.row.outcome)) } {
                        th scope="row" { (subject(page, item)) }
                        td { (result(page, item.row)) }
                        td { (evidence(page, shown, drawn, item)) }
                    }
                }
                @if !left.is_empty() {
                    tr class="more" {
                        td colspan="3" { "… and " (plural(left.len(), "more item")) " not shown: " (counts(&left, &[])) }
                    }
                }
            }
        }
    }
}

/// `error · certain · stable since 0.1.0`.
fn facts(rule: &page::Page) -> String {
    let status = match rule.status {
        Status::Stable => "stable",
        Status::Trial => "on trial (findings are hints),",
    };
    let (severity, confidence) = (rule.severity.word(), rule.confidence.word());
    format!("{severity} at worst, {confidence}; {status} since {}", rule.since)
}

/// The class of an item. Crashes are shown with failures.
fn class(of: Outcome) -> &'static str {
    match of {
        Outcome::Crashed => "fail",
        other => outcome(other).0,
    }
}

fn counts(items: &[Item], left: &[Item]) -> Markup {
    let mut counts: BTreeMap<usize, (Outcome, usize)> = BTreeMap::new();
    for Item { row, times, .. } in items.iter().chain(left) {
        counts.entry(rank(row.outcome)).or_insert((row.outcome, 0)).1 += times;
    }
    html! {
        @if counts.is_empty() { "no item" }
        @for (index, (of, count)) in counts.values().enumerate() {
            @let (class, sign, word) = outcome(*of);
            @if index > 0 { ", " }
            (badge(class, sign, &format!("{count} {word}")))
        }
    }
}

fn result(page: &Page, row: &Row) -> Markup {
    let (class, sign, word) = outcome(row.outcome);
    // A failed subject whose findings do not count is shown less prominently.
    let findings = page.findings_of(&row.rule, &row.subject);
    let counts = findings.iter().any(|(_, one)| page.fail_on.counts(one));
    let class = if row.outcome == Outcome::Fail && !counts {
        "warning"
    } else {
        class
    };
    badge(class, sign, word)
}

fn subject(page: &Page, item: &Item) -> Markup {
    if item.times == 1 {
        return words(&item.row.subject);
    }
    let subject = plain_subject(&item.row.subject, &page.run.platforms);
    html! { (words(subject)) " in " (plural(item.times, "recording")) }
}

fn evidence(page: &Page, shown: &ShownFindings, drawn: &PlotMarkup, item: &Item) -> Markup {
    let (index, row) = (item.index, item.row);
    let findings = page.findings_of(&row.rule, &row.subject);
    html! {
        @if let Some(reason) = &row.reason { p { (words(reason)) } }
        @if !row.measured.is_empty() {
            ul class="bare" {
                @for measured in row.measured.iter().take(MAX_MEASURED) { li { (number(measured)) } }
                @if row.measured.len() > MAX_MEASURED {
                    li { "… and " (plural(row.measured.len() - MAX_MEASURED, "more number")) }
                }
            }
        }
        @for (number, finding) in findings.iter().take(3) {
            p {
                (findings::severity(finding)) " "
                @if shown.has(*number) { a href={ "#finding-" (number + 1) } { "finding " (number + 1) } }
                @else { "finding " (number + 1) }
                @if !page.fail_on.counts(finding) && finding.waived.is_none() { " – does not count" }
            }
            @if let Some(waived) = &finding.waived { (summary::accepted(waived)) }
        }
        @if findings.len() > 3 { p { "… and " (plural(findings.len() - 3, "more finding")) } }
        @for id in drawn.ids(index) { p { a href={ "#" (id) } { "plot" } } }
    }
}

fn number(measured: &Measured) -> Markup {
    let spelled = NumberText::new(measured);
    let mut rest = String::new();
    for (name, value) in [(measured.bound.word(), &spelled.limit), ("spread", &spelled.spread)] {
        if let Some(value) = value {
            let _ = write!(rest, ", {name} {value}");
        }
    }
    if let Some(n) = measured.n {
        let _ = write!(rest, ", n = {n}");
    }
    html! { (words(&measured.what)) ": " strong { (plain(&spelled.value)) } (plain(&rest)) }
}
