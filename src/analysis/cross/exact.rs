//! Whether numbers alone show that two sources mean the same sensors, independent of names.

use std::collections::{BTreeMap, BTreeSet};

use nalgebra::Isometry3;
use serde::Deserialize;

use crate::analysis::cross::pair::Pair;
use crate::math::relation::{Classification, Relation};
use crate::source::SourceId;
use crate::world::FrameId;

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Limits {
    pub(crate) alternatives_turn_deg: f64,
    pub(crate) mount_m: f64,
    pub(crate) exact_deg: f64,
    pub(crate) exact_m: f64,
    pub(crate) telling_m: f64,
    pub(crate) min_sensors: usize,
}

impl Limits {
    /// Whether a convention error explains a difference to the last digits, for a transform that is hardly equal by chance.
    pub(crate) fn fits(&self, pose: &Isometry3<f64>, found: &Classification) -> bool {
        found.residual_angle_rad.to_degrees() <= self.exact_deg
            && found.residual_m <= self.exact_m
            && self.is_distinctive(pose)
    }

    /// Whether it is more specific than a mount along the axes with a length along one of them, which unrelated devices share.
    pub(crate) fn is_distinctive(&self, pose: &Isometry3<f64>) -> bool {
        self.is_distinct(pose, 2)
    }

    /// Whether a transform is hardly equal by chance among all frames of a robot: it is rotated off the axes, or has three lengths.
    pub(crate) fn is_unique(&self, pose: &Isometry3<f64>) -> bool {
        self.is_distinct(pose, 3)
    }

    /// Whether a transform is rotated off the axes, or has so many lengths.
    fn is_distinct(&self, pose: &Isometry3<f64>, least_lengths: usize) -> bool {
        self.lengths(pose) >= least_lengths || self.is_turned(pose)
    }

    fn lengths(&self, pose: &Isometry3<f64>) -> usize {
        let parts = pose.translation.vector.iter();
        parts.filter(|part| part.abs() > self.telling_m).count()
    }

    fn is_turned(&self, pose: &Isometry3<f64>) -> bool {
        off_axes_deg(pose) >= self.alternatives_turn_deg
    }

    /// Whether rotation or translation is equal to the last digits, and hardly by chance, with this difference.
    pub(crate) fn halves(&self, pose: &Isometry3<f64>, off_deg: f64, off_m: f64) -> bool {
        off_deg <= self.exact_deg && self.is_turned(pose) || off_m <= self.exact_m && self.lengths(pose) > 2
    }
}

/// Sensors that two sources state differently by one relation.
#[derive(Default)]
pub(crate) struct SharedRelations(BTreeMap<(Relation, [SourceId; 2]), BTreeSet<[FrameId; 2]>>);

impl SharedRelations {
    /// Counts a pair whose difference is this relation.
    pub(crate) fn add(&mut self, limits: &Limits, pair: &Pair, relation: Relation) {
        let reference = &pair.reference;
        if limits.is_distinctive(&reference.pose) {
            let sensors = self.0.entry((relation, Self::sources(pair))).or_default();
            sensors.insert([reference.target.clone(), reference.source_frame.clone()]);
        }
    }

    /// How many sensors of the two sources of a pair differ by this relation.
    pub(crate) fn count(&self, pair: &Pair, relation: Relation) -> usize {
        let sensors = self.0.get(&(relation, Self::sources(pair)));
        sensors.map_or(0, BTreeSet::len)
    }

    fn sources(pair: &Pair) -> [SourceId; 2] {
        let (a, b) = (pair.reference.place.source, pair.other.place.source);
        [a.min(b), a.max(b)]
    }
}

/// The largest angle between an axis of the source and the nearest axis of the target, degrees.
pub(crate) fn off_axes_deg(pose: &Isometry3<f64>) -> f64 {
    let matrix = pose.rotation.to_rotation_matrix();
    let columns = matrix.matrix().column_iter();
    let angles = columns.map(|column| {
        column
            .iter()
            .fold(0.0_f64, |most, part| most.max(part.abs()))
            .min(1.0)
            .acos()
    });
    angles.fold(0.0, f64::max).to_degrees()
}
