//! Why a mistake is missed, and what would show it.

use crate::faults::{Seers, Subject};
use crate::source::Confidence;
use crate::verdict::{Bound, Finding, Measured, NotEvaluated, Outcome, Row, Verdict};
use crate::world::World;

/// Why a mistake is missed, and what would show it.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct Miss {
    /// What a rule that should see it says.
    pub reason: String,
    /// What to record or to add.
    pub record: String,
}

impl Miss {
    /// By the rows of verdicts on the data of a world without and with the mistake; `record` is what shows it in general.
    pub(super) fn of(
        world: &World,
        seen_by: Seers,
        subject: &Subject,
        [healthy, altered]: [&Verdict; 2],
        record: &str,
    ) -> Self {
        if let Some(hidden) = Self::hidden(seen_by, subject, [healthy, altered]) {
            return hidden;
        }
        let mut rows: Vec<&Row> = altered.rows.iter().filter(|row| seen_by.wrote(row)).collect();
        let position = |row: &Row| seen_by.codes().position(|seer| seer == row.rule);
        // A row may also be about something else with the same frame, or compare other files.
        let own = [subject.words.first().map(String::as_str), subject.file()];
        let is_beside = |row: &Row| own.iter().flatten().filter(|word| !row.subject.contains(*word)).count();
        let is_changed = |row: &Row| outcome_before(row, healthy).is_some_and(|before| before != row.outcome);
        rows.sort_by_key(|row| {
            (
                is_beside(row),
                !is_changed(row),
                position(row),
                row.outcome != Outcome::Pass,
            )
        });
        let about: Vec<&Row> = rows.iter().copied().filter(|row| subject.is_in(&row.subject)).collect();
        let first = seen_by.codes().next().unwrap_or_default();
        let of_platform = rows
            .iter()
            .copied()
            .filter(|row| row.rule == first && row.subject == "platform");
        let mut told = about.iter().copied().chain(of_platform);
        let Some(row) = told.find(|row| row.outcome != Outcome::Crashed) else {
            return Self {
                reason: format!("{first} has nothing here to compare it with"),
                record: record.to_owned(),
            };
        };
        let lacks = about
            .iter()
            .find(|row| row.outcome == Outcome::NotEvaluated && row.applies());
        let is_unread =
            |row: &Row| row.why_not() == Some(NotEvaluated::TooLittleEvidence) && world.holds_more_about(&row.subject);
        let grown = grown(row, healthy);
        Self {
            reason: reason(row, altered),
            record: match (row.outcome, lacks) {
                (Outcome::NotEvaluated, _) if is_unread(row) => format!(
                    "read the whole recording with --full, for {} lacks evidence in the part that was read; if that does not show it: {record}",
                    row.rule
                ),
                // A share grows with what is recorded.
                (Outcome::Pass, _) if grown.is_some_and(|measured| measured.unit == "1") => record.to_owned(),
                (Outcome::Pass, _) if grown.is_some() => format!(
                    "nothing to record: {} measures it and allows as much; a smaller limit (`limits` in frames-lint.yaml) shows it",
                    row.rule
                ),
                (Outcome::Pass, Some(other)) => {
                    let lack = other.reason.as_deref().unwrap_or_default();
                    format!(
                        "more of the same does not help {}; {} may show it, and says: {lack}",
                        row.rule, other.rule
                    )
                }
                (Outcome::Pass, None) => {
                    format!(
                        "more of the same does not help {}; what may show it: {record}",
                        row.rule
                    )
                }
                (Outcome::Fail, _) if is_hint(row, altered) => confirmation(row, altered).map_or_else(
                    || {
                        let help = findings_of(row, altered).next().map_or("", |finding| &finding.help);
                        format!("nothing to record; what settles the hint: {help}")
                    },
                    |keys| {
                        format!(
                            "{keys} in frames-lint.yaml, if these are the frames: {} then gives more than a hint",
                            row.rule
                        )
                    },
                ),
                _ => record.to_owned(),
            },
        }
    }

    /// Where the data have it, and the user accepts the finding that shows it.
    pub(super) fn accepted(finding: &Finding) -> Option<Self> {
        let why = finding.waived.as_ref()?.words();
        Some(Self {
            reason: format!("{} fails {}, which is accepted: {why}", finding.rule, finding.subject),
            record: where_not_accepted(&finding.rule),
        })
    }

