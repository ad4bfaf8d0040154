//! Known mistakes that must be found, and would not have been: where, why, and what to record.

use crate::assure::{Assurance, Trial, TrialOutcome};
use crate::faults::Fault;
use crate::run::{RequirementKind, UnmetRequirement};

use super::{Force, Requirement, require};

/// Subjects that are named for one mistake.
const MAX_SUBJECTS: usize = 3;

/// The required mistakes that these trials miss, or that nothing in the data can have.
pub(super) fn undetected(assured: &[&Assurance], required: &[Requirement]) -> Vec<UnmetRequirement> {
    let mut faults: Vec<&'static Fault> = assured.iter().flat_map(|one| one.faults.iter().copied()).collect();
    faults.sort_by_key(|fault| fault.name);
    faults.dedup_by_key(|fault| fault.name);
    let mut unmet: Vec<UnmetRequirement> = Vec::new();
    for (at, requirement) in required.iter().enumerate() {
        if matches!(requirement.force, Force::Lifted(_)) {
            continue;
        }
        for fault in faults.iter().filter(|fault| fault.is_called(&requirement.rule)) {
            let Some(mut one) = missing(assured, requirement, fault) else {
                continue;
            };
            let mut behind = required.get(at + 1..).unwrap_or_default().iter();
            one.waived = behind.find_map(|later| later.lifts(requirement, |word| fault.is_called(word)));
            require::add(&mut unmet, one);
        }
    }
    unmet
}

fn missing(assured: &[&Assurance], requirement: &Requirement, fault: &'static Fault) -> Option<UnmetRequirement> {
    let of_fault = assured.iter().flat_map(|one| &one.trials);
    let all: Vec<&Trial> = of_fault.filter(|trial| trial.fault.name == fault.name).collect();
    let is_meant = |trial: &&Trial| {
        let subject = requirement.subject.as_ref();
        subject.is_none_or(|glob| glob.is_match(&trial.subject))
    };
    let trials: Vec<&Trial> = all.iter().copied().filter(is_meant).collect();
    let missed: Vec<&Trial> = trials
        .iter()
        .copied()
        .filter(|trial| trial.outcome == TrialOutcome::Missed)
        .collect();
    let omitted: usize = assured.iter().filter_map(|one| one.omitted.get(fault.name)).sum();
    let mut why: Vec<String> = Vec::new();
    if trials.is_empty() {
        if requirement.force == Force::IfApplicable {
            return None;
        }
        let glob = requirement.subject.as_ref().filter(|_| !all.is_empty());
        why.push(glob.map_or_else(
            || "nothing in the data can have this mistake".to_owned(),
            |glob| format!("no subject that can have this mistake matches `{}`", glob.glob().glob()),
        ));
    } else if missed.is_empty() && omitted == 0 {
        return None;
    }
    if omitted > 0 {
        why.push(format!(
            "{omitted} subjects were not tried: check fewer files in one run"
        ));
    }
    for trial in missed.iter().take(MAX_SUBJECTS) {
        let reason = trial.reason.as_deref().unwrap_or_default();
        why.push(format!("missed in {}: {reason}", trial.subject));
    }
    let more = missed.len().saturating_sub(MAX_SUBJECTS);
    if more > 0 {
        why.push(format!("and missed in {more} more"));
    }
    Some(UnmetRequirement {
        rule: fault.name.to_owned(),
        name: fault.sentence.to_owned(),
        subject: requirement.subject.as_ref().map(|glob| glob.glob().glob().to_owned()),
        kind: RequirementKind::Detection,
        why,
        record: Some(fault.record.to_owned()),
        recordings: Vec::new(),
        origin: requirement.origin.clone(),
        waived: None,
    })
}
