//! Poses without a velocity, row by row.

use crate::world::motion::{PoseRow, Series};

use super::super::point::Point;
use super::super::series::{Rows, Sample};

/// Position, orientation.
pub(in super::super) type Poses = Rows<7, 3>;

/// The numbers that follow each other in `parts`.
pub(super) fn joined<const N: usize>(parts: &[&[f64]]) -> [f64; N] {
    let mut values = [0.0; N];
    for (slot, value) in values.iter_mut().zip(parts.iter().copied().flatten()) {
        *slot = *value;
    }
    values
}

/// Takes in a valid pose.
pub(in super::super) fn push_pose(poses: &mut Poses, point: Point, pose: &crate::world::Pose) {
    poses.push(point, joined(&[&pose.translation_m, &pose.rotation_xyzw]));
}

/// The rows of poses without a velocity.
pub(in super::super) fn finish_poses(poses: Poses) -> Option<Series<PoseRow>> {
    poses.finish(|row| pose_row(&row))
}

/// Position and orientation of a row that begins with them.
pub(super) fn pose_row<const N: usize>(row: &Sample<N>) -> PoseRow {
    PoseRow {
        stamp_ns: row.stamp_ns,
        log_ns: row.log_ns,
        position: row.part(0),
        orientation: row.part(3),
        twist: None,
    }
}
