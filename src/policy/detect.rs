//! Known mistakes that must be found, and would not have been: where, why, and what to record.

use crate::assure::{Assurance, SmallestError, Trial, TrialOutcome};
use crate::faults::{Fault, Selection, SizedFault};
use crate::run::{RequirementKind, UnmetRequirement};
use crate::verdict::unit_factor;

use super::{Force, Requirement, require};

/// Subjects that are named for one mistake.
const MAX_SUBJECTS: usize = 3;

/// The required mistakes that these trials miss, or that nothing in the data can have.
pub(super) fn undetected(assured: &[&Assurance], required: &[Requirement]) -> Vec<UnmetRequirement> {
    let mut faults: Vec<&'static Fault> = assured.iter().flat_map(|one| one.faults.iter().copied()).collect();
    faults.sort_by_key(|fault| fault.name);
    faults.dedup_by_key(|fault| fault.name);
    let sizes = if assured.is_empty() {
        Vec::new()
    } else {
        Selection::all().sizes
    };
    let mut unmet: Vec<UnmetRequirement> = Vec::new();
    for (at, requirement) in required.iter().enumerate() {
        if matches!(requirement.force, Force::Lifted(_)) {
            continue;
        }
        let behind = required.get(at + 1..).unwrap_or_default();
        let mut add = |one: Option<UnmetRequirement>, is_called: &dyn Fn(&str) -> bool| {
            if let Some(mut one) = one {
                one.waived = behind.iter().find_map(|later| later.lifts(requirement, is_called));
                require::add(&mut unmet, one);
            }
        };
        for fault in faults.iter().filter(|fault| fault.is_called(&requirement.rule)) {
            add(missed(assured, requirement, fault), &|word| fault.is_called(word));
        }
        for fault in sizes.iter().filter(|fault| fault.is_called(&requirement.rule)) {
            add(too_large(assured, requirement, fault), &|word| fault.is_called(word));
        }
    }
    unmet
}

fn missed(assured: &[&Assurance], requirement: &Requirement, fault: &'static Fault) -> Option<UnmetRequirement> {
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
    let misses = missed
        .iter()
        .filter_map(|trial| Some((&trial.subject, trial.miss.as_ref()?)));
    let why = misses
        .clone()
        .map(|(subject, miss)| format!("missed in {subject}: {}", miss.reason));
    let described = Described {
        name: fault.name,
        sentence: fault.sentence,
        record: misses.clone().next().map_or(fault.record, |(_, miss)| &miss.record),
    };
    described.unmet(assured, requirement, [all.len(), trials.len()], why.collect())
}

/// Where a mistake of the required size would not have been found.
fn too_large(assured: &[&Assurance], requirement: &Requirement, fault: &SizedFault) -> Option<UnmetRequirement> {
    let of_fault = assured.iter().flat_map(|one| &one.smallest);
    let all: Vec<&SmallestError> = of_fault.filter(|error| error.fault.name == fault.name).collect();
    let is_meant = |error: &&SmallestError| {
        let subject = requirement.subject.as_ref();
        subject.is_none_or(|glob| glob.is_match(&error.subject))
    };
    let searched: Vec<&SmallestError> = all.iter().copied().filter(is_meant).collect();
    let limit = requirement
        .smaller_than
        .as_ref()
        .and_then(|(size, unit)| Some(size * unit_factor(unit, fault.unit)?));
    let why = searched.iter().filter_map(|error| match (&error.found, limit) {
        (Err(miss), _) => Some(format!("no size would be found in {}: {}", error.subject, miss.reason)),
        (Ok(found), Some(limit)) if found.size >= limit => Some(format!(
            "only from {:.3} {unit} on in {} ({} decides); {limit} {unit} is required",
            found.size,
            error.subject,
            found.rule,
            unit = fault.unit
        )),
        (Ok(_), _) => None,
    });
    let described = Described {
        name: fault.name,
        sentence: fault.sentence,
        record: searched
            .iter()
            .find_map(|error| error.found.as_ref().err())
            .map_or(fault.record, |miss| &miss.record),
    };
    described.unmet(assured, requirement, [all.len(), searched.len()], why.collect())
}

/// A mistake in words.
struct Described<'a> {
    name: &'static str,
    sentence: &'static str,
    record: &'a str,
}

impl Described<'_> {
    /// The requirement, if it is not met: how many subjects can have the mistake, how many of them are meant, and where it is missed.
    fn unmet(
        &self,
        assured: &[&Assurance],
        requirement: &Requirement,
        [all, meant]: [usize; 2],
        mut why: Vec<String>,
    ) -> Option<UnmetRequirement> {
        let omitted: usize = assured.iter().filter_map(|one| one.omitted.get(self.name)).sum();
        let more = why.len().saturating_sub(MAX_SUBJECTS);
        why.truncate(MAX_SUBJECTS);
        if more > 0 {
            why.push(format!("and missed in {more} more"));
        }
        if meant == 0 {
            if requirement.force == Force::IfApplicable {
                return None;
            }
            let glob = requirement.subject.as_ref().filter(|_| all > 0);
            why.push(glob.map_or_else(
                || "nothing in the data can have this mistake".to_owned(),
                |glob| format!("no subject that can have this mistake matches `{}`", glob.glob().glob()),
            ));
        } else if why.is_empty() && omitted == 0 {
            return None;
        }
        if omitted > 0 {
            let what = format!("{omitted} subjects were not tried: check fewer files in one run");
            why.insert(0, what);
        }
        Some(UnmetRequirement {
            rule: self.name.to_owned(),
            name: self.sentence.to_owned(),
            subject: requirement.subject.as_ref().map(|glob| glob.glob().glob().to_owned()),
            kind: RequirementKind::Detection,
            why,
            record: Some(self.record.to_owned()),
            recordings: Vec::new(),
            origin: requirement.origin.clone(),
            waived: None,
        })
    }
}
