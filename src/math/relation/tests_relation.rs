//! The dictionary itself: words, algebra in closed form, published examples, exact files, bad input.
#![allow(clippy::unwrap_used, clippy::float_cmp, clippy::too_many_lines)]

use std::collections::BTreeSet;
use std::f64::consts::{FRAC_PI_2, PI};

use nalgebra::{Isometry3, Matrix3, Rotation3, Translation3, UnitQuaternion, Vector3};
use proptest::prelude::*;

use super::tests_setup::Mount;
use super::{Relation, Tolerance, classify, classify_rotation};
use crate::math::rotation::{from_rpy, rotation_angle_between, to_rpy};
use crate::math::tests_support::Rng;

fn pose(xyz: [f64; 3], rotation: UnitQuaternion<f64>) -> Isometry3<f64> {
    Isometry3::from_parts(Translation3::from(Vector3::from(xyz)), rotation)
}

#[track_caller]
fn assert_same(a: &Isometry3<f64>, b: &Isometry3<f64>, least: f64, what: &str) {
    let angle = rotation_angle_between(&a.rotation, &b.rotation);
    let distance = (a.translation.vector - b.translation.vector).norm();
    assert!(angle < least && distance < least, "{what}: {angle} rad, {distance} m");
}

#[test]
fn words_are_distinct_and_stable() {
    let words: BTreeSet<&str> = Relation::all().iter().map(|relation| relation.word()).collect();
    assert_eq!(words.len(), Relation::all().len());
    for word in [
        "equal",
        "inverse",
        "transposed",
        "wxyz",
        "z180",
        "ned-enu",
        "flu-frd",
        "optical",
        "degrees",
        "millimetres",
    ] {
        assert!(words.contains(word), "{word}");
    }
    for &relation in Relation::all() {
        assert_eq!(Relation::from_word(relation.word()), Some(relation));
        assert!(
            relation
                .word()
                .chars()
                .all(|c| c.is_ascii_lowercase() || c.is_ascii_digit() || c == '-')
        );
        assert!(relation.describe().ends_with('.') && relation.describe().len() > 25);
    }
    assert_eq!(Relation::from_word("x180"), Some(Relation::FluFrd));
    assert_eq!(Relation::from_word("nonsense"), None);
    assert_eq!(Relation::all().first(), Some(&Relation::Equal));
}

