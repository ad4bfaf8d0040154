//! The 48 ways to rename three axes: signed permutations, half of them rotations and half of them mirrors.
//!
//! Owns their list, their names and the search for the one that explains a correlation. Must not know which sensor is
//! wrong, nor how clear an answer must be. The rotations with a common name are those of
//! [`constants`](super::constants). Source: `rules/quat/quaternion-convention.md`.

use nalgebra::{Matrix3, Vector3};

use super::constants::AxisTurn;

/// A signed permutation of three axes: `to = map * from`, where each `to` axis is one `from` axis or its negative.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct AxisMap {
    /// For each axis of `to`, which axis of `from` it is (0, 1, 2) and whether negated. A permutation.
    rows: [(u8, bool); 3],
}

/// The six orders of three axes, the even ones first.
const ORDERS: [[u8; 3]; 6] = [[0, 1, 2], [1, 2, 0], [2, 0, 1], [1, 0, 2], [0, 2, 1], [2, 1, 0]];

/// The mirrors that have a name: the single errors by which a right-handed triad becomes left-handed, and all axes negated.
const MIRRORS: [(&str, AxisMap); 7] = [
    ("x-negated", AxisMap::new([0, 1, 2], [true, false, false])),
    ("y-negated", AxisMap::new([0, 1, 2], [false, true, false])),
    ("z-negated", AxisMap::new([0, 1, 2], [false, false, true])),
    ("xy-swapped", AxisMap::new([1, 0, 2], [false; 3])),
    ("yz-swapped", AxisMap::new([0, 2, 1], [false; 3])),
    ("zx-swapped", AxisMap::new([2, 1, 0], [false; 3])),
    ("all-negated", AxisMap::new([0, 1, 2], [true; 3])),
];

impl AxisMap {
    /// Nothing changes.
    pub const IDENTITY: AxisMap = AxisMap::new([0, 1, 2], [false; 3]);

    const fn new(order: [u8; 3], negated: [bool; 3]) -> AxisMap {
        let ([a, b, c], [p, q, r]) = (order, negated);
        AxisMap {
            rows: [(a, p), (b, q), (c, r)],
        }
    }

    /// All 48, the identity first: each order of the axes with each choice of signs.
    pub fn all() -> impl Iterator<Item = AxisMap> {
        let signs = (0..8u8).map(|bits| [bits & 1 != 0, bits & 2 != 0, bits & 4 != 0]);
        ORDERS
            .into_iter()
            .flat_map(move |order| signs.clone().map(move |negated| AxisMap::new(order, negated)))
    }

    /// The map of one of the named rotations.
    pub fn from_turn(turn: AxisTurn) -> AxisMap {
        let wanted = turn.rotation();
        // Entries are exactly 0, 1 and -1 on both sides, and every turn is one of the 48.
        AxisMap::all()
            .find(|map| map.matrix() == *wanted.matrix())
            .unwrap_or(AxisMap::IDENTITY)
    }

    /// The named rotation that this is, if any. `None` for the identity, for the other rotations and for mirrors.
    pub fn turn(self) -> Option<AxisTurn> {
        AxisTurn::all()
            .iter()
            .copied()
            .find(|turn| *turn.rotation().matrix() == self.matrix())
    }

    /// Whether the map keeps handedness: determinant +1.
    pub fn is_proper(self) -> bool {
        let [(a, p), (b, q), (c, r)] = self.rows;
        let odd_order = !matches!([a, b, c], [0, 1, 2] | [1, 2, 0] | [2, 0, 1]);
        !(odd_order ^ p ^ q ^ r)
    }

    /// The matrix: entries exactly 0, 1 or -1, `to = matrix * from`. Dimensionless.
    pub fn matrix(self) -> Matrix3<f64> {
        let row = |(axis, negated): (u8, bool)| {
            let sign = if negated { -1.0 } else { 1.0 };
            Vector3::from_fn(|i, _| if i == usize::from(axis) { sign } else { 0.0 }).transpose()
        };
        Matrix3::from_rows(&self.rows.map(row))
    }

    /// The map that undoes this one.
    #[must_use]
    pub fn inverse(self) -> AxisMap {
        let back = self.matrix().transpose();
        AxisMap::all()
            .find(|map| map.matrix() == back)
            .unwrap_or(AxisMap::IDENTITY)
    }

