//! Transforms of one source that each have the numbers of the other.

use std::collections::BTreeMap;

use nalgebra::Isometry3;

use crate::analysis::cross::pair::Pair;
use crate::math::rotation::is_near;
use crate::source::SourceId;

/// Pairs whose statements differ, two of them at a time: those of one source state what the other source states of the other pair, within
/// an angle and a distance (radians, metres). By index, both ways.
pub(crate) fn exchanged<'p>(pairs: impl Iterator<Item = &'p Pair>, within: [f64; 2]) -> BTreeMap<usize, usize> {
    let mut of_sources: BTreeMap<[SourceId; 2], Vec<(usize, &Pair)>> = BTreeMap::new();
    for (index, pair) in pairs.enumerate() {
        let sides = [&pair.reference, &pair.other];
        let is_whole = sides.iter().all(|one| one.has_rotation && one.has_translation);
        if is_whole && pair.repeats.is_none() && !is_near(&pair.reference.pose, &pair.other.pose, within) {
            let sources = sides.map(|one| one.place.source);
            of_sources.entry(sources).or_default().push((index, pair));
        }
    }
    let mut exchanged = BTreeMap::new();
    for differing in of_sources.values() {
        for (at, (index, one)) in differing.iter().enumerate() {
            let mut others = differing.iter().skip(at + 1);
            if let Some((with, _)) = others.find(|(_, other)| is_crossed(one, other, within)) {
                exchanged.insert(*index, *with);
                exchanged.insert(*with, *index);
            }
        }
    }
    exchanged
}

/// Whether each of two pairs with one common frame has, in the second source, the transform of the other.
fn is_crossed(a: &Pair, b: &Pair, within: [f64; 2]) -> bool {
    let frames = |pair: &Pair| (pair.reference.target.clone(), pair.reference.source_frame.clone());
    let ((a_target, a_source), (b_target, b_source)) = (frames(a), frames(b));
    let unchanged = |pose: &Isometry3<f64>| *pose;
    let turn: fn(&Isometry3<f64>) -> Isometry3<f64> = if (a_target == b_target) != (a_source == b_source) {
        unchanged
    } else if (a_target == b_source) != (a_source == b_target) {
        Isometry3::inverse
    } else {
        return false;
    };
    is_near(&a.other.pose, &turn(&b.reference.pose), within) && is_near(&a.reference.pose, &turn(&b.other.pose), within)
}
