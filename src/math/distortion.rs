//! Lens distortion: how far from its centre a model of it can be used.
//!
//! Owns the radial part of the models of ROS and OpenCV. Must not know messages. Radii are of the normalised image (metres
//! at a depth of one metre, that is pixels over focal length); angles are from the optical axis, radians.
//! Source: OpenCV, Camera Calibration and 3D Reconstruction; Fisheye camera model (Kannala and Brandt 2006).

/// The radial part of a model.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum RadialModel {
    /// `plumb_bob` (Brown and Conrady): k1, k2, k3.
    PlumbBob([f64; 3]),
    /// `rational_polynomial`: k1 to k6.
    Rational([f64; 6]),
    /// `equidistant`, `fisheye`: k1 to k4, of the angle.
    Fisheye([f64; 4]),
}

/// How far a model can be used.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Reach {
    /// Up to the requested radius, at which this angle is imaged.
    Whole {
        /// From the optical axis, radians.
        angle_rad: f64,
    },
    /// Up to this radius in the distorted image: from there on a larger angle is imaged further in, or not
    /// at all.
    Folds {
        /// The largest distorted radius, normalised.
        radius: f64,
        /// Where it is reached, from the optical axis, radians.
        angle_rad: f64,
    },
}

/// Angles that are tried from the axis to the side.
const STEPS: u32 = 4000;

impl RadialModel {
    /// The radius in the distorted image of what is seen at an angle.
    pub fn distorted(&self, angle_rad: f64) -> f64 {
        let even = |x: f64, k: &[f64]| k.iter().rev().fold(0.0, |sum, k| (sum + k) * x);
        match self {
            Self::PlumbBob(k) => {
                let r = angle_rad.tan();
                r * (1.0 + even(r * r, k))
            }
            Self::Rational([k1, k2, k3, k4, k5, k6]) => {
                let r = angle_rad.tan();
                r * (1.0 + even(r * r, &[*k1, *k2, *k3])) / (1.0 + even(r * r, &[*k4, *k5, *k6]))
            }
            Self::Fisheye(k) => angle_rad * (1.0 + even(angle_rad * angle_rad, k)),
        }
    }

    /// The largest angle that the model is defined at, radians.
    fn widest_rad(&self) -> f64 {
        match self {
            Self::PlumbBob(_) | Self::Rational(_) => std::f64::consts::FRAC_PI_2,
            Self::Fisheye(_) => std::f64::consts::PI,
        }
    }

