//! Fitting one plane track onto another: rotation, scale and shift, with and without a mirror.
//!
//! Owns the least-squares similarity of two lists of points in the plane, and the spread of one list. Must not know
//! which list is odometry and which is GNSS, nor how much better a mirror must fit to be accepted. Metres, radians.
//! Source: Umeyama, Least-squares estimation of transformation parameters between two point patterns, IEEE TPAMI 13(4),
//! 1991. In two dimensions his problem is linear: with points as complex numbers a proper similarity is
//! `target = c * source + t`, a mirrored one `target = c * conj(source) + t`.

use nalgebra::{Complex, Matrix2, Vector2};

use super::circular::wrapped;

/// Whether a fitted map keeps the sense of rotation.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Sense {
    /// Determinant +1: a turn.
    Proper,
    /// Determinant -1: a mirror.
    Improper,
}

/// `target = scale * linear * source + translation`, the best in its class.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Similarity2 {
    /// A turn or a mirror.
    pub sense: Sense,
    /// Proper: the angle by which the source is turned, counter-clockwise. Improper: the angle of `c`, which is twice
    /// that of the mirror's axis: see [`axis_rad`](Self::axis_rad). -pi..=pi.
    pub angle_rad: f64,
    /// Target metres per source metre, 0 or more. 0 when nothing of the source is found in the target.
    pub scale: f64,
    /// The target coordinates of the source's origin, metres.
    pub translation_m: Vector2<f64>,
    /// The sum of the squared residuals in the target, m^2.
    pub sse_m2: f64,
    /// The root of the mean squared residual distance in the target, metres.
    pub rms_m: f64,
}

impl Similarity2 {
    /// The angle of the line that a mirror keeps in place, -pi/2..=pi/2, measured from the source's x axis towards y:
    /// 0 = y negated, 45 degrees = x and y exchanged, +-90 degrees = x negated. `None` for a turn.
    pub fn axis_rad(&self) -> Option<f64> {
        (self.sense == Sense::Improper).then_some(self.angle_rad / 2.0)
    }

    /// The linear part without the scale: orthogonal, determinant +1 or -1.
    pub fn linear(&self) -> Matrix2<f64> {
        let (sin, cos) = self.angle_rad.sin_cos();
        match self.sense {
            Sense::Proper => Matrix2::new(cos, -sin, sin, cos),
            Sense::Improper => Matrix2::new(cos, sin, sin, -cos),
        }
    }

    /// The target coordinates (metres) of a point given in source coordinates (metres).
    pub fn apply(&self, source_m: &Vector2<f64>) -> Vector2<f64> {
        self.linear() * source_m * self.scale + self.translation_m
    }
}

/// Both fits of one pair of tracks.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Similarities {
    /// The best turn.
    pub proper: Similarity2,
    /// The best mirror.
    pub improper: Similarity2,
    /// How many points.
    pub count: usize,
}

impl Similarities {
    /// ln(SSE of the turn / SSE of the mirror): negative when the turn fits better, positive when the mirror does, 0 for
    /// points on a line. Infinite when one fits exactly and the other does not, 0 when both do.
    pub fn log_ratio(&self) -> f64 {
        let (p, m) = (self.proper.sse_m2, self.improper.sse_m2);
        if p <= 0.0 && m <= 0.0 { 0.0 } else { (p / m).ln() }
    }
}

/// The least-squares turn and the least-squares mirror, each with scale and shift, that take `source_m` to `target_m`
/// (pairs of points at the same times, metres).
///
/// `None` for lists of unequal length, under three points, coordinates that are not finite, or a source that does not move.
pub fn fit_similarities(source_m: &[Vector2<f64>], target_m: &[Vector2<f64>]) -> Option<Similarities> {
    if source_m.len() != target_m.len() || source_m.len() < 3 {
        return None;
    }
    let n = source_m.len() as f64;
    // Means first: coordinates of a map grid are 10^6 m, and their squares would lose the centimetres.
    let (source_mean, target_mean) = (mean(source_m)?, mean(target_m)?);
    let (mut aa, mut bb) = (0.0, 0.0);
    let (mut turn, mut mirror) = (Complex::new(0.0, 0.0), Complex::new(0.0, 0.0));
    for (a, b) in source_m.iter().zip(target_m) {
        let (a, b) = (complex(a - source_mean), complex(b - target_mean));
        aa += a.norm_sqr();
        bb += b.norm_sqr();
        turn += a.conj() * b;
        mirror += a * b;
    }
    if !(aa > 0.0 && aa.is_finite() && bb.is_finite()) {
        return None;
    }
    let fit = |sense, correlation: Complex<f64>| {
        // Rounding may make it slightly negative.
        let sse_m2 = (bb - correlation.norm_sqr() / aa).max(0.0);
        let mut fit = Similarity2 {
            sense,
            angle_rad: correlation.arg(),
            scale: correlation.norm() / aa,
            translation_m: Vector2::zeros(),
            sse_m2,
            rms_m: (sse_m2 / n).sqrt(),
        };
        fit.translation_m = target_mean - fit.apply(&source_mean);
        fit
    };
    Some(Similarities {
        proper: fit(Sense::Proper, turn),
        improper: fit(Sense::Improper, mirror),
        count: source_m.len(),
    })
}

