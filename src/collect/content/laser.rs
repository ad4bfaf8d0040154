//! Scans of one topic's planar scanner.

use nalgebra::{Quaternion, UnitQuaternion, Vector3};

use crate::read::messages::content::{LaserScan, Pose};
use crate::world::cloud::{CloudEvidence, CloudSlice, RUN_CLOUDS, SLICE_BINS};
use crate::world::laser::{LaserEvidence, LaserScanAt, MAX_SCANS};

use super::super::point::{Point, PointOwner};
use super::super::thin::{SampleBudget, ThinnedSeries};
use super::runs::Runs;

/// Cosine of the angle from which on the plane of a scan is no longer that of its frame's x and y.
const LEVEL: f64 = 0.99;
/// The least time between scans of a run, nanoseconds: at forty scans a second, indoor robots hardly move from one to the next.
const APART_NS: i64 = 90_000_000;
/// Scans of a run: twice as many as of clouds, in half as many runs.
const RUN_SCANS: usize = 2 * RUN_CLOUDS;

/// Takes in scans in recording order.
pub(super) struct Lasers {
    first: Point,
    count: u64,
    scans: ThinnedSeries<LaserScanAt>,
    runs: Runs<CloudSlice>,
    /// Log time of the last scan of a run.
    last_ns: Option<i64>,
}

impl Lasers {
    pub(super) fn new(share: SampleBudget, first: Point) -> Self {
        Self {
            first,
            count: 0,
            scans: ThinnedSeries::new(MAX_SCANS.min(share.stamps)),
            runs: Runs::new(share.runs / 2, RUN_SCANS),
            last_ns: None,
        }
    }

    /// Scans were left out here.
    pub(super) fn seam(&mut self) {
        self.runs.seam();
        self.last_ns = None;
    }

    pub(super) fn push(&mut self, point: Point, scan: &LaserScan) {
        self.count += 1;
        let returns = scan.ranges.iter().filter(|range| counts(scan, **range)).count();
        let number = |count: usize| u32::try_from(count).unwrap_or(u32::MAX);
        self.scans.push(LaserScanAt {
            index: point.index,
            angles: scan.angles,
            time_increment_s: scan.time_increment,
            scan_time_s: scan.scan_time,
            range_m: scan.range,
            rays: number(scan.ranges.len()),
            returns: number(returns),
        });
        let near = |last_ns: i64| (0..APART_NS).contains(&point.log_ns.saturating_sub(last_ns));
        if self.last_ns.is_some_and(near) {
            return;
        }
        self.last_ns = Some(point.log_ns);
        self.runs.push(|| {
            let (points, after) = projected(scan);
            CloudSlice {
                optical: None,
                stamp_ns: point.stamp_ns.filter(|stamp| *stamp != 0),
                log_ns: point.log_ns,
                points,
                after,
            }
        });
    }

    pub(super) fn finish(self, on: PointOwner<'_>) -> LaserEvidence {
        LaserEvidence {
            count: self.count,
            first: self.first.on(on),
            scans: self.scans.finish(),
            projected: CloudEvidence {
                count: self.count,
                runs: self.runs.finish(2),
                ..CloudEvidence::default()
            },
        }
    }
}

/// Whether a range is one: finite, positive, and within the limits that the scan states. Scanners without a return write infinity,
/// NaN, zero, or more than the largest.
fn counts(scan: &LaserScan, range: f64) -> bool {
    let [least, most] = scan.range;
    // Neither where a limit is no number.
    let is_beyond = range < least || range > most;
    range.is_finite() && range > 0.0 && !is_beyond
}

