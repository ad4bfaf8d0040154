//! SARIF 2.1.0, for code scanning: findings as results, waivers as suppressions, pages as help, what was not evaluated as notifications.
//!
//! <https://docs.oasis-open.org/sarif/sarif/v2.1.0/sarif-v2.1.0.html>

use std::collections::{BTreeMap, BTreeSet};

use percent_encoding::{AsciiSet, CONTROLS, utf8_percent_encode};
use serde_json::{Map, Value, json};

use crate::page::{self, Page};
use crate::run::{FailOn, RequirementKind, Run, VerdictWord};
use crate::source::{Confidence, Place, SourceKind};
use crate::verdict::{Finding, Fix, Measured, Outcome, PlaceRole, Safety, Severity};
use crate::visible::pretty_json;

use super::fingerprint::fingerprints;
use super::place::Locator;
use super::terminal::measured_words;
use super::text::clean;

/// Characters that are escaped in the path of a URI.
const RESERVED: &AsciiSet = &CONTROLS
    .add(b' ')
    .add(b'"')
    .add(b'#')
    .add(b'%')
    .add(b'<')
    .add(b'>')
    .add(b'?')
    .add(b'[')
    .add(b'\\')
    .add(b']')
    .add(b'^')
    .add(b'`')
    .add(b'{')
    .add(b'|')
    .add(b'}')
    .add(b':');

pub(super) fn render(run: &Run, fail_on: FailOn) -> Result<String, serde_json::Error> {
    let locator = Locator::new(&run.sources);
    let numbers: BTreeMap<&str, usize> = run
        .rules
        .iter()
        .enumerate()
        .map(|(index, rule)| (rule.code, index))
        .collect();
    let results: Vec<Value> = run
        .verdict
        .findings
        .iter()
        .zip(fingerprints(run, &locator))
        .map(|(finding, print)| result(finding, &print, &numbers, fail_on, &locator))
        .collect();
    let rules: Vec<Value> = run.rules.iter().map(|page| rule(page)).collect();
    let document = json!({
        "$schema": "https://json.schemastore.org/sarif-2.1.0.json",
        "version": "2.1.0",
        "runs": [{
            "tool": {"driver": {
                "name": env!("CARGO_PKG_NAME"),
                "version": env!("CARGO_PKG_VERSION"),
                "semanticVersion": env!("CARGO_PKG_VERSION"),
                "rules": rules,
            }},
            "invocations": [{
                "executionSuccessful": run.summary(fail_on).verdict != VerdictWord::Incomplete,
                "exitCode": run.exit_code(fail_on),
                "toolExecutionNotifications": notifications(run, &numbers),
            }],
            "artifacts": artifacts(run),
            "results": results,
            "columnKind": "unicodeCodePoints",
        }],
    });
    pretty_json(&document)
}

/// A path as a URI: relative as it is, absolute with its scheme.
fn uri(path: &str) -> String {
    let encoded = utf8_percent_encode(path, RESERVED).to_string();
    if encoded.starts_with('/') {
        format!("file://{encoded}")
    } else {
        encoded
    }
}

fn level(severity: Severity) -> &'static str {
    match severity {
        Severity::Note => "note",
        Severity::Warning => "warning",
        Severity::Error => "error",
    }
}

fn rule(rule: &Page) -> Value {
    let sections = page::sections(rule.body);
    let section = |title: &str| {
        let found = sections.iter().find(|section| section.title == title);
        found.map_or("", |section| section.text.trim())
    };
    let help: Vec<String> = [
        "What it checks",
        "Why it matters",
        "How it decides",
        "How to fix",
        "Not covered",
    ]
    .iter()
    .map(|title| format!("## {title}\n\n{}", section(title)))
    .collect();
    json!({
        "id": rule.code,
        "name": rule.name,
        "shortDescription": {"text": rule.summary},
        "helpUri": page::url(rule.code),
        "fullDescription": {"text": section("What it checks")},
        "help": {"text": section("How to fix"), "markdown": help.join("\n\n")},
        "defaultConfiguration": {"level": level(rule.severity)},
        "properties": {
            "tags": [rule.family().to_lowercase()],
            "precision": match rule.confidence {
                Confidence::Certain => "very-high",
                Confidence::Likely => "high",
                Confidence::Hint => "low",
            },
            "problem.severity": match rule.severity {
                Severity::Note => "recommendation",
                Severity::Warning => "warning",
                Severity::Error => "error",
            },
        },
    })
}

