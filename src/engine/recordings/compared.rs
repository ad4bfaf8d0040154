//! Data kept of a judged recording to compare it with others: small enough for a thousand recordings.

use std::collections::{BTreeMap, BTreeSet};

use crate::analysis::Estimates;
use crate::analysis::geo::earth::is_earth;
use crate::analysis::geo::origins::{self, Limits};
use crate::source::Place;
use crate::world::bag::TfEdge;
use crate::world::{BagEvidence, Facts, FrameUse, LocalOrigin, World};

use super::JudgeContext;

impl JudgeContext<'_> {
    /// The first values of latched transforms, positions of Earth-fixed frames and origins of maps, by the recordings' indices.
    pub(super) fn compared(&self, world: &World) -> Vec<(usize, Facts)> {
        let settings = &self.setup.governed.at(self.setup.governed.of(world)).choice.settings;
        let origins = origins::of_bags(&Estimates::new(world, settings), &settings.limits::<Limits>());
        let bags = world.bags.iter();
        bags.map(|bag| (bag.source.0 as usize, facts(world, bag, &origins)))
            .collect()
    }
}

fn facts(world: &World, bag: &BagEvidence, origins: &[LocalOrigin]) -> Facts {
    let is_earth = |edge: &&TfEdge| is_earth(&edge.parent) || is_earth(&edge.child);
    let edges = bag.tf.iter().filter(|edge| edge.is_static || is_earth(edge));
    let edges = edges.filter_map(|edge| {
        let mut kept = TfEdge::once(edge.parent.clone(), edge.child.clone(), edge.first()?.clone());
        kept.topic.clone_from(&edge.topic);
        kept.is_static = edge.is_static;
        if !edge.is_static {
            kept.samples.clone_from(&edge.samples);
        }
        Some(kept)
    });
    // A recording joins others by the names of its frames.
    let mut known = BTreeSet::new();
    let frames = world.frames.iter().filter(|used| used.place.source == bag.source);
    let frames = frames.filter(|used| known.insert((&used.frame, used.role)));
    let frames = frames.map(|used| FrameUse {
        place: Place::whole(bag.source),
        ..used.clone()
    });
    let origins = origins.iter().filter(|origin| origin.bag == Some(bag.source));
    Facts {
        frames: frames.collect(),
        bag_origins: origins.cloned().collect(),
        bags: vec![BagEvidence {
            tf: edges.collect(),
            topics: BTreeMap::new(),
            parent_switches: Vec::new(),
            parts: Vec::new(),
            annotations: BTreeMap::new(),
            share: bag.share.clone(),
            ..*bag
        }],
        ..Facts::default()
    }
}
