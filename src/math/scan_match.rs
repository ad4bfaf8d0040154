//! The motion between two scans of one plane.
//!
//! Owns the iterative closest point, point to line (Censi 2008), and how sure each of its three numbers is. Metres and radians in the
//! sensor's axes. The caller decides what the points are, which scans to compare, and what moves by itself.

use kd_tree::KdMap;
use nalgebra::{Isometry2, Matrix2, Matrix3, SymmetricEigen, Vector2, Vector3};

use crate::math::stats::median;

/// Neighbours to each side, in the order of the scan, that make the line of a point: at least, and at most.
const NEIGHBOURS: [usize; 2] = [3, 10];
/// More than the least only as far as this, metres: the nearer a wall, the closer its points, and the worse a short line points.
const REACHES_M: f64 = 0.2;
/// Neighbours farther away than this share of their range, and 0.1 m, belong to something else; and farther than so many steps between
/// rays, where these are coarse: three neighbours to each side make a line.
const GAP: f64 = 0.06;
const GAP_STEPS: f64 = 3.3;
const MOST_GAP: f64 = 0.2;
/// Rays closer than this have one direction: points above and below it, radians.
const SAME_RAD: f64 = 1e-3;
/// How far from its line a point may be, metres, in the first round and from the last narrowing on.
const REACH_M: [f64; 2] = [1.0, 0.2];
/// Rounds in which the reach narrows.
const NARROWING: u32 = 8;
/// Rounds of matching.
const ROUNDS: u32 = 16;
/// A step shorter than this counts as none, metres and radians.
const STILL: f64 = 1e-5;
/// Points of a source that are used.
const ASKED: usize = 400;
/// Pairs that are needed.
const LEAST: usize = 30;
/// The information in a direction that only noise determines.
const UNKNOWN: f64 = 1e-6;
/// The least share of the source that must find its line.
const OVERLAP: f64 = 0.4;

/// A scan that others are matched to.
#[derive(Clone, Debug)]
pub struct Scan {
    points: Vec<Vector2<f64>>,
    lines: KdMap<[f64; 2], Line>,
    /// The distance of neighbours that belong together, as a share of their range.
    gap: f64,
}

/// The line through a point of a scan.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Line {
    /// Its unit normal.
    normal: Vector2<f64>,
    /// Variance of the normal's direction, square radians.
    turns: f64,
}

/// The motion between two scans.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ScanMatch {
    /// `target_from_source`.
    pub motion: Isometry2<f64>,
    /// Standard error of its angle, radians.
    pub sigma_rad: f64,
    /// Standard error of its translation in the least certain direction, metres.
    pub sigma_m: f64,
    /// Median distance of matched points from their lines, metres.
    pub residual_m: f64,
    /// Share of the source that found its line.
    pub overlap: f64,
}

impl Scan {
    /// A scan of points in the order of their azimuth; those that are not finite are left out.
    pub fn new(points: impl IntoIterator<Item = Vector2<f64>>) -> Self {
        let points: Vec<Vector2<f64>> = points
            .into_iter()
            .filter(|point| point.iter().all(|value| value.is_finite()))
            .collect();
        let gap = (GAP_STEPS * step_rad(&points)).clamp(GAP, MOST_GAP);
        let lines = (0..points.len()).filter_map(|index| {
            let point = points.get(index)?;
            Some(([point.x, point.y], line(&points, index, gap)?))
        });
        Self {
            lines: KdMap::build_by_ordered_float(lines.collect()),
            points,
            gap,
        }
    }

    /// The points that look for their lines, evenly thinned.
    fn asked(&self) -> impl Iterator<Item = &Vector2<f64>> {
        self.points.iter().step_by(self.points.len().div_ceil(ASKED).max(1))
    }

    /// How many points there are.
    pub fn len(&self) -> usize {
        self.points.len()
    }

    /// Whether there is none.
    pub fn is_empty(&self) -> bool {
        self.points.is_empty()
    }
}