/// Standard deviations of the turn (radians) and of the scale that [`fit_similarities`] finds.
///
/// By the jackknife over `blocks` of neighbouring points (Kunsch, The jackknife and the bootstrap for general stationary
/// observations, Ann. Statist. 17, 1989): noise may be correlated over less than a block, drift over more is seen as
/// scatter of the blocks. `None` for fewer than three blocks, or where a fit without one of them has no answer.
pub fn deviations(source_m: &[Vector2<f64>], target_m: &[Vector2<f64>], blocks: usize) -> Option<(f64, f64)> {
    let n = source_m.len();
    if blocks < 3 || n < 2 * blocks || target_m.len() != n {
        return None;
    }
    let whole = fit_similarities(source_m, target_m)?.proper;
    let (mut angle, mut scale) = (Vec::new(), Vec::new());
    for block in 0..blocks {
        let (from, to) = (block * n / blocks, (block + 1) * n / blocks);
        let without = |points: &[Vector2<f64>]| {
            [points.get(..from), points.get(to..)]
                .into_iter()
                .flatten()
                .flatten()
                .copied()
                .collect::<Vec<_>>()
        };
        let fit = fit_similarities(&without(source_m), &without(target_m))?.proper;
        angle.push(wrapped(fit.angle_rad - whole.angle_rad));
        scale.push(fit.scale - whole.scale);
    }
    let deviation = |values: &[f64]| {
        let m = blocks as f64;
        let mean = values.iter().sum::<f64>() / m;
        let squares: f64 = values.iter().map(|value| (value - mean).powi(2)).sum();
        (squares * (m - 1.0) / m).sqrt()
    };
    Some((deviation(&angle), deviation(&scale)))
}

/// How far a set of points is spread, along its long and its short axis.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Spread2 {
    /// The standard deviation along the axis of largest spread, metres.
    pub major_sd_m: f64,
    /// The standard deviation across it, metres: near 0 for a straight track.
    pub minor_sd_m: f64,
    /// The angle of the long axis from x towards y, -pi/2..=pi/2. Any value when the spread is round.
    pub major_axis_rad: f64,
}

/// The principal spread of points in the plane (metres): roots of the eigenvalues of their covariance (divided by n).
///
/// `None` when there is no point or a coordinate is not finite.
pub fn spread(points_m: &[Vector2<f64>]) -> Option<Spread2> {
    let centre = mean(points_m)?;
    let (mut xx, mut yy, mut xy) = (0.0, 0.0, 0.0);
    for p in points_m {
        let d = p - centre;
        xx += d.x * d.x;
        yy += d.y * d.y;
        xy += d.x * d.y;
    }
    let n = points_m.len() as f64;
    let (half_sum, half_difference) = (f64::midpoint(xx, yy), (xx - yy) / 2.0);
    let radius = half_difference.hypot(xy);
    Some(Spread2 {
        major_sd_m: ((half_sum + radius) / n).sqrt(),
        minor_sd_m: ((half_sum - radius).max(0.0) / n).sqrt(),
        major_axis_rad: xy.atan2(half_difference) / 2.0,
    })
}

/// The sum of the distances between neighbours, metres. 0 for fewer than two points.
pub fn path_length(points_m: &[Vector2<f64>]) -> f64 {
    points_m
        .iter()
        .zip(points_m.iter().skip(1))
        .map(|(a, b)| (b - a).norm())
        .sum()
}

fn mean(points: &[Vector2<f64>]) -> Option<Vector2<f64>> {
    let sum: Vector2<f64> = points.iter().sum();
    let mean = sum / points.len() as f64;
    (!points.is_empty() && mean.iter().all(|v| v.is_finite())).then_some(mean)
}

fn complex(v: Vector2<f64>) -> Complex<f64> {
    Complex::new(v.x, v.y)
}
