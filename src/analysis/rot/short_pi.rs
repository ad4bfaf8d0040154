//! Multiples of pi that are written with few digits.

use std::f64::consts::PI;

use crate::math::rotation::decimals_of;

/// The multiple of pi that a short number stands for: of pi/2 from two decimals on, of pi/4 and pi/6 from three on
/// (0.52 may well be meant). It must be what cutting or rounding to its decimals makes of that multiple.
pub(crate) fn meant(value: f64, nearest_rad: f64) -> Option<f64> {
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

    fn number(text: &str) -> f64 {
        text.parse().unwrap()
    }

    #[test]
    fn short_multiples_of_pi_are_known() {
        for (text, share) in [
            ("1.57", 0.5),
            ("-3.14", -1.0),
            ("4.71", 1.5),
            ("0.785", 0.25),
            ("1.047", 1.0 / 3.0),
        ] {
            let found = meant(number(text), 1e-2).unwrap();
            assert!((found - share * PI).abs() < 1e-12, "{text}");
        }
    }

    #[test]
    fn other_angles_and_full_digits_are_not() {
        let full = (PI / 2.0).to_string();
        for text in [
            "0",
            "0.5",
            "0.52",
            "1.5",
            "3",
            "1.6",
            "2",
            "0.79",
            "1.58",
            "1.575",
            full.as_str(),
        ] {
            assert_eq!(meant(number(text), 1e-2), None, "{text}");
        }
    }
}
