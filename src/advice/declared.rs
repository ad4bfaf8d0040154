//! How a finding says that the data were read as the user, or a name, declares.

use crate::analysis::{motion::StreamConvention, time::streams::Stream};
use crate::source::Place;
use crate::verdict::Finding;

/// The finding with this sentence at the end of its detail, and the place of the declaration, where there is one.
fn annotate(finding: Finding, sentence: &str, place: Option<&Place>) -> Finding {
    let finding = finding.detail(sentence);
    match place {
        Some(place) => finding.related(place.clone(), "declared here"),
        None => finding,
    }
}

impl StreamConvention {
    /// A finding that says how the numbers were read, where not as ROS defines.
    pub(crate) fn annotate(&self, finding: Finding) -> Finding {
        if !self.converts() {
            return finding;
        }
        let sentence = format!(
            "The numbers were read as {}, as {}.",
            self.convention.words(),
            self.says
        );
        annotate(finding, &sentence, self.place.as_ref())
    }
}

impl Stream<'_> {
    /// A finding that says in which time scale the stamps were read, where the user declares one.
    pub(crate) fn annotate(&self, finding: Finding) -> Finding {
        let Some(scale) = &self.declared else { return finding };
        let sentence = format!("The stamps were read as {}.", scale.words);
        annotate(finding, &sentence, scale.place.as_ref())
    }
}
