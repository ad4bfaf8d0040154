//! Principal moments of an inertia, and the rounding error of its printed digits.

use nalgebra::{Matrix3, SymmetricEigen};

use crate::math::rotation::decimals_of;

/// The most that rounding the six numbers to their printed decimals changes a principal moment, kg m². Trailing zeros are
/// not counted, so this is rather too large.
pub(crate) fn rounding(inertia: [f64; 6]) -> f64 {
    let half_unit = |moment: &f64| match i32::try_from(decimals_of(*moment)) {
        Ok(decimals) if *moment != 0.0 => 0.5 * 10f64.powi(-decimals),
        _ => 0.0,
    };
    2.0 * inertia.iter().map(half_unit).sum::<f64>()
}

/// Principal moments, smallest first, of `ixx ixy ixz iyy iyz izz`.
pub(crate) fn principal_moments([xx, xy, xz, yy, yz, zz]: [f64; 6]) -> Option<[f64; 3]> {
    let inertia = Matrix3::new(xx, xy, xz, xy, yy, yz, xz, yz, zz);
    let mut moments: [f64; 3] = SymmetricEigen::try_new(inertia, f64::EPSILON, 200)?.eigenvalues.into();
    moments.sort_by(f64::total_cmp);
    Some(moments)
}

/// Placeholder numbers: six equal ones, or moments of which one or two are zero.
pub(crate) fn is_placeholder(inertia: [f64; 6]) -> bool {
    let [xx, xy, xz, yy, yz, zz] = inertia;
    // Written by hand: compared exactly.
    #[allow(clippy::float_cmp)]
    let is_one_number = inertia.iter().all(|moment| *moment == xx);
    let moments = [xx, yy, zz];
    #[allow(clippy::float_cmp)]
    let has_zero = [xy, xz, yz] == [0.0; 3] && moments.contains(&0.0) && moments.iter().all(|moment| *moment >= 0.0);
    is_one_number || has_zero
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn principal_moments_of_a_turned_box_are_those_of_the_box() {
        // diag(1, 2, 3) turned by 45 deg about z: ixx = iyy = 1.5, ixy = -0.5 or 0.5 by the sense of the turn.
        let moments = principal_moments([1.5, -0.5, 0.0, 1.5, 0.0, 3.0]).unwrap();
        for (moment, expected) in moments.iter().zip([1.0, 2.0, 3.0]) {
            assert!((moment - expected).abs() < 1e-12);
        }
    }

    #[test]
    fn numbers_that_were_filled_in_are_told_from_wrong_ones() {
        assert!(is_placeholder([1e-6; 6]));
        assert!(is_placeholder([0.0, 0.0, 0.0, 0.0, 0.0, 0.987]));
        assert!(!is_placeholder([0.01, 0.0, 0.0, 0.01, 0.0, 0.1]));
        assert!(!is_placeholder([-0.01, 0.0, 0.0, 0.0, 0.0, 0.1]));
        assert!(!is_placeholder([0.0, 0.05, 0.0, 0.01, 0.0, 0.01]));
    }

    #[test]
    fn digits_excuse_half_a_unit_of_each_number() {
        assert!((rounding([0.083, 0.0, 0.0, 0.083, 0.0, 0.167]) - 3e-3).abs() < 1e-15);
        assert!(rounding([0.0; 6]).abs() < 1e-15);
    }
}
