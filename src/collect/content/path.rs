//! A path: one track, published again and again as it grows.
//!
//! Owns which of its poses are kept. Must not know whose track it is.

use crate::read::messages::content::Pose;
use crate::world::motion::{PoseRow, Series};

use super::super::point::Point;
use super::super::series::RowBudget;
use super::poses::{Poses, finish_poses, joined};

/// How far the last pose may be ahead of the message, nanoseconds: clocks of two programs on one computer agree better.
const MAX_AHEAD_NS: i64 = 1_000_000_000;

/// Takes in the messages of a path in recording order.
///
/// A message that goes back to where the rows begin replaces them: it holds the whole track again, as corrected since.
/// Of one that begins later (the last hundred poses, or what is new) only what is newer than the rows is added.
pub(super) struct Path {
    room: RowBudget,
    kept: Option<KeptPath>,
}

struct KeptPath {
    rows: Poses,
    first_ns: i64,
    last_ns: i64,
}

impl Path {
    pub(super) fn new(room: RowBudget) -> Self {
        Self { room, kept: None }
    }

    /// Takes in the poses of one message with their stamps. A plan is no track that was driven: its stamps are all
    /// equal, or in the future.
    pub(super) fn push(&mut self, point: Point, poses: &[(i64, Pose)]) {
        let (Some((first_ns, _)), Some((last_ns, _))) = (poses.first(), poses.last()) else {
            return;
        };
        let sent_ns = point.stamp_ns.filter(|stamp_ns| *stamp_ns != 0);
        let is_ahead = sent_ns.is_some_and(|sent_ns| last_ns.saturating_sub(sent_ns) > MAX_AHEAD_NS);
        if first_ns >= last_ns || is_ahead {
            return;
        }
        let kept = match self.kept.as_mut() {
            Some(kept) if kept.first_ns < *first_ns => kept,
            _ => self.kept.insert(KeptPath {
                rows: Poses::new(self.room),
                first_ns: *first_ns,
                last_ns: i64::MIN,
            }),
        };
        for (stamp_ns, pose) in poses {
            if *stamp_ns <= kept.last_ns {
                continue;
            }
            kept.last_ns = *stamp_ns;
            let at = Point {
                stamp_ns: Some(*stamp_ns),
                // The last one was known when the message was logged, each of the others by so much earlier.
                log_ns: point.log_ns.saturating_sub(last_ns.saturating_sub(*stamp_ns)),
                ..point
            };
            kept.rows.push(at, joined(&[&pose.position, &pose.orientation]));
        }
    }

    /// The rows; `None` where no message was a track.
    pub(super) fn finish(self) -> Option<Series<PoseRow>> {
        finish_poses(self.kept?.rows)
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::float_cmp)]
    use super::*;

    const S: i64 = 1_000_000_000;

    fn sent(path: &mut Path, at_s: i64, poses: &[(i64, f64)]) {
        let pose = |(at_s, x): &(i64, f64)| {
            let pose = Pose {
                position: [*x, 0.0, 0.0],
                orientation: [0.0, 0.0, 0.0, 1.0],
                covariance: None,
            };
            (at_s * S, pose)
        };
        let point = Point {
            index: 0,
            stamp_ns: Some(at_s * S),
            log_ns: (at_s + 100) * S,
            transform: None,
        };
        path.push(point, &poses.iter().map(pose).collect::<Vec<_>>());
    }

    /// Stamp, log time and x of each row, seconds and metres.
    fn rows(path: Path) -> Vec<(i64, i64, f64)> {
        let all = path.finish();
        let row = |row: &PoseRow| (row.stamp_ns / S, row.log_ns / S, row.position[0]);
        all.iter().flat_map(Series::rows).map(row).collect()
    }

    #[test]
    fn a_path_that_grows_is_kept_once_as_it_was_told_last() {
        let mut path = Path::new(RowBudget::of(0));
        sent(&mut path, 2, &[(1, 10.0), (2, 20.0)]);
        sent(&mut path, 3, &[(1, 11.0), (2, 21.0), (3, 31.0)]);
        assert_eq!(rows(path), [(1, 101, 11.0), (2, 102, 21.0), (3, 103, 31.0)]);
    }

    #[test]
    fn of_a_path_that_forgets_only_what_is_new_is_added() {
        let mut path = Path::new(RowBudget::of(0));
        sent(&mut path, 2, &[(1, 10.0), (2, 20.0)]);
        sent(&mut path, 3, &[(2, 21.0), (3, 31.0)]);
        assert_eq!(rows(path), [(1, 101, 10.0), (2, 102, 20.0), (3, 103, 31.0)]);
    }

    #[test]
    fn a_plan_is_no_way() {
        let mut path = Path::new(RowBudget::of(0));
        sent(&mut path, 5, &[(5, 10.0), (5, 20.0)]);
        sent(&mut path, 5, &[(0, 10.0), (0, 20.0)]);
        sent(&mut path, 5, &[(5, 10.0), (9, 20.0)]);
        sent(&mut path, 5, &[(1, 10.0)]);
        sent(&mut path, 5, &[]);
        assert_eq!(path.finish(), None);
    }
}
