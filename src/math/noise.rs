//! White noise of a smooth motion, and the ellipse of scattered vectors.
//!
//! Owns fourth differences and second moments in the plane. Must not know what is noisy. The
//! weights are those of the fourth difference, 1 -4 6 -4 1, whose squares sum to 70.

use nalgebra::{Matrix2, Vector2, Vector3};

/// Square degrees in a square radian.
pub const DEG2_PER_RAD2: f64 = (180.0 / std::f64::consts::PI) * (180.0 / std::f64::consts::PI);

/// The fourth difference of five evenly spaced values, scaled to the noise of one of them: motion up to the third power
/// of time cancels, white noise keeps its variance.
pub fn fourth_difference([a, b, c, d, e]: [Vector3<f64>; 5]) -> Vector3<f64> {
    (a - b * 4.0 + c * 6.0 - d * 4.0 + e) / 70f64.sqrt()
}

/// The main axes of a symmetric 2x2.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Ellipse {
    /// Direction of the longer axis from x towards y, -pi/2..=pi/2, radians. Meaningless for a circle.
    pub angle_rad: f64,
    /// The longer axis over the shorter, as deviations: the root of the ratio of the eigenvalues. Infinite for a line.
    pub stretch: f64,
    /// The sum of both eigenvalues.
    pub trace: f64,
}

impl Ellipse {
    /// Of a covariance `[[xx, xy], [xy, yy]]`. `None` where it is not finite, not positive, or has a negative eigenvalue.
    pub fn of(xx: f64, xy: f64, yy: f64) -> Option<Ellipse> {
        let (mean, half) = (f64::midpoint(xx, yy), (xx - yy) / 2.0);
        let radius = half.hypot(xy);
        let least = mean - radius;
        // By rounding, a line may have a least eigenvalue just under 0.
        if !(mean.is_finite() && radius.is_finite()) || mean <= 0.0 || least < -1e-9 * mean {
            return None;
        }
        Some(Ellipse {
            angle_rad: xy.atan2(half) / 2.0,
            stretch: ((mean + radius) / least.max(0.0)).sqrt(),
            trace: 2.0 * mean,
        })
    }

    /// Of the second moments of vectors about zero. `None` without any.
    pub fn of_vectors(vectors: impl IntoIterator<Item = Vector2<f64>>) -> Option<Ellipse> {
        let (mut sum, mut count) = (Matrix2::zeros(), 0.0);
        for vector in vectors
            .into_iter()
            .filter(|vector| vector.iter().all(|v| v.is_finite()))
        {
            sum += vector * vector.transpose();
            count += 1.0;
        }
        Ellipse::of(sum.m11 / count, sum.m12 / count, sum.m22 / count)
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;
    use crate::math::tests_support::Rng;
    use std::f64::consts::FRAC_PI_6;

    #[test]
    fn a_cubic_motion_has_no_noise_and_white_noise_keeps_its_variance() {
        let cubic = |t: f64| Vector3::new(1.0 + t, t * t, 2.0 * t * t * t - t);
        let values = [0.0, 1.0, 2.0, 3.0, 4.0].map(cubic);
        assert!(fourth_difference(values).norm() < 1e-12);
        let mut rng = Rng::new(5);
        let mut squares = 0.0;
        for _ in 0..20_000 {
            let values = [0; 5].map(|_| Vector3::new(0.3 * rng.normal(), 0.0, 0.0));
            squares += fourth_difference(values).x.powi(2);
        }
        assert!((squares / 20_000.0 / 0.09 - 1.0).abs() < 0.03);
    }

    #[test]
    fn the_ellipse_of_a_turned_diagonal() {
        let (sin, cos) = FRAC_PI_6.sin_cos();
        let (a, b) = (9.0, 1.0);
        let found = Ellipse::of(
            a * cos * cos + b * sin * sin,
            (a - b) * sin * cos,
            a * sin * sin + b * cos * cos,
        )
        .unwrap();
        assert!((found.angle_rad - FRAC_PI_6).abs() < 1e-12);
        assert!((found.stretch - 3.0).abs() < 1e-12 && (found.trace - 10.0).abs() < 1e-12);
        let vectors = [Vector2::new(3.0, 0.0), Vector2::new(0.0, 1.0)];
        let found = Ellipse::of_vectors(vectors).unwrap();
        assert!((found.stretch - 3.0).abs() < 1e-12 && found.angle_rad.abs() < 1e-12);
        assert!(Ellipse::of(1.0, 0.0, 0.0).unwrap().stretch.is_infinite());
        for (xx, xy, yy) in [(0.0, 0.0, 0.0), (1.0, 2.0, 1.0), (f64::NAN, 0.0, 1.0), (-1.0, 0.0, 2.0)] {
            assert_eq!(Ellipse::of(xx, xy, yy), None);
        }
        assert_eq!(Ellipse::of_vectors([]), None);
    }
}
