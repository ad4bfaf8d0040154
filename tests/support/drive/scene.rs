//! Simple worlds that a lidar sees: the ground under the vehicle, and boxes on it.
//!
//! Owns where things are and where a ray ends. Everything is in the ENU frame of the drive.

use std::collections::HashMap;

use nalgebra::Vector3;

use super::random::Random;
use super::truth::Truth;

/// What kind of place it is.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, serde::Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Surroundings {
    /// Flat ground, and something far away now and then.
    Apron,
    /// Houses to both sides, cars and posts.
    #[default]
    Street,
    /// A hall of ten metres with shelves.
    Warehouse,
    /// A ceiling at 2.4 m, and pillars.
    Garage,
    /// As the street, on ground beside the way that leans by up to five degrees, to the one side and to the other.
    Slope,
}

/// Along x, y and z: from where to where.
#[derive(Clone, Copy, Debug)]
struct Solid {
    low: Vector3<f64>,
    high: Vector3<f64>,
}

impl Solid {
    /// How far along a ray it begins, in lengths of the direction.
    fn hit(&self, from: &Vector3<f64>, inverse: &Vector3<f64>) -> Option<f64> {
        let (mut near, mut far) = (0.0_f64, f64::INFINITY);
        for axis in 0..3 {
            let a = (self.low[axis] - from[axis]) * inverse[axis];
            let b = (self.high[axis] - from[axis]) * inverse[axis];
            near = near.max(a.min(b));
            far = far.min(a.max(b));
        }
        (near <= far && near > 0.0).then_some(near)
    }
}

/// The sides of the squares that things are laid out in, metres.
const SQUARE_M: f64 = 25.0;
/// Nothing stands nearer to the way than this, metres.
const CLEAR_M: f64 = 2.5;

/// A place around a drive.
#[derive(Debug)]
pub struct Scene {
    surroundings: Surroundings,
    squares: HashMap<(i64, i64), Vec<Solid>>,
}

impl Scene {
    /// The place around the true way of a drive, up to `reach_m` from it.
    pub fn around(
        truth: &Truth,
        times_s: std::ops::RangeInclusive<f64>,
        seed: u64,
        surroundings: Surroundings,
        reach_m: f64,
    ) -> Self {
        let (from, to) = (*times_s.start(), *times_s.end());
        let steps = ((to - from) / 0.5).ceil().max(1.0) as usize;
        let way: Vec<Vector3<f64>> = (0..=steps)
            .map(|step| truth.position(from + (to - from) * step as f64 / steps as f64))
            .collect();
        Self::along(&way, seed, surroundings, reach_m)
    }

    /// The place around a way, up to `reach_m` from it.
    pub fn along(way: &[Vector3<f64>], seed: u64, surroundings: Surroundings, reach_m: f64) -> Self {
        let mut squares: HashMap<(i64, i64), Vec<Solid>> = HashMap::new();
        let reach = (reach_m / SQUARE_M).ceil() as i64;
        for place in way {
            let (i, j) = square(place);
            for di in -reach..=reach {
                for dj in -reach..=reach {
                    squares
                        .entry((i + di, j + dj))
                        .or_insert_with(|| solids(seed, (i + di, j + dj), surroundings, place.z));
                }
            }
        }
        let is_clear = |solid: &Solid| {
            way.iter().all(|place| {
                (0..2).any(|axis| place[axis] < solid.low[axis] - CLEAR_M || place[axis] > solid.high[axis] + CLEAR_M)
            })
        };
        #[allow(clippy::iter_over_hash_type)] // each by itself
        for solids in squares.values_mut() {
            solids.retain(is_clear);
        }
        Self { surroundings, squares }
    }

