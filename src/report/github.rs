//! Workflow commands of GitHub Actions: an annotation for each finding, at its line.
//!
//! <https://docs.github.com/actions/reference/workflow-commands-for-github-actions>

use std::fmt::Write;

use crate::run::{FailOn, Run};
use crate::source::Confidence;
use crate::verdict::{Finding, Severity};

use super::place::Locator;
use super::text::clean;

/// A command for each finding and each requirement that is not met, and a last line for the log.
pub(super) fn render(run: &Run, fail_on: FailOn) -> String {
    let locator = Locator::new(&run.sources);
    let mut out = String::new();
    for finding in &run.verdict.findings {
        annotation(finding, &locator, &mut out);
    }
    for unmet in run.lacking() {
        let mut words = format!("{} ({})", unmet.words(), unmet.origin);
        if let Some(record) = &unmet.record {
            let _ = write!(words, "\nneeded: {record}");
        }
        command(
            "error",
            &[("title", &format!("{} not met", unmet.rule))],
            &words,
            &mut out,
        );
    }
    for source in run.unread() {
        let words = format!("{}: {}", source.status.word(), source.shortfall());
        command(
            "error",
            &[("file", &source.path), ("title", "input not read")],
            &words,
            &mut out,
        );
    }
    let ending = super::terminal::plain_ending(run, fail_on);
    out.push_str(&ending);
    out
}

fn annotation(finding: &Finding, locator: &Locator, out: &mut String) {
    let level = match finding.loudness() {
        _ if finding.waived.is_some() => "notice",
        Severity::Note => "notice",
        Severity::Warning => "warning",
        Severity::Error => "error",
    };
    let spot = finding.places.first().map(|label| locator.find(&label.place));
    let mut properties: Vec<(&str, String)> = Vec::new();
    if let Some(spot) = &spot {
        properties.push(("file", spot.path.clone()));
        if let (Some(start), Some(end), false) = (spot.start, spot.end, spot.expanded || spot.message.is_some()) {
            properties.push(("line", start.line.to_string()));
            properties.push(("endLine", end.line.to_string()));
            // GitHub refuses columns for annotations of several lines.
            if start.line == end.line {
                properties.push(("col", start.column.to_string()));
                properties.push(("endColumn", end.column.to_string()));
            }
        }
    }
    let hint = match finding.confidence {
        Confidence::Certain => String::new(),
        other => format!(" ({})", other.word()),
    };
    let waived = if finding.waived.is_some() { "waived: " } else { "" };
    properties.push(("title", format!("{waived}{} {}{hint}", finding.rule, finding.name)));
    let mut words = finding.text();
    if let Some(message) = spot.and_then(|spot| spot.message) {
        let _ = write!(words, " [{} message {}]", message.topic, message.index);
    }
    if let Some(waived) = &finding.waived {
        let _ = write!(words, "\nwaived: {}", waived.words());
    } else if !finding.help.is_empty() {
        let _ = write!(words, "\nhelp: {}", finding.help);
    }
    let properties: Vec<(&str, &str)> = properties.iter().map(|(key, value)| (*key, value.as_str())).collect();
    command(level, &properties, &words, out);
}

fn command(level: &str, properties: &[(&str, &str)], words: &str, out: &mut String) {
    let properties: Vec<String> = properties
        .iter()
        .map(|(key, value)| format!("{key}={}", escaped(value).replace(':', "%3A").replace(',', "%2C")))
        .collect();
    let _ = writeln!(out, "::{level} {}::{}", properties.join(","), escaped(words));
}

/// Data of a command: characters that would end the line or begin an escape are escaped.
fn escaped(text: &str) -> String {
    // Before cleaning, because a carriage return is a control character.
    let text = text.replace('%', "%25").replace('\r', "%0D").replace('\n', "%0A");
    clean(&text).into_owned()
}
