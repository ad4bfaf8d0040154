//! Multiples of pi that were written with few digits.

use std::f64::consts::PI;

use crate::math::rotation::decimals_of;

/// The multiple of pi that a short number stands for: of pi/2 from two decimals on, of pi/4 and pi/6 from three on
/// (0.52 may well be meant). It must be what cutting or rounding to its decimals makes of that multiple.
pub(super) fn meant(value: f64, nearest_rad: f64) -> Option<f64> {
    let decimals = decimals_of(value);
    let cut = 10f64.powi(-i32::try_from(decimals).ok()?);
    [(2.0, 2), (4.0, 3), (6.0, 3)].into_iter().find_map(|(parts, least)| {
        let multiple = (value * parts / PI).round();
        let exact = multiple * PI / parts;
        let error = (value - exact).abs();
        let is_cut = value.abs() <= exact.abs() && error < cut;
        let is_rounded = error <= 0.5 * cut;
        let is_short = (1e-6..nearest_rad).contains(&error) && decimals >= least;
        (multiple != 0.0 && is_short && (is_cut || is_rounded)).then_some(exact)
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn short_multiples_of_pi_are_known_and_other_angles_are_not() {
        let eighth = std::f64::consts::FRAC_PI_4;
        for (value, exact) in [
            (1.57, PI / 2.0),
            (-3.14, -PI),
            (4.71, 1.5 * PI),
            (0.785, eighth),
            (1.047, PI / 3.0),
        ] {
            let found = meant(value, 1e-2).unwrap();
            assert!((found - exact).abs() < 1e-12, "{value}");
        }
        for value in [0.0, 0.5, 0.52, 1.5, 3.0, 1.6, PI / 2.0, 2.0, 0.79, 1.58, 1.575] {
            assert_eq!(meant(value, 1e-2), None, "{value}");
        }
    }
}
