//! The velocity of a sensor from the range rates of static surroundings.
//!
//! Owns the robust fit of `rate = -v . d` and the question which way detections go from one scan to the next. Metres, seconds and
//! radians; directions and velocities in one set of axes, whichever the caller's. Source: Kellner et al. 2013, "Instantaneous
//! ego-motion estimation using Doppler radar"; the cost after Torr and Zisserman 2000 (MSAC), the weights after Tukey.

use nalgebra::{Isometry3, Matrix2, SymmetricEigen, Vector2, Vector3};

/// Pairs of detections that are tried.
const TRIED: usize = 400;
/// Two directions nearer to each other than this, in the plane, radians, determine no velocity.
const LEAST_APART: f64 = 0.05;
/// Rounds of weighing.
const ROUNDS: usize = 12;
/// Beyond so many tolerances a detection weighs nothing.
const REACH: f64 = 1.5;

/// One detection.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Detection {
    /// From the sensor to it, a unit vector.
    pub direction: Vector3<f64>,
    /// How fast it goes away, m/s.
    pub rate: f64,
}

/// How a sensor moves.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct EgoVelocity {
    /// Its velocity relative to static surroundings, in the plane of x and y, m/s.
    pub velocity: Vector2<f64>,
    /// Standard error of the velocity in the least certain direction, m/s.
    pub sigma: f64,
    /// Detections that agree, and all of them.
    pub share: [usize; 2],
}

impl Detection {
    /// The residual range rate for a velocity of the sensor, m/s.
    fn left(&self, velocity: &Vector2<f64>) -> f64 {
        self.rate + velocity.dot(&self.direction.xy())
    }
}

/// How many detections agree with a velocity of the sensor.
pub fn agreeing(sights: &[Detection], velocity: &Vector2<f64>, tolerance: f64) -> usize {
    let agrees = |sight: &&Detection| sight.left(velocity).abs() <= tolerance;
    sights.iter().filter(agrees).count()
}

/// The velocity that most detections agree with to within the tolerance, m/s; its part along z is taken to be zero. `None` where
/// they are in one direction, or too few.
pub fn ego(sights: &[Detection], tolerance: f64) -> Option<EgoVelocity> {
    let usable = |sight: &&Detection| sight.rate.is_finite() && sight.direction.iter().all(|part| part.is_finite());
    let sights: Vec<Detection> = sights.iter().filter(usable).copied().collect();
    let cost = |velocity: &Vector2<f64>| -> f64 {
        let of = |sight: &Detection| sight.left(velocity).abs().min(tolerance).powi(2);
        sights.iter().map(of).sum()
    };
    let mut best = (cost(&Vector2::zeros()), Vector2::zeros());
    for (a, b) in pairs(sights.len()) {
        let (Some(a), Some(b)) = (sights.get(a), sights.get(b)) else {
            continue;
        };
        let Some(velocity) = of_two(a, b) else { continue };
        let cost = cost(&velocity);
        if cost < best.0 {
            best = (cost, velocity);
        }
    }
    let (mut velocity, mut sigma) = (best.1, f64::INFINITY);
    for _ in 0..ROUNDS {
        (velocity, sigma) = weighed(&sights, &velocity, tolerance)?;
    }
    Some(EgoVelocity {
        velocity,
        sigma,
        share: [agreeing(&sights, &velocity, tolerance), sights.len()],
    })
}

/// Every pair, or evenly scattered ones where there are too many.
fn pairs(count: usize) -> Vec<(usize, usize)> {
    let all = count * count.saturating_sub(1) / 2;
    if all <= TRIED {
        return (0..count).flat_map(|a| (a + 1..count).map(move |b| (a, b))).collect();
    }
    // A generator of numbers with a fixed seed: the same detections give the same velocity.
    let mut state = 0x2545_f491_4f6c_dd1d_u64;
    let mut next = || {
        state = state
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1_442_695_040_888_963_407);
        usize::try_from(state >> 33).unwrap_or(0) % count
    };
    (0..TRIED).map(|_| (next(), next())).filter(|(a, b)| a != b).collect()
}

