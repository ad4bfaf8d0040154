//! Faults of several streams that have one cause, told once.
//!
//! Must not know what is wrong with the streams.

use crate::rules::Judge;
use crate::verdict::{Finding, Label, NotEvaluated, PlaceRole};

/// How many of the other streams a finding names and points at.
const NAMED: usize = 3;

/// Gives findings of different streams that have one cause as one: the first, which names the others and points at them.
/// `more` says what the others do ("run the same way"); where it is empty, the message speaks of all already. The others get a row that points to the first.
pub(crate) fn tell_once(findings: Vec<Finding>, more: &str, out: &mut Judge) {
    let mut findings = findings.into_iter();
    let Some(mut first) = findings.next() else { return };
    let others: Vec<Finding> = findings.collect();
    for (index, other) in others.iter().enumerate() {
        let why = format!("has the same cause as the finding on {}", first.subject);
        out.not_evaluated(other.subject.clone(), NotEvaluated::NotApplicable, why);
        if let Some(label) = other.places.first().filter(|_| index < NAMED) {
            first.places.push(Label {
                role: PlaceRole::Related,
                note: other.subject.clone(),
                ..label.clone()
            });
        }
    }
    if !others.is_empty() && !more.is_empty() {
        let named: Vec<&str> = others.iter().take(NAMED).map(|other| other.subject.as_str()).collect();
        let rest = match others.len().saturating_sub(NAMED) {
            0 => String::new(),
            n => format!(" and {n} more"),
        };
        first.message = format!("{}; {}{rest} {more}", first.message, named.join(", "));
    }
    out.fail(first);
}