/// The angle between neighbouring rays, radians: the median of those between points.
fn step_rad(points: &[Vector2<f64>]) -> f64 {
    let neighbours = points.iter().zip(points.iter().skip(1));
    let steps = neighbours.map(|(from, to)| from.perp(to).atan2(from.dot(to)).abs());
    median(&steps.filter(|step| *step > SAME_RAD).collect::<Vec<_>>()).unwrap_or_default()
}

/// The line through a point and its neighbours; `None` where they make none.
fn line(points: &[Vector2<f64>], index: usize, gap: f64) -> Option<Line> {
    let [least, most] = NEIGHBOURS;
    let point = points.get(index)?;
    let gap_m = 0.1 + gap * point.norm();
    let is_near = |(place, other): &(usize, &Vector2<f64>)| {
        let apart_m = (*other - point).norm();
        apart_m <= gap_m && (*place < least || apart_m <= REACHES_M)
    };
    let before = points.get(..index)?.iter().rev().take(most).enumerate();
    let behind = points.get(index + 1..)?.iter().take(most).enumerate();
    let others = before.filter(is_near).chain(behind.filter(is_near));
    let near: Vec<Vector2<f64>> = others.map(|(_, other)| *other).chain([*point]).collect();
    if near.len() < 4 {
        return None;
    }
    let mean = near.iter().sum::<Vector2<f64>>() / near.len() as f64;
    let spread: Matrix2<f64> = near
        .iter()
        .map(|point| (point - mean) * (point - mean).transpose())
        .sum();
    let eigen = SymmetricEigen::try_new(spread, 1e-15, 50)?;
    let least = eigen.eigenvalues.imin();
    let (across, along) = (eigen.eigenvalues.min(), eigen.eigenvalues.max());
    // A heap of points is no line.
    (across <= 0.1 * along).then(|| Line {
        normal: eigen.eigenvectors.column(least).into(),
        // The slope of a regression: the variance of a point over the spread along the line.
        turns: (across / (near.len() - 2) as f64).max(0.0) / along.max(1e-12),
    })
}

/// The motion `target_from_source` near a guess; `None` where too little of the one is seen in the other.
pub fn matched(target: &Scan, source: &Scan, guess: &Isometry2<f64>) -> Option<ScanMatch> {
    let mut motion = *guess;
    for round in 0..ROUNDS {
        let share = f64::from(round.min(NARROWING)) / f64::from(NARROWING);
        let reach = REACH_M[0] * (REACH_M[1] / REACH_M[0]).powf(share);
        let (information, gradient, _) = normal_equations(&pairs(target, source, &motion, reach));
        let step = information.cholesky()?.solve(&-gradient);
        // About the sensor: rotation of what was moved so far.
        motion = Isometry2::new(step.xy(), step.z) * motion;
        if round >= NARROWING && step.norm() < STILL {
            break;
        }
    }
    let pairs = pairs(target, source, &motion, REACH_M[1]);
    let overlap = pairs.len() as f64 / source.asked().count().max(1) as f64;
    if pairs.len() < LEAST || overlap < OVERLAP {
        return None;
    }
    let (information, _, squares) = normal_equations(&pairs);
    // Neighbouring points share the errors of one surface: seven of them, which make a line, count as one.
    let variance = squares / pairs.len() as f64 * (2 * NEIGHBOURS[0] + 1) as f64;
    let covariance = sure(&information, &pairs)?.try_inverse()? * variance;
    let place = SymmetricEigen::try_new(covariance.fixed_view::<2, 2>(0, 0).into_owned(), 1e-15, 50)?;
    let off: Vec<f64> = pairs.iter().map(|pair| pair.off_m.abs()).collect();
    Some(ScanMatch {
        motion,
        sigma_rad: covariance.m33.max(0.0).sqrt(),
        sigma_m: place.eigenvalues.max().max(0.0).sqrt(),
        residual_m: median(&off)?,
        overlap,
    })
}

/// A point of the source and the line that it is on.
struct Pair {
    place: Vector2<f64>,
    normal: Vector2<f64>,
    turns: f64,
    off_m: f64,
}

