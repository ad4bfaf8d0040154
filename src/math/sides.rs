//! On which side of an orientation a constant factor is: `B = C * A` changes the world, `B = A * C` changes the body.
//!
//! Owns the two constants and how constant they are. Gives numbers and no verdict. Radians. Source:
//! `rules/quat/left-vs-right-multiplication.md`; the mean is that of Markley et al., Averaging quaternions, J. Guidance, Control, and Dynamics 30(4), 2007.

use nalgebra::{Matrix3, Matrix4, Quaternion, UnitQuaternion, Vector3, Vector4};

use super::stats::median;

/// A constant, and how constant it is.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Constant {
    /// The mean.
    pub mean: UnitQuaternion<f64>,
    /// The median of the angles of all to the mean, radians.
    pub spread_rad: f64,
}

/// Two orientations of one time, `A` and `B`, each `world_from_body`.
pub type Pair = (UnitQuaternion<f64>, UnitQuaternion<f64>);

/// The constant factors between two series of orientations.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sides {
    /// `C` of `B = C * A`: the world of `B` from the world of `A`.
    pub left: Constant,
    /// `C` of `B = A * C`: the body of `A` from the body of `B`.
    pub right: Constant,
    /// The largest angle of an `A` to the mean of all, radians: small angles determine no side.
    pub turned_rad: f64,
}

/// Both constants of pairs. `None` without a pair.
pub fn sides(pairs: &[Pair]) -> Option<Sides> {
    let of = |between: fn(&Pair) -> UnitQuaternion<f64>| {
        let all: Vec<UnitQuaternion<f64>> = pairs.iter().map(between).collect();
        let mean = mean(&all)?;
        let angles: Vec<f64> = all.iter().map(|one| one.angle_to(&mean)).collect();
        let largest = angles.iter().copied().fold(0.0, f64::max);
        let spread_rad = median(&angles)?;
        Some((Constant { mean, spread_rad }, largest))
    };
    Some(Sides {
        left: of(|(a, b)| b * a.inverse())?.0,
        right: of(|(a, b)| a.inverse() * b)?.0,
        turned_rad: of(|(a, _)| *a)?.1,
    })
}

/// The part of a constant on one side that no constant on the other side explains. A rotation about the only axis that `A` turns about is the
/// same on both sides: it is none of it. `None` without a pair.
pub fn one_sided(pairs: &[Pair], found: &Sides, is_left: bool) -> Option<UnitQuaternion<f64>> {
    let (constant, other) = if is_left {
        (found.left, found.right)
    } else {
        (found.right, found.left)
    };
    let all: Vec<UnitQuaternion<f64>> = pairs.iter().map(|(a, _)| *a).collect();
    let mean = mean(&all)?;
    let mut spread = Matrix3::zeros();
    for a in &all {
        let turned = if is_left {
            a * mean.inverse()
        } else {
            mean.inverse() * a
        };
        let turned = turned.scaled_axis();
        spread += turned * turned.transpose();
    }
    let eigen = spread.symmetric_eigen();
    let axis: Vector3<f64> = eigen.eigenvectors.column(eigen.eigenvalues.imax()).into();
    let of_constant = constant.mean;
    let twist = Quaternion::from_parts(of_constant.w, axis * axis.dot(&of_constant.imag()));
    let Some(twist) = UnitQuaternion::try_new(twist, 1e-9) else {
        return Some(of_constant);
    };
    // The twist goes to the other side.
    let (least, moved): (_, Vec<Pair>) = if is_left {
        let least = of_constant * twist.inverse();
        (least, pairs.iter().map(|(a, b)| (*a, least.inverse() * b)).collect())
    } else {
        let least = twist.inverse() * of_constant;
        (least, pairs.iter().map(|(a, b)| (*a, b * least.inverse())).collect())
    };
    let without = sides(&moved)?;
    let left_over = if is_left { without.right } else { without.left };
    // Half of the way from the constant's own spread to that without it.
    let is_enough = left_over.spread_rad <= 0.5 * (constant.spread_rad + other.spread_rad);
    Some(if is_enough { least } else { of_constant })
}

