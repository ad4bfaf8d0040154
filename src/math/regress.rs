//! Slopes: how much of one quantity goes with one unit of another.
//!
//! Owns least squares on one regressor, its robust form, and a median slope. Must not know units: a slope is in those of
//! y over those of x. Pairs that are not finite are left out. Every deviation is that for `n_eff` independent pairs,
//! which the caller has from [`effective_count`](super::effective::effective_count): rows of a recording are not
//! independent. Source: Huber, Robust Estimation of a Location Parameter, 1964, with k = 1.5.

use super::stats::{MAD_TO_SIGMA, median};

/// Whether the line passes through the origin.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum LineForm {
    /// y = slope x.
    Origin,
    /// y = intercept + slope x.
    Anywhere,
}

/// A fitted line.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Line {
    /// Units of y per unit of x.
    pub slope: f64,
    /// y at x = 0, 0 for a line through the origin.
    pub intercept: f64,
    /// The standard error of the slope for `n_eff` independent pairs. `None` when these are no more than the
    /// parameters.
    pub standard_error: Option<f64>,
    /// slope / standard error. `None` without one, or for a perfect fit.
    pub t: Option<f64>,
    /// The standard deviation of the residuals of y: robust in a robust fit.
    pub residual_sd: f64,
    /// How many pairs.
    pub count: usize,
    /// How many of them were taken at less than full weight: outliers, in a robust fit.
    pub lightened: usize,
}

/// The least-squares line of `(x, y)` pairs.
///
/// `None` when x does not vary (from 0, for a line through the origin), or with fewer pairs than parameters.
pub fn fit(pairs: &[(f64, f64)], through: LineForm, n_eff: f64) -> Option<Line> {
    let pairs = finite(pairs);
    let weights = vec![1.0; pairs.len()];
    let line = weighted(&pairs, &weights, through)?;
    let squares: f64 = residuals(&pairs, &line).map(|r| r * r).sum();
    Some(finished(line, &pairs, through, n_eff, squares, 0))
}

/// Huber's k: residuals beyond this many deviations lose weight.
const HUBER_K: f64 = 1.5;

/// The line of `(x, y)` pairs by Huber's M-estimator: iteratively reweighted least squares, weight min(1, 1.5 s / |r|)
/// with s the median absolute residual times 1.4826. It starts from the median slope, so that a third of the pairs may
/// be outliers in y. The standard error is Huber's (Robust Statistics, 1981, equation 7.6.3, without its small
/// correction). `None` as for [`fit`].
pub fn fit_huber(pairs: &[(f64, f64)], through: LineForm, n_eff: f64) -> Option<Line> {
    let pairs = finite(pairs);
    let mut line = weighted(&pairs, &vec![1.0; pairs.len()], through)?;
    if let Some(start) = median_line(&pairs, through) {
        line = start;
    }
    let (mut sigma, mut weights) = (0.0, vec![1.0; pairs.len()]);
    for _ in 0..50 {
        let sizes: Vec<f64> = residuals(&pairs, &line).map(f64::abs).collect();
        sigma = MAD_TO_SIGMA * median(&sizes)?;
        // More than half of the pairs lie on the line: nothing better can be found.
        if sigma <= 0.0 {
            break;
        }
        weights = sizes.iter().map(|r| (HUBER_K * sigma / r).min(1.0)).collect();
        let next = weighted(&pairs, &weights, through)?;
        let moved = (next.slope - line.slope).abs();
        line = next;
        if moved <= 1e-7 * line.slope.abs() {
            break;
        }
    }
    let lightened = weights.iter().filter(|w| **w < 1.0).count();
    let full = (pairs.len() - lightened) as f64 / pairs.len() as f64;
    // sum psi^2 over the square of the mean of its derivative, which is the share at full weight.
    let psi = residuals(&pairs, &line).zip(&weights).map(|(r, w)| (r * w).powi(2));
    let squares = psi.sum::<f64>() / (full * full);
    let line = finished(line, &pairs, through, n_eff, squares, lightened);
    Some(Line {
        residual_sd: sigma,
        ..line
    })
}

/// The slope that is the median of slopes between pairs of `(x, y)` pairs: each with the one half of the list further on
/// in the order of x (Theil's incomplete method, 1950), n / 2 slopes, so it costs a sort. Up to a quarter of the pairs
/// may be anything. `None` with fewer than two different x.
pub fn median_slope(pairs: &[(f64, f64)]) -> Option<f64> {
    let mut pairs = finite(pairs);
    pairs.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.total_cmp(&b.1)));
    let half = pairs.len().div_ceil(2);
    let slopes = pairs.iter().zip(pairs.iter().skip(half));
    let slopes: Vec<f64> = slopes
        .filter(|(a, b)| b.0 > a.0)
        .map(|(a, b)| (b.1 - a.1) / (b.0 - a.0))
        .collect();
    median(&slopes)
}

