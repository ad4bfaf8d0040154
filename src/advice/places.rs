//! Places for findings about frames, and edits that rename a frame wherever a text spells it.
//!
//! Owns the choice of the first place. Must not judge.

use std::collections::BTreeSet;

use crate::analysis::places::joint_of;
use crate::source::Place;
use crate::verdict::Edit;
use crate::world::graph::{Edge, EdgeOrigin};
use crate::world::{ClaimKind, FrameId, World};

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

/// Edits that replace a name by another in every text that spells it; `None` where one of its places is a text that
/// cannot be edited safely, or where no text spells it.
pub(crate) fn rename_edits(world: &World, spelled: &FrameId, to: &str) -> Option<Vec<Edit>> {
    if to.is_empty() || to.contains(['<', '>', '&', '"', '\'', ':', '#']) {
        return None;
    }
    let mut edits = Vec::new();
    for place in text_places(world, spelled) {
        let source = world.source(place.source)?;
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
        edits.push(Edit { place, replacement });
    }
    (!edits.is_empty()).then_some(edits)
}

/// Edits that exchange what stands at two places of one text; `None` where that text cannot be edited safely.
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

/// Every place in a text at which a frame is spelled like this, in order.
fn text_places(world: &World, spelled: &FrameId) -> BTreeSet<Place> {
    let name = spelled.as_str();
    let links = world
        .robots
        .iter()
        .flat_map(|robot| &robot.links)
        .map(|link| &link.name);
    let ends = world
        .robots
        .iter()
        .flat_map(|robot| &robot.joints)
        .flat_map(|joint| [joint.parent.as_ref(), joint.child.as_ref()])
        .flatten();
    let named = links
        .chain(ends)
        .filter(|placed| placed.value == name)
        .map(|placed| &placed.place);
    let claimed = world
        .claims
        .iter()
        .filter(|claim| matches!(claim.kind, ClaimKind::File { .. }))
        .flat_map(|claim| {
            let target = claim
                .target()
                .filter(|frame| *frame == spelled)
                .and(claim.target_place.as_ref());
            let source = claim
                .source_frame()
                .filter(|frame| *frame == spelled)
                .and(claim.source_place.as_ref());
            [target, source]
        })
        .flatten();
    let used = world
        .frames
        .iter()
        .filter(|used| used.frame == *spelled)
        .map(|used| &used.place);
    named
        .chain(claimed)
        .chain(used)
        .filter(|place| place.span().is_some())
        .cloned()
        .collect()
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
        let edits = rename_edits(&world(text, spelled), &spelled.trim_matches('"').into(), to)?;
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
        derived.derived = Some(crate::source::Derived::Expansion);
        let derived = world_of(derived, "a: Lidar", "Lidar");
        assert_eq!(rename_edits(&derived, &"Lidar".into(), "lidar"), None);
        let moved = world_of(source("a:  Lidar"), "a: Lidar", "Lidar");
        assert_eq!(rename_edits(&moved, &"Lidar".into(), "lidar"), None);
    }
}