impl Pair {
    /// How far a step in x, y and angle brings the point along a direction.
    fn along(&self, direction: &Vector2<f64>) -> Vector3<f64> {
        let turning = direction.dot(&Vector2::new(-self.place.y, self.place.x));
        Vector3::new(direction.x, direction.y, turning)
    }
}

fn pairs(target: &Scan, source: &Scan, motion: &Isometry2<f64>, reach_m: f64) -> Vec<Pair> {
    let pair = |point: &Vector2<f64>| {
        let place = motion * nalgebra::Point2::from(*point);
        let place = place.coords;
        let (nearest, Line { normal, turns }) = *target.lines.nearest(&[place.x, place.y])?.item;
        let from_nearest = place - Vector2::from(nearest);
        let off_m = normal.dot(&from_nearest);
        let apart = from_nearest.norm();
        (apart <= reach_m.max(target.gap * place.norm()) && off_m.abs() <= reach_m).then_some(Pair {
            place,
            normal,
            turns,
            off_m,
        })
    };
    source.asked().filter_map(pair).collect()
}

/// Information, gradient and the sum of squares, weighed after Huber, of x, y and angle.
fn normal_equations(pairs: &[Pair]) -> (Matrix3<f64>, Vector3<f64>, f64) {
    let off: Vec<f64> = pairs.iter().map(|pair| pair.off_m.abs()).collect();
    let usual = 2.0 * 1.483 * median(&off).unwrap_or(0.0) + 1e-6;
    let (mut information, mut gradient, mut squares) = (Matrix3::zeros(), Vector3::zeros(), 0.0);
    for pair in pairs {
        let weight = (usual / pair.off_m.abs().max(1e-12)).min(1.0);
        let row = pair.along(&pair.normal);
        information += weight * row * row.transpose();
        gradient += weight * pair.off_m * row;
        squares += weight * pair.off_m * pair.off_m;
    }
    (information, gradient, squares)
}

