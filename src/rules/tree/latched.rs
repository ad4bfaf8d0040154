//! Latched transforms by name, how far two of their values are apart, and those that keep their value.
//!
//! Must not know whether the values come from one recording or from several.

use std::collections::BTreeMap;

use crate::rules::Judge;
use crate::rules::relate::{Difference, Same};
use crate::verdict::{Measured, Severity};
use crate::world::bag::{TfEdge, TfSample};
use crate::world::{BagEvidence, FrameId};

use super::static_transform_changes::Limits;

/// Topic, parent and child, canonical.
pub(super) type Key = (String, FrameId, FrameId);

/// The latched edges of a recording.
pub(super) fn latched(bag: &BagEvidence) -> BTreeMap<Key, Vec<&TfEdge>> {
    let mut edges: BTreeMap<Key, Vec<&TfEdge>> = BTreeMap::new();
    for edge in bag.tf.iter().filter(|edge| edge.is_static) {
        let key = (edge.topic.clone(), edge.parent.canonical(), edge.child.canonical());
        edges.entry(key).or_default().push(edge);
    }
    edges
}

/// By how much two values differ.
#[derive(Clone, Copy)]
pub(super) struct Change {
    deg: f64,
    m: f64,
}

/// The change from one value to another.
pub(super) fn change(a: &TfSample, b: &TfSample) -> Change {
    let difference = a.pose.isometry().inv_mul(&b.pose.isometry());
    Change {
        deg: difference.rotation.angle().to_degrees(),
        m: difference.translation.vector.norm(),
    }
}

impl Change {
    /// How bad it is; `None` where the two values are one.
    pub(super) fn severity(self, limits: &Limits) -> Option<Severity> {
        if self.deg >= limits.error_deg || self.m >= limits.error_m {
            Some(Severity::Error)
        } else if self.deg > limits.same_deg || self.m > limits.same_m {
            Some(Severity::Warning)
        } else {
            None
        }
    }

    /// Angle and distance weighed against each other as 0.1 degrees against 1 mm, as the evidence does.
    pub(super) fn order<T>(a: &(T, Self), b: &(T, Self)) -> std::cmp::Ordering {
        let weight = |change: &Self| (change.deg / 0.1).max(change.m / 0.001);
        weight(&a.1).total_cmp(&weight(&b.1))
    }
}

/// Transforms that keep their value, for one row.
#[derive(Default)]
pub(super) struct Calm {
    count: u64,
    deg: f64,
    m: f64,
}

impl Calm {
    /// One more that keeps its value.
    pub(super) fn add(&mut self, change: &Change) {
        self.count += 1;
        self.deg = self.deg.max(change.deg);
        self.m = self.m.max(change.m);
    }

    /// Writes the row, if there is anything in it.
    pub(super) fn report(self, subject: String, limits: &Limits, out: &mut Judge) {
        if self.count > 0 {
            let turn = Measured::new("largest turn", self.deg, "deg").limit(limits.same_deg);
            let shift = Measured::new("largest shift", self.m, "m").limit(limits.same_m);
            out.pass(subject, [turn.samples(self.count), shift.samples(self.count)]);
        }
    }
}

/// The difference in words, and the convention error that explains it.
pub(super) fn difference(a: &TfSample, b: &TfSample, limits: &Limits) -> Difference {
    let same = Same {
        deg: limits.same_deg,
        m: limits.same_m,
    };
    Difference::between(&a.pose.isometry(), &b.pose.isometry(), same)
}
