//! Rotation forms and matrix diagnosis against closed forms and a second method. Only compiled for tests.
#![allow(clippy::unwrap_used, clippy::panic, clippy::float_cmp)]
#![allow(clippy::approx_constant, clippy::excessive_precision)]

use std::f64::consts::{FRAC_PI_2, FRAC_PI_3, PI};

use nalgebra::{Matrix3, Matrix4, Point3, Quaternion, Rotation3, Translation3, UnitQuaternion, Vector3};
use proptest::prelude::*;

use super::rotation::*;
use super::tests_support::Rng;

/// Horn 1987: the nearest rotation is the top eigenvector of a 4x4, with no singular values and no sign to choose.
fn nearest_by_horn(m: &Matrix3<f64>) -> UnitQuaternion<f64> {
    let (a, b, c, d, e, f, g, h, i) = (m.m11, m.m12, m.m13, m.m21, m.m22, m.m23, m.m31, m.m32, m.m33);
    #[rustfmt::skip]
    let k = Matrix4::new(
        a + e + i, h - f,     c - g,      d - b,
        h - f,     a - e - i, b + d,      c + g,
        c - g,     b + d,     -a + e - i, f + h,
        d - b,     c + g,     f + h,      -a - e + i,
    );
    let eigen = k.symmetric_eigen();
    let top = eigen.eigenvalues.imax();
    let v = eigen.eigenvectors.column(top).into_owned();
    UnitQuaternion::from_quaternion(Quaternion::new(v.x, v.y, v.z, v.w))
}

fn distance(a: &UnitQuaternion<f64>, b: &Rotation3<f64>) -> f64 {
    (a.to_rotation_matrix().matrix() - b.matrix()).norm()
}

#[test]
fn rpy_is_the_product_that_urdf_states() {
    let (r, p, y) = (0.3, -0.7, 2.1);
    let product =
        Rotation3::new(Vector3::z() * y) * Rotation3::new(Vector3::y() * p) * Rotation3::new(Vector3::x() * r);
    assert!(distance(&from_rpy(r, p, y), &product) < 1e-14);
    // At the poles only one angle is defined, and yaw is the one set to zero.
    for pitch in [FRAC_PI_2, -FRAC_PI_2] {
        let q = from_rpy(0.4, pitch, 1.1);
        let (roll, back, yaw) = to_rpy(&q);
        assert!((back - pitch).abs() < 1e-7 && yaw == 0.0);
        assert!(rotation_angle_between(&q, &from_rpy(roll, back, yaw)) < 1e-7);
    }
}

#[test]
fn the_angle_is_accurate_where_an_arccosine_is_not() {
    for angle in [0.0, 1e-12, 1e-8, 1e-4, 1.0, PI - 1e-8, PI] {
        let axis = Vector3::new(0.36, 0.48, -0.8);
        let a = from_rpy(0.3, 0.2, -1.0);
        let b = a * UnitQuaternion::from_scaled_axis(axis * angle);
        assert!(
            (rotation_angle_between(&a, &b) - angle).abs() < 1e-15 + 4e-16 * angle.max(1.0),
            "{angle}"
        );
        let negated = UnitQuaternion::new_unchecked(-b.into_inner());
        assert!((rotation_angle_between(&a, &negated) - angle).abs() < 1e-15 + 4e-16 * angle.max(1.0));
    }
}

#[test]
fn a_published_matrix_is_proper() {
    // EuRoC MAV cam0 T_BS, 12 digits.
    let m = Matrix3::new(
        0.014_865_542_981_8,
        -0.999_880_929_698,
        0.004_140_296_794_22,
        0.999_557_249_008,
        0.014_967_213_324_7,
        0.025_715_529_948,
        -0.025_774_436_697_4,
        0.003_756_188_357_97,
        0.999_660_727_178,
    );
    assert_eq!(
        diagnose(&m, allowed_orthogonality_error(&m), &Rotation3::identity()),
        Diagnosis::Proper
    );
    assert!(orthogonality_error(&m) < 1e-11 && (det(&m) - 1.0).abs() < 1e-11);
    let nearest = nearest_rotation(&m).unwrap();
    assert!(nearest.distance < 1e-11 && nearest.angle_moved_rad < 1e-11);
    assert!(distance(&nearest_by_horn(&m), &nearest.rotation) < 1e-12);
}