    /// The stable word of this map: `identity`, a word of [`AxisTurn`], the word of a mirror, or else its
    /// [`spelling`](Self::spelled). Each map has one name and no two share it.
    pub fn name(self) -> String {
        if self == AxisMap::IDENTITY {
            return "identity".to_owned();
        }
        let turn = self.turn().map(AxisTurn::word);
        let mirror = MIRRORS.iter().find(|(_, map)| *map == self).map(|(word, _)| *word);
        turn.or(mirror).map_or_else(|| self.spelled(), str::to_owned)
    }

    /// What the axes x, y, z of `to` are in `from`: `(y, x, -z)` means x = old y, y = old x, z = minus old z.
    pub fn spelled(self) -> String {
        let word = |(axis, negated): (u8, bool)| {
            let letter = match axis {
                0 => 'x',
                1 => 'y',
                _ => 'z',
            };
            format!("{}{letter}", if negated { "-" } else { "" })
        };
        format!("({})", self.rows.map(word).join(", "))
    }
}

/// A map with its score.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ScoredMap {
    /// The map.
    pub map: AxisMap,
    /// sum to . (map * from), in the unit of the correlation: larger is better.
    pub score: f64,
}

/// All 48 maps, ranked by how well each takes `from` to `to`.
#[derive(Debug, Clone, PartialEq)]
pub struct AxisSearch {
    ranked: Vec<ScoredMap>,
    from_power: f64,
    to_power: f64,
}

impl AxisSearch {
    /// Ranks the maps M by tr(M sum from to^T) = sum to . (M from): the M of least sum |to - M from|^2 comes first
    /// (Procrustes, among signed permutations). Equal scores keep the order of [`AxisMap::all`].
    ///
    /// `cross` is sum from to^T (3x3, rows: axes of `from`), `from_power` and `to_power` are sum |from|^2 and
    /// sum |to|^2, all in one squared unit. `None` when a number is not finite or a power is not positive.
    pub fn new(cross: &Matrix3<f64>, from_power: f64, to_power: f64) -> Option<AxisSearch> {
        let positive = from_power > 0.0 && to_power > 0.0 && from_power.is_finite() && to_power.is_finite();
        if !positive || cross.iter().any(|v| !v.is_finite()) {
            return None;
        }
        let mut ranked: Vec<ScoredMap> = AxisMap::all()
            .map(|map| ScoredMap {
                map,
                score: (map.matrix() * cross).trace(),
            })
            .collect();
        ranked.sort_by(|a, b| b.score.total_cmp(&a.score));
        Some(AxisSearch {
            ranked,
            from_power,
            to_power,
        })
    }

    /// All 48, the best first.
    pub fn ranked(&self) -> &[ScoredMap] {
        &self.ranked
    }

    /// The best of all.
    pub fn best(&self) -> Option<ScoredMap> {
        self.ranked.first().copied()
    }

    /// The second best of all.
    pub fn runner_up(&self) -> Option<ScoredMap> {
        self.ranked.get(1).copied()
    }

    /// The best of one handedness.
    pub fn best_of(&self, proper: bool) -> Option<ScoredMap> {
        self.ranked.iter().find(|s| s.map.is_proper() == proper).copied()
    }

    /// The relative residual of a scored map: sqrt(sum |to - M from|^2 / sum |from|^2). 0 = perfect, 1 = no information,
    /// 2 = opposite, where both have the same power.
    pub fn residual(&self, scored: &ScoredMap) -> f64 {
        let squares = self.from_power + self.to_power - 2.0 * scored.score;
        (squares.max(0.0) / self.from_power).sqrt()
    }

    /// The ratio of the runner-up's residual to the best's: 1 = indistinguishable. Infinite for a perfect best.
    pub fn margin(&self) -> Option<f64> {
        Some(self.ratio(self.runner_up()?))
    }

    /// The ratio of the residual of the best map of the other handedness to the best's: how sure the handedness is.
    pub fn handedness_margin(&self) -> Option<f64> {
        let other = self.best_of(!self.best()?.map.is_proper())?;
        Some(self.ratio(other))
    }

    /// The maps whose residual is at most `ratio` times the best's, the best first: those that these data cannot
    /// distinguish. Motion about one axis alone gives a class of eight.
    pub fn class(&self, ratio: f64) -> Vec<AxisMap> {
        let near = self.ranked.iter().take_while(|s| self.ratio(**s) <= ratio);
        near.map(|s| s.map).collect()
    }

