//! How many independent values a series is worth.
//!
//! Owns autocorrelation and Bartlett's effective count of a pair of series. Series come as stretches on one grid, and no
//! product reaches across the end of one. Must not know units or rates.
//! Source: Bartlett, Some aspects of the time-correlation problem in regard to tests of
//! significance, J. Royal Statistical Society 98, 1935.

/// sum a b over the shorter of two slices. Four sums side by side, which a processor can add at once.
pub(super) fn dot(a: &[f64], b: &[f64]) -> f64 {
    let (a4, a_rest) = a.as_chunks::<4>();
    let (b4, b_rest) = b.as_chunks::<4>();
    let chunks = a4.len().min(b4.len());
    let mut sums = [0.0; 4];
    for (x, y) in a4.iter().zip(b4) {
        for (sum, (x, y)) in sums.iter_mut().zip(x.iter().zip(y)) {
            *sum += x * y;
        }
    }
    // Where the lengths differ, one rest holds what the other's chunks do not.
    let rest = if a4.len() == b4.len() {
        a_rest.iter().zip(b_rest).map(|(x, y)| x * y).sum::<f64>()
    } else {
        let (a, b) = (a.iter().skip(4 * chunks), b.iter().skip(4 * chunks));
        a.zip(b).map(|(x, y)| x * y).sum()
    };
    sums.iter().sum::<f64>() + rest
}

/// A series about its mean, and the sum of its squares.
struct CentredSeries {
    stretches: Vec<Vec<f64>>,
    squares: f64,
    count: usize,
}

impl CentredSeries {
    /// `None` for a series that is empty, constant or not finite.
    fn new<'a>(stretches: impl Iterator<Item = &'a [f64]>) -> Option<CentredSeries> {
        let mut stretches: Vec<Vec<f64>> = stretches.map(<[f64]>::to_vec).collect();
        let count: usize = stretches.iter().map(Vec::len).sum();
        let mean = stretches.iter().flatten().sum::<f64>() / count as f64;
        stretches.iter_mut().flatten().for_each(|v| *v -= mean);
        let squares = stretches.iter().map(|s| dot(s, s)).sum::<f64>();
        // A constant has only rounding errors.
        let noise = (f64::EPSILON * mean).powi(2) * count as f64;
        (count > 1 && squares.is_finite() && squares > noise).then_some(CentredSeries {
            stretches,
            squares,
            count,
        })
    }

    fn at(&self, lag: usize) -> f64 {
        let products = self.stretches.iter().map(|s| dot(s, s.get(lag..).unwrap_or(&[])));
        products.sum::<f64>() / self.squares
    }
}

/// The autocorrelation at lags 0, 1, .. `most_lag`, in steps of the grid: r(k) = sum x(i) x(i+k) / sum x(i)^2 about the
/// mean of all stretches. The denominator is that of lag 0 for all lags (the biased estimate: never above 1, and never
/// a set of values that no process has). Dimensionless.
///
/// `None` for a series that is empty, constant or not finite.
pub fn autocorrelation<S: AsRef<[f64]>>(stretches: &[S], most_lag: usize) -> Option<Vec<f64>> {
    let series = CentredSeries::new(stretches.iter().map(AsRef::as_ref))?;
    Some((0..=most_lag).map(|lag| series.at(lag)).collect())
}

