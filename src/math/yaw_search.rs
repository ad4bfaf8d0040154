//! The yaw of a mounting at which scans of one scene coincide, once they are moved as the platform moved.
//!
//! Needs no match of scans: where one scan shows a few things only, many pairs of scans together still have one best yaw. Metres and
//! radians in the plane of the ground. Which scans, and how the platform moved, is the caller's.

use kd_tree::KdTree;
use nalgebra::{Isometry2, Point2, Translation2, UnitComplex, Vector2};

use crate::math::circular::{circular_mean, difference};

/// Yaws that are tried: every 2 degrees.
const TRIED: u32 = 180;
/// Points of a scan that are used.
const ASKED: usize = 150;
/// Farther from the nearest point of the other scan, a point counts as this far, metres: it shows something that the other does not.
const FAR_M: f64 = 1.0;
/// Groups of pairs, each left out once, that show how sure the best yaw is.
const GROUPS: usize = 10;

/// Two scans, and how the platform moved between them.
#[derive(Clone, Debug)]
pub struct Pair {
    /// `from_body_from_to_body`, in the plane.
    pub body: Isometry2<f64>,
    /// Points of the earlier scan, in the axes of the lidar, z up.
    pub from: Vec<Vector2<f64>>,
    /// Points of the later one.
    pub to: Vec<Vector2<f64>>,
}

/// The best yaw of a mounting.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MountYaw {
    /// The yaw of `body_from_lidar`, radians.
    pub yaw_rad: f64,
    /// Its standard error, by leaving out a tenth of the pairs at a time, radians.
    pub sigma_rad: f64,
    /// How much better it is than any yaw that is `apart_rad` or more from it: the least mean over its standard error, pair by pair.
    pub t: f64,
    /// How many pairs.
    pub pairs: usize,
}

/// How badly the scans of each pair coincide at each of the yaws that are tried.
#[derive(Clone, Debug)]
pub struct YawCosts(Vec<Vec<f64>>);

impl YawCosts {
    /// Those of a lidar at this place on its body, metres; pairs without points are left out.
    pub fn of(pairs: &[Pair], place: Vector2<f64>) -> Self {
        let pairs = pairs.iter().filter(|pair| !pair.from.is_empty() && !pair.to.is_empty());
        Self(pairs.map(|pair| costs(pair, place)).collect())
    }
}

/// The yaw at which the scans coincide best, and how sure it is; `None` without pairs.
pub fn search(YawCosts(costs): &YawCosts, apart_rad: f64) -> Option<MountYaw> {
    let all = |_: usize| true;
    let best = best(costs, all)?;
    let groups = GROUPS.min(costs.len());
    let without: Vec<f64> = (0..groups)
        .filter_map(|group| self::best(costs, |index| index % groups != group))
        .collect();
    let mean = circular_mean(without.iter().map(|yaw| (*yaw, 1.0)))?.mean_rad;
    let squares: f64 = without.iter().map(|yaw| difference(*yaw, mean).powi(2)).sum();
    // The jackknife: estimates that share nine tenths of their pairs differ by less than their error.
    let variance = squares * (groups as f64 - 1.0) / groups as f64;
    let at_best = nearest(best);
    let rivals = (0..TRIED).filter(|tried| difference(yaw(*tried), best).abs() >= apart_rad);
    let t = rivals
        .map(|rival| paired_t(costs, rival, at_best))
        .fold(f64::INFINITY, f64::min);
    Some(MountYaw {
        yaw_rad: best,
        // Half of the step between two yaws is no error, but less is not claimed than a quarter of it.
        sigma_rad: variance.sqrt().max(0.25 * yaw(1)),
        t,
        pairs: costs.len(),
    })
}

fn yaw(tried: u32) -> f64 {
    f64::from(tried) * std::f64::consts::TAU / f64::from(TRIED)
}

/// The yaw that was tried next to this one.
fn nearest(yaw_rad: f64) -> u32 {
    let off = |tried: &u32| difference(yaw(*tried), yaw_rad).abs();
    (0..TRIED).min_by(|a, b| off(a).total_cmp(&off(b))).unwrap_or(0)
}

/// Mean square of the remaining distances between the points of two scans, for each yaw.
fn costs(pair: &Pair, place: Vector2<f64>) -> Vec<f64> {
    let tree = KdTree::build_by_ordered_float(pair.from.iter().map(|point| [point.x, point.y]).collect());
    let asked: Vec<_> = pair.to.iter().step_by(pair.to.len().div_ceil(ASKED).max(1)).collect();
    let cost = |tried: u32| {
        let mounting = Isometry2::from_parts(Translation2::from(place), UnitComplex::new(yaw(tried)));
        let motion = mounting.inv_mul(&(pair.body * mounting));
        let squares = asked.iter().map(|point| {
            let moved = motion * Point2::from(**point);
            let nearest = tree.nearest(&[moved.x, moved.y]);
            nearest.map_or(FAR_M * FAR_M, |nearest| nearest.squared_distance.min(FAR_M * FAR_M))
        });
        squares.sum::<f64>() / asked.len() as f64
    };
    (0..TRIED).map(cost).collect()
}