/// The velocity that two static detections determine.
fn of_two(a: &Detection, b: &Detection) -> Option<Vector2<f64>> {
    let rows = Matrix2::new(a.direction.x, a.direction.y, b.direction.x, b.direction.y);
    if rows.determinant().abs() < LEAST_APART {
        return None;
    }
    Some(-rows.try_inverse()? * Vector2::new(a.rate, b.rate))
}

/// One round of least squares with Tukey's weights, and the standard error.
fn weighed(sights: &[Detection], about: &Vector2<f64>, tolerance: f64) -> Option<(Vector2<f64>, f64)> {
    let (mut information, mut moment) = (Matrix2::zeros(), Vector2::zeros());
    let (mut squares, mut weights) = (0.0, 0.0);
    for sight in sights {
        let left = sight.left(about);
        let share = left / (REACH * tolerance);
        if share.abs() >= 1.0 {
            continue;
        }
        let weight = (1.0 - share * share).powi(2);
        let direction = sight.direction.xy();
        information += weight * direction * direction.transpose();
        moment -= weight * sight.rate * direction;
        squares += weight * left * left;
        weights += weight;
    }
    // A direction is not observed where its eigenvalue is less than this share of all.
    let eigen = SymmetricEigen::try_new(information, 1e-15, 50)?;
    let least = eigen.eigenvalues.min();
    if weights < 3.0 || least < LEAST_APART * LEAST_APART * weights {
        return None;
    }
    let velocity = information.try_inverse()? * moment;
    let variance = (squares / (weights - 2.0).max(1.0)).max((tolerance / 10.0).powi(2));
    Some((velocity, (variance / least).sqrt()))
}

/// How near a detection must be to where it is expected.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MatchGate {
    /// In range, metres.
    pub range_m: f64,
    /// In direction, radians.
    pub angle_rad: f64,
}

