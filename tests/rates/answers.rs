//! What a rule's answer to a world is worth, the truth being known.

use frames_lint::verdict::{Finding, Outcome, Row, Severity, Verdict};

use crate::faults::Fault;

/// An answer.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Answer {
    /// A pass of what is healthy; a finding that names the fault.
    Right,
    /// A finding on what is healthy; a pass of what is not; a wrong name. With what was said.
    Wrong(String),
    /// The rule did not judge. With why.
    NotEvaluated(String),
}

/// What one rule answers for the subjects that begin so; a fault is expected to show in it.
pub fn of_rule(verdict: &Verdict, rule: &str, subject: &str, fault: Fault) -> Answer {
    let is_meant = |row: &&Row| row.rule == rule && row.subject.starts_with(subject);
    let rows: Vec<&Row> = verdict.rows.iter().filter(is_meant).collect();
    if rows.is_empty() {
        // What others are held against is no subject itself; its fault shows in them.
        let mut findings = verdict.findings.iter().filter(|finding| finding.rule == rule);
        return match findings.next() {
            Some(finding) if fault.is_named_by(finding) => Answer::Right,
            Some(finding) => Answer::Wrong(said(finding)),
            None => Answer::NotEvaluated("it is no subject".to_owned()),
        };
    }
    let mine = |finding: &&Finding| finding.rule == rule && finding.subject.starts_with(subject);
    let mut findings: Vec<&Finding> = verdict.findings.iter().filter(mine).collect();
    let mut points_elsewhere = false;
    for row in &rows {
        let reason = row.reason.as_deref().unwrap_or_default();
        if row.outcome == Outcome::Crashed {
            return Answer::Wrong(reason.to_owned());
        }
        // One cause, one finding: another rule has it.
        let explained = reason
            .strip_prefix("explained by ")
            .filter(|_| row.outcome == Outcome::Explained);
        let Some(owner) = explained.and_then(|words| words.split(' ').next()) else {
            continue;
        };
        points_elsewhere = true;
        findings.extend(verdict.findings.iter().filter(|finding| finding.rule == owner));
    }
    if let Some(wrong) = findings.iter().find(|finding| !fault.is_named_by(finding)) {
        return Answer::Wrong(said(wrong));
    }
    let passes = rows.iter().any(|row| row.outcome == Outcome::Pass);
    match (fault.is_healthy(), findings.is_empty(), passes) {
        (true, true, true) | (_, false, false) => Answer::Right,
        (_, _, true) => Answer::Wrong(format!("{rule} passes: {}", measured(&rows))),
        _ if points_elsewhere => Answer::Wrong(format!("{rule} points to a rule that says nothing")),
        _ => {
            let reasons: Vec<&str> = rows.iter().filter_map(|row| row.reason.as_deref()).collect();
            Answer::NotEvaluated(reasons.join("; "))
        }
    }
}

/// What all rules say together: nothing of what is healthy, and of a fault nothing but its name.
pub fn of_all(verdict: &Verdict, fault: Fault) -> Answer {
    if let Some(crashed) = verdict.rows.iter().find(|row| row.outcome == Outcome::Crashed) {
        return Answer::Wrong(format!("{} crashed", crashed.rule));
    }
    // That nothing states the origin of a map is true of each of these worlds in which it is said, and no alarm.
    let is_alarm =
        |finding: &&Finding| (finding.severity, finding.relation.as_deref()) != (Severity::Note, Some("missing"));
    let mut alarms = verdict.findings.iter().filter(is_alarm);
    if let Some(wrong) = alarms.find(|finding| !fault.is_named_by(finding)) {
        return Answer::Wrong(said(wrong));
    }
    let is_right = if fault.is_healthy() {
        verdict.count(Outcome::Pass) > 0
    } else {
        !verdict.findings.is_empty()
    };
    if is_right {
        Answer::Right
    } else {
        Answer::NotEvaluated(String::new())
    }
}

/// What was measured of these subjects.
fn measured(rows: &[&Row]) -> String {
    let all = rows.iter().flat_map(|row| &row.measured);
    let all: Vec<String> = all
        .map(|one| format!("{} {:.4} {}", one.what, one.value, one.unit))
        .collect();
    all.join(", ")
}

fn said(finding: &Finding) -> String {
    let relation = finding.relation.as_deref().unwrap_or("no relation");
    format!("{} ({relation}): {}", finding.rule, finding.message)
}
