//! JUnit XML: a suite for each rule, a test case for each check. What was not evaluated or is waived is skipped, with its
//! reason; a finding that does not count leaves its case passed, and is written to its output.

use std::collections::BTreeMap;
use std::fmt::Write;

use quick_junit::{NonSuccessKind, Report, TestCase, TestCaseStatus, TestSuite};

use crate::run::{FailOn, Run};
use crate::verdict::{Finding, Outcome, Row};

use super::ReportError;
use super::place::Locator;
use super::terminal::measured_words;
use super::text::clean;

pub(super) fn render(run: &Run, fail_on: FailOn) -> Result<String, ReportError> {
    let locator = Locator::new(&run.sources);
    let mut found: BTreeMap<(&str, &str), Vec<&Finding>> = BTreeMap::new();
    for finding in &run.verdict.findings {
        found
            .entry((&finding.rule, &finding.subject))
            .or_default()
            .push(finding);
    }
    let mut suites: BTreeMap<&str, TestSuite> = BTreeMap::new();
    for row in run.listed(&run.verdict.rows) {
        let suite = suites
            .entry(&row.rule)
            .or_insert_with(|| TestSuite::new(format!("{} {}", row.rule, row.name)));
        let findings = found.get(&(&*row.rule, row.subject.as_str()));
        suite.add_test_case(case(row, findings.map_or(&[], Vec::as_slice), fail_on, &locator));
    }
    let mut report = Report::new("frames-lint");
    report.add_test_suites(suites.into_values());
    let mut required = TestSuite::new("requirements");
    for unmet in &run.unmet {
        let words = match (&unmet.waived, &unmet.record) {
            (Some(waived), _) => format!("waived: {}", waived.words()),
            (None, Some(record)) => format!("{}\nneeded: {record}", unmet.reasons().join("\n")),
            (None, None) => unmet.reasons().join("\n"),
        };
        let status = match unmet.waived {
            Some(_) => skipped(&words),
            None => failed(NonSuccessKind::Error, "not met", &unmet.reason(), &words),
        };
        let subject = unmet.subject.as_deref().unwrap_or("any subject");
        let mut case = TestCase::new(subject, status);
        case.set_classname(format!("{} {}", unmet.rule, unmet.name));
        required.add_test_case(case);
    }
    let mut inputs = TestSuite::new("inputs");
    for source in run.sources.iter().filter(|source| source.required) {
        let unread = run.unread().any(|other| other.id == source.id);
        let status = if unread {
            let words = source.shortfall();
            failed(NonSuccessKind::Error, source.status.word(), words, words)
        } else {
            TestCaseStatus::success()
        };
        let mut case = TestCase::new(clean(&locator.name(source.id)).into_owned(), status);
        case.set_classname("inputs");
        inputs.add_test_case(case);
    }
    for suite in [required, inputs] {
        if !suite.test_cases.is_empty() {
            report.add_test_suite(suite);
        }
    }
    report.to_string().map_err(|error| ReportError(error.to_string()))
}

fn case(row: &Row, findings: &[&Finding], fail_on: FailOn, locator: &Locator) -> TestCase {
    let counting: Vec<&&Finding> = findings.iter().filter(|finding| fail_on.counts(finding)).collect();
    let status = match row.outcome {
        Outcome::Crashed => {
            let reason = row.reason.as_deref().unwrap_or("the rule crashed");
            failed(NonSuccessKind::Error, "crashed", reason, reason)
        }
        Outcome::NotEvaluated => skipped(row.reason.as_deref().unwrap_or("not evaluated")),
        Outcome::Waived => skipped(&format!("waived: {}", row.reason.as_deref().unwrap_or_default())),
        Outcome::Explained => skipped(row.reason.as_deref().unwrap_or("explained")),
        Outcome::Pass | Outcome::Fail => match counting.first() {
            None => TestCaseStatus::success(),
            Some(first) => {
                let words: Vec<String> = counting.iter().map(|finding| failure_text(finding, locator)).collect();
                failed(
                    NonSuccessKind::Failure,
                    first.severity.word(),
                    &first.message,
                    &words.join("\n"),
                )
            }
        },
    };
    let mut case = TestCase::new(clean(&row.subject).into_owned(), status);
    case.set_classname(format!("{} {}", row.rule, row.name));
    let mut out = String::new();
    for measured in &row.measured {
        let _ = writeln!(out, "{}", clean(&measured_words(measured)));
    }
    for finding in findings.iter().filter(|finding| !fail_on.counts(finding)) {
        out.push_str(&failure_text(finding, locator));
    }
    if !out.is_empty() {
        case.set_system_out(out);
    }
    case
}

/// A finding in a few lines: the place, what is wrong, what to do.
fn failure_text(finding: &Finding, locator: &Locator) -> String {
    let mut words = String::new();
    let place = finding.places.first().map(|label| locator.short(&label.place));
    let _ = writeln!(
        words,
        "{}: {} ({}): {}",
        clean(&place.unwrap_or_default()),
        finding.word(),
        finding.confidence.word(),
        clean(&finding.message)
    );
    if !finding.detail.is_empty() {
        let _ = writeln!(words, "  {}", clean(&finding.detail));
    }
    for measured in &finding.measured {
        let _ = writeln!(words, "  measured: {}", clean(&measured_words(measured)));
    }
    if !finding.help.is_empty() {
        let _ = writeln!(words, "  help: {}", clean(&finding.help));
    }
    if let Some(waived) = &finding.waived {
        let _ = writeln!(words, "  waived: {}", clean(&waived.words()));
    }
    words
}

fn skipped(why: &str) -> TestCaseStatus {
    let mut status = TestCaseStatus::skipped();
    status.set_message(clean(why).into_owned());
    status
}

fn failed(kind: NonSuccessKind, word: &str, message: &str, words: &str) -> TestCaseStatus {
    let mut status = TestCaseStatus::non_success(kind);
    status.set_type(word);
    status.set_message(clean(message).into_owned());
    status.set_description(clean(words).into_owned());
    status
}
