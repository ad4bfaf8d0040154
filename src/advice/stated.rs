//! Who states the two sides of a finding on a pair of statements.

use crate::analysis::cross::pair::{Pair, Statement};
use crate::verdict::Finding;

impl Pair {
    /// Says of a finding at the other statement who states it and how sure the reading is, and points at the reference
    /// and at the other sources that take one side or the other.
    pub(crate) fn point_at_all(&self, finding: Finding) -> Finding {
        let stated = |by: &Statement| format!("stated by {}", by.who);
        let mut finding = finding
            .confidence(self.reading())
            .label(stated(&self.other))
            .related(self.reference.place.clone(), stated(&self.reference));
        for (with_other, place, who) in &self.seconded_by {
            let side = if *with_other { &self.other } else { &self.reference };
            finding = finding.related(place.clone(), format!("{who} agrees with {}", side.who));
        }
        finding
    }
}
