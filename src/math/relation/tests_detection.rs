//! Is the truth found? Monte Carlo, seeded: the mounts of `tests_setup.rs`.
#![allow(clippy::unwrap_used, clippy::print_stdout)]

use super::tests_setup::{Mount, calibration_noise, holds};
use super::{Classification, Relation, Tolerance, classify, classify_either_way, classify_rotation};
use crate::math::tests_support::Rng;

/// (a) 0.3 degrees and 1 cm as lengths of the errors: every entry of the dictionary, 99 % at least.
#[test]
fn the_truth_is_in_the_named_class_for_every_relation() {
    for &truth in Relation::all() {
        let mut rng = Rng::new(1);
        let held = (0..300).filter(|_| {
            let t1 = Mount::Generic.draw(&mut rng);
            let held = truth.apply(&t1).unwrap();
            let (turn, shift) = (rng.normal() * 0.3f64.to_radians(), rng.normal() * 0.01);
            let mut t2 = rng.misaligned(&held, turn, 0.0);
            t2.translation.vector += rng.direction() * shift;
            holds(&classify(&t1, &t2, &Tolerance::default()), truth)
        });
        let held = held.count();
        assert!(held >= 297, "{truth}: {held} of 300");
    }
}

#[derive(Default)]
struct Tally {
    cases: usize,
    held: usize,
    held_or_withheld: usize,
    wrongly_named: usize,
    alone: usize,
    class_sizes: usize,
    largest: usize,
}

impl Tally {
    fn add(&mut self, answer: &Classification, truth: Relation) {
        self.cases += 1;
        if holds(answer, truth) {
            self.held += 1;
            self.alone += usize::from(answer.class.len() == 1);
            self.class_sizes += answer.class.len();
            self.largest = self.largest.max(answer.class.len());
        } else if answer.best.is_some() {
            self.wrongly_named += 1;
        }
        self.held_or_withheld += usize::from(holds(answer, truth) || answer.withheld.contains(&truth));
    }
}

/// (d) 0.3 degrees and 1 cm per axis: detection over the whole dictionary, and the sizes of the classes.
#[test]
fn detection_with_the_near_equal_gate_by_mount() {
    for (mount, least) in [
        (Mount::Generic, 0.99),
        (Mount::Tilted, 0.99),
        (Mount::NearNominal, 0.95),
        (Mount::AxisAligned, 0.95),
    ] {
        let mut tally = Tally::default();
        for &truth in Relation::all() {
            let mut rng = Rng::new(2);
            for _ in 0..100 {
                let t1 = mount.draw(&mut rng);
                let t2 = calibration_noise(&mut rng, &truth.apply(&t1).unwrap());
                tally.add(&classify(&t1, &t2, &Tolerance::default()), truth);
            }
        }
        let share = |count: usize| count as f64 / tally.cases as f64;
        println!(
            "{mount:?}: detected {:.4}, or withheld {:.4}, wrongly named {:.5}; class of one {:.3}, mean {:.2}, largest {}",
            share(tally.held),
            share(tally.held_or_withheld),
            share(tally.wrongly_named),
            tally.alone as f64 / tally.held as f64,
            tally.class_sizes as f64 / tally.held as f64,
            tally.largest,
        );
        assert!(share(tally.held) >= least, "{mount:?}: {}", share(tally.held));
        assert!(
            share(tally.held_or_withheld) >= 0.995,
            "{mount:?}: {}",
            share(tally.held_or_withheld)
        );
        assert!(
            share(tally.wrongly_named) <= 0.001,
            "{mount:?}: {}",
            share(tally.wrongly_named)
        );
    }
}

/// Rotations alone: every relation that turns something is in the class that is named.
#[test]
fn rotations_alone_are_classified_too() {
    let mut rng = Rng::new(3);
    let turning = Relation::all()
        .iter()
        .filter(|relation| !relation.is_translation_only());
    let (mut held, mut cases) = (0, 0);
    for &truth in turning {
        for _ in 0..50 {
            let t1 = Mount::Generic.draw(&mut rng);
            let t2 = calibration_noise(&mut rng, &truth.apply(&t1).unwrap());
            let answer = classify_rotation(&t1.rotation, &t2.rotation, &Tolerance::default());
            assert!(answer.distance_m == 0.0 && answer.residual_m == 0.0);
            held += usize::from(holds(&answer, truth));
            cases += 1;
        }
    }
    println!("rotations alone: {held} of {cases}");
    assert!(held as f64 >= 0.99 * f64::from(cases), "{held} of {cases}");
}

/// What can't be undone is found when the error is in the first of the two.
#[test]
fn the_error_may_be_in_the_first_one() {
    for &truth in Relation::all().iter().filter(|relation| relation.reversed().is_none()) {
        let mut rng = Rng::new(4);
        let found = (0..100).filter(|_| {
            let b = Mount::Generic.draw(&mut rng);
            let a = calibration_noise(&mut rng, &truth.apply(&b).unwrap());
            let answer = classify_either_way(&a, &b, &Tolerance::default());
            answer.reversed && holds(&answer.classification, truth)
        });
        let found = found.count();
        assert!(found >= 98, "{truth}: {found} of 100");
    }
}