    /// Where a rule would show it, and the user does not want to know.
    fn hidden(seen_by: Seers, subject: &Subject, [healthy, altered]: [&Verdict; 2]) -> Option<Self> {
        let was = |row: &Row| outcome_before(row, healthy);
        let is_hidden = |row: &&Row| match row.outcome {
            Outcome::Waived => true,
            Outcome::NotEvaluated => was(row).is_some_and(Outcome::is_judged) && is_off(row),
            _ => false,
        };
        let seen = altered.rows.iter().filter(|row| seen_by.wrote(row));
        let about = seen.filter(|row| subject.is_in(&row.subject));
        let row = about
            .filter(is_hidden)
            .min_by_key(|row| was(row) == Some(row.outcome))?;
        Some(Self {
            reason: reason(row, altered),
            record: where_not_accepted(&row.rule),
        })
    }
}

/// What to do where a rule would show a mistake.
fn where_not_accepted(rule: &str) -> String {
    format!("nothing: {rule} shows it where its findings are not accepted")
}

/// Whether the configuration turns a rule off for a file.
fn is_off(row: &Row) -> bool {
    row.reason
        .as_deref()
        .is_some_and(|why| why.starts_with("off for this file"))
}

/// A row without the mistake.
fn before<'v>(row: &Row, healthy: &'v Verdict) -> Option<&'v Row> {
    let mut rows = healthy.rows.iter();
    rows.find(|other| other.rule == row.rule && other.subject == row.subject)
}

fn outcome_before(row: &Row, healthy: &Verdict) -> Option<Outcome> {
    before(row, healthy).map(|row| row.outcome)
}

/// Share of a limit by which a mistake changes what is measured.
const CHANGE: f64 = 0.1;

/// What a row that passes measures of the mistake: a value that grows with it, and stays within its limit.
fn grown<'v>(row: &'v Row, healthy: &Verdict) -> Option<&'v Measured> {
    let without = before(row, healthy).map_or(&[][..], |row| &row.measured);
    let mut both = row.measured.iter().zip(without);
    let grown = both.find(|(with, without)| {
        let limit = with.limit.filter(|_| with.bound == Bound::Within);
        limit.is_some_and(|limit| with.value.abs() - without.value.abs() > CHANGE * limit)
    });
    grown.map(|(with, _)| with)
}

fn reason(row: &Row, altered: &Verdict) -> String {
    let why = row.reason.as_deref().unwrap_or_default();
    match row.outcome {
        Outcome::Pass => {
            let measured: Vec<String> = row.measured.iter().take(3).map(in_words).collect();
            format!("{} passes {}: {}", row.rule, row.subject, measured.join(", "))
        }
        Outcome::Fail if is_hint(row, altered) => {
            let hint = findings_of(row, altered).next();
            let says = hint.map_or(&row.subject, |finding| &finding.message);
            format!("{} gives only a hint: {says}", row.rule)
        }
        Outcome::Waived => format!("{} fails {}, which is accepted: {why}", row.rule, row.subject),
        Outcome::Fail => format!(
            "{} fails {} without the mistake, too: correct that first",
            row.rule, row.subject
        ),
        _ if row.subject == "platform" => {
            format!("{}: {}", row.rule, why.strip_prefix("not applicable: ").unwrap_or(why))
        }
        _ => format!("{} of {}: {why}", row.rule, row.subject),
    }
}

/// Whether a row that fails has no finding that is more than a hint.
fn is_hint(row: &Row, verdict: &Verdict) -> bool {
    !findings_of(row, verdict).any(|finding| finding.confidence > Confidence::Hint)
}

/// The configuration that would make the hint of a row certain.
fn confirmation<'v>(row: &'v Row, verdict: &'v Verdict) -> Option<&'v str> {
    findings_of(row, verdict).find_map(Finding::confirmed_by)
}

fn findings_of<'v>(row: &'v Row, verdict: &'v Verdict) -> impl Iterator<Item = &'v Finding> {
    let findings = verdict.findings.iter();
    findings.filter(|finding| finding.rule == row.rule && finding.subject == row.subject)
}

fn in_words(measured: &Measured) -> String {
    let amount = |value: f64| match measured.unit.as_str() {
        "1" => format!("{value:.3}"),
        "count" => format!("{value:.0}"),
        unit => format!("{value:.3} {unit}"),
    };
    let limit = measured.limit.filter(|_| measured.bound == Bound::Within);
    let limit = limit.map_or_else(String::new, |limit| format!(" (limit {})", amount(limit)));
    format!("{} {}{limit}", measured.what, amount(measured.value))
}
