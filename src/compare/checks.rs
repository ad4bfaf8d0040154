//! What the rules say of two platforms: which checks came out otherwise.

use std::collections::BTreeMap;

use crate::run::Run;
use crate::verdict::waiver::{FAMILY, plain_subject};
use crate::verdict::{Outcome, Row};

use super::{Change, Comparison, Kind};

/// A rule and a subject.
type Key = (String, String);

pub(super) fn compare(a: &Run, b: &Run, out: &mut Comparison) {
    let (before, after) = (rows(a), rows(b));
    for (key, first) in &before {
        let Some(second) = after.get(key) else { continue };
        let (was_judged, is_judged) = (judged(first), judged(second));
        if was_judged && is_judged {
            out.checks += 1;
        }
        if first.outcome == second.outcome || !(was_judged || is_judged) {
            continue;
        }
        let mut change = Change::new(
            Kind::Check,
            format!("{} {}", first.rule, first.name),
            format!(
                "{} on {}: {}, and was {}",
                first.rule,
                key.1,
                second.outcome.word(),
                first.outcome.word()
            ),
        );
        let fails = [(b, second, Outcome::Fail), (a, first, Outcome::Fail)];
        let said = fails
            .iter()
            .find(|(_, row, outcome)| row.outcome == *outcome)
            .and_then(|(run, row, _)| {
                let found = run
                    .verdict
                    .findings
                    .iter()
                    .find(|finding| finding.rule == row.rule && finding.subject == row.subject)?;
                Some(found.message.clone())
            });
        change.explanation = said
            .or_else(|| [second, first].iter().find_map(|row| row.reason.clone()))
            .unwrap_or_default();
        change.measured.clone_from(&second.measured);
        out.changes.push(change);
    }
}

fn judged(row: &Row) -> bool {
    row.outcome.is_judged()
}

/// The rows by what they are about. The two have other files: a subject is known without their paths. Of rows that are then alike, the
/// worst counts.
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
        let known = rows.entry((row.rule.clone(), subject)).or_insert(row);
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