fn artifacts(run: &Run) -> Vec<Value> {
    let mut artifacts: Vec<Value> = Vec::new();
    let mut seen = BTreeSet::new();
    for source in run
        .sources
        .iter()
        .filter(|source| source.kind != SourceKind::Configuration)
    {
        if !seen.insert(source.path.as_str()) {
            continue;
        }
        artifacts.push(json!({
            "location": {"uri": uri(&source.path)},
            "length": source.examined.bytes_total,
            "properties": {"kind": source.kind.word(), "status": source.status.word(), "bytesExamined": source.examined.bytes},
        }));
    }
    artifacts
}

/// Checks that were not evaluated and inputs that were not read: a scan without input must not look clean.
fn notifications(run: &Run, numbers: &BTreeMap<&str, usize>) -> Vec<Value> {
    let about = |code: &str| {
        let mut descriptor = json!({"id": code});
        if let (Some(index), Some(keys)) = (numbers.get(code), descriptor.as_object_mut()) {
            keys.insert("index".to_owned(), (*index).into());
        }
        descriptor
    };
    let mut notifications = Vec::new();
    for row in run.listed(&run.verdict.rows) {
        let level = match row.outcome {
            Outcome::NotEvaluated => "note",
            Outcome::Crashed => "error",
            _ => continue,
        };
        let reason = row.reason.as_deref().unwrap_or_default();
        notifications.push(json!({
            "level": level,
            "message": message(&format!("{} {} on {}: {reason}", row.rule, row.outcome.word(), row.subject)),
            "associatedRule": about(&row.rule),
        }));
    }
    for unmet in &run.unmet {
        let mut text = unmet.words();
        if let Some(waived) = &unmet.waived {
            text = format!("{text} (waived: {})", waived.words());
        } else if let Some(record) = &unmet.record {
            text = format!("{text}; needed: {record}");
        }
        let mut notification = json!({
            "level": if unmet.waived.is_some() { "note" } else { "error" },
            "message": message(&text),
        });
        if let (Some(keys), false) = (notification.as_object_mut(), unmet.kind != RequirementKind::Rule) {
            keys.insert("associatedRule".to_owned(), about(&unmet.rule));
        }
        notifications.push(notification);
    }
    for source in run.unread() {
        let detail = source.shortfall();
        notifications.push(json!({
            "level": "error",
            "message": message(&format!("{}: {}: {detail}", source.path, source.status.word())),
            "locations": [{"physicalLocation": {"artifactLocation": {"uri": uri(&source.path)}}}],
        }));
    }
    notifications
}

fn result(
    finding: &Finding,
    print: &str,
    numbers: &BTreeMap<&str, usize>,
    fail_on: FailOn,
    locator: &Locator,
) -> Value {
    let mut text = finding.text();
    if !finding.help.is_empty() {
        text = format!("{text}\n\n{}", finding.help);
    }
    let places = |role: PlaceRole| -> Vec<Value> {
        finding
            .places
            .iter()
            .filter(|label| label.role == role)
            .enumerate()
            .map(|(id, label)| location(&label.place, &label.note, id, locator))
            .collect()
    };
    let mut result = Map::new();
    let mut set = |key: &str, value: Value| {
        result.insert(key.to_owned(), value);
    };
    set("ruleId", finding.rule.as_str().into());
    if let Some(index) = numbers.get(finding.rule.as_str()) {
        set("ruleIndex", (*index).into());
    }
    // A hint never fails a run, and code scanning decides by level.
    set("level", level(finding.loudness()).into());
    set("message", message(&text));
    set("locations", places(PlaceRole::Primary).into());
    let related = places(PlaceRole::Related);
    if !related.is_empty() {
        set("relatedLocations", related.into());
    }
    set("partialFingerprints", json!({"framesLint/v1": print}));
    set(
        "suppressions",
        match &finding.waived {
            None => json!([]),
            Some(waived) => {
                let kind = if finding
                    .places
                    .iter()
                    .any(|label| waived.origin.starts_with(locator.path_of(&label.place)))
                {
                    "inSource"
                } else {
                    "external"
                };
                json!([{"kind": kind, "status": "accepted", "justification": clean(&waived.words())}])
            }
        },
    );
    if let Some(fix) = finding.fix.as_ref().and_then(|fix| fixed(fix, locator)) {
        set("fixes", json!([fix]));
    }
    set(
        "properties",
        json!({
            "name": finding.name,
            "subject": finding.subject,
            "severity": finding.severity.word(),
            "confidence": finding.confidence.word(),
            "counts": fail_on.counts(finding),
            "relation": finding.relation,
            "measured": finding.measured.iter().map(measured).collect::<Vec<_>>(),
        }),
    );
    Value::Object(result)
}

