//! Who states the two sides of a finding on a pair of statements.

use crate::analysis::cross::pair::{Pair, Statement};
use crate::source::Confidence;
use crate::verdict::Finding;

impl Pair {
    /// Says of a finding at the other statement who states it and how sure the reading is, and points at the reference
    /// and at the other sources that take one side or the other.
    pub(crate) fn point_at_all(&self, finding: Finding) -> Finding {
        self.point_at_all_with(finding, Confidence::Hint)
    }

    /// The same, where the names of a program's sensors are as sure as this.
    pub(crate) fn point_at_all_with(&self, finding: Finding, roles: Confidence) -> Finding {
        let stated = |by: &Statement| format!("stated by {}", by.who);
        let mut finding = finding
            .confidence(self.reading_with(roles))
            .label(stated(&self.other))
            .related(self.reference.place.clone(), stated(&self.reference));
        for (with_other, place, who) in &self.seconded_by {
            let side = if *with_other { &self.other } else { &self.reference };
            finding = finding.related(place.clone(), format!("{who} agrees with {}", side.who));
        }
        finding
    }
}
