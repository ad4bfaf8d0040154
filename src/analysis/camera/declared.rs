//! Which topics a declared projection is about. Must not judge.

use globset::Glob;

use crate::world::{World, bag::TopicEvidence, projection::Projection};

/// The name of a declaration in reports.
pub(crate) fn name(world: &World, projection: &Projection) -> String {
    let path = world.path(projection.place.source);
    if projection.label.is_empty() {
        format!("{} of {path}", projection.format)
    } else {
        format!("{} `{}` of {path}", projection.format, projection.label)
    }
}

/// Whether a declaration names this topic, or any.
pub(crate) fn is_about(projection: &Projection, topic: &TopicEvidence) -> bool {
    let Some(text) = &projection.topic else { return true };
    Glob::new(text).is_ok_and(|glob| glob.compile_matcher().is_match(&topic.topic))
}