fn measured(measured: &Measured) -> Value {
    clean(&measured_words(measured)).into()
}

/// A message object. Brackets are escaped if a name from a file would be read as a link.
///
/// Source: SARIF 2.1.0, 3.11.6 "Messages with embedded links".
fn message(text: &str) -> Value {
    let text = clean(text);
    if text.contains("](") {
        json!({"text": text.replace('\\', "\\\\").replace('[', "\\[").replace(']', "\\]")})
    } else {
        json!({"text": text})
    }
}

fn location(place: &Place, note: &str, id: usize, locator: &Locator) -> Value {
    let spot = locator.find(place);
    let mut physical = json!({"artifactLocation": {"uri": uri(&spot.path)}});
    if let (Some(start), Some(end), false, Some(keys)) = (
        spot.start,
        spot.end,
        spot.expanded || spot.message.is_some(),
        physical.as_object_mut(),
    ) {
        keys.insert(
            "region".to_owned(),
            json!({"startLine": start.line, "startColumn": start.column, "endLine": end.line, "endColumn": end.column}),
        );
    }
    let mut location = json!({"id": id, "physicalLocation": physical});
    if let Some(keys) = location.as_object_mut() {
        if let Some(message) = spot.message {
            let field = message.field.map_or_else(String::new, |field| format!(".{field}"));
            let name = format!("{}[{}]{field}", message.topic, message.index);
            keys.insert(
                "logicalLocations".to_owned(),
                json!([{"fullyQualifiedName": name, "kind": "message"}]),
            );
        }
        if !note.is_empty() {
            keys.insert("message".to_owned(), message(note));
        }
    }
    location
}

/// A fix whose edits can all be made in files.
fn fixed(fix: &Fix, locator: &Locator) -> Option<Value> {
    let mut changes: BTreeMap<String, Vec<Value>> = BTreeMap::new();
    for edit in &fix.edits {
        let spot = locator.find(&edit.place);
        if spot.expanded || spot.message.is_some() {
            return None;
        }
        let (start, end) = (spot.start?, spot.end?);
        changes.entry(spot.path).or_default().push(json!({
            "deletedRegion": {
                "startLine": start.line, "startColumn": start.column, "endLine": end.line, "endColumn": end.column
            },
            "insertedContent": {"text": edit.replacement},
        }));
    }
    let changes: Vec<Value> = changes
        .into_iter()
        .map(|(path, replacements)| json!({"artifactLocation": {"uri": uri(&path)}, "replacements": replacements}))
        .collect();
    let safety = match fix.safety {
        Safety::Safe => "safe",
        Safety::ChangesBehaviour => "changes behaviour",
    };
    Some(json!({"description": message(&format!("{} ({safety})", fix.title)), "artifactChanges": changes}))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_name_is_no_link() {
        assert_eq!(
            message("frame `[x](http://a)`"),
            json!({"text": r"frame `\[x\](http://a)`"})
        );
        assert_eq!(message("R[0] of a\u{202e}b"), json!({"text": r"R[0] of a\u{202e}b"}));
    }

    #[test]
    fn paths_become_uris() {
        assert_eq!(uri("a b/c#1.urdf"), "a%20b/c%231.urdf");
        assert_eq!(uri("/data/ä.yaml"), "file:///data/%C3%A4.yaml");
    }
}
