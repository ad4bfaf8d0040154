//! Split recordings whose later files hold no latched transforms.

use crate::analysis::tf;
use crate::source::Place;
use crate::verdict::{Finding, Measured};
use crate::world::BagEvidence;
use crate::world::bag::Part;

/// Whether what is not in the evidence of the static topics is not in the recording either.
fn is_read_up(bag: &BagEvidence) -> bool {
    let mut latched = bag.topics.values().filter(|topic| tf::is_static_topic(&topic.topic));
    bag.share.whole || latched.all(|topic| topic.total.is_some_and(|total| total <= topic.count))
}

/// Latched transforms stand in the first file or files only. As one recording it is whole, so this is a note.
pub(crate) fn split(bag: &BagEvidence, subject: &str) -> Option<Finding> {
    let with_messages: Vec<&Part> = bag.parts.iter().filter(|part| part.messages > 0).collect();
    let without: Vec<&&Part> = with_messages.iter().filter(|part| !part.static_transforms).collect();
    let lacking = without.first()?;
    if with_messages.len() == without.len() || bag.truncated || !is_read_up(bag) {
        return None;
    }
    let first = bag.tf.iter().filter(|edge| edge.is_static).map(|edge| &edge.first_at);
    let first = first.min_by_key(|at| at.log_ns)?;
    let message = format!(
        "{} of the {} files of the split recording hold no latched transforms ({}{}): played or checked alone, they \
         have no mounts",
        without.len(),
        with_messages.len(),
        lacking.path,
        if without.len() > 1 { ", ..." } else { "" },
    );
    let finding = Finding::note(subject, message, Place::message(bag.source, first.clone()))
        .label("the latched transforms are here")
        .help("keep the files together and play them as one, or write /tf_static into every file when splitting")
        .measured(Measured::count("files without latched transforms", without.len()).limit(0.0));
    Some(finding)
}
