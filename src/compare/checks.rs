//! The outcomes of rules for two platforms: which checks have another outcome, and which findings only one has.

use std::collections::{BTreeMap, BTreeSet};

use crate::run::Run;
use crate::verdict::waiver::{FAMILY, plain_subject};
use crate::verdict::{Finding, Outcome, Row, Severity};

use super::{Change, Comparison, Kind};

/// A rule and a subject.
type Key = (String, String);

pub(super) fn compare(a: &Run, b: &Run, out: &mut Comparison) {
    let (before, after) = (rows(a), rows(b));
    let keys: BTreeSet<&Key> = before.keys().chain(after.keys()).collect();
    for key in keys {
        let (first, second) = (before.get(key).copied(), after.get(key).copied());
        let (was_judged, is_judged) = (first.is_some_and(judged), second.is_some_and(judged));
        if was_judged && is_judged {
            out.checks += 1;
        }
        let (was, is) = (findings(a, first), findings(b, second));
        let outcomes = [first, second].map(|row| row.map(|row| row.outcome));
        let is_otherwise = match outcomes {
            // Where only one side has the subject, only findings count.
            [Some(_), Some(_)] => (was_judged || is_judged) && outcomes[0] != outcomes[1],
            _ => false,
        };
        if !is_otherwise && kinds(&was) == kinds(&is) {
            continue;
        }
        let Some(row) = second.or(first) else { continue };
        let word = |outcome: Option<Outcome>| outcome.map_or("absent", Outcome::word);
        let words = match outcomes {
            [was, is] if was == is => format!("{} with other findings than before", word(is)),
            [was, is] => format!("{} (was {})", word(is), word(was)),
        };
        let mut change = Change::new(
            Kind::Check,
            format!("{} {}", row.rule, row.name),
            format!("{} on {}: {words}", row.rule, key.1),
        );
        // A new finding, else one that is gone.
        let came: Vec<&&Finding> = is.iter().filter(|one| !kinds(&was).contains(&kind(one))).collect();
        let said = came.first().copied().or_else(|| is.first()).or_else(|| was.first());
        change.explanation = said
            .map(|finding| finding.message.clone())
            .or_else(|| [second, first].iter().find_map(|row| row.as_ref()?.reason.clone()))
            .unwrap_or_default();
        change.measured.clone_from(&row.measured);
        out.changes.push(change);
    }
}

/// The open findings of a row.
fn findings<'r>(run: &'r Run, row: Option<&Row>) -> Vec<&'r Finding> {
    let of = |finding: &&Finding| row.is_some_and(|row| finding.rule == row.rule && finding.subject == row.subject);
    run.verdict.open().filter(of).collect()
}

/// What distinguishes findings: severity and relation.
type FindingKind<'f> = (Severity, Option<&'f str>);

fn kind(finding: &Finding) -> FindingKind<'_> {
    (finding.severity, finding.relation.as_deref())
}

fn kinds<'f>(findings: &[&'f Finding]) -> Vec<FindingKind<'f>> {
    let mut kinds: Vec<FindingKind> = findings.iter().copied().map(kind).collect();
    kinds.sort_unstable();
    kinds
}

fn judged(row: &Row) -> bool {
    row.outcome.is_judged()
}

/// The rows by rule and subject. The two sides have different files: paths are removed from the subjects. Of rows that are then equal,
/// the worst counts.
fn rows(run: &Run) -> BTreeMap<Key, &Row> {
    let mut paths: Vec<&str> = run.sources.iter().map(|source| source.path.as_str()).collect();
    paths.sort_by_key(|path| std::cmp::Reverse(path.len()));
    paths.dedup();
    let mut rows: BTreeMap<Key, &Row> = BTreeMap::new();
    for row in run.verdict.rows.iter().filter(|row| !row.rule.starts_with(FAMILY)) {
        let mut subject = plain_subject(&row.subject, &run.platforms).to_owned();
        for path in &paths {
            if subject.contains(path) {
                subject = subject.replace(path, "its file");
            }
        }
        let known = rows.entry((row.rule.to_string(), subject)).or_insert(row);
        if rank(row) > rank(known) {
            *known = row;
        }
    }
    rows
}

fn rank(row: &Row) -> u8 {
    match row.outcome {
        Outcome::Crashed => 4,
        Outcome::Fail => 3,
        Outcome::Waived | Outcome::Explained => 2,
        Outcome::Pass => 1,
        Outcome::NotEvaluated => 0,
    }
}
