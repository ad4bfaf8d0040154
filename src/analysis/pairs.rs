//! Which other sources state the transform between the same two frames.
//!
//! Only constant statements count: fixed joints, static TF and files. Names are compared as tf2 stores them. A rule that
//! judges one statement finds here what confirms it; the statements that CROSS compares have a rank and a name for messages,
//! and include chains and constant TF.

use std::collections::BTreeMap;

use nalgebra::Isometry3;

use crate::source::{Place, SourceId};
use crate::world::{FrameId, World};

/// One statement of a transform.
#[derive(Clone, Debug)]
pub(crate) struct Statement {
    /// Who states it.
    pub source: SourceId,
    /// Where.
    pub place: Place,
    /// `target_from_source` of the requested pair.
    pub pose: Isometry3<f64>,
    /// Whether a rotation was stated.
    pub has_rotation: bool,
    /// Whether a translation was stated.
    pub has_translation: bool,
}

/// All constant statements by their pair of frames.
#[derive(Debug, Default)]
pub(crate) struct Pairs {
    /// By source within a pair: one file may state a pair thousands of times, and is never compared with itself.
    by_pair: BTreeMap<(FrameId, FrameId), BTreeMap<SourceId, Vec<Statement>>>,
}

impl Pairs {
    /// Collects the statements of a world.
    pub(crate) fn new(world: &World) -> Self {
        let mut pairs = Self::default();
        for claim in world.claims.iter().filter(|claim| claim.is_rigid()) {
            if let (Some((target, source)), Some(pose)) = (&claim.frames, &claim.pose) {
                let statement = Statement {
                    source: claim.place.source,
                    place: claim.place.clone(),
                    pose: pose.isometry(),
                    has_rotation: claim.has_rotation,
                    has_translation: claim.has_translation,
                };
                pairs.add(target, source, statement);
            }
        }
        for bag in &world.bags {
            for edge in bag.tf.iter().filter(|edge| edge.is_static) {
                if let Some(sample) = edge.first() {
                    let statement = Statement {
                        source: bag.source,
                        place: Place::message(bag.source, sample.at.clone()),
                        pose: sample.pose.isometry(),
                        has_rotation: true,
                        has_translation: true,
                    };
                    pairs.add(&edge.parent, &edge.child, statement);
                }
            }
        }
        pairs
    }

    fn add(&mut self, target: &FrameId, source: &FrameId, statement: Statement) {
        let key = (target.canonical(), source.canonical());
        let by_source = self.by_pair.entry(key).or_default();
        by_source.entry(statement.source).or_default().push(statement);
    }

    /// What sources other than `asking` state about `target_from_source`, in either direction. A rotation or a translation alone
    /// cannot be inverted, so it counts in its own direction only.
    pub(crate) fn others(&self, target: &FrameId, source: &FrameId, asking: SourceId) -> Vec<Statement> {
        let (target, source) = (target.canonical(), source.canonical());
        let stated = |pair: (FrameId, FrameId)| {
            let by_source = self.by_pair.get(&pair).into_iter().flatten();
            by_source
                .filter(|(stating, _)| **stating != asking)
                .flat_map(|(_, statements)| statements)
        };
        let direct = stated((target.clone(), source.clone()));
        let turned = stated((source, target))
            .filter(|statement| statement.has_rotation && statement.has_translation)
            .map(|statement| Statement {
                pose: statement.pose.inverse(),
                ..statement.clone()
            });
        direct.cloned().chain(turned).collect()
    }
}
