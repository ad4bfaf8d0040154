//! Pairs of statements that differ for the same reason: one source contradicts several that agree.
//!
//! Must not know limits of rules.

use crate::analysis::cross::pair::{Pair, Statement};
use crate::world::World;

/// How many differences about two frames later ones are compared with.
const MAX_KNOWN: usize = 256;

/// A wrong source differs from each of those that agree: only the first of such pairs is reported, and names the others.
/// `earlier` are the pairs before this one about the same two frames.
pub(crate) fn fold(world: &World, pair: &mut Pair, earlier: &mut [Pair]) {
    if is_same(&pair.reference, &pair.other, false) {
        return;
    }
    let known = earlier.iter_mut().filter(|known| known.repeats.is_none());
    let known = known.take(MAX_KNOWN).find(|known| {
        let turned = known.reference.target != pair.reference.target;
        let same = |a: &Statement, b: &Statement| is_same(a, b, turned);
        known.alternatives == pair.alternatives
            && (same(&known.reference, &pair.reference) && same(&known.other, &pair.other)
                || same(&known.reference, &pair.other) && same(&known.other, &pair.reference))
    });
    let Some(known) = known else { return };
    pair.repeats = Some(format!("the same difference as in {}", known.subject(world)));
    let turned = known.reference.target != pair.reference.target;
    for statement in [&pair.reference, &pair.other] {
        let with_other = is_same(&known.other, statement, turned);
        let second = (with_other, statement.place.clone(), statement.who.clone());
        let is_known = [&known.reference, &known.other]
            .iter()
            .any(|known| known.place == statement.place);
        if !is_known && !known.seconded_by.contains(&second) {
            known.seconded_by.push(second);
        }
    }
}

/// Whether two statements are the same transform, up to rounding; `turned`: `b` is in the other direction.
fn is_same(a: &Statement, b: &Statement, turned: bool) -> bool {
    const ANGLE_RAD: f64 = 0.05 * std::f64::consts::PI / 180.0;
    const DISTANCE_M: f64 = 0.001;
    let b_pose = if turned { b.pose.inverse() } else { b.pose };
    let difference = a.pose.inv_mul(&b_pose);
    a.has_rotation == b.has_rotation
        && a.has_translation == b.has_translation
        && difference.rotation.angle() <= ANGLE_RAD
        && difference.translation.vector.norm() <= DISTANCE_M
}