/// The rotation with the least sum of squared chords to all: the eigenvector of the sum of `q q^T` with the largest
/// eigenvalue. The sign of a quaternion does not matter. `None` for none, or where one is not finite.
pub fn mean(all: &[UnitQuaternion<f64>]) -> Option<UnitQuaternion<f64>> {
    let mut sum = Matrix4::zeros();
    for one in all {
        let q: Vector4<f64> = one.coords;
        sum += q * q.transpose();
    }
    if all.is_empty() || !sum.iter().all(|part| part.is_finite()) {
        return None;
    }
    let eigen = sum.symmetric_eigen();
    let best = eigen.eigenvalues.imax();
    let q: Vector4<f64> = eigen.eigenvectors.column(best).into();
    UnitQuaternion::try_new(Quaternion::from(q), 0.5)
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;
    use crate::math::rotation::from_rpy;
    use crate::math::tests_support::Rng;

    fn drive(rng: &mut Rng, noise: f64) -> Vec<Pair> {
        let step = |i: u32| {
            let t = f64::from(i) * 0.1;
            let a = from_rpy(0.1 * (0.7 * t).sin(), 0.05 * (1.1 * t).cos(), 0.2 * t);
            let off = from_rpy(noise * rng.normal(), noise * rng.normal(), noise * rng.normal());
            (a, a * off)
        };
        (0..200).map(step).collect()
    }

    #[test]
    fn a_constant_is_found_on_the_side_where_it_stands() {
        let mut rng = Rng::new(4);
        let constant = from_rpy(0.3, -0.2, 1.1);
        let plain = drive(&mut rng, 0.002);
        let left: Vec<_> = plain.iter().map(|(a, b)| (*a, constant * b)).collect();
        let found = sides(&left).unwrap();
        assert!(found.left.mean.angle_to(&constant) < 1e-3);
        assert!(found.left.spread_rad < 0.01 && found.right.spread_rad > 0.1);
        let right: Vec<_> = plain.iter().map(|(a, b)| (*a, b * constant)).collect();
        let found = sides(&right).unwrap();
        assert!(found.right.mean.angle_to(&constant) < 1e-3);
        assert!(found.right.spread_rad < 0.01 && found.left.spread_rad > 0.1);
    }

    /// A car turns about z: its yaw may be that of the world. A body that tumbles shows the whole rotation.
    #[test]
    fn a_rotation_about_the_only_axis_of_motion_is_on_neither_side() {
        let constant = from_rpy(0.25, 0.0, 0.0) * from_rpy(0.0, 0.0, 0.85);
        let step = |roll: f64| move |i: u32| from_rpy(roll * (0.31 * f64::from(i)).sin(), 0.0, 0.05 * f64::from(i));
        for (roll, angle) in [(0.0, 0.25), (1.0, constant.angle())] {
            let all: Vec<_> = (0..200).map(step(roll)).collect();
            let right: Vec<Pair> = all.iter().map(|a| (*a, a * constant)).collect();
            let of_body = one_sided(&right, &sides(&right).unwrap(), false).unwrap();
            assert!((of_body.angle() - angle).abs() < 0.02, "{roll}: {}", of_body.angle());
            let left: Vec<Pair> = all.iter().map(|a| (*a, constant * a)).collect();
            let of_world = one_sided(&left, &sides(&left).unwrap(), true).unwrap();
            assert!((of_world.angle() - angle).abs() < 0.02, "{roll}: {}", of_world.angle());
        }
    }

    #[test]
    fn the_mean_knows_no_sign_and_none_has_no_mean() {
        let (a, b) = (from_rpy(0.0, 0.0, 0.1), from_rpy(0.0, 0.0, 0.3));
        let negated = UnitQuaternion::new_unchecked(-b.into_inner());
        assert!(mean(&[a, negated]).unwrap().angle_to(&from_rpy(0.0, 0.0, 0.2)) < 1e-9);
        assert_eq!(mean(&[]), None);
    }
}