/// The information without the part that noisy normals pretend: the walls of a corridor give none along it, but the noise of their
/// normals does (errors in variables; Fuller 1987, chapter 2). Directions in which that part is half or more are undetermined.
fn sure(information: &Matrix3<f64>, pairs: &[Pair]) -> Option<Matrix3<f64>> {
    let of_noise: Matrix3<f64> = pairs
        .iter()
        .map(|pair| {
            let row = pair.along(&Vector2::new(-pair.normal.y, pair.normal.x));
            pair.turns * row * row.transpose()
        })
        .sum();
    // Angles in units that bring points as far as metres do.
    let squares: f64 = pairs.iter().map(|pair| pair.place.norm_squared()).sum();
    let range_m = (squares / pairs.len().max(1) as f64).sqrt().max(1e-3);
    let scale = Matrix3::from_diagonal(&Vector3::new(1.0, 1.0, 1.0 / range_m));
    let eigen = SymmetricEigen::try_new(scale * information * scale, 1e-15, 100)?;
    let noise = scale * of_noise * scale;
    let mut left = Matrix3::zeros();
    for (value, axis) in eigen.eigenvalues.iter().zip(eigen.eigenvectors.column_iter()) {
        let of_noise = axis.dot(&(noise * axis));
        let kept = if *value > 2.0 * of_noise {
            value - of_noise
        } else {
            UNKNOWN * value
        };
        left += kept.max(f64::MIN_POSITIVE) * axis * axis.transpose();
    }
    let back = Matrix3::from_diagonal(&Vector3::new(1.0, 1.0, range_m));
    Some(back * left * back)
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;
    use crate::math::tests_support::Rng;
    use std::f64::consts::TAU;

    /// The range to a rectangle of walls about the origin of the world, from a place in it.
    fn room(sensor: &Isometry2<f64>, half: [f64; 2], rng: &mut Rng) -> Scan {
        let rays = (0..720).map(|index| {
            let angle = TAU * f64::from(index) / 720.0;
            let direction = sensor.rotation * Vector2::new(angle.cos(), angle.sin());
            let from = sensor.translation.vector;
            let along = |axis: usize| {
                let wall = half[axis].copysign(direction[axis]);
                (wall - from[axis]) / direction[axis]
            };
            let range = along(0).min(along(1)) + 0.01 * rng.normal();
            range * Vector2::new(angle.cos(), angle.sin())
        });
        Scan::new(rays.collect::<Vec<_>>())
    }

    #[test]
    fn the_motion_in_a_room_is_found_within_its_own_error() {
        let mut rng = Rng::new(3);
        for trial in 0..20 {
            let first = Isometry2::new(
                Vector2::new(rng.range(-2.0, 2.0), rng.range(-1.0, 1.0)),
                rng.range(-3.0, 3.0),
            );
            let truth = Isometry2::new(
                Vector2::new(rng.range(-0.4, 0.4), rng.range(-0.4, 0.4)),
                rng.range(-0.08, 0.08),
            );
            let target = room(&first, [9.0, 6.0], &mut rng);
            let source = room(&(first * truth), [9.0, 6.0], &mut rng);
            let found = matched(&target, &source, &Isometry2::identity()).unwrap();
            let error = found.motion.inv_mul(&truth);
            assert!(error.rotation.angle().abs() < 0.003, "{trial}: {found:?} {truth:?}");
            assert!(error.translation.vector.norm() < 0.02, "{trial}: {found:?} {truth:?}");
            assert!(
                error.rotation.angle().abs() < 5.0 * found.sigma_rad,
                "{trial}: {found:?}"
            );
            assert!(
                error.translation.vector.norm() < 5.0 * found.sigma_m,
                "{trial}: {found:?}"
            );
        }
    }

    #[test]
    fn a_scan_has_not_moved_against_itself() {
        let scan = room(
            &Isometry2::new(Vector2::new(1.0, 0.5), 0.4),
            [9.0, 6.0],
            &mut Rng::new(6),
        );
        let found = matched(&scan, &scan, &Isometry2::identity()).unwrap();
        assert!(
            found.motion.translation.vector.norm() < 1e-6 && found.motion.rotation.angle().abs() < 1e-6,
            "{found:?}"
        );
        assert!(found.overlap > 0.9 && found.residual_m < 1e-6, "{found:?}");
    }

    #[test]
    fn a_round_room_does_not_tell_how_it_was_turned() {
        let mut rng = Rng::new(7);
        let mut round = || {
            let rays = (0..720).map(|index| {
                let angle = TAU * f64::from(index) / 720.0;
                (7.0 + 0.01 * rng.normal()) * Vector2::new(angle.cos(), angle.sin())
            });
            Scan::new(rays.collect::<Vec<_>>())
        };
        let (target, source) = (round(), round());
        let found = matched(&target, &source, &Isometry2::identity());
        assert!(found.is_none_or(|found| found.sigma_rad > 0.01), "{found:?}");
    }

    #[test]
    fn a_long_corridor_does_not_tell_the_way_along_it() {
        let mut rng = Rng::new(4);
        let [first, second] = [0.0, 0.3].map(|x| Isometry2::new(Vector2::new(x, 0.2), 0.0));
        let target = room(&first, [500.0, 2.0], &mut rng);
        let source = room(&second, [500.0, 2.0], &mut rng);
        let found = matched(&target, &source, &Isometry2::identity());
        assert!(found.is_none_or(|found| found.sigma_m > 0.1), "{found:?}");
    }

    #[test]
    fn nothing_is_found_in_nothing_or_in_another_place() {
        let mut rng = Rng::new(5);
        let here = room(&Isometry2::identity(), [9.0, 6.0], &mut rng);
        let nothing = Scan::new([]);
        assert!(matched(&here, &nothing, &Isometry2::identity()).is_none());
        assert!(matched(&nothing, &here, &Isometry2::identity()).is_none());
        let there = room(&Isometry2::identity(), [40.0, 30.0], &mut rng);
        assert!(matched(&here, &there, &Isometry2::identity()).is_none());
        let odd = Scan::new([Vector2::new(f64::NAN, 1.0), Vector2::new(f64::INFINITY, 0.0)]);
        assert!(odd.is_empty());
    }
}
