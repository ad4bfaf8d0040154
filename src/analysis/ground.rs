//! The ground below lidars: planes in their clouds, searched once for all rules.
//!
//! Owns the position of the search, and which of six sides is the ground. Must not judge.

use std::collections::BTreeMap;
use std::rc::Rc;

use nalgebra::Vector3;
use serde::Deserialize;

use crate::analysis::{
    Estimates,
    estimates::{InputHasher, hash_numbers},
    lidar::Clouds,
    names,
};
use crate::math::support_plane::{Options, SupportPlane, support_plane};
use crate::world::World;

/// The sides of a cloud's axes, each next to its opposite, and their names.
pub(crate) const SIDES: [([f64; 3], &str); 6] = [
    ([0.0, 0.0, 1.0], "z"),
    ([0.0, 0.0, -1.0], "-z"),
    ([1.0, 0.0, 0.0], "x"),
    ([-1.0, 0.0, 0.0], "-x"),
    ([0.0, 1.0, 0.0], "y"),
    ([0.0, -1.0, 0.0], "-y"),
];

/// Points of a cloud in which planes are searched.
const POINTS: usize = 1500;

/// The plane opposite to each side of the axes of one cloud.
pub(crate) type Sides = [Option<SupportPlane>; 6];

/// Criteria for a plane to be the ground.
#[derive(Clone, Copy, Debug)]
pub(crate) struct GroundCriteria {
    /// Minimum share of the points on it.
    pub(crate) min_on: f64,
    /// Minimum share of the points above it; in an open place, minimum share of the visible sectors instead.
    pub(crate) min_above: f64,
    pub(crate) min_around: f64,
    /// Minimum share of its points at a grazing angle.
    pub(crate) min_far: f64,
    /// Maximum share of the points below it.
    pub(crate) max_below: f64,
    /// Maximum share of its points near the sensor's own horizon.
    pub(crate) max_at_horizon: f64,
    /// Minimum height of the sensor, metres.
    pub(crate) least_m: f64,
    /// Minimum score.
    pub(crate) min_score: f64,
    /// A sensor with fewer visible sectors has a narrow field of view; then minimum share on the ground, and minimum score.
    pub(crate) narrow: usize,
    pub(crate) narrow_on: f64,
    pub(crate) narrow_score: f64,
    /// Minimum ratio to the next side's score.
    pub(crate) min_ratio: f64,
}

impl GroundCriteria {
    /// Minimum share of the points on a plane and minimum score, by the sensor's field of view.
    pub(crate) fn least(&self, plane: &SupportPlane) -> (f64, f64) {
        if plane.seen < self.narrow {
            (self.narrow_on, self.narrow_score)
        } else {
            (self.min_on, self.min_score)
        }
    }
}

/// The ground in one cloud.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Ground {
    /// The one of [`SIDES`] that it is opposite to.
    pub(crate) side: usize,
    /// Cells on it, reduced by points below it.
    pub(crate) score: f64,
    /// The same for the next best side.
    pub(crate) next: f64,
    /// The plane.
    pub(crate) plane: SupportPlane,
    /// Cells on a ceiling: a plane on the opposite side with hardly any points beyond it, or with as many points as a ground. Any level
    /// plane intersects the walls of a street.
    pub(crate) ceiling_cells: f64,
}

/// The planes of all clouds, by recording and topic.
pub(crate) struct Planes {
    by_topic: BTreeMap<(usize, String), Vec<Sides>>,
}

impl Planes {
    /// Those of a world; made once.
    pub(crate) fn of(world: &Estimates) -> Rc<Self> {
        world.once(|world| Self {
            by_topic: Clouds::all(world)
                .filter(Clouds::is_of_a_lidar)
                .map(|clouds| {
                    let at = sensor_in_cloud(world, &clouds).unwrap_or_else(Vector3::zeros);
                    let key = (clouds.index, clouds.topic.topic.clone());
                    (key, sides(world, &clouds, &at))
                })
                .collect(),
        })
    }

    /// The ground in each sampled cloud that shows one.
    pub(crate) fn grounds(&self, clouds: &Clouds, is: &GroundCriteria) -> Vec<Ground> {
        let grounds = self.grounds_by_cloud(clouds, is).into_iter();
        grounds.map(|(_, ground)| ground).collect()
    }

