//! The mounting of a sensor on a body, from the motions of both in one plane: AX = XB in SE(2).
//!
//! Owns the least squares, which are linear in the place and in cosine and sine of the yaw, and their errors by the jackknife. Metres
//! and radians. Source: `rules/cross/hand-eye.md`; the jackknife after Efron and Tibshirani (1993), chapter 11.

use nalgebra::{Isometry2, Matrix2, Matrix4, Rotation2, Vector2, Vector4};

use super::stats::median;

/// Groups that the jackknife leaves out one by one.
const GROUPS: usize = 10;
/// Pairs farther off than this many medians are left out once.
const OUTLIER: f64 = 4.0;

/// The mounting of the sensor.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PlanarMount {
    /// `body_from_sensor`: its yaw, radians, and its place, metres.
    pub yaw_rad: f64,
    /// x and y on the body, metres of the sensor.
    pub place: Vector2<f64>,
    /// Metres that the body moves for a metre of the sensor.
    pub scale: f64,
    /// Standard error of the scale.
    pub scale_sigma: f64,
    /// Standard errors of yaw, x and y.
    pub sigma: [f64; 3],
    /// Median residual, metres.
    pub residual_m: f64,
    /// Median distance that the sensor moves in a pair, metres.
    pub way_m: f64,
    /// Pairs that were used.
    pub pairs: usize,
}

/// Solves for `body_from_sensor` from motions `(body, sensor)`, each the later pose in the earlier one's axes. `None` where they do
/// not determine it: too few, or hardly any turning.
pub fn mounted(pairs: &[(Isometry2<f64>, Isometry2<f64>)]) -> Option<PlanarMount> {
    let is_finite = |motion: &Isometry2<f64>| motion.to_homogeneous().iter().all(|value| value.is_finite());
    let pairs: Vec<_> = pairs
        .iter()
        .filter(|(body, sensor)| is_finite(body) && is_finite(sensor))
        .collect();
    if pairs.len() < 2 * GROUPS {
        return None;
    }
    let first = solved(pairs.iter().copied())?;
    let all: Vec<f64> = pairs.iter().map(|pair| left_m(pair, &first)).collect();
    let limit = OUTLIER * median(&all)?.max(1e-9);
    let kept: Vec<_> = pairs.into_iter().filter(|pair| left_m(pair, &first) <= limit).collect();
    let whole = solved(kept.iter().copied())?;
    let (yaw_rad, at) = (yaw(&whole), place(&whole));
    let mut squares = [0.0; 4];
    let size = kept.len().div_ceil(GROUPS);
    for group in 0..GROUPS {
        let rest = kept
            .iter()
            .enumerate()
            .filter(|(index, _)| index / size != group)
            .map(|(_, pair)| *pair);
        let part = solved(rest)?;
        let off = [
            Rotation2::new(yaw(&part)).rotation_to(&Rotation2::new(yaw_rad)).angle(),
            place(&part).x - at.x,
            place(&part).y - at.y,
            scale(&part) - scale(&whole),
        ];
        for (sum, off) in squares.iter_mut().zip(off) {
            *sum += off * off;
        }
    }
    let share = (GROUPS - 1) as f64 / GROUPS as f64;
    let [yaw_sigma, x_sigma, y_sigma, scale_sigma] = squares.map(|sum: f64| (share * sum).sqrt());
    let left: Vec<f64> = kept.iter().map(|pair| left_m(pair, &whole)).collect();
    let ways: Vec<f64> = kept
        .iter()
        .map(|(_, sensor)| sensor.translation.vector.norm())
        .collect();
    Some(PlanarMount {
        yaw_rad,
        place: at,
        scale: scale(&whole),
        scale_sigma,
        sigma: [yaw_sigma, x_sigma, y_sigma],
        residual_m: median(&left)?,
        way_m: median(&ways)?,
        pairs: kept.len(),
    })
}

fn yaw(solution: &Vector4<f64>) -> f64 {
    solution.y.atan2(solution.x)
}

fn scale(solution: &Vector4<f64>) -> f64 {
    solution.x.hypot(solution.y)
}

/// The lever arm that explains motions that are published too long is too long as well.
fn place(solution: &Vector4<f64>) -> Vector2<f64> {
    Vector2::new(solution.z, solution.w) / scale(solution)
}

/// The two equations of a pair in cosine, sine, x and y: `(R_A - 1) t - R t_B = -t_A`.
fn equations((body, sensor): &(Isometry2<f64>, Isometry2<f64>)) -> [(Vector4<f64>, f64); 2] {
    let turned = body.rotation.to_rotation_matrix().into_inner() - Matrix2::identity();
    let (a, b) = (body.translation.vector, sensor.translation.vector);
    [
        (Vector4::new(-b.x, b.y, turned.m11, turned.m12), -a.x),
        (Vector4::new(-b.y, -b.x, turned.m21, turned.m22), -a.y),
    ]
}

fn solved<'p>(pairs: impl Iterator<Item = &'p (Isometry2<f64>, Isometry2<f64>)>) -> Option<Vector4<f64>> {
    let (mut information, mut right) = (Matrix4::zeros(), Vector4::zeros());
    for (row, value) in pairs.flat_map(equations) {
        information += row * row.transpose();
        right += row * value;
    }
    let solution = information.cholesky()?.solve(&right);
    solution.iter().all(|value| value.is_finite()).then_some(solution)
}

