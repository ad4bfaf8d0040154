//! What the rotations of a body show of a sensor that is fixed to it: the information of hand-eye calibration, `A X = X B`.
//!
//! A small rotation of X about e changes `R_A R_X = R_X R_B` by `a x e` for each rotation vector a: the information on the rotation is
//! `sum |a|^2 I - a a'`. Its lever arm t is in `(R_A - I) t`: the information on the translation is `sum (R_A - I)' (R_A - I)`. Both
//! vanish along an axis that all rotations share (Tsai and Lenz 1989; Chen 1991).

use nalgebra::{Matrix3, SymmetricEigen, UnitQuaternion, Vector3};

/// Information below this share of the largest is none: rounding.
const SINGULAR: f64 = 1e-9;

/// A rotation that counts, radians (10 degrees).
pub const LEAST_RAD: f64 = 0.174_532_925;
/// Rotations that are needed.
pub const LEAST: usize = 10;
/// Rotations about another axis than the main one that are needed.
pub const LEAST_OFF: usize = 5;
/// The angle from which on an axis is another one, radians (30 degrees): the error of hand-eye grows with one over the sine of the angle
/// between the axes (Tsai and Lenz 1989).
pub const OFF_RAD: f64 = std::f64::consts::FRAC_PI_6;

/// What rotations of a body show.
#[derive(Clone, Debug, PartialEq)]
pub struct Excitation {
    /// About the rotation of a fixed sensor, in the axes of the body, rad^2.
    pub rotation: Information,
    /// About its lever arm, in the axes of the body, without unit.
    pub translation: Information,
    /// The rotations, rad, in the axes of the body.
    motions: Vec<Vector3<f64>>,
}

/// A symmetric information matrix by its axes, the weakest first.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Information {
    /// Eigenvalues, ascending; not negative.
    pub eigenvalues: [f64; 3],
    /// Their directions.
    pub axes: [Vector3<f64>; 3],
}

impl Information {
    fn of(matrix: Matrix3<f64>) -> Option<Self> {
        let eigen = SymmetricEigen::try_new(matrix, 1e-15, 100)?;
        let columns = eigen.eigenvectors.column_iter().map(nalgebra::Matrix::into_owned);
        let mut pairs: Vec<(f64, Vector3<f64>)> = eigen.eigenvalues.iter().copied().zip(columns).collect();
        pairs.sort_by(|a, b| a.0.total_cmp(&b.0));
        let &[weak, middle, strong] = pairs.as_slice() else {
            return None;
        };
        let all = [weak, middle, strong];
        Some(Self {
            eigenvalues: all.map(|(value, _)| value.max(0.0)),
            axes: all.map(|(_, axis)| axis),
        })
    }

    /// Whether nothing is shown about at least one axis.
    pub fn is_singular(&self) -> bool {
        let [weakest, _, strongest] = self.eigenvalues;
        weakest <= SINGULAR * strongest
    }

    /// The standard error along the weakest axis for a unit of independent noise in each motion; infinite if nothing is shown.
    pub fn worst_error(&self) -> f64 {
        let [weakest, ..] = self.eigenvalues;
        if self.is_singular() {
            f64::INFINITY
        } else {
            weakest.sqrt().recip()
        }
    }
}

impl Excitation {
    /// Of rotation vectors, rad, in the axes of the body; those that are not finite are left out. `None` without any.
    pub fn of(motions: impl IntoIterator<Item = Vector3<f64>>) -> Option<Self> {
        let is_finite = |motion: &Vector3<f64>| motion.iter().all(|value| value.is_finite());
        let motions: Vec<Vector3<f64>> = motions.into_iter().filter(is_finite).collect();
        let (mut rotation, mut translation) = (Matrix3::zeros(), Matrix3::zeros());
        for motion in &motions {
            rotation += Matrix3::identity() * motion.norm_squared() - motion * motion.transpose();
            let moved = UnitQuaternion::from_scaled_axis(*motion)
                .to_rotation_matrix()
                .into_inner()
                - Matrix3::identity();
            translation += moved.transpose() * moved;
        }
        (!motions.is_empty()).then_some(())?;
        Some(Self {
            rotation: Information::of(rotation)?,
            translation: Information::of(translation)?,
            motions,
        })
    }

    /// Number of rotations.
    pub fn count(&self) -> usize {
        self.motions.len()
    }