/// The maps written down a second time, as matrices and as numbers, where `apply.rs` uses quaternions.
#[test]
fn every_map_is_what_its_name_says() {
    let mut rng = Rng::new(31);
    for _ in 0..20 {
        let truth = Mount::Generic.draw(&mut rng);
        let r = *truth.rotation.to_rotation_matrix().matrix();
        let t = truth.translation.vector;
        let (roll, pitch, yaw) = to_rpy(&truth.rotation);
        let turn = |axis: Vector3<f64>, angle: f64| *Rotation3::new(axis * angle).matrix();
        let (x, y, z) = (Vector3::x(), Vector3::y(), Vector3::z());
        let p = Matrix3::new(0., 1., 0., 1., 0., 0., 0., 0., -1.);
        let f = Matrix3::new(1., 0., 0., 0., -1., 0., 0., 0., -1.);
        let o = Matrix3::new(0., 0., 1., -1., 0., 0., 0., -1., 0.);
        let zz = Matrix3::new(-1., 0., 0., 0., -1., 0., 0., 0., 1.);
        let (my, mz) = (
            Matrix3::from_diagonal(&Vector3::new(1., -1., 1.)),
            Matrix3::from_diagonal(&Vector3::new(1., 1., -1.)),
        );
        let same = Matrix3::identity();
        let expected = [
            (Relation::Equal, r, t),
            (Relation::Inverse, r.transpose(), -(r.transpose() * t)),
            (Relation::Transposed, r.transpose(), t),
            (Relation::RotationLost, same, t),
            (Relation::TranslationLost, r, t * 0.0),
            (Relation::TranslationNegated, r, -t),
            (Relation::InverseTranslation, r, -(r.transpose() * t)),
            (Relation::Millimetres, r, t * 1e3),
            (Relation::Metres, r, t * 1e-3),
            (Relation::Z180, r * zz, t),
            (Relation::NedEnu, r * p, t),
            (Relation::FluFrd, r * f, t),
            (Relation::Optical, r * o, t),
            (Relation::OpticalInverse, r * o.transpose(), t),
            (Relation::Z90, r * turn(z, FRAC_PI_2), t),
            (Relation::ZMinus90, r * turn(z, -FRAC_PI_2), t),
            (Relation::Y180, r * turn(y, PI), t),
            (Relation::X90, r * turn(x, FRAC_PI_2), t),
            (Relation::XMinus90, r * turn(x, -FRAC_PI_2), t),
            (Relation::Y90, r * turn(y, FRAC_PI_2), t),
            (Relation::YMinus90, r * turn(y, -FRAC_PI_2), t),
            (Relation::LeftZ180, zz * r, zz * t),
            (Relation::LeftNedEnu, p * r, p * t),
            (Relation::LeftFluFrd, f * r, f * t),
            (Relation::LeftOptical, o * r, o * t),
            (Relation::LeftOpticalInverse, o.transpose() * r, o.transpose() * t),
            (Relation::LeftZ90, turn(z, FRAC_PI_2) * r, turn(z, FRAC_PI_2) * t),
            (Relation::LeftZMinus90, turn(z, -FRAC_PI_2) * r, turn(z, -FRAC_PI_2) * t),
            (Relation::EnuFluNedFrd, p * r * f, p * t),
            (Relation::BothFluFrd, f * r * f, f * t),
            (Relation::BothNedEnu, p * r * p, p * t),
            (Relation::RpyRotating, turn(x, roll) * turn(y, pitch) * turn(z, yaw), t),
            (Relation::Ypr, turn(z, roll) * turn(y, pitch) * turn(x, yaw), t),
            (Relation::MirroredY, my * r * my, my * t),
            (Relation::MirroredZ, mz * r * mz, mz * t),
            (Relation::InverseZ180, r.transpose() * zz, -(r.transpose() * t)),
            (Relation::Z180Inverse, zz * r.transpose(), -(zz * r.transpose() * t)),
            (Relation::AppliedTwice, r * r, r * t + t),
        ];
        for (relation, rotation, translation) in expected {
            let rotation = UnitQuaternion::from_rotation_matrix(&Rotation3::from_matrix_unchecked(rotation));
            let expected = Isometry3::from_parts(translation.into(), rotation);
            assert_same(&relation.apply(&truth).unwrap(), &expected, 1e-12, relation.word());
        }
        // The rest by numbers.
        let q = truth.rotation.coords; // x, y, z, w
        let wxyz = Relation::Wxyz.apply(&truth).unwrap().rotation.coords;
        assert_eq!([wxyz.w, wxyz.x, wxyz.y, wxyz.z], [q.x, q.y, q.z, q.w]);
        let degrees = Relation::Degrees.apply(&truth).unwrap().rotation;
        let k = 180.0 / PI;
        let expected = turn(z, yaw * k) * turn(y, pitch * k) * turn(x, roll * k);
        assert!((degrees.to_rotation_matrix().matrix() - expected).norm() < 1e-10);
    }
}

#[test]
fn a_relation_and_its_reverse_cancel() {
    let mut rng = Rng::new(32);
    for _ in 0..50 {
        let truth = Mount::Generic.draw(&mut rng);
        for &relation in Relation::all() {
            let Some(reverse) = relation.reversed() else {
                continue;
            };
            let back = reverse.apply(&relation.apply(&truth).unwrap()).unwrap();
            assert_same(&back, &truth, 1e-6, relation.word());
        }
    }
}

