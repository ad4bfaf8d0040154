//! Statistics of angles: means for which -pi and pi are the same direction, differences, unwrapping.
//!
//! Owns weighted circular moments. Must not know what the angles mean: a course, a yaw, a phase are all the same here.
//! Radians. Angles and weights that are not finite, and weights that are not positive, are left out of every result.
//! Source: Mardia and Jupp, Directional Statistics, 2000, sections 2.2 and 2.3.

use std::f64::consts::{PI, TAU};

/// The first moment of a set of weighted angles.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CircularMean {
    /// The mean direction, -pi..=pi. Meaningless where `resultant` is near 0.
    pub mean_rad: f64,
    /// R, the length of the weighted mean of the unit vectors: 1 when all agree, 0 when they cancel. Dimensionless.
    pub resultant: f64,
    /// How many angles counted.
    pub count: usize,
    /// The sum of their weights, in the unit of the weights.
    pub weight: f64,
}

impl CircularMean {
    /// The circular standard deviation sqrt(-2 ln R), radians: that of a wrapped normal distribution. Infinite at R = 0.
    pub fn sd_rad(&self) -> f64 {
        (-2.0 * self.resultant.min(1.0).ln()).sqrt()
    }
}

/// The weighted mean of `(angle_rad, weight)` on the circle: z = sum w exp(i a) / sum w, mean = arg z, R = |z|.
///
/// `None` when nothing counts.
pub fn circular_mean(angles: impl IntoIterator<Item = (f64, f64)>) -> Option<CircularMean> {
    moment(angles, 1.0)
}

/// How widely directions are spread over a half circle: D = 1 - |sum w exp(2 i a) / sum w|, 0..=1. Dimensionless.
///
/// 0 when all angles are equal *or opposite*: an out-and-back drive has no diversity. Two directions at a right angle,
/// with equal weights, and a full turn give 1. `None` when nothing counts.
pub fn diversity(angles: impl IntoIterator<Item = (f64, f64)>) -> Option<f64> {
    moment(angles, 2.0).map(|m| (1.0 - m.resultant).max(0.0))
}

fn moment(angles: impl IntoIterator<Item = (f64, f64)>, order: f64) -> Option<CircularMean> {
    let (mut x, mut y, mut weight, mut count) = (0.0, 0.0, 0.0, 0);
    for (angle, w) in angles {
        if angle.is_finite() && w.is_finite() && w > 0.0 {
            let (sin, cos) = (order * angle).sin_cos();
            x += w * cos;
            y += w * sin;
            weight += w;
            count += 1;
        }
    }
    (count > 0).then(|| CircularMean {
        mean_rad: y.atan2(x),
        resultant: (x.hypot(y) / weight).min(1.0),
        count,
        weight,
    })
}

/// The angle in -pi..=pi that is `angle_rad` but for whole turns. Not finite when the angle is not.
pub fn wrapped(angle_rad: f64) -> f64 {
    // `angle - TAU * round` alone may exceed +-pi by rounding; the clamp keeps the promised range.
    (angle_rad - TAU * (angle_rad / TAU).round()).clamp(-PI, PI)
}

/// How far angles turn that come one by one, from the rightmost to the leftmost, whole turns counted.
#[derive(Clone, Copy, Debug, Default)]
pub struct Span {
    last: Option<f64>,
    turned: f64,
    least: f64,
    most: f64,
}

impl Span {
    /// Takes in the next angle, radians; gives the span of all so far.
    pub fn add(&mut self, angle_rad: f64) -> f64 {
        if let Some(last) = self.last.replace(angle_rad) {
            self.turned += wrapped(angle_rad - last);
            self.least = self.least.min(self.turned);
            self.most = self.most.max(self.turned);
        }
        self.rad()
    }

    /// The span of all so far, radians.
    pub fn rad(&self) -> f64 {
        self.most - self.least
    }
}

/// The shortest way from `from_rad` to `to_rad`: `to - from` but for whole turns, in -pi..=pi.
pub fn difference(to_rad: f64, from_rad: f64) -> f64 {
    wrapped(to_rad - from_rad)
}