/// How many places of a scan are found in another one when they are moved: `to_from_from`, about the sensor.
pub fn found(from: &[Vector3<f64>], to: &[Vector3<f64>], to_from_from: &Isometry3<f64>, near: MatchGate) -> usize {
    let is_found = |place: &&Vector3<f64>| {
        let expected = to_from_from * nalgebra::Point3::from(**place);
        to.iter().any(|seen| {
            (seen.norm() - expected.coords.norm()).abs() <= near.range_m
                && seen.angle(&expected.coords) <= near.angle_rad
        })
    };
    from.iter().filter(is_found).count()
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;
    use crate::math::tests_support::Rng;

    fn direction(azimuth: f64, elevation: f64) -> Vector3<f64> {
        Vector3::new(
            elevation.cos() * azimuth.cos(),
            elevation.cos() * azimuth.sin(),
            elevation.sin(),
        )
    }

    fn sight(azimuth: f64, elevation: f64, velocity: &Vector3<f64>) -> Detection {
        let direction = direction(azimuth, elevation);
        Detection {
            direction,
            rate: -velocity.dot(&direction),
        }
    }

    #[test]
    fn exact_rates_give_the_exact_velocity() {
        // Straight ahead the rate is the speed, at 60 degrees half of it: v = (8, 0).
        let ahead = Detection {
            direction: Vector3::x(),
            rate: -8.0,
        };
        let (sin, cos) = 60_f64.to_radians().sin_cos();
        let aside = [sin, -sin].map(|sin| Detection {
            direction: Vector3::new(cos, sin, 0.0),
            rate: -4.0,
        });
        let sights = [ahead, aside[0], aside[1], ahead, aside[0]];
        let found = ego(&sights, 0.3).unwrap();
        assert!((found.velocity - Vector2::new(8.0, 0.0)).norm() < 1e-9, "{found:?}");
        assert_eq!(found.share, [5, 5]);
        // And of any motion in the plane, with elevations.
        let velocity = Vector3::new(-3.0, 1.5, 0.0);
        let sights: Vec<Detection> = (0..12_u32)
            .map(|k| sight(f64::from(k) * 0.1 - 0.5, f64::from(k % 3) * 0.1 - 0.1, &velocity))
            .collect();
        let found = ego(&sights, 0.3).unwrap();
        assert!((found.velocity - velocity.xy()).norm() < 1e-9, "{found:?}");
    }

    #[test]
    fn a_third_of_moving_targets_is_left_out_and_the_error_is_as_told() {
        let mut rng = Rng::new(11);
        let mut beyond = 0;
        for trial in 0..100 {
            let velocity = Vector3::new(rng.range(3.0, 25.0), rng.range(-1.0, 1.0), 0.0);
            let sights: Vec<Detection> = (0..40)
                .map(|index| {
                    let mut one = sight(rng.range(-1.0, 1.0), rng.range(-0.1, 0.1), &velocity);
                    one.rate += 0.1 * rng.normal();
                    if index % 3 == 0 {
                        // Half of them drive along at the speed of the sensor.
                        one.rate = if index % 2 == 0 {
                            0.1 * rng.normal()
                        } else {
                            rng.range(-40.0, 10.0)
                        };
                    }
                    one
                })
                .collect();
            let found = ego(&sights, 0.5).unwrap();
            let off = (found.velocity - velocity.xy()).norm();
            assert!(off < 0.6, "{trial}: {off} {found:?}");
            beyond += u32::from(off > 3.0 * found.sigma);
            assert!(found.share[0] >= 24, "{trial}: {found:?}");
        }
        assert!(beyond <= 3, "{beyond} of 100 beyond three standard errors");
    }

    #[test]
    fn rates_without_the_motion_of_the_sensor_give_none() {
        let mut rng = Rng::new(12);
        let sights: Vec<Detection> = (0..30)
            .map(|_| Detection {
                direction: direction(rng.range(-1.0, 1.0), 0.0),
                rate: 0.1 * rng.normal(),
            })
            .collect();
        let found = ego(&sights, 0.5).unwrap();
        assert!(found.velocity.norm() < 0.3, "{found:?}");
    }

    #[test]
    fn one_direction_too_few_and_what_is_no_number_give_nothing() {
        let velocity = Vector3::new(8.0, 0.0, 0.0);
        let same: Vec<Detection> = (0..20)
            .map(|k| sight(0.3 + f64::from(k) * 1e-4, 0.0, &velocity))
            .collect();
        assert!(ego(&same, 0.3).is_none());
        assert!(ego(&[], 0.3).is_none());
        assert!(ego(&same[..1], 0.3).is_none());
        let odd = [f64::NAN, f64::INFINITY, f64::NEG_INFINITY].map(|rate| Detection {
            direction: Vector3::x(),
            rate,
        });
        assert!(ego(&odd, 0.3).is_none());
        // Among others they do no harm.
        let mut mixed: Vec<Detection> = (0..20)
            .map(|k| sight(f64::from(k) * 0.1 - 1.0, 0.0, &velocity))
            .collect();
        mixed.extend(odd);
        mixed.push(Detection {
            direction: Vector3::y(),
            rate: 1e300,
        });
        let found = ego(&mixed, 0.3).unwrap();
        assert!((found.velocity.x - 8.0).abs() < 1e-6, "{found:?}");
    }

    #[test]
    fn places_are_found_where_they_went() {
        let mut rng = Rng::new(13);
        let from: Vec<Vector3<f64>> = (0..40)
            .map(|_| direction(rng.range(-1.0, 1.0), 0.0) * rng.range(10.0, 60.0))
            .collect();
        let motion = Isometry3::translation(-2.0, 0.0, 0.0);
        let to: Vec<Vector3<f64>> = from.iter().map(|place| place + motion.translation.vector).collect();
        let near = MatchGate {
            range_m: 0.3,
            angle_rad: 0.02,
        };
        assert_eq!(found(&from, &to, &motion, near), 40);
        assert!(found(&from, &to, &motion.inverse(), near) < 8);
    }
}
