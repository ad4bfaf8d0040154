//! Units of measurements and limits, as users write them.

/// Units that can be converted into one another, each with its size.
const KINDS: [&[(&str, f64)]; 6] = [
    &[("m", 1.0), ("km", 1000.0), ("cm", 0.01), ("mm", 0.001), ("um", 1e-6)],
    &[
        ("deg", 1.0),
        ("rad", 180.0 / std::f64::consts::PI),
        ("mrad", 0.18 / std::f64::consts::PI),
    ],
    &[("s", 1.0), ("min", 60.0), ("ms", 1e-3), ("us", 1e-6), ("ns", 1e-9)],
    &[("m/s", 1.0), ("km/h", 1.0 / 3.6), ("mm/s", 1e-3)],
    &[("deg/s", 1.0), ("rad/s", 180.0 / std::f64::consts::PI)],
    &[("1", 1.0), ("", 1.0), ("%", 0.01), ("ppm", 1e-6)],
];

/// The factor from the written unit to the wanted one; `None` if they cannot be converted.
pub fn unit_factor(written: &str, wanted: &str) -> Option<f64> {
    if written == wanted {
        return Some(1.0);
    }
    let of = |unit: &str| {
        KINDS.iter().enumerate().find_map(|(kind, units)| {
            units
                .iter()
                .find(|(name, _)| *name == unit)
                .map(|(_, size)| (kind, *size))
        })
    };
    if written.is_empty() && matches!(wanted, "count" | "1") {
        return Some(1.0);
    }
    let ((kind, size), (other, unit)) = (of(written)?, of(wanted)?);
    (kind == other).then_some(size / unit)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn units_are_converted() {
        let close = |a: Option<f64>, b: f64| a.is_some_and(|a| (a - b).abs() < 1e-12 * b);
        assert!(close(unit_factor("cm", "m"), 0.01));
        assert!(close(unit_factor("rad", "deg"), 57.295_779_513_082_32));
        assert!(close(unit_factor("ms", "s"), 0.001));
        assert!(close(unit_factor("%", "1"), 0.01));
        assert!(close(unit_factor("", "count"), 1.0));
        assert_eq!(unit_factor("deg", "m"), None);
        assert_eq!(unit_factor("", "m"), None);
        assert!(close(unit_factor("furlong", "furlong"), 1.0));
    }
}
