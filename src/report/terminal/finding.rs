//! One finding: headline, source lines, messages of recordings, measured numbers, help and fix.

use std::fmt::Write;

use crate::source::{Confidence, MessageRef, Place, SourceId, SourcePart};
use crate::verdict::{Bound, Finding, Fix, Measured, PlaceRole, Safety, Severity};

use super::super::Style;
use super::super::place::Locator;
use super::super::style::Ink;
use super::super::text::{clean, number, one_line, plural, stamp, wrap};
use super::snippet::{Mark, Painter};

/// More places of one finding are only counted.
const MAX_PLACES: usize = 12;
/// More edits of one fix are only counted.
const MAX_EDITS: usize = 3;
/// Characters of a text that an edit shows.
const LONGEST: usize = 77;

/// A finding in full.
pub(super) fn full(finding: &Finding, locator: &Locator, painter: &Painter, style: Style, out: &mut String) {
    let head = format!(
        "{} {}",
        head(finding, style),
        style.paint(Ink::Strong, &one_line(&finding.message))
    );
    push(out, &wrap(&head, style.width, "", "  "));
    if !finding.detail.is_empty() {
        push(out, &wrap(&clean(&finding.detail), style.width, "  ", "  "));
    }
    places(finding, locator, painter, style, out);
    for (index, measured) in finding.measured.iter().enumerate() {
        let label = if index == 0 { "  measured: " } else { "            " };
        push(
            out,
            &wrap(&one_line(&measured_words(measured)), style.width, label, "            "),
        );
    }
    if !finding.help.is_empty() {
        push(out, &wrap(&clean(&finding.help), style.width, "  help: ", "        "));
    }
    if let Some(fix) = &finding.fix {
        fix_lines(fix, locator, style, out);
    }
}

/// A finding on one line, in the format that editors recognise.
pub(super) fn line(finding: &Finding, locator: &Locator, style: Style, out: &mut String) {
    let place = finding
        .places
        .first()
        .map_or_else(|| "?".to_owned(), |label| locator.short(&label.place));
    push(
        out,
        &format!(
            "{}: {} {}",
            one_line(&place),
            head(finding, style),
            one_line(&finding.message)
        ),
    );
}

/// `error[NAME06 optical-suffix]`, with the confidence if it is not certain. Hints are called `hint`, for any severity of the rule.
fn head(finding: &Finding, style: Style) -> String {
    let ink = match finding.severity {
        _ if finding.confidence == Confidence::Hint => Ink::Note,
        Severity::Error => Ink::Error,
        Severity::Warning => Ink::Warning,
        Severity::Note => Ink::Note,
    };
    let word = finding.word();
    let (rule, name) = (one_line(&finding.rule), one_line(&finding.name));
    let head = style.paint(ink, &format!("{word}[{} {name}]", style.link(&rule)));
    match finding.confidence {
        Confidence::Likely => format!("{head} (likely)"),
        Confidence::Certain | Confidence::Hint => head,
    }
}

/// Places in their order: those in one text together in one snippet, the others on a line each.
fn places(finding: &Finding, locator: &Locator, painter: &Painter, style: Style, out: &mut String) {
    let shown = finding.places.get(..MAX_PLACES).unwrap_or(&finding.places);
    let mut drawn: Vec<SourceId> = Vec::new();
    for label in shown {
        let id = label.place.source;
        if label.place.span().is_some() {
            if drawn.contains(&id) {
                continue;
            }
            drawn.push(id);
            let marks: Vec<Mark> = shown
                .iter()
                .filter(|other| other.place.source == id)
                .filter_map(|other| {
                    Some(Mark {
                        span: other.place.span()?,
                        note: other.note.clone(),
                        primary: other.role == PlaceRole::Primary,
                    })
                })
                .collect();
            if let Some(snippet) = painter.snippet(id, &marks) {
                out.push_str(&snippet);
                continue;
            }
        }
        let line = place_line(&label.place, &label.note, locator, style);
        push(out, &wrap(line.trim_start(), style.width, "  ", "    "));
    }
    if finding.places.len() > shown.len() {
        let more = plural(finding.places.len() - shown.len(), "more place");
        push(out, &format!("  ... and {more}"));
    }
}

/// A place without source lines, on one line.
pub(super) fn place_line(place: &Place, note: &str, locator: &Locator, style: Style) -> String {
    let arrow = style.pick("→", "->");
    let place = match &place.at {
        SourcePart::Message(message) => format!("{} {}", locator.find(place).path, message_words(message)),
        _ => locator.short(place),
    };
    let place = style.paint(Ink::Strong, &one_line(&place));
    if note.is_empty() {
        format!("  {arrow} {place}")
    } else {
        format!("  {arrow} {place}: {}", one_line(note))
    }
}

/// `/tf message 12, stamp 2023-11-14 22:13:20.000 UTC (1700000000 s), transforms[0]`.
pub(in crate::report) fn message_words(message: &MessageRef) -> String {
    let when = match message.stamp_ns {
        Some(ns) => format!("stamp {}", stamp(ns)),
        None => format!("recorded {}", stamp(message.log_ns)),
    };
    let field = message
        .field
        .as_ref()
        .map_or_else(String::new, |field| format!(", {field}"));
    format!("{} message {}, {when}{field}", message.topic, message.index)
}

