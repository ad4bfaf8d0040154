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

/// An angle as an expression of the language of a file: `${-5*pi/6}` in xacro; `None` where it has none, or the angle is no fraction of pi.
pub(crate) fn expression(exact: f64, path: &str) -> Option<String> {
    let [open, pi, close] = match path.rsplit('.').next() {
        Some("xacro") => ["${", "pi", "}"],
        Some("py") => ["", "math.pi", ""],
        _ => return None,
    };
    let whole = |below: u8| {
        let count = exact / PI * f64::from(below);
        ((count - count.round()).abs() < 1e-9).then_some((count.round(), below))
    };
    let (count, below) = (1..=12).find_map(whole)?;
    let above = match count {
        1.0 => pi.to_owned(),
        -1.0 => format!("-{pi}"),
        count => format!("{count}*{pi}"),
    };
    let below = if below == 1 { String::new() } else { format!("/{below}") };
    Some(format!("{open}{above}{below}{close}"))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn number(text: &str) -> f64 {
        text.parse().unwrap()
    }

    #[test]
    fn an_angle_is_written_in_the_language_of_its_file() {
        assert_eq!(expression(-5.0 * PI / 6.0, "a.urdf.xacro").unwrap(), "${-5*pi/6}");
        assert_eq!(expression(PI, "a.xacro").unwrap(), "${pi}");
        assert_eq!(expression(-PI / 2.0, "a.launch.py").unwrap(), "-math.pi/2");
        assert_eq!(expression(1.0, "a.xacro"), None);
        assert_eq!(expression(PI, "a.urdf"), None);
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
