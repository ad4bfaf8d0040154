//! Places for findings about frames, and edits that rename a frame everywhere in a text.
//!
//! Owns the choice of the first place. Must not judge.

use std::collections::{BTreeMap, BTreeSet};

use crate::analysis::places::{joint_of, of_numbers};
use crate::source::Place;
use crate::verdict::{Edit, Finding};
use crate::world::graph::{Edge, EdgeOrigin};
use crate::world::{Claim, ClaimKind, FrameId, World};

/// The finding with the places of the transforms that mount a sensor on a body.
pub(crate) fn with_mounting(world: &World, [body, sensor]: [&FrameId; 2], finding: Finding) -> Finding {
    let graph = world.graph();
    let chain = graph.chain(body, sensor, |edge| edge.is_rigid);
    let steps = chain.map(|(_, steps)| steps).unwrap_or_default();
    let edges = steps.iter().filter_map(|step| graph.edges.get(step.edge));
    let places = edges.filter_map(|edge| of_numbers(world, edge));
    places.fold(finding, |finding, place| {
        finding.related(place, "transform of the mounting")
    })
}

/// The edit that gives the joint behind an edge another `rpy`, where it is written in one place of an editable text.
pub(crate) fn rpy_edit(world: &World, edge: &Edge, rpy: &str) -> Option<Edit> {
    let EdgeOrigin::Joint(index) = edge.origin else {
        return None;
    };
    let joint = joint_of(world, world.claims.get(index)?)?;
    let [origin] = joint.origins.as_slice() else {
        return None;
    };
    let place = origin.rpy.as_ref()?.text.place.clone();
    let is_editable = world
        .source(place.source)
        .is_some_and(|source| source.derived.is_none());
    is_editable.then(|| Edit {
        place,
        replacement: rpy.to_owned(),
    })
}

/// Edits that exchange the texts at two places; `None` where that text cannot be edited safely.
pub(crate) fn swap_edits(world: &World, a: &Place, b: &Place) -> Option<Vec<Edit>> {
    let text = |place: &Place| {
        let source = world.source(place.source).filter(|source| source.derived.is_none())?;
        let span = place.span()?;
        source.text.get(span.start..span.end).map(str::to_owned)
    };
    let (at_a, at_b) = text(a).zip(text(b))?;
    let edit = |place: &Place, replacement| Edit {
        place: place.clone(),
        replacement,
    };
    Some(vec![edit(a, at_b), edit(b, at_a)])
}

/// The places of frame names in texts.
pub(crate) struct NamePlaces<'w> {
    world: &'w World,
    places: BTreeMap<&'w str, BTreeSet<&'w Place>>,
}

impl<'w> NamePlaces<'w> {
    /// Searches the texts of a world once.
    pub(crate) fn of(world: &'w World) -> Self {
        let links = world.robots.iter().flat_map(|robot| &robot.links);
        let joints = world.robots.iter().flat_map(|robot| &robot.joints);
        let ends = joints.flat_map(|joint| [joint.parent.as_ref(), joint.child.as_ref()]);
        let named = links.map(|link| &link.name).chain(ends.flatten());
        let named = named.map(|placed| (placed.value.as_str(), &placed.place));
        let is_of_file = |claim: &&Claim| matches!(claim.kind, ClaimKind::File { .. });
        let claims = world.claims.iter().filter(is_of_file);
        let claimed = claims.flat_map(|claim| {
            let target = claim.target().zip(claim.target_place.as_ref());
            [target, claim.source_frame().zip(claim.source_place.as_ref())]
        });
        let used = world.frames.iter().map(|used| (&used.frame, &used.place));
        let framed = claimed.flatten().chain(used);
        let mut places: BTreeMap<&str, BTreeSet<&Place>> = BTreeMap::new();
        for (name, place) in named.chain(framed.map(|(frame, place)| (frame.as_str(), place))) {
            if place.span().is_some() {
                places.entry(name).or_default().insert(place);
            }
        }
        Self { world, places }
    }

    /// Edits that replace a name everywhere; `None` where one of its places is a text that cannot be edited safely, or where no
    /// text contains it.
    pub(crate) fn rename_edits(&self, spelled: &FrameId, to: &str) -> Option<Vec<Edit>> {
        if to.is_empty() || to.contains(['<', '>', '&', '"', '\'', ':', '#']) {
            return None;
        }
        let mut edits = Vec::new();
        for place in self.places.get(spelled.as_str()).into_iter().flatten().copied() {
            let source = self.world.source(place.source)?;
            if source.derived.is_some() {
                return None;
            }
            let span = place.span()?;
            let text = source.text.get(span.start..span.end)?;
            let quoted = ['"', '\''].into_iter().find(|quote| {
                text.strip_prefix(*quote)
                    .and_then(|rest| rest.strip_suffix(*quote))
                    .is_some_and(|inner| inner == spelled.as_str())
            });
            let replacement = match quoted {
                Some(quote) => format!("{quote}{to}{quote}"),
                None if text == spelled.as_str() => to.to_owned(),
                None => return None,
            };
            edits.push(Edit {
                place: place.clone(),
                replacement,
            });
        }
        (!edits.is_empty()).then_some(edits)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::source::{Source, SourceId, SourceKind, Span};
    use crate::world::{FrameRole, FrameUse};

    fn world_of(source: Source, text: &str, spelled: &str) -> World {
        let id = source.id;
        let mut world = World::default();
        world.sources = vec![source.into()].into();
        for (start, found) in text.match_indices(spelled) {
            world.frames.push(FrameUse {
                frame: FrameId::new(spelled.trim_matches('"')),
                role: FrameRole::Calibration,
                place: Place::text(id, Span::new(start, start + found.len())),
                count: 1,
            });
        }
        world
    }

    fn source(text: &str) -> Source {
        let mut source = Source::new(SourceId(0), "calibration.yaml", SourceKind::Yaml);
        source.text = text.to_owned();
        source
    }

    fn world(text: &str, spelled: &str) -> World {
        world_of(source(text), text, spelled)
    }

    fn replaced(text: &str, spelled: &str, to: &str) -> Option<Vec<String>> {
        let edits = NamePlaces::of(&world(text, spelled)).rename_edits(&spelled.trim_matches('"').into(), to)?;
        Some(edits.into_iter().map(|edit| edit.replacement).collect())
    }

    #[test]
    fn every_place_is_renamed_and_quotes_are_kept() {
        assert_eq!(
            replaced("a: Lidar\nb: Lidar", "Lidar", "lidar").unwrap(),
            ["lidar", "lidar"]
        );
        assert_eq!(replaced("a: \"Lidar\"", "\"Lidar\"", "lidar").unwrap(), ["\"lidar\""]);
    }

    #[test]
    fn nothing_is_renamed_where_the_text_is_not_the_name_or_is_not_a_file() {
        assert_eq!(replaced("a: Lidar", "Camera", "camera"), None);
        assert_eq!(replaced("a: Lidar", "Lidar", "a<b"), None);
        let mut derived = source("a: Lidar");
        derived.derived = Some(crate::source::Derivation::Expansion);
        let derived = world_of(derived, "a: Lidar", "Lidar");
        assert_eq!(NamePlaces::of(&derived).rename_edits(&"Lidar".into(), "lidar"), None);
        let moved = world_of(source("a:  Lidar"), "a: Lidar", "Lidar");
        assert_eq!(NamePlaces::of(&moved).rename_edits(&"Lidar".into(), "lidar"), None);
    }
}
