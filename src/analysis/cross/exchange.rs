//! Transforms of one source that each have the numbers of the other.

use std::collections::BTreeMap;

use nalgebra::Isometry3;

use crate::analysis::cross::pair::Pair;
use crate::math::rotation::is_near;
use crate::source::SourceId;
use crate::world::FrameId;

/// Pairs of frames of two sources that are compared with each other: each is with every other one, and no platform has more.
const MAX_PAIRS: usize = 200;

/// Of two sources, the first pair of each two frames whose statements differ, with its index.
type Differing<'p> = BTreeMap<[&'p FrameId; 2], (usize, &'p Pair)>;

/// Pairs whose statements differ, two of them at a time: those of one source state what the other source states of the other pair, within
/// an angle and a distance (radians, metres). By index, both ways.
pub(crate) fn exchanged<'p>(pairs: impl Iterator<Item = &'p Pair>, within: [f64; 2]) -> BTreeMap<usize, usize> {
    let mut of_sources: BTreeMap<[SourceId; 2], Differing> = BTreeMap::new();
    for (index, pair) in pairs.enumerate() {
        let sides = [&pair.reference, &pair.other];
        let is_whole = sides.iter().all(|one| one.has_rotation && one.has_translation);
        if is_whole && pair.repeats.is_none() && !is_near(&pair.reference.pose, &pair.other.pose, within) {
            let sources = sides.map(|one| one.place.source);
            let frames = [&pair.reference.target, &pair.reference.source_frame];
            let of_frames = of_sources.entry(sources).or_default();
            of_frames.entry(frames).or_insert((index, pair));
        }
    }
    let mut exchanged = BTreeMap::new();
    for differing in of_sources.values() {
        for (at, (index, one)) in differing.values().take(MAX_PAIRS).enumerate() {
            let mut others = differing.values().take(MAX_PAIRS).skip(at + 1);
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
    let (one, other) = (&a.reference, &b.reference);
    let unchanged = |pose: &Isometry3<f64>| *pose;
    let turn: fn(&Isometry3<f64>) -> Isometry3<f64> =
        if (one.target == other.target) != (one.source_frame == other.source_frame) {
            unchanged
        } else if (one.target == other.source_frame) != (one.source_frame == other.target) {
            Isometry3::inverse
        } else {
            return false;
        };
    is_near(&a.other.pose, &turn(&b.reference.pose), within) && is_near(&a.reference.pose, &turn(&b.other.pose), within)
}