    /// The same, each with the index of its sampled cloud.
    pub(crate) fn grounds_by_cloud(&self, clouds: &Clouds, is: &GroundCriteria) -> Vec<(usize, Ground)> {
        let key = (clouds.index, clouds.topic.topic.clone());
        let sides = self.by_topic.get(&key).into_iter().flatten().enumerate();
        sides
            .filter_map(|(index, sides)| Some((index, ground(sides, is)?)))
            .collect()
    }
}

/// Position of the sensor in its cloud, metres: the origin, or, for a cloud expressed in the base, the only lidar by TF. `None` if it
/// is unknown.
pub(crate) fn sensor_in_cloud(world: &World, clouds: &Clouds) -> Option<Vector3<f64>> {
    let frame = clouds.frame()?;
    if !names::is_base(&frame) || names::is_device(&frame) {
        return Some(Vector3::zeros());
    }
    let graph = world.graph();
    let lidars = graph
        .frames
        .iter()
        .filter(|other| names::has_word_of(other, &[names::LIDARS, names::LIDAR_MAKERS]));
    let mut places = lidars.filter_map(|lidar| {
        let (base_from_lidar, _) = graph.chain(&frame, lidar, |edge| edge.is_rigid)?;
        Some(base_from_lidar.translation.vector)
    });
    let first = places.next()?;
    // The frames of one device are millimetres apart.
    places.all(|place| (place - first).norm() < 0.2).then_some(first)
}

/// The planes of each sampled cloud, searched from the sensor's position.
pub(crate) fn sides(world: &Estimates, clouds: &Clouds, sensor_in_cloud: &Vector3<f64>) -> Vec<Sides> {
    let samples = clouds.evidence.samples.iter();
    samples
        .map(|sample| {
            let step = sample.points.len().div_ceil(POINTS).max(1);
            let points = sample.points.iter().step_by(step);
            let points: Vec<Vector3<f64>> = points.map(|point| Vector3::from(point.xyz) - sensor_in_cloud).collect();
            let numbers = |hasher: &mut InputHasher| {
                hash_numbers(hasher, points.iter().flat_map(|point| point.iter()).copied());
            };
            *world.shared(numbers, || {
                SIDES.map(|(side, _)| support_plane(&points, &Vector3::from(side), &Options::default()))
            })
        })
        .collect()
}

/// The side that the ground of a cloud is opposite to; `None` if no plane is clearly the ground.
pub(crate) fn ground(sides: &Sides, is: &GroundCriteria) -> Option<Ground> {
    let scores = sides.map(|plane| plane.map_or(0.0, |plane| score(&plane, is)));
    let mut order: Vec<usize> = (0..sides.len()).collect();
    let of = |side: usize| scores.get(side).copied().unwrap_or(0.0);
    order.sort_by(|a, b| of(*b).total_cmp(&of(*a)));
    let [side, next, ..] = *order else { return None };
    let plane = (*sides.get(side)?)?;
    let (min_on, min_score) = is.least(&plane);
    let is_ground = plane.on >= min_on
        && (plane.above >= is.min_above || plane.sectors as f64 >= is.min_around * plane.seen as f64)
        && plane.far >= is.min_far
        && plane.height_m >= is.least_m
        && plane.at_horizon <= is.max_at_horizon
        && of(side) >= min_score
        && of(side) >= is.min_ratio * of(next);
    let opposite = sides.get(side ^ 1).copied().flatten();
    let whole = opposite.filter(|opposite| opposite.on >= is.min_on);
    is_ground.then_some(Ground {
        side,
        score: of(side),
        next: of(next),
        plane,
        ceiling_cells: whole.map_or(of(side ^ 1), |whole| whole.cells as f64),
    })
}

/// The cells on a plane, reduced by points below it.
fn score(plane: &SupportPlane, is: &GroundCriteria) -> f64 {
    plane.cells as f64 * (1.0 - plane.below / is.max_below).max(0.0)
}

