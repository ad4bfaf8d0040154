//! The places of frames, transforms and their numbers.

use crate::source::{Confidence, Place, Span};
use crate::world::graph::Edge;
use crate::world::{Claim, FrameId, Literal, World, robot::Joint};

/// The first use of a frame: roles in the order of [`crate::world::FrameRole`], then places. `frame` is canonical.
pub(crate) fn first(world: &World, frame: &FrameId) -> Option<Place> {
    world
        .uses_of(frame)
        .min_by_key(|used| (used.role, &used.place))
        .map(|used| used.place.clone())
}

/// Where an edge is stated: the joint's start tag, or the first message that carries it.
pub(crate) fn of_edge(world: &World, edge: &Edge) -> Option<Place> {
    if let Some((bag, tf)) = edge.origin.recorded(world) {
        return Some(Place::message(bag.source, tf.first_at.clone()));
    }
    let claim = edge.claim(world)?;
    let joint = joint_of(world, claim);
    Some(joint.map_or_else(|| claim.place.clone(), |joint| joint.place.clone()))
}

/// How sure it is that a launch file publishes an edge; other edges are certain.
pub(crate) fn published_reading(world: &World, edge: &Edge) -> Confidence {
    let published = edge.claim(world).filter(|_| edge.is_published());
    published.map_or(Confidence::Certain, |claim| claim.reading)
}

/// The place of an edge's numbers: a joint's `<origin>`, where it has one; else as [`of_edge`].
pub(crate) fn of_numbers(world: &World, edge: &Edge) -> Option<Place> {
    let stated = edge.claim(world).map(|claim| claim.place.clone());
    stated.or_else(|| of_edge(world, edge))
}

/// The joint whose origin a claim is.
pub(crate) fn joint_of<'a>(world: &'a World, claim: &Claim) -> Option<&'a Joint> {
    let child = claim.source_frame().map(FrameId::as_str);
    world
        .joints_called(claim.place.source, &claim.label)
        .find(|joint| joint.child.as_ref().map(|link| link.value.as_str()) == child)
}

/// The place that covers all of the literals; `whole` where there are none.
pub(crate) fn cover(literals: &[Literal], whole: &Place) -> Place {
    let span = literals.iter().map(|literal| literal.span).reduce(Span::cover);
    span.map_or_else(|| whole.clone(), |span| Place::text(whole.source, span))
}