/// n_eff = n / (1 + 2 sum (1 - k/n) r_a(k) r_b(k)): the number of independent pairs that a correlation of two series is
/// worth. Between 1 and n.
///
/// Each pair of stretches holds values at the same times; what one has more than the other is not used. The sum ends at
/// four times the first lag where r_a r_b is not positive: noise in far lags would add up, and periodic series still
/// show their period. `None` where a series is empty, constant or not finite.
pub fn effective_count<A: AsRef<[f64]>, B: AsRef<[f64]>>(pairs: &[(A, B)]) -> Option<f64> {
    let both = pairs.iter().map(|(a, b)| {
        let (a, b) = (a.as_ref(), b.as_ref());
        let n = a.len().min(b.len());
        (a.get(..n).unwrap_or(a), b.get(..n).unwrap_or(b))
    });
    let a = CentredSeries::new(both.clone().map(|(a, _)| a))?;
    let b = CentredSeries::new(both.map(|(_, b)| b))?;
    let n = a.count as f64;
    let (mut sum, mut last, mut crossed) = (0.0, a.count, false);
    let mut lag = 1;
    while lag < last {
        // Every lag at first, then groups of a sixteenth of their lag, each by its middle: far lags change slowly.
        let group = (lag / 16).max(1);
        let middle = lag + (group - 1) / 2;
        let product = a.at(middle) * b.at(middle);
        if !crossed && product <= 0.0 {
            crossed = true;
            last = last.min(4 * lag);
        }
        sum += group as f64 * (1.0 - middle as f64 / n) * product;
        lag += group;
    }
    Some((n / (1.0 + 2.0 * sum).max(1.0)).max(1.0))
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, clippy::float_cmp)]
    use super::*;
    use crate::math::tests_drive::Wander;
    use crate::math::tests_support::Rng;

    /// A first-order autoregressive series with r(k) = keep^k.
    fn series(rng: &mut Rng, keep: f64, count: usize) -> Vec<f64> {
        let mut wander = Wander::new(rng, 1.0, -1.0 / keep.ln(), 1.0);
        (0..count).map(|_| 5.0 + wander.next(rng)).collect()
    }

    #[test]
    fn products_are_summed_whatever_the_lengths() {
        let a: Vec<f64> = (1..=11).map(f64::from).collect();
        for (m, n) in [(0, 3), (4, 4), (11, 11), (5, 11), (9, 7), (11, 8)] {
            let (x, y) = (a.get(..m).unwrap(), a.get(..n).unwrap());
            let wanted: f64 = (1..=m.min(n)).map(|i| (i * i) as f64).sum();
            assert_eq!(dot(x, y), wanted);
        }
    }

    #[test]
    fn the_autocorrelation_is_the_textbooks() {
        // R: acf(1:5, plot = FALSE) = 1, 0.4, -0.1, -0.4, -0.4.
        let r = autocorrelation(&[[1.0, 2.0, 3.0, 4.0, 5.0]], 4).unwrap();
        for (found, wanted) in r.iter().zip([1.0, 0.4, -0.1, -0.4, -0.4]) {
            assert!((found - wanted).abs() < 1e-12);
        }
        let mut rng = Rng::new(21);
        let r = autocorrelation(&[series(&mut rng, 0.8, 20_000)], 5).unwrap();
        for (k, found) in r.iter().enumerate() {
            assert!((found - 0.8f64.powi(i32::try_from(k).unwrap())).abs() < 0.03);
        }
        assert_eq!(autocorrelation(&[[9.81; 7]], 2), None);
        assert_eq!(autocorrelation::<Vec<f64>>(&[], 2), None);
        assert_eq!(autocorrelation(&[[1.0, f64::NAN]], 2), None);
    }

    #[test]
    fn no_product_crosses_the_end_of_a_stretch() {
        let r = autocorrelation(&[[1.0, -1.0], [1.0, -1.0]], 2).unwrap();
        assert_eq!(r, [1.0, -0.5, 0.0]);
    }

    #[test]
    fn the_effective_count_is_bartletts_closed_form() {
        // For two autoregressive series 1 + 2 sum (ab)^k = (1 + ab) / (1 - ab).
        let mut rng = Rng::new(22);
        for (a, b) in [(0.01, 0.01), (0.9, 0.8), (0.97, 0.97)] {
            let n = 30_000;
            let pair = (series(&mut rng, a, n), series(&mut rng, b, n));
            let wanted = n as f64 * (1.0 - a * b) / (1.0 + a * b);
            let found = effective_count(&[pair]).unwrap();
            assert!((found / wanted - 1.0).abs() < 0.15, "{a} {b}: {found} {wanted}");
        }
    }

    #[test]
    fn correlations_of_unrelated_series_spread_as_it_says() {
        // The variance of r between independent series is 1 / n_eff: 400 pairs of 500 values, r(k) = 0.9^k.
        let mut rng = Rng::new(23);
        let (mut squares, mut predicted) = (0.0, 0.0);
        for _ in 0..400 {
            let (a, b) = (series(&mut rng, 0.9, 500), series(&mut rng, 0.9, 500));
            let (ca, cb) = (
                CentredSeries::new([a.as_slice()].into_iter()).unwrap(),
                CentredSeries::new([b.as_slice()].into_iter()).unwrap(),
            );
            let r =
                dot(ca.stretches.first().unwrap(), cb.stretches.first().unwrap()) / (ca.squares * cb.squares).sqrt();
            squares += r * r / 400.0;
            predicted += 1.0 / effective_count(&[(a, b)]).unwrap() / 400.0;
        }
        assert!((squares / predicted - 1.0).abs() < 0.25, "{squares} {predicted}");
    }

    #[test]
    fn cut_series_are_worth_as_much_as_whole_ones() {
        let mut rng = Rng::new(24);
        let whole = (series(&mut rng, 0.9, 20_000), series(&mut rng, 0.9, 20_000));
        let cut: Vec<_> = whole.0.chunks(500).zip(whole.1.chunks(500)).collect();
        let ratio = effective_count(&cut).unwrap() / effective_count(std::slice::from_ref(&whole)).unwrap();
        assert!((ratio - 1.0).abs() < 0.1);
        assert_eq!(effective_count(&[([1.0, 2.0, 1.0], [3.0, 3.0, 3.0])]), None);
    }
}