    /// How far a ray goes, up to `reach_m`: the ground is a plane through a point, with a normal.
    pub fn range(
        &self,
        from: &Vector3<f64>,
        direction: &Vector3<f64>,
        ground: (&Vector3<f64>, &Vector3<f64>),
        reach_m: f64,
    ) -> Option<f64> {
        let mut best = reach_m;
        let (point, normal) = ground;
        let mut plane = |point: &Vector3<f64>| {
            let down = direction.dot(normal);
            let range = (point - from).dot(normal) / down;
            if range.is_finite() && range > 0.0 {
                best = best.min(range);
            }
        };
        plane(point);
        if let Some(ceiling_m) = self.ceiling_m() {
            plane(&(point + normal * ceiling_m));
        }
        let inverse = direction.map(|part| 1.0 / part);
        // Square by square, as the ray passes them.
        let flat = direction.xy().norm();
        let mut seen = None;
        let mut along = 0.0;
        while along <= best + SQUARE_M {
            let here = square(&(from + direction * along.min(best)));
            if seen != Some(here) {
                seen = Some(here);
                for (di, dj) in [(0, 0), (1, 0), (-1, 0), (0, 1), (0, -1)] {
                    let solids = self.squares.get(&(here.0 + di, here.1 + dj)).into_iter().flatten();
                    best = solids
                        .filter_map(|solid| solid.hit(from, &inverse))
                        .fold(best, f64::min);
                }
            }
            if flat < 1e-3 {
                break;
            }
            along += SQUARE_M / 2.0 / flat;
        }
        (best < reach_m).then_some(best)
    }

    /// How high the ceiling is over the ground, metres.
    fn ceiling_m(&self) -> Option<f64> {
        match self.surroundings {
            Surroundings::Warehouse => Some(10.0),
            Surroundings::Garage => Some(2.4),
            _ => None,
        }
    }

    /// How far the ground leans to the side of the vehicle at a time, radians.
    pub fn lean_rad(&self, t_s: f64) -> f64 {
        match self.surroundings {
            Surroundings::Slope => 5_f64.to_radians() * (std::f64::consts::TAU * t_s / 9.0).sin(),
            _ => 0.0,
        }
    }
}

fn square(place: &Vector3<f64>) -> (i64, i64) {
    let number = |value: f64| (value / SQUARE_M).floor() as i64;
    (number(place.x), number(place.y))
}

/// What stands in a square, by its number alone.
fn solids(seed: u64, (i, j): (i64, i64), surroundings: Surroundings, ground_m: f64) -> Vec<Solid> {
    let mut random = Random::new(seed, &format!("square {i} {j}"));
    let corner = Vector3::new(i as f64 * SQUARE_M, j as f64 * SQUARE_M, ground_m);
    let mut solids = Vec::new();
    let mut put = |random: &mut Random, count: usize, size: [[f64; 2]; 3]| {
        for _ in 0..count {
            let [x, y] = [0, 1].map(|_| random.between(0.0, SQUARE_M));
            let [a, b, c] = size.map(|[low, high]| random.between(low, high));
            let low = corner + Vector3::new(x, y, -5.0);
            solids.push(Solid {
                low,
                high: low + Vector3::new(a, b, c + 5.0),
            });
        }
    };
    match surroundings {
        Surroundings::Apron => {
            let count = usize::from(random.between(0.0, 1.0) < 0.15);
            put(&mut random, count, [[3.0, 10.0], [3.0, 10.0], [2.0, 6.0]]);
        }
        Surroundings::Street | Surroundings::Slope => {
            put(&mut random, 1, [[6.0, 14.0], [6.0, 14.0], [4.0, 12.0]]);
            put(&mut random, 2, [[1.7, 4.5], [1.7, 4.5], [1.4, 2.0]]);
            put(&mut random, 2, [[0.2, 0.4], [0.2, 0.4], [3.0, 8.0]]);
        }
        Surroundings::Warehouse => put(&mut random, 4, [[1.0, 12.0], [1.0, 1.5], [2.0, 8.0]]),
        Surroundings::Garage => {
            put(&mut random, 6, [[0.4, 0.8], [0.4, 0.8], [3.0, 3.0]]);
            put(&mut random, 2, [[1.7, 4.5], [1.7, 4.5], [1.4, 1.8]]);
        }
    }
    solids
}