#[test]
fn a_mirror_is_named_relative_to_what_is_known() {
    let truth = *from_rpy(0.4, -0.3, 1.2).to_rotation_matrix().matrix();
    let reference = *from_rpy(0.41, -0.3, 1.19).to_rotation_matrix().matrix();
    let reference = Rotation3::from_matrix_unchecked(reference);
    for &flip in Flip::all() {
        let mirrored = flip.undo(&truth);
        assert!((det(&mirrored) + 1.0).abs() < 1e-12 && orthogonality_error(&mirrored) < 1e-12);
        match diagnose(&mirrored, 1e-6, &reference) {
            Diagnosis::Reflection {
                flip: found,
                residual_rad,
            } => {
                assert_eq!(found, flip);
                assert!(residual_rad < 0.02);
            }
            other => panic!("{flip:?}: {other:?}"),
        }
        assert_eq!(flip.undo(&mirrored), truth);
    }
    // With no reference: a plain negated y axis, and two exchanged axes.
    let simple = Matrix3::from_diagonal(&Vector3::new(1.0, -1.0, 1.0));
    let at_identity = |m: &Matrix3<f64>| diagnose(m, 1e-6, &Rotation3::identity());
    assert_eq!(
        at_identity(&simple),
        Diagnosis::Reflection {
            flip: Flip::ColumnY,
            residual_rad: 0.0
        }
    );
    let swapped = Matrix3::new(0., 1., 0., 1., 0., 0., 0., 0., 1.);
    assert_eq!(
        at_identity(&swapped),
        Diagnosis::Reflection {
            flip: Flip::SwapXY,
            residual_rad: 0.0
        }
    );
}

#[test]
fn what_is_no_rotation_gets_its_name() {
    let r = *from_rpy(0.4, -0.3, 1.2).to_rotation_matrix().matrix();
    let of = |m: Matrix3<f64>| diagnose(&m, 1e-4, &Rotation3::identity());
    match of(r * 1000.0) {
        Diagnosis::Scaled { factor } => assert!((factor - 1000.0).abs() < 1e-9),
        other => panic!("{other:?}"),
    }
    assert!(matches!(of(r * 1.01), Diagnosis::Scaled { .. }));
    assert_eq!(of(Matrix3::zeros()), Diagnosis::NotOrthogonal);
    assert_eq!(
        of(Matrix3::from_diagonal(&Vector3::new(1.0, 1.0, 1.02)) * r),
        Diagnosis::NotOrthogonal
    );
    assert_eq!(of(r * f64::NAN), Diagnosis::NotFinite);
    let camera_matrix = Matrix3::new(458.654, 0., 367.215, 0., 457.296, 248.375, 0., 0., 1.);
    assert_eq!(of(camera_matrix), Diagnosis::NotOrthogonal);
    assert_eq!(nearest_rotation(&Matrix3::zeros()).map(|n| n.distance), None);
    assert_eq!(nearest_rotation(&(r * f64::INFINITY)).map(|n| n.distance), None);
    let [s1, s2, s3] = singular_values(&Matrix3::from_diagonal(&Vector3::new(2.0, 5.0, 3.0))).unwrap();
    assert!((s1 - 5.0).abs() < 1e-12 && (s2 - 3.0).abs() < 1e-12 && (s3 - 2.0).abs() < 1e-12);
    assert_eq!(of(r * 1e200), Diagnosis::NotOrthogonal);
    assert_eq!(of(r * 1e-200), Diagnosis::NotOrthogonal);
}

#[test]
fn flipping_all_off_diagonals_is_no_rotation_while_a_transpose_is() {
    // Some texts say that this is what a JPL quaternion does; it is not.
    let mut rng = Rng::new(5);
    let mut errors: Vec<f64> = Vec::new();
    for _ in 0..2000 {
        let r = *rng.rotation().to_rotation_matrix().matrix();
        assert!((det(&r.transpose()) - 1.0).abs() < 1e-12);
        let diagonal = Matrix3::from_diagonal(&r.diagonal());
        errors.push(orthogonality_error(&(diagonal * 2.0 - r)));
    }
    let median = super::stats::median(&errors).unwrap();
    assert!((median - 1.25).abs() < 0.06, "{median}");
}

#[test]
fn decimals_are_counted_on_the_shortest_form() {
    let cases = [
        (0.0356, 4),
        (3.559_999_999_999_999_970e-02, 4),
        (1e-7, 7),
        (1.5e-10, 11),
        (5.0, 0),
        (-0.25, 2),
        (1e300, 0),
        (0.0, 0),
        (f64::NAN, 0),
        (f64::INFINITY, 0),
        (0.1, 1),
        (-1.570_796_326_794_896_6, 16),
    ];
    for (value, decimals) in cases {
        assert_eq!(decimals_of(value), decimals, "{value}");
    }
    assert_eq!(deciding_decimals([1.0, 0.0, 0.05, -1.0]), None);
    assert_eq!(deciding_decimals([0.5, 0.866_025, 0.012]), Some(6));
    assert!((expected_rounding_error(3) - 3e-3).abs() < 1e-18);
    assert_eq!(expected_rounding_error(u32::MAX), 0.0);
}