/// `rotation difference = 90 deg, limit 1 deg, spread 0.2 deg, from 12 samples`. A condition that is met: `distance = 51 m (at least 5 m needed)`.
/// That none is allowed is not said of a number of things.
pub(in crate::report) fn measured_words(measured: &Measured) -> String {
    let spelled = NumberText::new(measured);
    let mut words = format!("{} = {}", measured.what, spelled.value);
    let allows_none = measured.bound == Bound::Within && measured.unit == "count" && measured.limit == Some(0.0);
    if let Some(limit) = spelled.limit.filter(|_| !allows_none) {
        let is_reached = measured.limit.is_some_and(|limit| measured.value >= limit);
        let _ = match measured.bound {
            Bound::AtLeast if is_reached => write!(words, " (at least {limit} needed)"),
            bound => write!(words, ", {} {limit}", bound.word()),
        };
    }
    if let Some(spread) = spelled.spread {
        let _ = write!(words, ", spread {spread}");
    }
    let is_counted = |n: u64| measured.unit == "count" && measured.value.total_cmp(&(n as f64)).is_eq();
    if let Some(n) = measured.n.filter(|n| *n > 1 && !is_counted(*n)) {
        let _ = write!(words, ", from {n} samples");
    }
    words
}

/// The numbers of a measurement with their units.
pub(in crate::report) struct NumberText {
    pub(in crate::report) value: String,
    pub(in crate::report) limit: Option<String>,
    pub(in crate::report) spread: Option<String>,
}

/// A value below this in its unit, or below a millionth of its limit, is rounding error and shown as 0.
fn least(measured: &Measured) -> f64 {
    let of_unit = match measured.unit.as_str() {
        "deg" | "deg/s" => 1e-6,
        "rad" | "rad/s" => 1e-8,
        "m" | "m/s" => 1e-7,
        "mm" => 1e-4,
        "s" => 1e-9,
        _ => 1e-15,
    };
    match measured.limit {
        // It must differ from its limit.
        Some(limit) if limit.abs() <= of_unit => 0.0,
        Some(limit) if measured.bound == Bound::Within => f64::max(of_unit, limit.abs() * 1e-6),
        _ => of_unit,
    }
}

impl NumberText {
    pub(in crate::report) fn new(measured: &Measured) -> Self {
        let unit = match measured.unit.as_str() {
            "1" | "count" | "" => String::new(),
            unit => format!(" {unit}"),
        };
        // As many digits as needed to distinguish the value from its limit.
        let digits = (4..=17)
            .find(|digits| {
                measured.limit.is_none_or(|limit| {
                    limit.total_cmp(&measured.value).is_eq()
                        || number(limit, *digits) != number(measured.value, *digits)
                })
            })
            .unwrap_or(17);
        let spell = |value: f64, digits: usize| format!("{}{unit}", number(value, digits));
        let least = least(measured);
        let rounded = |value: f64| if value.abs() < least { 0.0 } else { value };
        Self {
            value: spell(rounded(measured.value), digits),
            limit: measured
                .limit
                .map(|limit| format!("{}{}", side(measured, limit), spell(limit, digits))),
            spread: measured.spread.map(|spread| spell(rounded(spread), 4)),
        }
    }
}

/// The sign before a limit that holds on both sides, where the value is on the other one.
fn side(measured: &Measured, limit: f64) -> &'static str {
    let is_below = measured.bound == Bound::Within && measured.value < 0.0 && limit > 0.0;
    if is_below { "+-" } else { "" }
}

fn fix_lines(fix: &Fix, locator: &Locator, style: Style, out: &mut String) {
    let safety = match fix.safety {
        Safety::Safe => "safe",
        Safety::ChangesBehaviour => "changes behaviour",
    };
    push(
        out,
        &wrap(
            &format!("{} ({safety})", one_line(&fix.title)),
            style.width,
            "  fix: ",
            "       ",
        ),
    );
    for edit in fix.edits.iter().take(MAX_EDITS) {
        let written = locator.text(&edit.place).unwrap_or_default();
        let change = match [written, &edit.replacement].map(in_backticks) {
            [old, None] => format!("remove {}", old.unwrap_or_default()),
            [None, Some(new)] => format!("write {new}"),
            [Some(old), Some(new)] => format!("write {new} instead of {old}"),
        };
        let line = format!("{}: {change}", one_line(&locator.short(&edit.place)));
        push(out, &wrap(&line, style.width, "       ", "         "));
    }
    if fix.edits.len() > MAX_EDITS {
        push(
            out,
            &format!("       ... and {}", plural(fix.edits.len() - MAX_EDITS, "more edit")),
        );
    }
}

/// A text on one line, cut where it is long; `None` if it is empty.
fn in_backticks(text: &str) -> Option<String> {
    let line = one_line(text);
    let short: String = line.chars().take(LONGEST).collect();
    let more = if short.len() < line.len() { "..." } else { "" };
    (!line.is_empty()).then(|| format!("`{short}{more}`"))
}

fn push(out: &mut String, line: &str) {
    out.push_str(line);
    out.push('\n');
}