#[test]
fn exact_files_give_their_relation_and_nothing_simpler() {
    // A camera to the left of a tilted lidar: no symmetry, so most words stand alone.
    let truth = pose([1.2, -0.4, 0.7], from_rpy(0.31, -0.22, 1.13));
    for &relation in Relation::all() {
        let held = relation.apply(&truth).unwrap();
        let answer = classify(&truth, &held, &Tolerance::default());
        assert!(
            answer.score < 1e-6 && answer.residual_angle_rad < 1e-7 && answer.residual_m < 1e-9,
            "{relation}"
        );
        assert_eq!(answer.best, Some(relation), "{:?}", answer.class);
        assert_eq!(answer.class.first(), Some(&relation));
        assert_eq!(answer.error(), Some(relation).filter(|&r| r != Relation::Equal));
    }
}

#[test]
fn the_plain_word_is_preferred_where_left_and_right_agree() {
    // A quarter turn about z at the origin: a turn of the source or of the target frame is the same.
    let truth = pose([0.0, 0.0, 1.5], from_rpy(0.0, 0.0, FRAC_PI_2));
    let answer = classify(
        &truth,
        &Relation::LeftZ180.apply(&truth).unwrap(),
        &Tolerance::default(),
    );
    // Yaw 90 and -90 degrees: as well a transposed rotation, which is simpler.
    assert_eq!(answer.best, Some(Relation::Transposed));
    for relation in [Relation::Z180, Relation::LeftZ180] {
        assert!(answer.class.contains(&relation), "{relation}");
    }
    let truth = pose([0.0, 0.0, 1.5], from_rpy(0.0, 0.0, 0.7));
    let answer = classify(
        &truth,
        &Relation::LeftZ180.apply(&truth).unwrap(),
        &Tolerance::default(),
    );
    assert_eq!(answer.best, Some(Relation::Z180));
    assert!(answer.class.contains(&Relation::LeftZ180));
}

/// JPL and Hamilton quaternions of one rotation have opposite vector parts: a transpose, and still proper.
#[test]
fn jpl_read_as_hamilton_is_transposed() {
    let truth = pose([0.4, 0.1, -0.2], from_rpy(0.5, -0.3, 1.9));
    let jpl = pose([0.4, 0.1, -0.2], truth.rotation.conjugate());
    assert_eq!(
        classify(&truth, &jpl, &Tolerance::default()).best,
        Some(Relation::Transposed)
    );
    let alone = classify_rotation(&truth.rotation, &jpl.rotation, &Tolerance::default());
    assert_eq!(alone.best, Some(Relation::Inverse));
    assert!(alone.class.contains(&Relation::Transposed));
}

/// EuRoC MAV cam0: `T_BS` of sensor.yaml (ETH ASL), and `T_cam_imu` of Kalibr as MSCKF-VIO ships it: its inverse.
#[test]
fn euroc_body_from_camera_against_camera_from_imu() {
    let rotation = |m: Matrix3<f64>| UnitQuaternion::from_rotation_matrix(&Rotation3::from_matrix_unchecked(m));
    let body_from_cam = pose(
        [-0.021_640_145_497_5, -0.064_676_986_768, 0.009_810_730_589_49],
        rotation(Matrix3::new(
            0.014_865_542_981_8,
            -0.999_880_929_698,
            0.004_140_296_794_22,
            0.999_557_249_008,
            0.014_967_213_324_7,
            0.025_715_529_948,
            -0.025_774_436_697_4,
            0.003_756_188_357_97,
            0.999_660_727_178,
        )),
    );
    let cam_from_imu = pose(
        [0.065_222_909_535_531, -0.020_706_385_492_719, -0.008_054_602_460_030],
        rotation(Matrix3::new(
            0.014_865_542_981_794,
            0.999_557_249_008_346,
            -0.025_774_436_697_440,
            -0.999_880_929_698_575,
            0.014_967_213_324_719,
            0.003_756_188_357_967,
            0.004_140_296_794_224,
            0.025_715_529_947_966,
            0.999_660_727_177_902,
        )),
    );
    let answer = classify(&body_from_cam, &cam_from_imu, &Tolerance::default());
    assert_eq!(answer.best, Some(Relation::Inverse));
    // The lever arm of 7 cm is enough to tell it from the transpose, which leaves 10 cm.
    assert!(!answer.class.contains(&Relation::Transposed), "{:?}", answer.class);
    assert!(answer.residual_m < 1e-9 && answer.residual_angle_rad < 1e-9);
    assert_same(
        &Relation::Inverse.apply(&body_from_cam).unwrap(),
        &cam_from_imu,
        1e-9,
        "inverse",
    );
}

