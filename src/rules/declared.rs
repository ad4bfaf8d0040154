//! How a finding says that the data were read as the user, or a name, has it.

use crate::source::Place;
use crate::verdict::Finding;

/// The finding with this sentence behind its message, and the place of the declaration, where there is one.
pub(crate) fn tell(mut finding: Finding, sentence: &str, place: Option<&Place>) -> Finding {
    finding.message = format!("{}. {sentence}", finding.message.trim_end_matches('.'));
    match place {
        Some(place) => finding.related(place.clone(), "declared here"),
        None => finding,
    }
}
