//! Many names with one fault: a namespace or a habit, and one finding.

use std::collections::BTreeMap;

use crate::source::{Confidence, Place, SourceId};
use crate::verdict::{Edit, Finding, Measured, Safety, Severity};

/// Source, severity, confidence and fault in words: names that share all of these have one cause.
pub(super) type Kind = (SourceId, Severity, Confidence, &'static str);

/// The findings, with those of one kind made one where there are more than `most_apart`; `shown` places stand beside the
/// first.
pub(super) fn fold(findings: Vec<(Kind, Finding)>, most_apart: usize, shown: usize) -> Vec<Finding> {
    let mut kinds: BTreeMap<Kind, Vec<Finding>> = BTreeMap::new();
    for (kind, finding) in findings {
        kinds.entry(kind).or_default().push(finding);
    }
    let mut all = Vec::new();
    for mut findings in kinds.into_values() {
        if findings.len() > most_apart {
            findings.sort_by(|a, b| place(a).cmp(&place(b)));
            all.extend(folded(findings, shown));
        } else {
            all.extend(findings);
        }
    }
    all
}

fn place(finding: &Finding) -> Option<&Place> {
    finding.places.first().map(|label| &label.place)
}

fn folded(findings: Vec<Finding>, shown: usize) -> Option<Finding> {
    let count = findings.len();
    let edits = findings.iter().map(|finding| Some(finding.fix.as_ref()?.edits.clone()));
    let edits: Option<Vec<Edit>> = edits.collect::<Option<Vec<_>>>().map(|edits| edits.concat());
    let mut others = findings.into_iter();
    let mut first = others.next()?;
    first.message = format!("{count} frame names have one fault, the first: {}", first.message);
    first.measured = vec![Measured::count("names with this fault", count).limit(0.0)];
    first.fix = None;
    for other in others.take(shown) {
        if let Some(place) = place(&other) {
            first = first.related(place.clone(), other.subject.clone());
        }
    }
    Some(match edits {
        Some(edits) => first.fix(format!("mend the {count} names"), Safety::Safe, edits),
        None => first,
    })
}
