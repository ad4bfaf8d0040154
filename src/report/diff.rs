//! Two platforms compared, for people and as JSON.

use std::fmt::Write;

use serde_json::{Value, json};

use crate::compare::{Change, Comparison};
use crate::visible::pretty_json;

use super::Style;
use super::style::Ink;
use super::terminal::measured_words;
use super::text::{clean, one_line, plural, wrap};

/// Places shown on either side.
const MAX_STATED: usize = 4;

/// For people: the changes by kind, and a line with the numbers of compared items.
pub fn text(comparison: &Comparison, [a, b]: [&str; 2], style: Style) -> String {
    let mut out = String::new();
    let mut kind = None;
    for change in &comparison.changes {
        if kind != Some(change.kind) {
            let title = match change.kind.word() {
                "transform" => "Transforms",
                "origin" => "Map origin",
                "convention" => "Topics and their frames",
                "clock" => "Clocks and rates",
                _ => "Checks",
            };
            let _ = writeln!(
                out,
                "{}{}",
                if kind.is_some() { "\n" } else { "" },
                style.paint(Ink::Strong, title)
            );
            kind = Some(change.kind);
        }
        one(change, style, &mut out);
    }
    if kind.is_some() {
        out.push('\n');
    }
    let compared = format!(
        "Compared: {}, {} and {} that both contain.",
        plural(comparison.transforms, "transform"),
        plural(comparison.topics, "topic"),
        plural(comparison.checks, "check")
    );
    let _ = writeln!(out, "{compared}");
    let verdict = match comparison.changes.len() {
        _ if comparison.is_empty() => {
            format!(
                "Nothing was compared: {a} and {b} have no transform, topic or check in common. This is not a match."
            )
        }
        0 => format!("No change from {a} to {b}."),
        count => format!("{} from {a} to {b}.", plural(count, "change")),
    };
    let ink = if comparison.changes.is_empty() && !comparison.is_empty() {
        Ink::Good
    } else {
        Ink::Warning
    };
    let _ = writeln!(out, "{}", style.paint(ink, &one_line(&verdict)));
    out
}

fn one(change: &Change, style: Style, out: &mut String) {
    let _ = writeln!(out, "{}", wrap(&one_line(&change.message), style.width, "  ", "    "));
    if !change.explanation.is_empty() {
        let _ = writeln!(
            out,
            "{}",
            wrap(&clean(&change.explanation), style.width, "    ", "    ")
        );
    }
    for (which, stated) in ["before", "after"].iter().zip(&change.stated) {
        for who in stated.iter().take(MAX_STATED) {
            let _ = writeln!(out, "    {which}: {}", one_line(who));
        }
        if stated.len() > MAX_STATED {
            let _ = writeln!(
                out,
                "    {which}: ... and {}",
                plural(stated.len() - MAX_STATED, "more place")
            );
        }
    }
}

/// One document: `{"schema": "frames-lint-diff/1", ...}`.
pub fn json(comparison: &Comparison, [a, b]: [&str; 2]) -> Result<String, serde_json::Error> {
    let change = |change: &Change| -> Value {
        json!({
            "kind": change.kind.word(),
            "subject": change.subject,
            "message": change.message,
            "explanation": change.explanation,
            "relation": change.relation,
            "measured": change.measured.iter().map(|one| json!({
                "what": one.what,
                "value": one.value.is_finite().then_some(one.value),
                "unit": one.unit,
                "limit": one.limit,
                "words": measured_words(one),
            })).collect::<Vec<_>>(),
            "before": change.stated[0],
            "after": change.stated[1],
        })
    };
    let document = json!({
        "schema": "frames-lint-diff/1",
        "before": a,
        "after": b,
        "compared": {
            "transforms": comparison.transforms,
            "topics": comparison.topics,
            "checks": comparison.checks,
        },
        "changes": comparison.changes.iter().map(change).collect::<Vec<_>>(),
    });
    pretty_json(&document)
}
