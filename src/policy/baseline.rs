//! A baseline: known findings, which are accepted. New ones, and known ones that have become worse, are not.
//!
//! An entry identifies its finding by rule, subject, file and relation: lines may move. It keeps the first measured number, so that
//! a finding that has become much worse is a new one.

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};

use crate::source::Place;
use crate::verdict::waiver::{Acceptance, FAMILY, Identity, Waiver, WaiverKind};
use crate::verdict::{Finding, Measured, Verdict};

use super::{Context, Exception, Scope};

/// Name of the document's schema.
pub const SCHEMA: &str = "frames-lint-baseline/1";

/// A known finding is the same as long as its distance from the limit has not grown by more than half: repeated recordings of one
/// fault differ by less, and a new fault differs by more.
const MAX_GROWTH: f64 = 1.5;

/// The document.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Document {
    /// [`SCHEMA`].
    pub schema: String,
    /// What is accepted, in order.
    pub findings: Vec<Entry>,
}

/// A known finding.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Entry {
    /// Code of the rule.
    pub rule: String,
    /// What was judged.
    pub subject: String,
    /// The file, from the folder of the baseline.
    pub path: String,
    /// The relation that explains the difference, or nothing.
    pub relation: Option<String>,
    /// How many findings share all this.
    pub count: usize,
    /// The most places that one of them has: a finding that sums up more of them is a new one.
    pub places: usize,
    /// The first measured number of each of them, the worst first.
    pub measured: Vec<Number>,
    /// Its message, for the reader.
    pub message: String,
}

/// A number and its limit.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Number {
    /// What was measured.
    pub what: String,
    /// The value; `None` where it was not finite.
    pub value: Option<f64>,
    /// Its unit.
    pub unit: String,
    /// The limit that it was compared with.
    pub limit: Option<f64>,
}

impl Number {
    fn of(measured: &Measured) -> Self {
        let finite = |value: f64| value.is_finite().then_some(value);
        Self {
            what: measured.what.clone(),
            value: finite(measured.value),
            unit: measured.unit.clone(),
            limit: measured.limit.and_then(finite),
        }
    }

    /// How far the value is from its limit, or from zero.
    fn excess(&self) -> Option<f64> {
        Some((self.value? - self.limit.unwrap_or(0.0)).abs())
    }

    /// Whether `other`, of the same kind, is much worse.
    fn is_outgrown_by(&self, other: &Self) -> bool {
        if self.what != other.what || self.unit != other.unit {
            return false;
        }
        match (self.excess(), other.excess()) {
            (Some(known), Some(now)) => now > known * MAX_GROWTH + 1e-9,
            (known, now) => known.is_some() && now.is_none(),
        }
    }
}

/// A finding that a baseline accepts.
#[derive(Clone, Debug)]
pub struct AcceptedFinding {
    /// Its identity.
    pub identity: Identity,
    /// How many such findings.
    pub count: usize,
    /// The most places that it may have.
    pub places: usize,
    /// The worst first number.
    pub worst: Option<Number>,
}

impl AcceptedFinding {
    /// Whether this is the finding, of any size.
    pub(super) fn was(&self, finding: &Finding, context: &Context) -> bool {
        self.identity == identity(finding, context)
    }

    pub(super) fn is(&self, finding: &Finding, context: &Context) -> bool {
        self.was(finding, context)
            && finding.places.len() <= self.places
            && !self
                .worst
                .as_ref()
                .zip(finding.measured.first())
                .is_some_and(|(worst, now)| worst.is_outgrown_by(&Number::of(now)))
    }
}

fn identity(finding: &Finding, context: &Context) -> Identity {
    Identity::of(finding, context.platforms, |place| {
        let source = context.sources.get(place.source.0 as usize)?;
        Some((source.path.clone(), context.known_as?(source)))
    })
}

/// The baseline that accepts the findings of a verdict that no waiver accepts.
pub fn of(verdict: &Verdict, context: &Context) -> Document {
    let mut groups: BTreeMap<Identity, Vec<&Finding>> = BTreeMap::new();
    // What a baseline had accepted is part of the next one.
    let own = |finding: &&Finding| finding.waived.as_ref().is_none_or(|waived| waived.reason == REASON);
    for finding in verdict
        .findings
        .iter()
        .filter(own)
        .filter(|finding| !finding.rule.starts_with(FAMILY))
    {
        groups.entry(identity(finding, context)).or_default().push(finding);
    }
    let entry = |(identity, found): (Identity, Vec<&Finding>)| {
        let mut measured: Vec<Number> = found
            .iter()
            .filter_map(|finding| finding.measured.first().map(Number::of))
            .collect();
        measured.sort_by(|a, b| {
            b.excess()
                .unwrap_or(f64::MAX)
                .total_cmp(&a.excess().unwrap_or(f64::MAX))
        });
        Entry {
            rule: identity.rule,
            subject: identity.subject,
            path: identity.path,
            relation: Some(identity.relation).filter(|word| !word.is_empty()),
            count: found.len(),
            places: found.iter().map(|finding| finding.places.len()).max().unwrap_or(0),
            measured,
            message: found.first().map(|finding| finding.message.clone()).unwrap_or_default(),
        }
    };
    Document {
        schema: SCHEMA.to_owned(),
        findings: groups.into_iter().map(entry).collect(),
    }
}

/// Accepts what the baseline that was just written to `origin` contains.
pub fn accept_all(verdict: &mut Verdict, origin: &str) {
    let open = |finding: &&mut Finding| finding.waived.is_none() && !finding.rule.starts_with(FAMILY);
    for finding in verdict.findings.iter_mut().filter(open) {
        finding.waived = Some(Acceptance {
            reason: REASON.to_owned(),
            by: None,
            until: None,
            origin: origin.to_owned(),
        });
    }
    super::settle_rows(verdict);
}

/// Why findings of a baseline are accepted.
pub const REASON: &str = "known before this baseline was written";

/// The acceptances of a baseline. `place` gives the place and the origin of the entry with a number.
pub fn exceptions(document: &Document, place: impl Fn(usize) -> (Place, String)) -> Vec<Exception> {
    let exception = |(index, entry): (usize, &Entry)| {
        let (place, origin) = place(index);
        Exception {
            waiver: Waiver {
                kind: WaiverKind::Baseline,
                rule: entry.rule.clone(),
                about: format!("`{}` in {}", entry.subject, entry.path),
                reason: REASON.to_owned(),
                by: None,
                until: None,
                origin,
                place,
            },
            scope: Scope::Known(Box::new(AcceptedFinding {
                identity: Identity {
                    rule: entry.rule.clone(),
                    subject: entry.subject.clone(),
                    path: entry.path.clone(),
                    relation: entry.relation.clone().unwrap_or_default(),
                },
                count: entry.count,
                places: entry.places,
                worst: entry.measured.first().cloned(),
            })),
        }
    };
    document.findings.iter().enumerate().map(exception).collect()
}