/// The series with whole turns added so that no step between neighbours is longer than half a turn.
///
/// The first finite angle is kept as it is. Right only where no true step is longer than pi, so never across a hole:
/// give each stretch by itself. Values that are not finite stay where they are and are stepped over.
pub fn unwrap(angles_rad: &[f64]) -> Vec<f64> {
    let mut last: Option<f64> = None;
    let unwrapped = angles_rad.iter().map(|&angle| {
        if !angle.is_finite() {
            return angle;
        }
        let next = last.map_or(angle, |before| before + difference(angle, before));
        last = Some(next);
        next
    });
    unwrapped.collect()
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, clippy::float_cmp)]
    use super::*;
    use crate::math::tests_support::Rng;
    use proptest::prelude::*;

    fn plain(angles: &[f64]) -> impl Iterator<Item = (f64, f64)> {
        angles.iter().map(|&a| (a, 1.0))
    }

    #[test]
    fn published_circular_data_have_their_published_moments() {
        // Mardia and Jupp 2000, table 1.1 and example 2.1: a roulette wheel spun nine times, degrees.
        let spins = [43.0f64, 45.0, 52.0, 61.0, 75.0, 88.0, 88.0, 279.0, 357.0].map(f64::to_radians);
        let m = circular_mean(plain(&spins)).unwrap();
        assert!((m.mean_rad.to_degrees() - 51.0).abs() < 0.5);
        assert!((m.resultant - 0.711).abs() < 1e-3);
        assert_eq!((m.count, m.weight), (9, 9.0));
    }

    #[test]
    fn the_mean_does_not_break_at_half_a_turn() {
        let m = circular_mean(plain(&[PI - 0.1, 0.1 - PI])).unwrap();
        assert!((m.mean_rad.abs() - PI).abs() < 1e-12);
        assert!((m.resultant - 0.1f64.cos()).abs() < 1e-12);
        let m = circular_mean([
            (0.0, 3.0),
            (PI / 2.0, 1.0),
            (1.0, 0.0),
            (1.0, f64::NAN),
            (f64::NAN, 1.0),
        ])
        .unwrap();
        assert!((m.mean_rad - (1.0f64 / 3.0).atan()).abs() < 1e-12);
        assert!((m.resultant - 10f64.sqrt() / 4.0).abs() < 1e-12);
        assert_eq!(m.count, 2);
        assert_eq!(circular_mean(plain(&[])), None);
    }

    #[test]
    fn the_deviation_is_that_of_a_wrapped_normal() {
        let mut rng = Rng::new(3);
        let angles: Vec<f64> = (0..20_000).map(|_| 3.0 + 0.7 * rng.normal()).collect();
        let m = circular_mean(plain(&angles)).unwrap();
        assert!((m.sd_rad() - 0.7).abs() < 0.02 && difference(m.mean_rad, 3.0).abs() < 0.02);
        assert_eq!(circular_mean(plain(&[0.0, 0.0])).unwrap().sd_rad(), 0.0);
    }

    #[test]
    fn out_and_back_has_no_diversity_and_a_corner_has_it_all() {
        assert!(diversity(plain(&[0.3, 0.3 + PI, 0.3])).unwrap() < 1e-12);
        assert!((diversity(plain(&[0.3, 0.3 + PI / 2.0])).unwrap() - 1.0).abs() < 1e-12);
        // An arc of half width h: |mean exp(2ia)| = sin(2h) / 2h.
        let h = 0.4;
        let arc: Vec<f64> = (0..10_000)
            .map(|i| 2.0 - h + 2.0 * h * (f64::from(i) + 0.5) / 10_000.0)
            .collect();
        assert!((diversity(plain(&arc)).unwrap() - (1.0 - (2.0 * h).sin() / (2.0 * h))).abs() < 1e-6);
        assert_eq!(diversity(plain(&[])), None);
    }

    #[test]
    fn unwrapping_steps_over_what_is_not_finite() {
        let series = unwrap(&[3.0, -3.0, f64::NAN, 3.0, 2.9]);
        assert!((series.get(1).unwrap() - (TAU - 3.0)).abs() < 1e-12);
        assert!(series.get(2).unwrap().is_nan());
        assert!((series.get(4).unwrap() - 2.9).abs() < 1e-12);
        assert!(unwrap(&[]).is_empty());
    }

    proptest! {
        #[test]
        fn a_difference_is_short_and_right(a in -50.0f64..50.0, b in -50.0f64..50.0) {
            let d = difference(a, b);
            prop_assert!((-PI..=PI).contains(&d));
            prop_assert!(((a - b - d) / TAU - ((a - b - d) / TAU).round()).abs() < 1e-12);
        }

        #[test]
        fn unwrapping_restores_a_series_of_short_steps(steps in prop::collection::vec(-3.1f64..3.1, 1..50)) {
            let mut at = 0.0;
            let truth: Vec<f64> = steps.iter().map(|s| { at += s; at }).collect();
            let held: Vec<f64> = truth.iter().map(|&a| wrapped(a)).collect();
            let shift = held.first().unwrap() - truth.first().unwrap();
            for (t, u) in truth.iter().zip(unwrap(&held)) {
                prop_assert!((t + shift - u).abs() < 1e-9);
            }
        }
    }
}