/// Upper bound of a slope whose x is noisy too, where that bound reaches 1 to within `share` and the slope itself does not: noise of
/// x shrinks a slope, and the regression of x on y, `slope / correlation^2`, bounds it from above (Frisch's bounds). `None` where
/// the slope is not between 0 and 1, or its bound is below 1 as well: then noise does not explain that it is not 1.
pub fn bound_that_reaches_one(slope: f64, correlation: f64, share: f64) -> Option<f64> {
    let upper = slope / correlation.powi(2);
    (slope > 0.0 && slope < 1.0 && upper * (1.0 + share) > 1.0).then_some(upper)
}

fn finite(pairs: &[(f64, f64)]) -> Vec<(f64, f64)> {
    let sound = pairs.iter().copied().filter(|(x, y)| x.is_finite() && y.is_finite());
    sound.collect()
}

/// A line for the robust fit to start from.
fn median_line(pairs: &[(f64, f64)], through: LineForm) -> Option<Line> {
    let (slope, intercept) = match through {
        // Weighted by nothing: ratios at small x are wild, so those of the larger half decide.
        LineForm::Origin => {
            let sizes: Vec<f64> = pairs.iter().map(|(x, _)| x.abs()).collect();
            let least = median(&sizes)?;
            let large = pairs.iter().filter(|(x, _)| x.abs() >= least && *x != 0.0);
            (median(&large.map(|(x, y)| y / x).collect::<Vec<_>>())?, 0.0)
        }
        LineForm::Anywhere => {
            let slope = median_slope(pairs)?;
            (
                slope,
                median(&pairs.iter().map(|(x, y)| y - slope * x).collect::<Vec<_>>())?,
            )
        }
    };
    Some(plain(slope, intercept))
}

fn plain(slope: f64, intercept: f64) -> Line {
    Line {
        slope,
        intercept,
        standard_error: None,
        t: None,
        residual_sd: 0.0,
        count: 0,
        lightened: 0,
    }
}

fn residuals<'a>(pairs: &'a [(f64, f64)], line: &Line) -> impl Iterator<Item = f64> + 'a {
    let (slope, intercept) = (line.slope, line.intercept);
    pairs.iter().map(move |(x, y)| y - intercept - slope * x)
}

/// The mean of x that a slope is measured about, weighted.
fn centre(pairs: &[(f64, f64)], weights: &[f64], through: LineForm) -> (f64, f64) {
    if through == LineForm::Origin {
        return (0.0, 0.0);
    }
    let total: f64 = weights.iter().sum();
    let sums = pairs.iter().zip(weights);
    let (x, y) = sums.fold((0.0, 0.0), |(sx, sy), ((x, y), w)| (sx + w * x, sy + w * y));
    (x / total, y / total)
}

fn weighted(pairs: &[(f64, f64)], weights: &[f64], through: LineForm) -> Option<Line> {
    let (x0, y0) = centre(pairs, weights, through);
    let (mut xx, mut xy) = (0.0, 0.0);
    for ((x, y), w) in pairs.iter().zip(weights) {
        xx += w * (x - x0) * (x - x0);
        xy += w * (x - x0) * (y - y0);
    }
    let slope = xy / xx;
    (slope.is_finite() && pairs.len() >= parameters(through)).then(|| plain(slope, y0 - slope * x0))
}

fn parameters(through: LineForm) -> usize {
    match through {
        LineForm::Origin => 1,
        LineForm::Anywhere => 2,
    }
}

/// The line with its errors; `squares` is the sum of squared residuals, or what stands for it.
fn finished(line: Line, pairs: &[(f64, f64)], through: LineForm, n_eff: f64, squares: f64, lightened: usize) -> Line {
    let (x0, _) = centre(pairs, &vec![1.0; pairs.len()], through);
    let xx: f64 = pairs.iter().map(|(x, _)| (x - x0) * (x - x0)).sum();
    let free = n_eff - parameters(through) as f64;
    // For n_eff = n the textbook's squares / (n - p) / xx.
    let standard_error = (free > 0.0).then(|| (squares / free / xx).sqrt());
    Line {
        standard_error,
        t: standard_error.filter(|se| *se > 0.0).map(|se| line.slope / se),
        residual_sd: (squares / pairs.len() as f64).sqrt(),
        count: pairs.len(),
        lightened,
        ..line
    }
}
