//! Known mistakes that must be found, and would not have been: where, why, and what to record.

use crate::assure::{Assurance, Trial, TrialOutcome};
use crate::faults::Fault;
use crate::run::{RequirementKind, UnmetRequirement};
use crate::verdict::waiver::Acceptance;

use super::{Force, Requirement};

/// Subjects that are named for one mistake.
const MAX_SUBJECTS: usize = 3;

/// The required mistakes that these trials miss, or that nothing in the data can have.
pub(super) fn undetected(assured: &[&Assurance], required: &[Requirement]) -> Vec<UnmetRequirement> {
    let mut whole = Assurance::default();
    for one in assured {
        whole.join((*one).clone());
    }
    let mut unmet: Vec<UnmetRequirement> = Vec::new();
    for (at, requirement) in required.iter().enumerate() {
        if matches!(requirement.force, Force::Lifted(_)) {
            continue;
        }
        let tried = whole.trials.iter().map(|trial| trial.fault);
        let mut faults: Vec<&'static Fault> = tried.chain(whole.inapplicable.iter().copied()).collect();
        faults.retain(|fault| fault.is_called(&requirement.rule));
        faults.sort_by_key(|fault| fault.name);
        faults.dedup_by_key(|fault| fault.name);
        for fault in faults {
            let Some(mut one) = missing(&whole, requirement, fault) else {
                continue;
            };
            let behind = required.get(at + 1..).unwrap_or_default();
            one.waived = behind.iter().find_map(|later| lifts(later, fault));
            if !unmet
                .iter()
                .any(|known| known.rule == one.rule && known.subject == one.subject)
            {
                unmet.push(one);
            }
        }
    }
    unmet
}

fn missing(whole: &Assurance, requirement: &Requirement, fault: &'static Fault) -> Option<UnmetRequirement> {
    let is_meant = |trial: &&Trial| {
        let subject = requirement.subject.as_ref();
        trial.fault.name == fault.name && subject.is_none_or(|glob| glob.is_match(&trial.subject))
    };
    let trials: Vec<&Trial> = whole.trials.iter().filter(is_meant).collect();
    let missed: Vec<&Trial> = trials
        .iter()
        .copied()
        .filter(|trial| trial.outcome == TrialOutcome::Missed)
        .collect();
    let omitted = whole.omitted.get(fault.name).copied().unwrap_or_default();
    let mut why: Vec<String> = Vec::new();
    if trials.is_empty() {
        if requirement.force == Force::IfApplicable {
            return None;
        }
        let applies = whole.trials.iter().any(|trial| trial.fault.name == fault.name);
        let glob = requirement.subject.as_ref().filter(|_| applies);
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

/// The acceptance, if this entry lifts an earlier requirement of a mistake.
fn lifts(later: &Requirement, fault: &Fault) -> Option<Acceptance> {
    let Force::Lifted(reason) = &later.force else {
        return None;
    };
    fault.is_called(&later.rule).then(|| Acceptance {
        reason: reason.clone(),
        by: None,
        until: None,
        origin: later.origin.clone(),
    })
}