#[test]
fn a_small_angle_rotation_of_six_decimals_is_caught() {
    // FORMATS.md section 3: the smallest real fault, Frobenius 5.9e-4 at six decimals; a first-order rotation has it.
    let w = 0.0204;
    let m = Matrix3::new(1.0, -w, 0.0, w, 1.0, 0.1 * w, 0.0, -0.1 * w, 1.0);
    assert!((orthogonality_error(&m) - 5.9e-4).abs() < 1e-5);
    assert!(orthogonality_error(&m) > allowed_orthogonality_error(&m));
    assert_eq!(allowed_orthogonality_error(&Matrix3::identity()), 2e-6);
    assert_eq!(allowed_quaternion_norm_error([0.0, 0.0, 0.707, 0.707]), 1e-3);
    assert_eq!(allowed_quaternion_norm_error([0.5, 0.5, 0.5, 0.5]), 1e-6);
    assert_eq!(quaternion_norm([0.0, 3.0, 0.0, 4.0]), 5.0);
    assert!(!quaternion_norm([0.0, f64::NAN, 0.0, 4.0]).is_finite());
    // Cos 60 degrees is exactly 0.5: it must not excuse an error in the others.
    let r = *from_rpy(0.0, 0.0, FRAC_PI_3).to_rotation_matrix().matrix();
    assert_eq!(allowed_orthogonality_error(&r.map(|v| (v * 1e6).round() / 1e6)), 3e-6);
}

fn rounded(m: &Matrix3<f64>, decimals: i32) -> Matrix3<f64> {
    let unit = 10f64.powi(decimals);
    m.map(|v| (v * unit).round() / unit)
}

proptest! {
    #[test]
    fn rpy_goes_there_and_back(roll in -PI..PI, pitch in -1.57f64..1.57, yaw in -PI..PI) {
        let q = from_rpy(roll, pitch, yaw);
        let (r, p, y) = to_rpy(&q);
        prop_assert!(rotation_angle_between(&q, &from_rpy(r, p, y)) < 1e-12);
        prop_assert!((r - roll).abs() < 1e-9 && (p - pitch).abs() < 1e-9 && (y - yaw).abs() < 1e-9);
    }

    #[test]
    fn the_nearest_rotation_is_horns(seed in any::<u64>(), noise in 0.0f64..0.5, scale in 0.01f64..100.0) {
        let mut rng = Rng::new(seed);
        let r = *rng.rotation().to_rotation_matrix().matrix();
        let m = (r + Matrix3::from_columns(&[rng.normal3(), rng.normal3(), rng.normal3()]) * noise) * scale;
        let [s1, s2, s3] = singular_values(&m).unwrap();
        prop_assert!(s1 >= s2 && s2 >= s3);
        prop_assert!((s1 * s2 * s3 - det(&m).abs()).abs() < 1e-9 * s1 * s1 * s1);
        prop_assert!((s1.hypot(s2).hypot(s3) - m.norm()).abs() < 1e-9 * s1);
        // Near a tie of the two smallest (with a negative determinant) no single rotation is nearest.
        prop_assume!(s2 + s3 * det(&m).signum() > 1e-3 * s1);
        let nearest = nearest_rotation(&m).unwrap();
        prop_assert!(orthogonality_error(nearest.rotation.matrix()) < 1e-12 && det(nearest.rotation.matrix()) > 0.0);
        prop_assert!(distance(&nearest_by_horn(&m), &nearest.rotation) < 1e-8);
    }

    #[test]
    fn rounding_is_always_excused(seed in any::<u64>(), decimals in 3i32..9) {
        let r = *Rng::new(seed).rotation().to_rotation_matrix().matrix();
        let m = rounded(&r, decimals);
        prop_assert!(orthogonality_error(&m) <= expected_rounding_error(u32::try_from(decimals).unwrap()) * 1.001);
        prop_assert_eq!(diagnose(&m, allowed_orthogonality_error(&m), &Rotation3::identity()), Diagnosis::Proper);
    }
}

#[test]
fn a_translation_stated_apart_is_the_origin_of_one_frame_in_the_other() {
    // A quarter turn about z takes x to y.
    let rotation = UnitQuaternion::from_axis_angle(&Vector3::z_axis(), FRAC_PI_2);
    let translation = Translation3::new(1.0, 2.0, 3.0);
    let near = |a: Point3<f64>, b: Point3<f64>| assert!((a - b).norm() < 1e-12, "{a} {b}");
    let straight = pose_of_halves(rotation, translation, false);
    near(straight * Point3::origin(), Point3::new(1.0, 2.0, 3.0));
    near(straight * Point3::new(1.0, 0.0, 0.0), Point3::new(1.0, 3.0, 3.0));
    // The target's origin lies at (1, 2, 3) of the source; seen from the target, the source's lies at -R (1, 2, 3).
    let turned = pose_of_halves(rotation, translation, true);
    near(turned * Point3::new(1.0, 2.0, 3.0), Point3::origin());
    near(turned * Point3::origin(), Point3::new(2.0, -1.0, -3.0));
}

#[test]
fn a_turn_about_an_axis_is_named_by_it() {
    assert_eq!(turn_in_words(&from_rpy(PI, 0.0, 0.0)), "180.0 deg about x");
    assert_eq!(turn_in_words(&from_rpy(0.0, 0.0, -FRAC_PI_2)), "-90.0 deg about z");
    assert_eq!(
        turn_in_words(&from_rpy(FRAC_PI_2, 0.0, FRAC_PI_2)),
        "RPY(90, 0, 90) deg"
    );
}
