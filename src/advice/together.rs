//! Faults of several streams with one cause, reported once.
//!
//! Must not know what is wrong with the streams.

use crate::verdict::{Finding, Judge, Label, PlaceRole};

/// How many of the other streams a finding names and points at.
const NAMED: usize = 3;

/// Gives findings of different streams that have one cause as one: the first, which names the others and points at them.
/// `more` says what the others do ("run the same way"); where it is empty, the message is about all of them already.
/// The others are explained by the first, and count as it does.
pub(crate) fn report_once(findings: Vec<Finding>, more: &str, out: &mut Judge) {
    let mut findings = findings.into_iter();
    let Some(mut first) = findings.next() else { return };
    let others: Vec<Finding> = findings.collect();
    for (index, other) in others.iter().enumerate() {
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
        first = first.detail(format!("Others that {more}: {}{rest}.", named.join(", ")));
    }
    if more.is_empty() && others.len() > NAMED {
        first = first.detail(format!("The first {} are shown.", NAMED + 1));
    }
    let (cause, severity, confidence) = (first.subject.clone(), first.severity, first.confidence);
    out.fail(first);
    for mut other in others {
        // One cause is one judgement: the others count no more than the one that reports it.
        (other.severity, other.confidence) = (severity, confidence);
        out.fail(other.same_cause_as(cause.as_str()));
    }
}
