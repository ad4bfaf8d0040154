//! The places of names in a world, so that a rule that looks up many of them does not search everything for each.

use std::collections::{BTreeMap, BTreeSet};

use crate::source::SourceId;

use super::robot::Joint;
use super::{Claim, FrameId, FrameUse, World};

/// Places by names; indices into the world that it was made of.
#[derive(Clone, Debug, Default)]
pub(super) struct Index {
    /// Uses of a canonical frame, as indices into `World::frames`.
    uses: BTreeMap<FrameId, Vec<usize>>,
    /// Joints of one name, as indices into `World::robots` and its `joints`.
    joints: BTreeMap<(SourceId, String), Vec<(usize, usize)>>,
    /// Claims of one label, as indices into `World::claims`.
    claims: BTreeMap<(SourceId, String), Vec<usize>>,
}

impl Index {
    fn of(world: &World) -> Self {
        let mut index = Self::default();
        for (number, used) in world.frames.iter().enumerate() {
            index.uses.entry(used.frame.canonical()).or_default().push(number);
        }
        for (number, robot) in world.robots.iter().enumerate() {
            for (inside, joint) in robot.joints.iter().enumerate() {
                let key = (robot.source, joint.name.value.clone());
                index.joints.entry(key).or_default().push((number, inside));
            }
        }
        for (number, claim) in world.claims.iter().enumerate() {
            let key = (claim.place.source, claim.label.clone());
            index.claims.entry(key).or_default().push(number);
        }
        index
    }
}

impl World {
    fn index(&self) -> &Index {
        self.made.index.get_or_init(|| Index::of(self))
    }

    /// Where a frame is named; `frame` is canonical.
    pub fn uses_of(&self, frame: &FrameId) -> impl Iterator<Item = &FrameUse> {
        let numbers = self.index().uses.get(frame).into_iter().flatten();
        numbers.filter_map(|number| self.frames.get(*number))
    }

    /// Frames of the graphs whose names are of these words; see [`FrameId::tokens`].
    pub fn frames_of_words(&self, words: &[String]) -> impl Iterator<Item = &FrameId> {
        let known = self.made.words.get_or_init(|| {
            let mut known: BTreeMap<Vec<String>, BTreeSet<FrameId>> = BTreeMap::new();
            for frame in self.graphs().flat_map(|graph| &graph.frames) {
                known.entry(frame.tokens()).or_default().insert(frame.clone());
            }
            known
        });
        known.get(words).into_iter().flatten()
    }

    /// The claims of a file with this key or joint, in order.
    pub fn claims_called(&self, source: SourceId, label: &str) -> impl Iterator<Item = &Claim> {
        let numbers = self
            .index()
            .claims
            .get(&(source, label.to_owned()))
            .into_iter()
            .flatten();
        numbers.filter_map(|number| self.claims.get(*number))
    }

    /// The joints of a file that have this name, in order.
    pub fn joints_called(&self, source: SourceId, name: &str) -> impl Iterator<Item = &Joint> {
        let numbers = self
            .index()
            .joints
            .get(&(source, name.to_owned()))
            .into_iter()
            .flatten();
        numbers.filter_map(|(robot, joint)| self.robots.get(*robot)?.joints.get(*joint))
    }
}
