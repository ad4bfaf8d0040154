//! What the keys of a file mean, by those whose meaning another source shows.

use std::cmp::Reverse;
use std::collections::BTreeSet;

use nalgebra::Isometry3;

use crate::analysis::cross::pair::{Direction, Pair, Statement};
use crate::math::{relation::Tolerance, rotation::rotation_angle_between};
use crate::source::{Confidence, SourceId};

/// Files, each with a way to name frames in its keys (`t_<1>_<2>`) that is shown to be right.
pub(crate) struct KeyNotations(BTreeSet<(SourceId, String)>);

impl KeyNotations {
    /// Of the statements that equal a sure one, and would not if their keys meant the inverse.
    pub(crate) fn of(pairs: &[Pair]) -> Self {
        let showing = pairs.iter().filter(|pair| is_shown(pair));
        let statements = showing.flat_map(|pair| [&pair.reference, &pair.other]);
        Self(statements.filter_map(notation).collect())
    }

    /// Makes the reading likely of the statements of a pair whose keys are written in one of them.
    pub(crate) fn confirm(&self, pair: &mut Pair) {
        for one in [&mut pair.reference, &mut pair.other] {
            let is_shown = || notation(one).is_some_and(|notation| self.0.contains(&notation));
            if one.reading == Confidence::Hint && is_shown() {
                one.reading = Confidence::Likely;
            }
        }
    }
}

/// Whether a pair has a sure statement that the other one equals, and its inverse does not.
fn is_shown(pair: &Pair) -> bool {
    let sides = [&pair.reference, &pair.other];
    let [sure, pose] = sides.map(|one| &one.pose);
    let is_equal = |a: &Isometry3<f64>, b: &Isometry3<f64>| {
        let Tolerance {
            angle_rad, distance_m, ..
        } = Tolerance::default();
        rotation_angle_between(&a.rotation, &b.rotation) <= angle_rad
            && (a.translation.vector - b.translation.vector).norm() <= distance_m
    };
    sides.iter().all(|one| one.has_rotation && one.has_translation)
        && sides.iter().any(|one| one.reading > Confidence::Hint)
        && is_equal(sure, pose)
        && !is_equal(pose, &pose.inverse())
}

/// How the key of a statement names its frames; `None` where they are not both in the key.
fn notation(one: &Statement) -> Option<(SourceId, String)> {
    let (first, second) = (&one.called.0, &one.called.1);
    let mut names = match one.direction {
        Direction::AsStated => [(first, "<1>"), (second, "<2>")],
        Direction::TurnedRound => [(first, "<2>"), (second, "<1>")],
    };
    // A name may be a part of the other one.
    names.sort_by_key(|(name, _)| Reverse(name.as_str().len()));
    let mut key = one.label.rsplit('/').next()?.to_lowercase();
    for (name, stands_for) in names {
        let name = name.as_str().to_lowercase();
        if !key.contains(&name) {
            return None;
        }
        key = key.replacen(&name, stands_for, 1);
    }
    Some((one.place.source, key))
}