    /// The axis that most of the rotation is about: what is fixed to the body is shown least about and along it.
    pub fn main_axis(&self) -> Vector3<f64> {
        let [weakest, ..] = self.rotation.axes;
        weakest
    }

    /// Rotations about axes that differ from the main one by at least this angle, rad.
    pub fn off_axis(&self, least_rad: f64) -> usize {
        let axis = self.main_axis();
        let is_off = |motion: &&Vector3<f64>| motion.cross(&axis).norm().atan2(motion.dot(&axis).abs()) >= least_rad;
        self.motions.iter().filter(is_off).count()
    }
}

/// A rotation of a body.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BodyRotation {
    /// Start and end, seconds.
    pub span_s: [f64; 2],
    /// Its rotation vector, rad, in the axes of the body at its start.
    pub vector: Vector3<f64>,
}

/// Rotations of a body one after the other, each as soon as it is large enough, from `(seconds, world_from_body)`. What takes longer
/// than `longest_s` is left out: a drift of the orientation is no rotation.
pub fn rotations(orientations: &[(f64, UnitQuaternion<f64>)], least_rad: f64, longest_s: f64) -> Vec<BodyRotation> {
    let mut rotations = Vec::new();
    let Some((mut from, rest)) = orientations.split_first() else {
        return rotations;
    };
    for to in rest {
        let vector = (from.1.inverse() * to.1).scaled_axis();
        let is_late = to.0 - from.0 > longest_s;
        let is_enough = vector.norm() >= least_rad;
        if is_enough && !is_late {
            rotations.push(BodyRotation {
                span_s: [from.0, to.0],
                vector,
            });
        }
        if is_enough || is_late {
            from = to;
        }
    }
    rotations
}

