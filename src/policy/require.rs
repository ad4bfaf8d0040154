//! What must have been judged, and was not: with the reason, and what would have to be there.

use crate::page::names_rule;
use crate::run::{RuleInfo, Unmet};
use crate::verdict::Row;
use crate::verdict::waiver::{Applied, plain_subject};

use super::{Context, Requirement, Scope};

/// So many reasons are told of one rule.
const MAX_REASONS: usize = 3;

/// The requirements that outcomes do not meet, in the order in which they stand; a rule that is required twice is told once.
///
/// A waiver for the whole rule, or for the same subjects, accepts that it was not judged.
pub(super) fn unmet(
    rows: (&[Row], &[Row]),
    required: &[Requirement],
    applied: &mut [(Applied, Scope)],
    context: &Context,
) -> Vec<Unmet> {
    let mut unmet: Vec<Unmet> = Vec::new();
    for requirement in required {
        let rules = context
            .rules
            .iter()
            .filter(|rule| names_rule(&requirement.rule, &rule.code, &rule.name));
        for rule in rules {
            let Some(mut one) = missing(rows, requirement, rule, context) else {
                continue;
            };
            for (waiver, scope) in applied.iter_mut().filter(|(waiver, _)| waiver.expired_days.is_none()) {
                let is_meant = match scope {
                    Scope::Globs { subject, file: None } => subject
                        .as_ref()
                        .is_none_or(|glob| one.subject.as_deref() == Some(glob.glob().glob())),
                    _ => false,
                };
                if is_meant && names_rule(&waiver.waiver.rule, &rule.code, &rule.name) {
                    waiver.matched += 1;
                    one.waived.get_or_insert_with(|| waiver.waiver.waived());
                }
            }
            let is_known = |other: &Unmet| other.rule == one.rule && other.subject == one.subject;
            if !unmet.iter().any(is_known) {
                unmet.push(one);
            }
        }
    }
    unmet
}

fn missing(
    (rows, beside): (&[Row], &[Row]),
    requirement: &Requirement,
    rule: &RuleInfo,
    context: &Context,
) -> Option<Unmet> {
    let rows: Vec<_> = rows.iter().filter(|row| row.rule == rule.code).collect();
    let meant = |subject: &str| {
        let subject = plain_subject(subject, context.platforms);
        requirement.subject.as_ref().is_none_or(|glob| glob.is_match(subject))
    };
    let beside = beside.iter().filter(|row| row.rule == rule.code);
    let mut known = rows.iter().copied().chain(beside);
    if known.any(|row| row.outcome.is_judged() && meant(&row.subject)) {
        return None;
    }
    let mut why: Vec<String> = Vec::new();
    if !context.asked.contains(&rule.code) {
        why.push("the rule is not among those that were asked (`select`, `ignore`)".to_owned());
    }
    let not_judged: Vec<_> = rows.iter().filter(|row| !row.outcome.is_judged()).collect();
    let about: Vec<_> = not_judged.iter().filter(|row| meant(&row.subject)).collect();
    let told = if about.is_empty() {
        not_judged.iter().collect()
    } else {
        about
    };
    for row in told {
        let reason = row.reason.clone().unwrap_or_else(|| row.outcome.word().to_owned());
        if !why.contains(&reason) {
            why.push(reason);
        }
    }
    if why.is_empty()
        && let Some(glob) = &requirement.subject
    {
        why.push(format!("nothing that was judged is `{}`", glob.glob().glob()));
    }
    let more = why.len().saturating_sub(MAX_REASONS);
    why.truncate(MAX_REASONS);
    if more > 0 {
        why.push(format!("and {more} more reasons"));
    }
    Some(Unmet {
        rule: rule.code.clone(),
        name: rule.name.clone(),
        subject: requirement.subject.as_ref().map(|glob| glob.glob().glob().to_owned()),
        why,
        record: None,
        recordings: Vec::new(),
        origin: requirement.origin.clone(),
        waived: None,
    })
}
