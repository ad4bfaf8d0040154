//! Is silence kept when there is no convention error? Monte Carlo, seeded: the mounts of `tests_setup.rs`.
#![allow(clippy::print_stdout)]

use nalgebra::{Isometry3, Vector3};

use super::tests_setup::Mount;
use super::{Relation, Tolerance, classify, classify_either_way, classify_rotation};
use crate::math::tests_support::Rng;

/// How many of `cases` genuine errors of this size are named.
fn named(mount: Mount, degrees: f64, cases: usize, seed: u64) -> usize {
    let mut rng = Rng::new(seed);
    let named = (0..cases).filter(|_| {
        let t1 = mount.draw(&mut rng);
        let t2 = rng.misaligned(&t1, degrees.to_radians(), 0.01);
        classify(&t1, &t2, &Tolerance::default()).error().is_some()
    });
    named.count()
}

/// (b) 900 genuine errors in each mount class, none named.
#[test]
fn a_genuine_misalignment_is_never_explained_away() {
    for mount in Mount::ALL {
        for degrees in [3.0, 5.0, 8.0] {
            assert_eq!(named(mount, degrees, 300, 21), 0, "{mount:?}, {degrees} degrees");
        }
    }
}

/// The rate behind (b), with enough cases to see it: `cargo test --lib math -- --ignored --nocapture`.
#[test]
#[ignore = "a measurement, half a minute long"]
fn the_rate_of_false_names() {
    for mount in Mount::ALL {
        for degrees in [3.0, 5.0, 8.0, 13.0, 20.0] {
            println!(
                "{mount:?}, {degrees} degrees: {} of 10000",
                named(mount, degrees, 10_000, 22)
            );
        }
    }
}

/// A sensor that was moved, or measured badly: 0.1 to 0.5 m, with calibration noise on the rotation.
#[test]
fn a_genuine_shift_is_never_explained_away() {
    for mount in Mount::ALL {
        for metres in [0.1, 0.2, 0.5] {
            let mut rng = Rng::new(23);
            for _ in 0..300 {
                let t1 = mount.draw(&mut rng);
                let mut t2 = rng.noisy(&t1, 0.3f64.to_radians(), 0.01);
                t2.translation.vector += rng.direction() * metres;
                let answer = classify(&t1, &t2, &Tolerance::default());
                assert_eq!(answer.error(), None, "{mount:?}, {metres} m: {:?}", answer.class);
            }
        }
    }
}

/// (c) Two unrelated transforms.
#[test]
fn independent_extrinsics_have_no_relation() {
    let mut rng = Rng::new(24);
    for _ in 0..1000 {
        let (a, b) = (Mount::Generic.draw(&mut rng), Mount::Generic.draw(&mut rng));
        assert_eq!(
            classify_either_way(&a, &b, &Tolerance::default()).classification.best,
            None
        );
    }
}

/// The second look of `classify_either_way` must not undo the silence.
#[test]
fn looking_both_ways_names_no_misalignment_either() {
    for mount in Mount::ALL {
        for degrees in [3f64, 5.0, 8.0] {
            let mut rng = Rng::new(25);
            for _ in 0..100 {
                let a = mount.draw(&mut rng);
                let b = rng.misaligned(&a, degrees.to_radians(), 0.01);
                let answer = classify_either_way(&a, &b, &Tolerance::default());
                assert_eq!(answer.classification.error(), None, "{mount:?}, {degrees} degrees");
            }
        }
    }
}

/// Within tolerance it is equal, whatever else would fit a little better.
#[test]
fn a_small_difference_is_equal() {
    let mut rng = Rng::new(26);
    for mount in Mount::ALL {
        for _ in 0..300 {
            let a = mount.draw(&mut rng);
            let mut b = rng.misaligned(&a, 1f64.to_radians(), 0.0);
            b.translation.vector += rng.direction() * 0.01;
            let answer = classify(&a, &b, &Tolerance::default());
            assert_eq!(answer.best, Some(Relation::Equal));
            assert_eq!(answer.class.first(), Some(&Relation::Equal));
            let alone = classify_rotation(&a.rotation, &b.rotation, &Tolerance::default());
            assert_eq!(alone.best, Some(Relation::Equal));
        }
    }
}

/// On the identity most relations change nothing: that is "equal", with all of them in its class.
#[test]
fn a_relation_that_changes_nothing_is_not_named() {
    let same = Isometry3::identity();
    let answer = classify(&same, &same, &Tolerance::default());
    assert_eq!(answer.best, Some(Relation::Equal));
    for relation in [
        Relation::Inverse,
        Relation::Transposed,
        Relation::Degrees,
        Relation::RotationLost,
    ] {
        assert!(answer.class.contains(&relation), "{relation}");
    }
    // A sensor turned by 180 degrees at the origin is its own inverse.
    let turned = Isometry3::new(Vector3::zeros(), Vector3::z() * std::f64::consts::PI);
    let answer = classify(&turned, &turned.inverse(), &Tolerance::default());
    assert_eq!(answer.best, Some(Relation::Equal));
    assert!(answer.class.contains(&Relation::Inverse));
}
