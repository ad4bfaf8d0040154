//! Which of two statements holds the convention error.
//!
//! Must not word a finding.

use crate::analysis::cross::pair::{Direction, Pair, Statement};
use crate::math::relation::{Classification, Relation, TwoWayMatch, classify, classify_either_way};

/// Puts the statement with the error second, and names the relation from the first to it. The reference is taken as right
/// unless the numbers, or most of the other sources, contradict it.
pub(crate) fn blame(pair: &mut Pair, mount_m: f64) -> Classification {
    let found = pair.classify();
    let longest_m = [&pair.reference, &pair.other]
        .map(|s| s.pose.translation.vector.norm())
        .into_iter()
        .fold(0.0, f64::max);
    let swap = match found.best {
        None => either_way(pair).is_some_and(|either| either.reversed),
        // Degrees in the larger numbers are common; radians that were converted once too often are not.
        Some(Relation::Radians) => true,
        // Nothing is mounted so far away: the longer one is in millimetres, else the shorter one was scaled twice.
        Some(Relation::Metres) => longest_m > mount_m,
        Some(Relation::Millimetres) => longest_m <= mount_m,
        // Two against one, where the error has a name in the other direction as well.
        Some(_) => {
            outvoted(pair)
                && classify(&pair.other.pose, &pair.reference.pose, &pair.tolerance())
                    .best
                    .is_some()
        }
    };
    if !swap {
        return found;
    }
    pair.swap();
    pair.classify()
}

/// The pair in the direction in which a convention error explains it: an error that was made in one direction may have no name in the other.
pub(crate) fn oriented(pair: Pair) -> Pair {
    let is_turned = |statement: &Statement| statement.direction == Direction::TurnedRound;
    if !(is_turned(&pair.reference) || is_turned(&pair.other))
        || pair.classify().best.is_some()
        || named(&pair).is_some()
    {
        return pair;
    }
    pair.turned().filter(|turned| named(turned).is_some()).unwrap_or(pair)
}

/// Whether more of the other sources agree with the second than with the first.
fn outvoted(pair: &Pair) -> bool {
    let with_other = pair.seconded_by.iter().filter(|(with_other, ..)| *with_other).count();
    with_other > pair.seconded_by.len() - with_other
}

/// The convention error between the two, whichever of them holds it.
pub(crate) fn named(pair: &Pair) -> Option<Relation> {
    either_way(pair).map_or_else(|| pair.classify().error(), |either| either.classification.error())
}

/// `None` for a pair of which one states only a rotation or a translation.
pub(crate) fn either_way(pair: &Pair) -> Option<TwoWayMatch> {
    let complete = |s: &Statement| s.has_rotation && s.has_translation;
    (complete(&pair.reference) && complete(&pair.other))
        .then(|| classify_either_way(&pair.reference.pose, &pair.other.pose, &pair.tolerance()))
}

/// Whether the first of the two may be the wrong one instead, with radians that were read as degrees.
pub(crate) fn holds_radians_twice(pair: &Pair) -> bool {
    classify(&pair.other.pose, &pair.reference.pose, &pair.tolerance())
        .class
        .contains(&Relation::Radians)
}