/// Ouster: `sensor` and `lidar` frame differ by Rz(180) and 36.18 mm (ouster-sdk, OS1 metadata).
#[test]
fn ouster_sensor_read_as_lidar_is_z180() {
    let truth = pose([0.8, 0.0, 1.9], from_rpy(0.0, 0.05, 0.4));
    let sensor_from_lidar = pose([0.0, 0.0, 0.036_18], from_rpy(0.0, 0.0, PI));
    let answer = classify(&truth, &(truth * sensor_from_lidar), &Tolerance::default());
    assert_eq!(answer.best, Some(Relation::Z180));
    assert!((answer.residual_m - 0.036_18).abs() < 1e-9);
}

#[test]
fn two_degrees_are_the_end() {
    let truth = pose([1.2, -0.4, 0.7], from_rpy(0.31, -0.22, 1.13));
    let at = |degrees: f64| {
        let turn = UnitQuaternion::from_scaled_axis(Vector3::new(0.6, 0.0, 0.8) * degrees.to_radians());
        let held = truth.inverse();
        classify(
            &truth,
            &pose(held.translation.vector.into(), turn * held.rotation),
            &Tolerance::default(),
        )
    };
    assert_eq!(at(1.95).best, Some(Relation::Inverse));
    let past = at(2.05);
    assert_eq!((past.best, past.class.len(), past.withheld.len()), (None, 0, 0));
    assert!(past.angle_rad > 0.2 && past.residual_angle_rad == past.angle_rad);
}

#[test]
fn numbers_that_are_not_finite_have_no_relation() {
    let good = pose([1.0, 2.0, 3.0], from_rpy(0.1, 0.2, 0.3));
    let bad = pose([f64::NAN, 0.0, 0.0], UnitQuaternion::identity());
    let far = pose([1e308, 1e308, 0.0], UnitQuaternion::identity());
    for (a, b) in [(good, bad), (bad, good), (bad, bad)] {
        assert_eq!(classify(&a, &b, &Tolerance::default()).best, None);
        assert_eq!(Relation::Equal.apply(&bad), None);
    }
    assert_eq!(Relation::Millimetres.apply(&far), None);
    classify(&good, &far, &Tolerance::default());
    classify(&far, &far, &Tolerance::default());
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    /// The answer is consistent whatever the input: `best` leads its class, `Equal` shares no class with a named error,
    /// what is named fits, and a transform always equals itself.
    #[test]
    fn answers_are_consistent(seed in any::<u64>(), degrees in 0.0f64..20.0, shift in 0.0f64..0.5, pick in any::<prop::sample::Index>()) {
        let mut rng = Rng::new(seed);
        let tol = Tolerance::default();
        let t1 = Mount::NearNominal.draw(&mut rng);
        let held = pick.get(Relation::all()).apply(&t1).unwrap();
        let t2 = rng.misaligned(&held, degrees.to_radians(), shift / 3.0);
        prop_assert_eq!(classify(&t1, &t1, &tol).best, Some(Relation::Equal));
        let answer = classify(&t1, &t2, &tol);
        match answer.best {
            None => prop_assert!(answer.class.is_empty() && answer.residual_angle_rad == answer.angle_rad),
            Some(best) => {
                prop_assert_eq!(answer.class.first(), Some(&best));
                prop_assert!(answer.withheld.is_empty());
                prop_assert!(answer.residual_angle_rad <= tol.angle_rad);
                prop_assert!(best == Relation::Equal || !answer.class.contains(&Relation::Equal));
            }
        }
        prop_assert_eq!(classify(&t1, &t2, &tol), answer);
    }
}
