//! Latched transforms by name, the difference between two of their values, and those that keep their value.
//!
//! Must not know whether the values come from one recording or from several.

use std::collections::BTreeMap;

use serde::Deserialize;

use crate::analysis::relate::{Difference, PoseTolerance};
use crate::math::{relation::Relation, stats::rounded};
use crate::verdict::Severity;
use crate::world::bag::{TfEdge, TfSample};
use crate::world::{BagEvidence, FrameId};

/// Topic, parent and child, canonical.
pub(crate) type Key = (String, FrameId, FrameId);

/// The latched edges of a recording.
pub(crate) fn latched(bag: &BagEvidence) -> BTreeMap<Key, Vec<&TfEdge>> {
    let mut edges: BTreeMap<Key, Vec<&TfEdge>> = BTreeMap::new();
    for edge in bag.tf.iter().filter(|edge| edge.is_static) {
        let key = (edge.topic.clone(), edge.parent.canonical(), edge.child.canonical());
        edges.entry(key).or_default().push(edge);
    }
    edges
}

/// By how much two values differ.
#[derive(Clone, Copy)]
pub(crate) struct Change {
    deg: f64,
    m: f64,
}

/// The change from one value to another.
pub(crate) fn change(a: &TfSample, b: &TfSample) -> Change {
    let difference = a.pose.isometry().inv_mul(&b.pose.isometry());
    Change {
        deg: difference.rotation.angle().to_degrees(),
        m: difference.translation.vector.norm(),
    }
}

impl Change {
    /// How bad it is; `None` where the two values are the same.
    pub(crate) fn severity(self, limits: &Limits) -> Option<Severity> {
        if self.deg >= limits.error_deg || self.m >= limits.error_m {
            Some(Severity::Error)
        } else if self.deg > limits.same_deg || self.m > limits.same_m {
            Some(Severity::Warning)
        } else {
            None
        }
    }

    /// Its size in words.
    pub(crate) fn words(self) -> String {
        format!("{:.2} deg and {:.3} m", self.deg, self.m)
    }

    /// Angle and distance are weighted equally at 0.1 degrees and 1 mm, as in the evidence.
    pub(crate) fn order<T>(a: &(T, Self), b: &(T, Self)) -> std::cmp::Ordering {
        let weight = |change: &Self| (change.deg / 0.1).max(change.m / 0.001);
        weight(&a.1).total_cmp(&weight(&b.1))
    }
}

/// Transforms that keep their value, for one row.
#[derive(Default)]
pub(crate) struct StableTally {
    pub(crate) count: u64,
    pub(crate) deg: f64,
    pub(crate) m: f64,
}

impl StableTally {
    /// One more that keeps its value.
    pub(crate) fn add(&mut self, change: &Change) {
        self.count += 1;
        self.deg = self.deg.max(change.deg);
        self.m = self.m.max(change.m);
    }
}

/// A value in words.
pub(crate) fn value(sample: &TfSample) -> String {
    let pose = sample.pose.isometry();
    let (roll, pitch, yaw) = pose.rotation.euler_angles();
    let [x, y, z] = <[f64; 3]>::from(pose.translation.vector);
    let [x, y, z, roll, pitch, yaw] = [x, y, z, roll, pitch, yaw].map(|value| rounded(value, 4));
    format!("xyz {x:.4} {y:.4} {z:.4} m, rpy {roll:.4} {pitch:.4} {yaw:.4} rad")
}

/// The simplest convention error between two values, as a sentence behind a space, or nothing.
pub(crate) fn explanation(difference: &Difference) -> String {
    let known = difference.relation.and_then(Relation::from_word);
    known.map_or_else(String::new, |relation| {
        format!(
            " The simplest explanation: one of the two values {}.",
            relation.relates_to("the other")
        )
    })
}

/// The difference in words, and the convention error that explains it.
pub(crate) fn difference(a: &TfSample, b: &TfSample, limits: &Limits) -> Difference {
    let same = PoseTolerance {
        deg: limits.same_deg,
        m: limits.same_m,
    };
    Difference::between(&a.pose.isometry(), &b.pose.isometry(), same)
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Limits {
    /// Rotation up to which two values are the same, degrees.
    pub same_deg: f64,
    /// Translation up to which two values are the same, metres.
    pub same_m: f64,
    /// Rotation from which the change is an error, degrees.
    pub error_deg: f64,
    /// Translation from which the change is an error, metres.
    pub error_m: f64,
}
