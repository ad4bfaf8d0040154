//! How a finding says that the data were read as the user, or a name, declares.

use crate::analysis::{motion::ExpressedIn, time::streams::Stream};
use crate::source::Place;
use crate::verdict::Finding;

/// The finding with this sentence at the end of its detail, and the place of the declaration, where there is one.
fn tell(finding: Finding, sentence: &str, place: Option<&Place>) -> Finding {
    let finding = finding.detail(sentence);
    match place {
        Some(place) => finding.related(place.clone(), "declared here"),
        None => finding,
    }
}

impl ExpressedIn {
    /// A finding that says how the numbers were read, where not as ROS defines.
    pub(crate) fn tell(&self, finding: Finding) -> Finding {
        if !self.converts() {
            return finding;
        }
        let sentence = format!(
            "The numbers were read as {}, as {}.",
            self.convention.words(),
            self.says
        );
        tell(finding, &sentence, self.place.as_ref())
    }
}

impl Stream<'_> {
    /// A finding that says in which time scale the stamps were read, where the user declares one.
    pub(crate) fn tell(&self, finding: Finding) -> Finding {
        let Some(scale) = &self.declared else { return finding };
        let sentence = format!("The stamps were read as {}.", scale.words);
        tell(finding, &sentence, scale.place.as_ref())
    }
}