/// `first_from_body` from angular velocities in the axes of the body, `(seconds, rad/s)`, by the mid-point rule.
pub fn integrated(rates: impl IntoIterator<Item = (f64, Vector3<f64>)>) -> Vec<(f64, UnitQuaternion<f64>)> {
    let mut before: Option<(f64, Vector3<f64>, UnitQuaternion<f64>)> = None;
    let rates = rates.into_iter().map(|(t_s, rate)| {
        let turned = before.map_or_else(UnitQuaternion::identity, |(from_s, last, turned)| {
            turned * UnitQuaternion::from_scaled_axis((last + rate) * (0.5 * (t_s - from_s)))
        });
        before = Some((t_s, rate, turned));
        (t_s, turned)
    });
    rates.collect()
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;
    use crate::math::rotation::nearest_rotation;
    use crate::math::tests_support::Rng;

    const TEN_DEG: f64 = 0.174_532_925;

    #[test]
    fn one_axis_hides_what_is_about_and_along_it() {
        let mut rng = Rng::new(1);
        for axis in [Vector3::z(), rng.direction(), rng.direction()] {
            let motions = (0..40).map(|_| rng.range(-1.0, 1.0) * axis);
            let found = Excitation::of(motions).unwrap();
            for information in [found.rotation, found.translation] {
                assert!(information.is_singular() && information.worst_error().is_infinite());
                assert!(information.axes[0].cross(&axis).norm() < 1e-6, "{found:?}");
                let [_, middle, strong] = information.eigenvalues;
                assert!((middle - strong).abs() < 1e-9 * strong, "the others are shown alike");
            }
            assert_eq!(found.off_axis(0.1), 0);
        }
    }

    #[test]
    fn two_axes_show_everything_with_the_textbook_numbers() {
        // Ten rotations by a about x and ten about z: scatter a^2 diag(10, 0, 10), information a^2 diag(10, 20, 10).
        let a = 0.3;
        let motions = (0..20).map(|k| if k % 2 == 0 { Vector3::x() * a } else { Vector3::z() * a });
        let found = Excitation::of(motions).unwrap();
        let expected = [10.0, 10.0, 20.0];
        // |R - I|^2 across the axis is 2 (1 - cos a).
        for (information, unit) in [(found.rotation, a * a), (found.translation, 2.0 * (1.0 - a.cos()))] {
            assert!(!information.is_singular());
            for (value, expected) in information.eigenvalues.iter().zip(expected) {
                assert!((value - expected * unit).abs() < 1e-12, "{information:?}");
            }
            assert!((information.worst_error() - (10.0 * unit).sqrt().recip()).abs() < 1e-9);
        }
    }

    #[test]
    fn the_trace_is_twice_the_sum_of_squares_and_a_rotation_of_the_body_changes_no_eigenvalue() {
        let mut rng = Rng::new(2);
        let motions: Vec<_> = (0..50).map(|_| rng.in_ball(0.6)).collect();
        let found = Excitation::of(motions.clone()).unwrap();
        let squares: f64 = motions.iter().map(Vector3::norm_squared).sum();
        assert!((found.rotation.eigenvalues.iter().sum::<f64>() - 2.0 * squares).abs() < 1e-9);
        let turned = rng.rotation();
        let other = Excitation::of(motions.iter().map(|motion| turned * motion)).unwrap();
        for (a, b) in found.rotation.eigenvalues.iter().zip(other.rotation.eigenvalues) {
            assert!((a - b).abs() < 1e-9);
        }
    }

    /// The stated error is that of the least squares: by many solutions with noise.
    #[test]
    fn the_worst_error_is_that_of_a_solved_rotation() {
        let mut rng = Rng::new(3);
        // Much about z, little about x.
        let motions: Vec<_> = (0..60)
            .map(|k| {
                if k % 6 == 0 {
                    Vector3::x() * 0.2
                } else {
                    Vector3::z() * 0.3
                }
            })
            .collect();
        let found = Excitation::of(motions.clone()).unwrap();
        let (sigma, axis, runs) = (0.002, found.main_axis(), 2000);
        let mut squares = 0.0;
        for _ in 0..runs {
            let cross: Matrix3<f64> = motions
                .iter()
                .map(|a| (a + rng.normal3() * sigma) * a.transpose())
                .sum();
            let solved = nearest_rotation(&cross).unwrap().rotation;
            squares += solved.scaled_axis().dot(&axis).powi(2);
        }
        let ratio = (squares / f64::from(runs)).sqrt() / (sigma * found.rotation.worst_error());
        assert!((ratio - 1.0).abs() < 0.05, "{ratio}");
    }

    #[test]
    fn few_rotations_about_a_second_axis_are_counted() {
        let motions = (0..50).map(|k| {
            if k < 4 {
                Vector3::y() * TEN_DEG
            } else {
                Vector3::z() * TEN_DEG
            }
        });
        let found = Excitation::of(motions).unwrap();
        assert!((found.main_axis().z.abs() - 1.0).abs() < 1e-9);
        assert_eq!((found.count(), found.off_axis(0.5)), (50, 4));
        // Yaw on a road that rolls a little stays about z.
        let road = (0..50).map(|k| Vector3::new(0.03 * f64::from(k % 3 - 1), 0.0, TEN_DEG));
        assert_eq!(Excitation::of(road).unwrap().off_axis(0.5), 0);
    }

    #[test]
    fn a_rate_is_cut_into_rotations_of_the_same_size() {
        // 0.5 rad/s about y for 10 s.
        let rates = (0..=200).map(|k| (f64::from(k) * 0.05, Vector3::y() * 0.5));
        let orientations = integrated(rates);
        assert!(
            (orientations.last().unwrap().1.scaled_axis() - Vector3::y() * (5.0 - std::f64::consts::TAU)).norm() < 1e-9
        );
        let found = rotations(&orientations, TEN_DEG, 2.0);
        assert_eq!(found.len(), 28, "each after seven rows: 0.175 rad");
        assert!(
            found
                .iter()
                .all(|one| (one.vector - Vector3::y() * 0.175).norm() < 1e-9)
        );
        assert!((found[1].span_s[0] - 0.35).abs() < 1e-9 && (found[1].span_s[1] - 0.7).abs() < 1e-9);
        assert!(rotations(&orientations, TEN_DEG, 0.3).is_empty(), "too slow");
    }

    #[test]
    fn nothing_and_what_is_no_number_show_nothing() {
        assert_eq!(Excitation::of([]), None);
        assert_eq!(Excitation::of([Vector3::new(f64::NAN, 0.0, 0.0)]), None);
        assert!(Excitation::of([Vector3::zeros()]).unwrap().rotation.is_singular());
        assert!(rotations(&[], 0.1, 1.0).is_empty() && integrated([]).is_empty());
    }
}
