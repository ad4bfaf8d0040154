//! Frames that are rigid with each other, in clusters: the pose between any two without a search.

use std::collections::{BTreeMap, BTreeSet};

use nalgebra::Isometry3;

use super::frame::FrameId;

/// The clusters of a graph. If rigid edges contradict each other, poses are computed through the first frame of a cluster.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Rigid {
    /// Each frame with the number of its cluster, and `first_from_frame` for the first frame of that.
    of: BTreeMap<FrameId, (usize, Isometry3<f64>)>,
    /// Frames with `first_from_frame`, sorted; the clusters by their first frames.
    pub clusters: Vec<Vec<(FrameId, Isometry3<f64>)>>,
}

impl Rigid {
    /// `reach` returns all frames that are rigid with a frame, including itself, with `frame_from_other`.
    pub(super) fn new<'f>(
        frames: &'f BTreeSet<FrameId>,
        reach: impl Fn(&FrameId) -> Vec<(&'f FrameId, Isometry3<f64>)>,
    ) -> Self {
        let mut rigid = Self::default();
        for first in frames {
            if rigid.of.contains_key(first) {
                continue;
            }
            let number = rigid.clusters.len();
            let reached = reach(first).into_iter();
            let mut cluster: Vec<_> = reached.map(|(frame, pose)| (frame.clone(), pose)).collect();
            cluster.sort_unstable_by(|(a, _), (b, _)| a.cmp(b));
            let numbered = cluster.iter().map(|(frame, pose)| (frame.clone(), (number, *pose)));
            rigid.of.extend(numbered);
            rigid.clusters.push(cluster);
        }
        rigid
    }

    /// `target_from_source`, where rigid edges connect the two.
    pub fn between(&self, target: &FrameId, source: &FrameId) -> Option<Isometry3<f64>> {
        let ((cluster, at_target), (of, at_source)) = (self.of.get(target)?, self.of.get(source)?);
        (cluster == of).then(|| at_target.inv_mul(at_source))
    }

    /// The frames that are rigid with one, including itself, with `first_from_frame`.
    pub fn cluster(&self, frame: &FrameId) -> &[(FrameId, Isometry3<f64>)] {
        let number = self.of.get(frame).map(|(number, _)| *number);
        number
            .and_then(|number| self.clusters.get(number))
            .map_or(&[], Vec::as_slice)
    }
}
