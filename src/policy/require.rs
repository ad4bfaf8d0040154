//! What must be evaluated, and was not: with the reason, and what is missing.

use crate::page::{Page, names_rule};
use crate::run::{RequirementKind, UnmetRequirement};
use crate::verdict::waiver::{Acceptance, FAMILY, WaiverEffect, plain_subject};
use crate::verdict::{Row, judged_of_applicable};

use super::{Context, Force, RequiredShare, Requirement, Scope};

/// Reasons that are shown for one rule.
const MAX_REASONS: usize = 3;

/// The requirements that outcomes do not meet, in their order; a rule that is required twice is reported once.
///
/// A waiver for the whole rule, or for the same subjects, accepts that it was not evaluated; so does a later entry that lifts the
/// requirement.
pub(super) fn unmet(
    rows: (&[Row], &[Row]),
    required: &[Requirement],
    applied: &mut [(WaiverEffect, Scope)],
    context: &Context,
) -> Vec<UnmetRequirement> {
    let mut unmet: Vec<UnmetRequirement> = Vec::new();
    for (at, requirement) in required.iter().enumerate() {
        if matches!(requirement.force, Force::Lifted(_)) {
            continue;
        }
        let rules = context
            .rules
            .iter()
            .filter(|rule| names_rule(&requirement.rule, rule.code, rule.name));
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
                if is_meant && names_rule(&waiver.waiver.rule, rule.code, rule.name) {
                    waiver.matched += 1;
                    one.waived.get_or_insert_with(|| waiver.waiver.waived());
                }
            }
            let behind = required.get(at + 1..).unwrap_or_default();
            let is_called = |word: &str| names_rule(word, rule.code, rule.name);
            if let Some(lifted) = behind.iter().find_map(|later| later.lifts(requirement, is_called)) {
                one.waived.get_or_insert(lifted);
            }
            add(&mut unmet, one);
        }
    }
    unmet
}

/// Adds a requirement that is not met; one that is required twice is reported once.
pub(super) fn add(unmet: &mut Vec<UnmetRequirement>, one: UnmetRequirement) {
    let is_known = |other: &&mut UnmetRequirement| other.rule == one.rule && other.subject == one.subject;
    match unmet.iter_mut().find(is_known) {
        // It was lifted, and is required again later.
        Some(known) if one.waived.is_none() => *known = one,
        Some(_) => {}
        None => unmet.push(one),
    }
}

/// If fewer of the applicable checks were evaluated than required.
pub(super) fn too_few(rows: &[Row], required: &RequiredShare) -> Option<UnmetRequirement> {
    let (judged, applicable) = judged_of_applicable(rows.iter().filter(|row| !row.rule.starts_with(FAMILY)));
    if judged as f64 >= required.share * applicable as f64 {
        return None;
    }
    Some(UnmetRequirement {
        kind: RequirementKind::Share,
        rule: "share".to_owned(),
        name: "of the checks that apply".to_owned(),
        subject: None,
        why: vec![format!(
            "{judged} of {applicable} applicable checks were evaluated ({:.0} %); {} % are required",
            // Rounded down: a share that is too small must not look sufficient.
            (100.0 * judged as f64 / applicable as f64).floor(),
            100.0 * required.share
        )],
        record: None,
        recordings: Vec::new(),
        origin: required.origin.clone(),
        waived: None,
    })
}

impl Requirement {
    /// The acceptance, if this entry lifts an earlier requirement of what is called like that.
    pub(super) fn lifts(&self, before: &Self, is_called: impl Fn(&str) -> bool) -> Option<Acceptance> {
        let Force::Lifted(reason) = &self.force else {
            return None;
        };
        let glob = |one: &Self| one.subject.as_ref().map(|glob| glob.glob().glob().to_owned());
        let is_meant = self.subject.is_none() || glob(self) == glob(before);
        (is_meant && is_called(&self.rule)).then(|| Acceptance {
            reason: reason.clone(),
            by: None,
            until: None,
            origin: self.origin.clone(),
        })
    }
}

fn missing(
    (rows, beside): (&[Row], &[Row]),
    requirement: &Requirement,
    rule: &Page,
    context: &Context,
) -> Option<UnmetRequirement> {
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
    let applies = |row: &&Row| row.applies() && meant(&row.subject);
    if requirement.force == Force::IfApplicable && !rows.is_empty() && !rows.iter().copied().any(|row| applies(&row)) {
        return None;
    }
    let mut why: Vec<String> = Vec::new();
    if !context.asked.contains(rule.code) {
        why.push("the rule was not run: `select` or `ignore` excludes it".to_owned());
    }
    let not_judged: Vec<_> = rows.iter().filter(|row| !row.outcome.is_judged()).collect();
    let about: Vec<_> = not_judged.iter().filter(|row| meant(&row.subject)).collect();
    let listed = if about.is_empty() {
        not_judged.iter().collect()
    } else {
        about
    };
    for row in listed {
        let reason = row.reason.clone().unwrap_or_else(|| row.outcome.word().to_owned());
        if !why.contains(&reason) {
            why.push(reason);
        }
    }
    if why.is_empty()
        && let Some(glob) = &requirement.subject
    {
        why.push(format!("no subject matches `{}`", glob.glob().glob()));
    }
    let more = why.len().saturating_sub(MAX_REASONS);
    why.truncate(MAX_REASONS);
    if more > 0 {
        why.push(format!("and {more} more reasons"));
    }
    Some(UnmetRequirement {
        kind: RequirementKind::Rule,
        rule: rule.code.to_owned(),
        name: rule.name.to_owned(),
        subject: requirement.subject.as_ref().map(|glob| glob.glob().glob().to_owned()),
        why,
        record: None,
        recordings: Vec::new(),
        origin: requirement.origin.clone(),
        waived: None,
    })
}