/// The side that most of the grounds are opposite to, and their number.
pub(crate) fn most(grounds: &[Ground]) -> Option<(usize, usize)> {
    let count = |side: usize| grounds.iter().filter(|ground| ground.side == side).count();
    let counts = (0..SIDES.len()).map(|side| (side, count(side)));
    counts
        .filter(|(_, count)| *count > 0)
        .max_by_key(|(side, count)| (*count, SIDES.len() - side))
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Limits {
    pub(crate) min_clouds: usize,
    pub(crate) min_agreement: f64,
    pub(crate) min_score: f64,
    pub(crate) min_ratio: f64,
    pub(crate) max_below: f64,
    pub(crate) min_on: f64,
    pub(crate) min_above: f64,
    pub(crate) min_around: f64,
    pub(crate) min_far: f64,
    pub(crate) narrow: usize,
    pub(crate) narrow_on: f64,
    pub(crate) narrow_score: f64,
    pub(crate) max_at_horizon: f64,
    pub(crate) least_m: f64,
    pub(crate) max_off_deg: f64,
    pub(crate) ceiling_cells: f64,
    pub(crate) min_open: f64,
    pub(crate) top_deg: f64,
    pub(crate) min_top_deg: f64,
    pub(crate) min_gravity: f64,
    pub(crate) fix_s: f64,
}

impl Limits {
    /// Criteria of a ground.
    pub(crate) fn is_ground(&self) -> GroundCriteria {
        GroundCriteria {
            min_on: self.min_on,
            min_above: self.min_above,
            min_around: self.min_around,
            min_far: self.min_far,
            narrow: self.narrow,
            narrow_on: self.narrow_on,
            narrow_score: self.narrow_score,
            max_below: self.max_below,
            max_at_horizon: self.max_at_horizon,
            least_m: self.least_m,
            min_score: self.min_score,
            min_ratio: self.min_ratio,
        }
    }

    /// The side that enough clouds agree on, or why there is none.
    pub(crate) fn agreed(&self, clouds: &Clouds, grounds: &[Ground]) -> Result<usize, String> {
        let (side, count) = most(grounds).unwrap_or_default();
        if count >= self.min_clouds && count as f64 >= self.min_agreement * grounds.len() as f64 {
            return Ok(side);
        }
        Err(format!(
            "only {} of {} sampled clouds show a ground, {count} of them on one side, {} are needed",
            grounds.len(),
            clouds.evidence.samples.len(),
            self.min_clouds
        ))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::tests_support::Rng;
    use crate::rules::pages;
    use std::collections::BTreeMap;

    /// The planes of a sensor at the origin, facing x: 70 degrees wide, from 25 degrees down to 15 up, with the ground and a wall at these
    /// distances; a fifth of the rays ends before.
    fn seen(ground_m: f64, wall_m: f64) -> Sides {
        let mut rng = Rng::new(3);
        let points: Vec<Vector3<f64>> = (0..1500)
            .filter_map(|_| {
                let [across, up] = [rng.range(-35.0, 35.0), rng.range(-25.0, 15.0)].map(f64::to_radians);
                let ray = Vector3::new(across.cos() * up.cos(), across.sin() * up.cos(), up.sin());
                let range = (wall_m / ray.x).min(if ray.z < 0.0 { -ground_m / ray.z } else { f64::INFINITY });
                let range = if rng.range(0.0, 1.0) < 0.2 {
                    rng.range(0.3, 0.9) * range
                } else {
                    range
                };
                (range < 80.0).then_some(ray * range)
            })
            .collect();
        SIDES.map(|(side, _)| support_plane(&points, &Vector3::from(side), &Options::default()))
    }

    #[test]
    fn a_sensor_that_faces_ahead_finds_the_ground_and_no_wall() {
        let limits = pages::AXES10.limits::<Limits>(&BTreeMap::new()).unwrap().is_ground();
        let side = |ground_m, wall_m| ground(&seen(ground_m, wall_m), &limits).map(|ground| ground.side);
        assert_eq!(side(1.8, 60.0), Some(0));
        for wall_m in [4.0, 8.0, 20.0] {
            assert_eq!(side(100.0, wall_m), None, "{wall_m}");
        }
    }
}