/// Where the sum of the costs of some pairs is least, between the yaws that were tried: the vertex of a parabola.
fn best(costs: &[Vec<f64>], counts: impl Fn(usize) -> bool) -> Option<f64> {
    let counted = || {
        costs
            .iter()
            .enumerate()
            .filter(|(index, _)| counts(*index))
            .map(|(_, of)| of)
    };
    counted().next()?;
    let sum = |tried: u32| -> f64 { counted().filter_map(|of| of.get(tried as usize)).sum() };
    let sums: Vec<f64> = (0..TRIED).map(sum).collect();
    let least = (0..TRIED).min_by(|a, b| sum_at(&sums, *a).total_cmp(&sum_at(&sums, *b)))?;
    let [before, at, after] = [least + TRIED - 1, least, least + 1].map(|tried| sum_at(&sums, tried % TRIED));
    let bend = before - 2.0 * at + after;
    let shift = if bend > 0.0 { 0.5 * (before - after) / bend } else { 0.0 };
    Some(difference(yaw(least) + shift * yaw(1), 0.0))
}

fn sum_at(sums: &[f64], tried: u32) -> f64 {
    sums.get(tried as usize).copied().unwrap_or(f64::INFINITY)
}

/// How much larger the residual of a yaw is than that of the best, pair by pair: mean over standard error.
fn paired_t(costs: &[Vec<f64>], rival: u32, best: u32) -> f64 {
    let more: Vec<f64> = costs
        .iter()
        .filter_map(|of| Some(of.get(rival as usize)? - of.get(best as usize)?))
        .collect();
    let count = more.len() as f64;
    if more.len() < 2 {
        return 0.0;
    }
    let mean = more.iter().sum::<f64>() / count;
    let variance = more.iter().map(|more| (more - mean).powi(2)).sum::<f64>() / (count - 1.0);
    if variance > 0.0 {
        mean / (variance / count).sqrt()
    } else {
        0.0
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;
    use crate::math::tests_support::Rng;

    /// Pairs of scans of single things on a field, seen by a lidar that is rotated by `true_rad` on a body that drives.
    fn drive(true_rad: f64, things: usize, count: usize, noise_m: f64, rng: &mut Rng) -> Vec<Pair> {
        let field: Vec<Vector2<f64>> = (0..things)
            .map(|_| Vector2::new(rng.range(-40.0, 40.0), rng.range(-40.0, 40.0)))
            .collect();
        let mounting = Isometry2::new(Vector2::new(1.0, 0.3), true_rad);
        let look = |body: &Isometry2<f64>, rng: &mut Rng| -> Vec<Vector2<f64>> {
            let seen = |thing: &Vector2<f64>| {
                let noise = Vector2::new(noise_m * rng.normal(), noise_m * rng.normal());
                (body * mounting).inverse_transform_point(&Point2::from(*thing)).coords + noise
            };
            field.iter().map(seen).collect()
        };
        (0..count)
            .map(|_| {
                let from = Isometry2::new(
                    Vector2::new(rng.range(-15.0, 15.0), rng.range(-15.0, 15.0)),
                    rng.range(-3.0, 3.0),
                );
                let body = Isometry2::new(Vector2::new(rng.range(1.5, 3.0), 0.0), rng.range(-0.3, 0.3));
                let to = from * body;
                Pair {
                    body,
                    from: look(&from, rng),
                    to: look(&to, rng),
                }
            })
            .collect()
    }

    #[test]
    fn a_few_things_have_one_yaw() {
        let mut rng = Rng::new(11);
        for true_deg in [0.0_f64, 90.0, -90.0, 180.0, 37.0] {
            let pairs = drive(true_deg.to_radians(), 5, 40, 0.2, &mut rng);
            let found = search(&YawCosts::of(&pairs, Vector2::new(1.0, 0.3)), 0.26).unwrap();
            let off_deg = difference(found.yaw_rad, true_deg.to_radians()).to_degrees().abs();
            assert!(
                off_deg < 2.0 && off_deg < 4.0 * found.sigma_rad.to_degrees(),
                "{true_deg}: {found:?}"
            );
            assert!(found.t > 5.0, "{true_deg}: {found:?}");
        }
    }

    #[test]
    fn nothing_is_sure_of_a_body_that_stands_or_of_walls_along_the_way() {
        let mut rng = Rng::new(12);
        let mut still = drive(0.0, 5, 40, 0.2, &mut rng);
        for pair in &mut still {
            pair.to.clone_from(&pair.from);
            pair.body = Isometry2::identity();
        }
        let sure = |pairs: &[Pair]| search(&YawCosts::of(pairs, Vector2::zeros()), 0.26).unwrap().t;
        assert!(sure(&still) < 5.0);
        let walls: Vec<Vector2<f64>> = (-30..30)
            .flat_map(|step| [-3.0, 3.0].map(|y| Vector2::new(0.5 * f64::from(step), y)))
            .collect();
        let corridor: Vec<Pair> = (0..20)
            .map(|_| Pair {
                body: Isometry2::new(Vector2::new(2.0 + 0.02 * rng.normal(), 0.0), 0.0),
                from: walls.clone(),
                to: walls.clone(),
            })
            .collect();
        assert!(sure(&corridor) < 5.0, "forward and backward look the same");
    }

    #[test]
    fn nothing_is_found_without_points() {
        let pair = Pair {
            body: Isometry2::identity(),
            from: Vec::new(),
            to: vec![Vector2::new(1.0, 0.0)],
        };
        for pairs in [vec![pair], Vec::new()] {
            assert!(search(&YawCosts::of(&pairs, Vector2::zeros()), 0.26).is_none());
        }
    }
}
