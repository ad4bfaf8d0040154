//! Split recordings with files that contain no latched transforms.

use crate::analysis::tf;
use crate::source::Place;
use crate::verdict::{Finding, Measured};
use crate::world::BagEvidence;
use crate::world::bag::Part;

/// Some files contain no latched transforms. As one recording nothing is missing, so this is a note.
pub(crate) fn split(bag: &BagEvidence, subject: &str) -> Option<Finding> {
    let with_messages: Vec<&Part> = bag.parts.iter().filter(|part| part.messages > 0).collect();
    let without: Vec<&&Part> = with_messages.iter().filter(|part| !part.static_transforms).collect();
    let lacking = without.first()?;
    if with_messages.len() == without.len() || bag.truncated || !tf::latched_is_read(bag) {
        return None;
    }
    let first = bag.tf.iter().filter(|edge| edge.is_static).map(|edge| &edge.first_at);
    let first = first.min_by_key(|at| at.log_ns)?;
    let message = format!(
        "{} of {} files of the split recording contain no latched transforms ({}{})",
        without.len(),
        with_messages.len(),
        lacking.path,
        if without.len() > 1 { ", ..." } else { "" },
    );
    let finding = Finding::note(subject, message, Place::message(bag.source, first.clone()))
        .label("the latched transforms are here")
        .detail("Played or checked alone, these files have no mounting transforms.")
        .help("play the files together as one recording, or write `/tf_static` into every file when splitting")
        .measured(Measured::count("files without latched transforms", without.len()).limit(0.0));
    Some(finding)
}
