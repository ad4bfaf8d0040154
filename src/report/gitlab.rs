//! The Code Quality report of GitLab: a list of issues that merge requests compare.
//!
//! <https://docs.gitlab.com/ci/testing/code_quality/#code-quality-report-format>

use serde::Serialize;

use crate::run::{FailOn, Run};
use crate::verdict::{Finding, Severity};
use crate::visible::pretty_json;

use super::fingerprint::fingerprints;
use super::place::Locator;
use super::text::clean;

#[derive(Serialize)]
struct Issue {
    description: String,
    check_name: String,
    fingerprint: String,
    severity: &'static str,
    location: Location,
}

#[derive(Serialize)]
struct Location {
    path: String,
    lines: Lines,
}

#[derive(Serialize)]
struct Lines {
    begin: usize,
}

pub(super) fn render(run: &Run, fail_on: FailOn) -> Result<String, serde_json::Error> {
    let locator = Locator::new(&run.sources);
    let prints = fingerprints(run, &locator);
    let findings = run.verdict.findings.iter().zip(prints);
    let mut issues: Vec<Issue> = findings
        .map(|(finding, fingerprint)| issue(finding, fingerprint, fail_on, &locator))
        .collect();
    for unmet in run.lacking() {
        let (path, line) = unmet.origin.split_once(':').unwrap_or((&unmet.origin, "1"));
        issues.push(Issue {
            description: clean(&unmet.words()).into_owned(),
            check_name: unmet.rule.clone(),
            fingerprint: format!(
                "required-{}-{}",
                unmet.rule,
                unmet.subject.as_deref().unwrap_or_default()
            ),
            severity: "blocker",
            location: Location {
                path: path.to_owned(),
                lines: Lines {
                    begin: line.parse().unwrap_or(1),
                },
            },
        });
    }
    pretty_json(&issues)
}

fn issue(finding: &Finding, fingerprint: String, fail_on: FailOn, locator: &Locator) -> Issue {
    let spot = finding.places.first().map(|label| locator.find(&label.place));
    let line = spot.as_ref().filter(|spot| !spot.expanded && spot.message.is_none());
    let begin = line.and_then(|spot| spot.start).map_or(1, |start| start.line);
    let waived = finding.waived.as_ref();
    Issue {
        description: match waived {
            Some(waived) => clean(&format!("waived: {} [{}]", finding.message, waived.words())).into_owned(),
            None => clean(&finding.message).into_owned(),
        },
        check_name: format!("{} {}", finding.rule, finding.name),
        fingerprint,
        severity: match finding.loudness() {
            _ if waived.is_some() => "info",
            Severity::Note => "info",
            Severity::Error if fail_on.counts(finding) => "critical",
            Severity::Error => "major",
            Severity::Warning => "minor",
        },
        location: Location {
            path: spot.map(|spot| spot.path).unwrap_or_default(),
            lines: Lines { begin },
        },
    }
}
