//! Small robust statistics on slices.
//!
//! Owns totals, median, median absolute deviation and quantiles. Must not know units, time or weights: a caller that needs
//! circular or weighted statistics does not find them here. Values that are not finite are left out of every result.

/// 1 / (quantile of the standard normal at 3/4): makes the MAD of normal data estimate its standard deviation.
pub const MAD_TO_SIGMA: f64 = 1.482_602_218_505_602;

/// Counts together; as many as there can be where they are more, which only altered evidence says.
pub fn total(counts: impl IntoIterator<Item = u64>) -> u64 {
    counts.into_iter().fold(0, u64::saturating_add)
}

/// The finite values, in ascending order.
fn sorted_finite(values: &[f64]) -> Vec<f64> {
    let mut kept: Vec<f64> = values.iter().copied().filter(|v| v.is_finite()).collect();
    kept.sort_by(f64::total_cmp);
    kept
}

/// A number with so many decimals; zero has no sign.
pub fn rounded(value: f64, decimals: i32) -> f64 {
    let scale = 10_f64.powi(decimals);
    // Adding zero turns -0 into 0.
    (value * scale).round() / scale + 0.0
}

/// The `q`-quantile (0 <= `q` <= 1) of the finite values, with linear interpolation between order statistics
/// (Hyndman and Fan 1996, type 7: the default of NumPy and R). In the unit of the values.
///
/// `None` when no value is finite or `q` is outside 0..=1.
pub fn quantile(values: &[f64], q: f64) -> Option<f64> {
    if !(0.0..=1.0).contains(&q) {
        return None;
    }
    quantile_of_sorted(&sorted_finite(values), q)
}

fn quantile_of_sorted(sorted: &[f64], q: f64) -> Option<f64> {
    let last = sorted.len().checked_sub(1)?;
    let at = q * last as f64;
    // `at` is in 0..=last, so the cast neither truncates a large number nor meets a negative one.
    #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss)]
    let below = (at.floor() as usize).min(last);
    let low = *sorted.get(below)?;
    let high = *sorted.get((below + 1).min(last))?;
    // Weighted halves and not `low + share * (high - low)`: the difference of two large values can overflow.
    let share = at - below as f64;
    Some(low * (1.0 - share) + high * share)
}

/// The median of the finite values, in their unit. `None` when there is none.
pub fn median(values: &[f64]) -> Option<f64> {
    quantile(values, 0.5)
}

/// The median absolute deviation from the median, times [`MAD_TO_SIGMA`]: a standard deviation that up to half of the
/// values can't spoil. In the unit of the values; `None` when no value is finite.
///
/// It is 0 when more than half of the values are equal, so never divide by it unguarded.
pub fn mad(values: &[f64]) -> Option<f64> {
    let sorted = sorted_finite(values);
    let centre = quantile_of_sorted(&sorted, 0.5)?;
    let deviations: Vec<f64> = sorted.iter().map(|v| (v - centre).abs()).collect();
    median(&deviations).map(|m| m * MAD_TO_SIGMA)
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, clippy::float_cmp)]
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn small_cases_have_the_textbook_values() {
        assert_eq!(median(&[]), None);
        assert_eq!(median(&[f64::NAN, f64::INFINITY]), None);
        assert_eq!(median(&[3.0, 1.0, 2.0]), Some(2.0));
        assert_eq!(median(&[4.0, f64::NAN, 1.0, 2.0, 3.0]), Some(2.5));
        assert_eq!(quantile(&[1.0, 2.0, 3.0, 4.0], 0.25), Some(1.75)); // numpy.quantile
        assert_eq!(quantile(&[1.0, 2.0], 1.0), Some(2.0));
        assert_eq!(quantile(&[1.0], 1.5), None);
        assert_eq!(quantile(&[1.0], f64::NAN), None);
        assert_eq!(median(&[f64::MAX, -f64::MAX]), Some(0.0));
    }

    #[test]
    fn mad_estimates_sigma_and_ignores_outliers() {
        // R: mad(c(1, 1, 2, 2, 4, 6, 9)) = 1.4826
        let value = mad(&[1.0, 1.0, 2.0, 2.0, 4.0, 6.0, 9.0]).unwrap();
        assert!((value - 1.4826).abs() < 1e-4);
        assert_eq!(mad(&[5.0, 5.0, 5.0, 1e300]), Some(0.0));
        // Normal quantiles on a grid: the MAD is the sigma.
        let mut rng = crate::math::tests_support::Rng::new(7);
        let normal: Vec<f64> = (0..20_000).map(|_| 3.0 * rng.normal() + 1.0).collect();
        assert!((mad(&normal).unwrap() - 3.0).abs() < 0.1);
    }

    proptest! {
        #[test]
        fn a_quantile_lies_within_the_data_and_grows_with_q(
            values in prop::collection::vec(-1e6f64..1e6, 1..40), a in 0.0f64..=1.0, b in 0.0f64..=1.0,
        ) {
            let (lo, hi) = (a.min(b), a.max(b));
            let (x, y) = (quantile(&values, lo).unwrap(), quantile(&values, hi).unwrap());
            let min = values.iter().copied().fold(f64::INFINITY, f64::min);
            let max = values.iter().copied().fold(f64::NEG_INFINITY, f64::max);
            prop_assert!(x <= y + 1e-9 && x >= min - 1e-9 && y <= max + 1e-9);
        }
    }
}