fn left_m(pair: &(Isometry2<f64>, Isometry2<f64>), solution: &Vector4<f64>) -> f64 {
    let [x, y] = equations(pair).map(|(row, value)| row.dot(solution) - value);
    x.hypot(y)
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;
    use crate::math::tests_support::Rng;

    fn pairs(
        mount: &Isometry2<f64>,
        count: usize,
        turn_rad: f64,
        noise: [f64; 2],
        rng: &mut Rng,
    ) -> Vec<(Isometry2<f64>, Isometry2<f64>)> {
        (0..count)
            .map(|_| {
                let body = Isometry2::new(Vector2::new(rng.range(0.3, 0.8), 0.0), turn_rad * rng.normal());
                let shaken = Isometry2::new(
                    Vector2::new(noise[0] * rng.normal(), noise[0] * rng.normal()),
                    noise[1] * rng.normal(),
                );
                (body, mount.inverse() * body * mount * shaken)
            })
            .collect()
    }

    #[test]
    fn an_exact_mounting_is_found_exactly() {
        let mut rng = Rng::new(1);
        for yaw in [0.0, 0.4, -1.6, 3.0] {
            let mount = Isometry2::new(Vector2::new(0.7, -0.2), yaw);
            let found = mounted(&pairs(&mount, 40, 0.1, [0.0, 0.0], &mut rng)).unwrap();
            assert!((found.yaw_rad - yaw).abs() < 1e-9, "{found:?}");
            assert!((found.place - Vector2::new(0.7, -0.2)).norm() < 1e-9, "{found:?}");
            assert!((found.scale - 1.0).abs() < 1e-9, "{found:?}");
        }
    }

    #[test]
    fn its_errors_are_those_it_states() {
        let mut rng = Rng::new(2);
        let mount = Isometry2::new(Vector2::new(0.7, -0.2), 0.3);
        let mut beyond = 0;
        for _ in 0..200 {
            let found = mounted(&pairs(&mount, 80, 0.1, [0.02, 0.002], &mut rng)).unwrap();
            let off = [found.yaw_rad - 0.3, found.place.x - 0.7, found.place.y + 0.2];
            beyond += off
                .iter()
                .zip(found.sigma)
                .filter(|(off, sigma)| off.abs() > 3.0 * sigma)
                .count();
        }
        // Of 600, normal errors pass three deviations in 1.6; the jackknife of ten groups has heavier tails (Student, nine degrees
        // of freedom: 1.5 per cent, 9 of 600).
        assert!(beyond <= 20, "{beyond}");
    }

    #[test]
    fn a_few_matches_that_failed_do_not_matter_nor_do_those_that_are_no_numbers() {
        let mut rng = Rng::new(4);
        let mount = Isometry2::new(Vector2::new(0.7, -0.2), 0.3);
        let mut all = pairs(&mount, 80, 0.1, [0.005, 0.001], &mut rng);
        for pair in all.iter_mut().step_by(20) {
            // A match that did not move.
            pair.1 = Isometry2::identity();
        }
        all.push((Isometry2::new(Vector2::new(f64::NAN, 0.0), 0.0), Isometry2::identity()));
        let found = mounted(&all).unwrap();
        assert!((found.yaw_rad - 0.3).abs() < 0.02, "{found:?}");
        assert!((found.place - Vector2::new(0.7, -0.2)).norm() < 0.05, "{found:?}");
        assert!((70..=76).contains(&found.pairs), "{found:?}");
    }

    #[test]
    fn a_sensor_that_measures_half_shows_a_scale_of_two() {
        let mut rng = Rng::new(5);
        // With the sensor at the origin of the body its place and the scale are apart.
        let mount = Isometry2::new(Vector2::zeros(), 0.3);
        let mut all = pairs(&mount, 40, 0.1, [0.0, 0.0], &mut rng);
        for (_, sensor) in &mut all {
            sensor.translation.vector *= 0.5;
        }
        let found = mounted(&all).unwrap();
        assert!(
            (found.scale - 2.0).abs() < 1e-9 && (found.yaw_rad - 0.3).abs() < 1e-9,
            "{found:?}"
        );
    }

    /// Wheels that are smaller than their odometry assumes.
    #[test]
    fn a_body_that_counts_its_way_short_does_not_move_the_sensor() {
        let mut rng = Rng::new(6);
        let mount = Isometry2::new(Vector2::new(0.7, -0.2), 0.3);
        let mut all = pairs(&mount, 40, 0.1, [0.0, 0.0], &mut rng);
        for (body, _) in &mut all {
            body.translation.vector *= 0.9;
        }
        let found = mounted(&all).unwrap();
        assert!(
            (found.scale - 0.9).abs() < 1e-9 && (found.yaw_rad - 0.3).abs() < 1e-9,
            "{found:?}"
        );
        assert!((found.place - Vector2::new(0.7, -0.2)).norm() < 1e-9, "{found:?}");
    }

    #[test]
    fn straight_drives_and_few_pairs_determine_nothing() {
        let mut rng = Rng::new(3);
        let mount = Isometry2::new(Vector2::new(0.7, -0.2), 0.3);
        assert!(mounted(&pairs(&mount, 10, 0.1, [0.0, 0.0], &mut rng)).is_none());
        let straight = mounted(&pairs(&mount, 40, 0.0, [0.02, 0.0], &mut rng));
        assert!(
            straight.is_none_or(|found| found.sigma[1].max(found.sigma[2]) > 1.0),
            "{straight:?}"
        );
    }
}
