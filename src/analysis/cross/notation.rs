//! What the keys of a file mean, by those whose meaning another source shows.

use std::cmp::Reverse;
use std::collections::{BTreeMap, BTreeSet};

use nalgebra::Isometry3;

use crate::analysis::cross::pair::{Direction, Pair, Statement};
use crate::math::{relation::Tolerance, rotation::is_near};
use crate::source::{Confidence, SourceId};

/// Files, each with the ways in which its keys name frames (`t_<1>_<2>`), and what they mean.
pub(crate) struct KeyNotations {
    /// Some states what a sure source states.
    shown: BTreeSet<Notation>,
    /// None does, and several state the inverse of what a sure source states.
    reversed: BTreeSet<Notation>,
}

/// A file, and a key of it without the names of its frames.
type Notation = (SourceId, String);

impl KeyNotations {
    /// Of pairs with a sure statement that show a direction.
    pub(crate) fn of(pairs: &[Pair]) -> Self {
        let sure = pairs.iter().filter(|pair| {
            let sides = [&pair.reference, &pair.other];
            sides.iter().any(|one| one.reading == Confidence::Certain)
        });
        let sure: Vec<&Pair> = sure.filter(|pair| is_directed(pair)).collect();
        let of = |is_it: &dyn Fn(&Pair) -> bool| {
            let sides = sure.iter().filter(|pair| is_it(pair));
            let sides = sides.flat_map(|pair| [&pair.reference, &pair.other]);
            let named = sides.filter_map(|one| Some((notation(one)?, &one.label)));
            let mut labels: BTreeMap<Notation, BTreeSet<&str>> = BTreeMap::new();
            for (notation, label) in named {
                labels.entry(notation).or_default().insert(label);
            }
            labels
        };
        let shown = of(&|pair| is_equal(&pair.reference.pose, &pair.other.pose));
        let shown: BTreeSet<Notation> = shown.into_keys().collect();
        let mut reversed = of(&|pair| is_equal(&pair.reference.pose, &pair.other.pose.inverse()));
        reversed.retain(|notation, labels| labels.len() > 1 && !shown.contains(notation));
        Self {
            reversed: reversed.into_keys().collect(),
            shown,
        }
    }

    /// Sets how sure the statements of a pair are whose keys are written in one of them.
    pub(crate) fn confirm(&self, pair: &mut Pair) {
        for one in [&mut pair.reference, &mut pair.other] {
            let Some(notation) = notation(one) else { continue };
            if self.shown.contains(&notation) {
                one.reading = one.reading.max(Confidence::Likely);
            } else if self.reversed.contains(&notation) {
                one.reading = Confidence::Hint;
            }
        }
    }
}

/// Whether both statements are whole, and differ from their inverses.
fn is_directed(pair: &Pair) -> bool {
    let sides = [&pair.reference, &pair.other];
    sides.iter().all(|one| one.has_rotation && one.has_translation)
        && !is_equal(&pair.other.pose, &pair.other.pose.inverse())
}

/// Within the tolerance of relations.
fn is_equal(a: &Isometry3<f64>, b: &Isometry3<f64>) -> bool {
    let tolerance = Tolerance::default();
    is_near(a, b, [tolerance.angle_rad, tolerance.distance_m])
}

/// How the key of a statement names its frames; `None` where they are not both in the key, or the program that reads the file says what it means.
fn notation(one: &Statement) -> Option<Notation> {
    let (first, second) = (&one.called.0, &one.called.1);
    let mut names = match one.direction {
        Direction::AsStated => [(first, "<1>"), (second, "<2>")],
        Direction::TurnedRound => [(first, "<2>"), (second, "<1>")],
    };
    // A name may be a part of the other one.
    names.sort_by_key(|(name, _)| Reverse(name.as_str().len()));
    let mut key = one.key.as_ref()?.rsplit('/').next()?.to_lowercase();
    for (name, stands_for) in names {
        let name = name.as_str().to_lowercase();
        if !key.contains(&name) {
            return None;
        }
        key = key.replacen(&name, stands_for, 1);
    }
    Some((one.place.source, key))
}