/// The points of a scan in the axes of its frame, evenly thinned, ray by ray; none where its plane is not that of x and y, or an
/// angle is NaN. And their times after the scan's first, seconds; none where the scan does not state them.
fn projected(scan: &LaserScan) -> (Vec<[f64; 3]>, Vec<f64>) {
    let Some((turn, shift)) = scan.pose.as_ref().map_or(Some(identity()), placed) else {
        return (Vec::new(), Vec::new());
    };
    let [start, _, increment] = scan.angles;
    let every = scan.ranges.len().div_ceil(SLICE_BINS as usize).max(1);
    let rays = scan.ranges.iter().enumerate().step_by(every);
    let points = rays.filter(|(_, range)| counts(scan, **range)).map(|(ray, range)| {
        let angle = start + increment * ray as f64;
        let point = turn * Vector3::new(range * angle.cos(), range * angle.sin(), 0.0) + shift;
        (point.into(), scan.time_increment * ray as f64)
    });
    let (points, after): (Vec<[f64; 3]>, Vec<f64>) = points
        .filter(|(point, _): &([f64; 3], f64)| point.iter().all(|value| value.is_finite()))
        .unzip();
    let has_times = scan.time_increment > 0.0 && after.iter().all(|after| after.is_finite());
    (points, if has_times { after } else { Vec::new() })
}

fn identity() -> (UnitQuaternion<f64>, Vector3<f64>) {
    (UnitQuaternion::identity(), Vector3::zeros())
}

/// The pose of the plane; an orientation of all zeros was left out and is none.
fn placed(pose: &Pose) -> Option<(UnitQuaternion<f64>, Vector3<f64>)> {
    let [x, y, z, w] = pose.orientation;
    let turn = Quaternion::new(w, x, y, z);
    let turn = if turn.norm() == 0.0 {
        UnitQuaternion::identity()
    } else {
        UnitQuaternion::try_new(turn, 1e-6)?
    };
    let shift = Vector3::from(pose.position);
    let is_level = (turn * Vector3::z()).z.abs() >= LEVEL;
    (is_level && shift.iter().all(|value| value.is_finite())).then_some((turn, shift))
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;
    use std::f64::consts::FRAC_PI_2;

    fn scan(ranges: &[f64], pose: Option<Pose>) -> LaserScan {
        LaserScan {
            angles: [0.0, FRAC_PI_2, FRAC_PI_2],
            time_increment: 0.0,
            scan_time: 0.1,
            range: [0.1, 30.0],
            ranges: ranges.to_vec(),
            pose,
        }
    }

    fn pose(orientation: [f64; 4]) -> Pose {
        Pose {
            position: [0.0, 0.0, 1.0],
            orientation,
            covariance: None,
        }
    }

    #[test]
    fn ranges_that_are_none_make_no_points() {
        let odd = [f64::NAN, f64::INFINITY, -1.0, 0.0, 0.05, 31.0];
        assert!(projected(&scan(&odd, None)).0.is_empty());
        let free = LaserScan {
            range: [f64::NAN; 2],
            ..scan(&[31.0, 0.05], None)
        };
        let points = projected(&free).0;
        assert!(
            (points[0][0] - 31.0).abs() < 1e-12 && (points[1][1] - 0.05).abs() < 1e-12,
            "{points:?}"
        );
        let wild = LaserScan {
            angles: [f64::NAN, 1.0, f64::INFINITY],
            ..scan(&[2.0; 3], None)
        };
        assert!(projected(&wild).0.is_empty());
    }

    #[test]
    fn the_pose_of_the_plane_is_taken_in_where_it_is_level() {
        let points = projected(&scan(&[2.0, 3.0], Some(pose([1.0, 0.0, 0.0, 0.0])))).0;
        assert!(
            (points[1][1] + 3.0).abs() < 1e-12 && (points[0][2] - 1.0).abs() < 1e-12,
            "{points:?}"
        );
        assert_eq!(projected(&scan(&[2.0, 3.0], Some(pose([0.0; 4])))).0.len(), 2);
        let half = FRAC_PI_2 / 2.0;
        assert!(
            projected(&scan(&[2.0], Some(pose([half.sin(), 0.0, 0.0, half.cos()]))))
                .0
                .is_empty()
        );
        assert!(projected(&scan(&[2.0], Some(pose([f64::NAN; 4])))).0.is_empty());
    }

    #[test]
    fn many_rays_are_thinned() {
        let many = LaserScan {
            angles: [0.0, 1.0, 1e-4],
            ..scan(&vec![2.0; 10_000], None)
        };
        let points = projected(&many).0;
        assert!((600..=SLICE_BINS as usize).contains(&points.len()), "{}", points.len());
    }
}