    fn ratio(&self, other: ScoredMap) -> f64 {
        let best = self.best().map_or(f64::NAN, |best| self.residual(&best));
        let other = self.residual(&other);
        // Two perfect maps are equal, not undefined.
        if other <= best { 1.0 } else { other / best }
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, clippy::float_cmp)]
    use super::*;
    use crate::math::tests_support::Rng;
    use std::collections::BTreeSet;

    fn named(name: &str) -> AxisMap {
        AxisMap::all().find(|map| map.name() == name).unwrap()
    }

    /// The search over `count` vectors of these deviations per axis, mapped by `map` and blurred by `noise`.
    fn searched(rng: &mut Rng, map: AxisMap, sd: [f64; 3], noise: f64) -> AxisSearch {
        let (mut cross, mut from_power, mut to_power) = (Matrix3::zeros(), 0.0, 0.0);
        for _ in 0..200 {
            let from = rng.normal3().component_mul(&Vector3::from(sd));
            let to = map.matrix() * from + rng.normal3() * noise;
            cross += from * to.transpose();
            from_power += from.norm_squared();
            to_power += to.norm_squared();
        }
        AxisSearch::new(&cross, from_power, to_power).unwrap()
    }

    #[test]
    fn there_are_48_half_of_them_proper_each_with_its_own_name() {
        let all: BTreeSet<AxisMap> = AxisMap::all().collect();
        let names: BTreeSet<String> = AxisMap::all().map(AxisMap::name).collect();
        assert_eq!((all.len(), names.len()), (48, 48));
        assert_eq!(AxisMap::all().filter(|m| m.is_proper()).count(), 24);
        for map in AxisMap::all() {
            let m = map.matrix();
            assert_eq!(m * m.transpose(), Matrix3::identity());
            assert_eq!(m.determinant(), if map.is_proper() { 1.0 } else { -1.0 });
            assert_eq!(map.inverse().matrix() * m, Matrix3::identity());
        }
    }

    #[test]
    fn the_turns_of_the_field_keep_their_words() {
        assert_eq!(AxisMap::IDENTITY.name(), "identity");
        for &turn in AxisTurn::all() {
            let map = AxisMap::from_turn(turn);
            assert_eq!((map.name().as_str(), map.turn()), (turn.word(), Some(turn)));
            assert_eq!(map.matrix(), *turn.rotation().matrix());
        }
        // NED/ENU: x and y change places, z changes sign.
        assert_eq!(AxisMap::from_turn(AxisTurn::NedEnu).spelled(), "(y, x, -z)");
        assert_eq!(AxisMap::from_turn(AxisTurn::FluFrd).spelled(), "(x, -y, -z)");
        assert_eq!(AxisMap::from_turn(AxisTurn::Z180).spelled(), "(-x, -y, z)");
        assert_eq!(AxisMap::from_turn(AxisTurn::Optical).spelled(), "(z, -x, -y)");
        assert!(!named("xy-swapped").is_proper() && named("xy-swapped").spelled() == "(y, x, z)");
        assert_eq!(named("all-negated").matrix(), -Matrix3::identity());
    }

    #[test]
    fn every_map_is_found_again_from_noisy_vectors() {
        let mut rng = Rng::new(5);
        for map in AxisMap::all() {
            let search = searched(&mut rng, map, [1.0, 0.7, 1.5], 0.1);
            assert_eq!(search.best().unwrap().map, map);
            assert!(search.margin().unwrap() > 3.0 && search.handedness_margin().unwrap() > 3.0);
            let best = search.best().unwrap();
            // Noise of 0.1 on three axes against a power of 1 + 0.49 + 2.25.
            assert!((search.residual(&best) - (0.03f64 / 3.74).sqrt()).abs() < 0.02);
            assert_eq!(search.class(1.5), [map]);
        }
    }

    #[test]
    fn motion_about_one_axis_leaves_a_class_of_both_hands() {
        let mut rng = Rng::new(6);
        let frd = AxisMap::from_turn(AxisTurn::FluFrd);
        let search = searched(&mut rng, frd, [0.0, 0.0, 1.0], 0.0);
        let class = search.class(1.5);
        assert_eq!(class.len(), 8);
        assert!(class.contains(&frd) && class.contains(&named("z-negated")) && class.contains(&named("all-negated")));
        assert!(class.iter().filter(|m| m.is_proper()).count() == 4);
        assert!(!class.contains(&AxisMap::IDENTITY));
        assert_eq!((search.margin(), search.handedness_margin()), (Some(1.0), Some(1.0)));
    }

    #[test]
    fn nothing_is_searched_without_motion() {
        assert_eq!(AxisSearch::new(&Matrix3::zeros(), 0.0, 1.0), None);
        assert_eq!(AxisSearch::new(&Matrix3::repeat(f64::NAN), 1.0, 1.0), None);
    }
}