    /// How far the model can be used on the way to a radius of the distorted image. `None` where it is not finite.
    pub fn reach(&self, to_radius: f64) -> Option<Reach> {
        let (mut radius, mut angle_rad) = (0.0, 0.0);
        for step in 1..STEPS {
            let next_rad = self.widest_rad() * f64::from(step) / f64::from(STEPS);
            let next = self.distorted(next_rad);
            if !next.is_finite() || !to_radius.is_finite() {
                return None;
            }
            if next <= radius {
                return Some(Reach::Folds { radius, angle_rad });
            }
            if next >= to_radius {
                return Some(Reach::Whole { angle_rad: next_rad });
            }
            (radius, angle_rad) = (next, next_rad);
        }
        Some(Reach::Folds { radius, angle_rad })
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, clippy::panic)]
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn a_cubic_folds_where_its_derivative_is_zero() {
        // r (1 + k r^2) has its largest value at r = 1 / sqrt(-3 k), two thirds of that r.
        for k1 in [-0.1_f64, -0.3, -0.45] {
            let at = 1.0 / (-3.0 * k1).sqrt();
            let radial = RadialModel::PlumbBob([k1, 0.0, 0.0]);
            let Some(Reach::Folds { radius, angle_rad }) = radial.reach(10.0) else {
                panic!("{k1}")
            };
            assert!((radius - at * 2.0 / 3.0).abs() < 1e-5, "{k1}: {radius}");
            assert!((angle_rad.tan() - at).abs() < 2e-3, "{k1}: {angle_rad}");
            let Some(Reach::Whole { angle_rad }) = radial.reach(0.9 * radius) else {
                panic!("{k1}")
            };
            assert!((radial.distorted(angle_rad) - 0.9 * radius).abs() < 1e-3);
        }
    }

    #[test]
    fn a_pinhole_reaches_any_radius_at_its_own_angle() {
        for radius in [0.2_f64, 1.0, 3.0] {
            let pinhole = RadialModel::PlumbBob([0.0; 3]).reach(radius);
            let Some(Reach::Whole { angle_rad }) = pinhole else {
                panic!("{radius}")
            };
            assert!((angle_rad - radius.atan()).abs() < 1e-3, "{radius}");
        }
        assert_eq!(RadialModel::PlumbBob([f64::NAN, 0.0, 0.0]).reach(1.0), None);
    }

    #[test]
    fn an_equidistant_lens_sees_behind_itself() {
        let Some(Reach::Whole { angle_rad }) = RadialModel::Fisheye([0.0; 4]).reach(1.75) else {
            panic!("it reaches 1.75 rad")
        };
        assert!((angle_rad - 1.75).abs() < 1e-3);
        let beyond = RadialModel::Fisheye([0.0; 4]).reach(4.0);
        assert!(matches!(beyond, Some(Reach::Folds { radius, .. }) if (radius - std::f64::consts::PI).abs() < 1e-2));
    }

    #[test]
    fn the_models_are_those_of_opencv() {
        // Worked out from the formulas of OpenCV's manual at r = 0.5 and theta = 0.9, with another program.
        let half = 0.5_f64.atan();
        let near = |a: f64, b: f64| (a - b).abs() < 1e-12;
        let found = RadialModel::PlumbBob([-0.28, 0.07, 0.01]).distorted(half);
        assert!(near(found, 0.467_265_625), "{found}");
        let found = RadialModel::Rational([8.0, 4.5, 0.2, 8.3, 6.6, 1.1]).distorted(half);
        assert!(near(found, 0.468_568_880_962_995_9), "{found}");
        let found = RadialModel::Fisheye([-0.02, 0.004, -0.003, 0.0005]).distorted(0.9);
        assert!(near(found, 0.886_540_779_544_500_1), "{found}");
    }

    #[test]
    fn a_quotient_that_falls_again_folds_at_its_top() {
        // r / (1 + r^2) has its largest value, a half, at r = 1.
        let Some(Reach::Folds { radius, angle_rad }) = RadialModel::Rational([0.0, 0.0, 0.0, 1.0, 0.0, 0.0]).reach(2.0)
        else {
            panic!("it folds")
        };
        assert!(
            (radius - 0.5).abs() < 1e-6 && (angle_rad - 1.0_f64.atan()).abs() < 1e-3,
            "{radius} {angle_rad}"
        );
        // r / (1 - r^2) has a pole at r = 1: every radius is reached before.
        let Some(Reach::Whole { angle_rad }) = RadialModel::Rational([0.0, 0.0, 0.0, -1.0, 0.0, 0.0]).reach(100.0)
        else {
            panic!("it reaches the pole")
        };
        assert!(angle_rad < 1.0_f64.atan());
    }

    proptest! {
        #[test]
        fn up_to_where_a_model_folds_it_only_grows(k in prop::array::uniform4(-0.5..0.5), to in 0.1..3.0) {
            for radial in [RadialModel::PlumbBob([k[0], k[1], k[2]]), RadialModel::Fisheye(k)] {
                let (end_rad, most) = match radial.reach(to) {
                    Some(Reach::Whole { angle_rad }) => (angle_rad, f64::INFINITY),
                    Some(Reach::Folds { radius, angle_rad }) => (angle_rad, radius + 1e-12),
                    None => continue,
                };
                let mut last = 0.0;
                for step in 1..200 {
                    let radius = radial.distorted(end_rad * f64::from(step) / 200.0);
                    prop_assert!(radius >= last && radius <= most, "{radial:?} {radius} {last}");
                    last = radius;
                }
            }
        }

        #[test]
        fn any_numbers_end_without_panic(k in prop::array::uniform6(prop::num::f64::ANY), to in prop::num::f64::ANY) {
            let _ = RadialModel::Rational(k).reach(to);
            let _ = RadialModel::PlumbBob([k[0], k[1], k[2]]).reach(to);
            let _ = RadialModel::Fisheye([k[0], k[1], k[2], k[3]]).reach(to);
        }
    }

    #[test]
    fn the_quotient_of_equal_polynomials_is_a_pinhole() {
        let radial = RadialModel::Rational([0.3, -0.2, 0.1, 0.3, -0.2, 0.1]);
        for angle_rad in [0.1_f64, 0.5, 1.0] {
            assert!((radial.distorted(angle_rad) - angle_rad.tan()).abs() < 1e-12);
        }
        let plain = RadialModel::PlumbBob([0.3, -0.2, 0.1]);
        let same = RadialModel::Rational([0.3, -0.2, 0.1, 0.0, 0.0, 0.0]);
        assert!((plain.distorted(0.7) - same.distorted(0.7)).abs() < 1e-12);
    }
}
