//! Which relation explains a difference, if any does.
//!
//! Owns the decision and its margins. Must not know why two transforms are compared, nor word a message.

use nalgebra::{Isometry3, UnitQuaternion, Vector3};

use super::Relation;
use super::apply::is_finite;
use crate::math::rotation::rotation_angle_between;

/// The limits of [`classify`]. The defaults were chosen by the simulations of `tests_detection.rs` and `tests_false_names.rs`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Tolerance {
    /// A relation can explain a difference if the residual is within this angle, in radians.
    pub angle_rad: f64,
    /// ... and within this distance, in metres ...
    pub distance_m: f64,
    /// ... plus this share of the longer translation.
    pub relative_distance: f64,
    /// Two transforms nearer than this angle (radians) and ...
    pub near_angle_rad: f64,
    /// ... this distance (metres) are nearly equal: a small genuine misalignment is then the rival explanation, and the
    /// next two limits apply.
    pub near_distance_m: f64,
    /// Between nearly equal transforms, a relation is named only if its score is at most this ...
    pub near_best_score: f64,
    /// ... and "equal" scores at least this many times as much. The same ratio decides between a simpler and a better
    /// fitting relation of one class.
    pub near_ratio: f64,
    /// Whether one of the two is written as a quaternion: else the order of its numbers is the last explanation of a difference.
    pub has_quaternion: bool,
}

impl Default for Tolerance {
    fn default() -> Self {
        Tolerance {
            angle_rad: 2f64.to_radians(),
            distance_m: 0.05,
            relative_distance: 0.01,
            near_angle_rad: 12f64.to_radians(),
            near_distance_m: 0.3,
            near_best_score: 0.35,
            near_ratio: 6.0,
            has_quaternion: true,
        }
    }
}

/// The answer of [`classify`].
#[derive(Debug, Clone, PartialEq)]
pub struct Classification {
    /// The relation to name. `Equal`: the same within tolerance. `None`: no relation may be named, so report the plain
    /// difference as unexplained.
    pub best: Option<Relation>,
    /// All relations that this data can't distinguish from `best`: `best` first, the others in prior order. Empty when
    /// `best` is `None`. More than one: say "indistinguishable here".
    pub class: Vec<Relation>,
    /// Relations that fit but are not named, because the two transforms are so nearly equal that a genuine small
    /// misalignment explains them as well. Never report one as the cause. Empty when `best` is `Some`.
    pub withheld: Vec<Relation>,
    /// How badly `best` (or `Equal` when there is none) fits: 1 is one tolerance off in angle or in distance. Dimensionless.
    pub score: f64,
    /// The plain difference of the two rotations, in radians.
    pub angle_rad: f64,
    /// The plain difference of the two translations, in metres; 0 where only rotations were compared.
    pub distance_m: f64,
    /// The residual angle with `best`, in radians; the plain difference when `best` is `None`.
    pub residual_angle_rad: f64,
    /// The residual distance with `best`, in metres; the plain difference when `best` is `None`.
    pub residual_m: f64,
}

impl Classification {
    /// The convention error to report: `best` unless it is `Equal` or absent.
    pub fn error(&self) -> Option<Relation> {
        self.best.filter(|&relation| relation != Relation::Equal)
    }
}

/// Scores up to this count as an exact fit: 0.04 degrees or 1 mm, the rounding errors of files.
const EXACT_SCORE: f64 = 0.02;

/// The difference between two transforms, and its score.
#[derive(Clone, Copy)]
struct Gap {
    angle_rad: f64,
    distance_m: f64,
    score: f64,
    within: bool,
}

fn gap(a: &Isometry3<f64>, b: &Isometry3<f64>, tol: &Tolerance) -> Gap {
    let angle_rad = rotation_angle_between(&a.rotation, &b.rotation);
    let (ta, tb): (Vector3<f64>, Vector3<f64>) = (a.translation.vector, b.translation.vector);
    let distance_m = (ta - tb).norm();
    let allowed_m = tol.distance_m + tol.relative_distance * ta.norm().max(tb.norm());
    Gap {
        angle_rad,
        distance_m,
        score: (angle_rad / tol.angle_rad).hypot(distance_m / allowed_m),
        within: angle_rad <= tol.angle_rad && distance_m <= allowed_m,
    }
}

/// One relation, what it predicts and how far that is from what was seen.
struct Candidate {
    relation: Relation,
    predicted: Isometry3<f64>,
    gap: Gap,
}

/// Finds the relation `f` with `t2 = f(t1)`: `t1` is taken as the truth, `t2` as the transform that may hold an error.
///
/// Both are `target_from_source` of the same two frames, in metres.
///
/// How it decides. Each relation predicts a second transform; its score is the hypotenuse of (angle / 2 degrees) and
/// (distance / (5 cm + 1 % of the length)), and it fits when both parts are within tolerance. Then:
/// 1. `Equal` fits: nothing else is named.
/// 2. The best fit's class is every relation whose prediction lies within tolerance of the best fit's. If `Equal` is
///    in it, nothing else is named.
/// 3. Named is the simplest member of the class that itself fits, is not within tolerance of `t1`, and either scores at
///    most six times the best score or fits exactly (0.04 degrees, 1 mm).
/// 4. Where the two are nearly equal (12 degrees and 0.3 m) the named one must score at most 0.35, and `Equal` at least
///    `6 * sqrt(n)` times as much, `n` being the number of different predictions that near: else a small genuine
///    misalignment would be explained away by an Euler-angle order. See below for `n`.
///
/// Measured (seeded Monte Carlo in `tests_detection.rs` and `tests_false_names.rs`; 43 relations, 0.3 degrees and 1 cm per
/// axis of noise on `t2`, |t| up to 3 m; "named" is out of 10 000 genuine misalignments each of 3, 5 and 8 degrees):
///
/// | mount | truth in named class | class of one | class mean, largest | named 3 / 5 / 8 deg | without `n` |
/// |---|---|---|---|---|---|
/// | generic | .998 | .93 | 1.07, 3 | 0 / 1 / 0 | 0 / 1 / 0, .998 |
/// | tilted | .998 | .92 | 1.08, 2 | 0 / 0 / 1 | 0 / 0 / 1, .998 |
/// | yaw 0, 90, 180, -90 and 2 degrees per axis | .965 | .85 | 1.22, 7 | 1 / 3 / 0 | 6 / 5 / 0, .973 |
/// | any of the 24 axis-aligned and 3 degrees per axis | .983 | .90 | 1.11, 4 | 0 / 2 / 1 | 1 / 4 / 1, .984 |
///
/// Nearly all of the rest is `withheld`; a wrong name came once in 4300 cases (generic). With errors of 0.3 degrees and
/// 1 cm in length, not per axis, each relation alone is found in 99 % or more of generic mounts; per axis, `ypr` and
/// `transposed` are withheld in 2 to 3 % of them, where they happen to change less than 12 degrees. Past the near
/// region, at 13 and 20 degrees, up to 5 in 10 000 genuine errors are named.
///
/// A transform that is not finite gives `best: None` and NaN differences.
pub fn classify(t1: &Isometry3<f64>, t2: &Isometry3<f64>, tol: &Tolerance) -> Classification {
    decide(t1, t2, tol, Relation::all().iter().copied())
}

/// [`classify`] for two rotations whose translations are unknown (an IMU's orientation, a rotation-only matrix).
///
/// Relations of translations are left out. `Inverse` and `Transposed` are one map here, and a right factor can't be distinguished
/// from a change of both frames by it: expect larger classes. `distance_m` and `residual_m` are 0.
pub fn classify_rotation(r1: &UnitQuaternion<f64>, r2: &UnitQuaternion<f64>, tol: &Tolerance) -> Classification {
    let [t1, t2] = [r1, r2].map(|r| Isometry3::from_parts(Vector3::zeros().into(), *r));
    let relations = Relation::all()
        .iter()
        .copied()
        .filter(|relation| !relation.is_translation_only());
    decide(&t1, &t2, tol, relations)
}

/// The answer of [`classify_either_way`].
#[derive(Debug, Clone, PartialEq)]
pub struct TwoWayMatch {
    /// The answer; its `best` is `f` with `b = f(a)`, or with `a = f(b)` when `reversed`.
    pub classification: Classification,
    /// The error is in `a`, with `b` as the truth. When false the error can be in either, if the relation has a
    /// [`Relation::reversed`].
    pub reversed: bool,
}

/// [`classify`] where neither of the two is known to be the truth: tries `b = f(a)`, and if nothing may be named,
/// `a = f(b)`. The second attempt finds what can't be undone: degrees, a lost rotation or translation, a doubled transform.
pub fn classify_either_way(a: &Isometry3<f64>, b: &Isometry3<f64>, tol: &Tolerance) -> TwoWayMatch {
    let forward = classify(a, b, tol);
    if forward.best.is_none() {
        let backward = classify(b, a, tol);
        if backward.best.is_some() {
            return TwoWayMatch {
                classification: backward,
                reversed: true,
            };
        }
    }
    TwoWayMatch {
        classification: forward,
        reversed: false,
    }
}

/// If neither of the two is written as a quaternion, an order of a quaternion's numbers counts only where nothing else explains the
/// difference: a program may have read a quaternion wrongly before it wrote a matrix.
fn decide(
    t1: &Isometry3<f64>,
    t2: &Isometry3<f64>,
    tol: &Tolerance,
    relations: impl Iterator<Item = Relation>,
) -> Classification {
    let all: Vec<Relation> = relations.collect();
    if !tol.has_quaternion {
        let others = all.iter().copied().filter(|relation| !relation.is_quaternion_order());
        let found = decide_among(t1, t2, tol, others);
        if found.best.is_some() {
            return found;
        }
    }
    decide_among(t1, t2, tol, all.into_iter())
}

fn decide_among(
    t1: &Isometry3<f64>,
    t2: &Isometry3<f64>,
    tol: &Tolerance,
    relations: impl Iterator<Item = Relation>,
) -> Classification {
    let plain = gap(t1, t2, tol);
    let unexplained = |withheld| Classification {
        best: None,
        class: Vec::new(),
        withheld,
        score: plain.score,
        angle_rad: plain.angle_rad,
        distance_m: plain.distance_m,
        residual_angle_rad: plain.angle_rad,
        residual_m: plain.distance_m,
    };
    if !is_finite(t1) || !is_finite(t2) {
        return unexplained(Vec::new());
    }
    let candidates: Vec<Candidate> = relations
        .filter_map(|relation| {
            let predicted = relation.apply(t1)?;
            Some(Candidate {
                relation,
                predicted,
                gap: gap(&predicted, t2, tol),
            })
        })
        .collect();
    let explained = |by: &Candidate, class: Vec<Relation>| Classification {
        best: Some(by.relation),
        class: leading(by.relation, class),
        withheld: Vec::new(),
        score: by.gap.score,
        angle_rad: plain.angle_rad,
        distance_m: plain.distance_m,
        residual_angle_rad: by.gap.angle_rad,
        residual_m: by.gap.distance_m,
    };

    if plain.within {
        // A relation that fits better than `Equal` can't be excluded, even just past the tolerance from it.
        let better = |c: &Candidate| c.gap.within && c.gap.score <= plain.score;
        let class = members(&candidates, |c| better(c) || gap(&c.predicted, t1, tol).within);
        return match candidates.first() {
            Some(equal) => explained(equal, class),
            None => unexplained(Vec::new()),
        };
    }

    let fitting = candidates.iter().filter(|c| c.gap.within);
    let Some(best) = fitting.min_by(|a, b| a.gap.score.total_cmp(&b.gap.score)) else {
        return unexplained(Vec::new());
    };
    let in_class = |c: &Candidate| gap(&c.predicted, &best.predicted, tol).within;
    let class = members(&candidates, in_class);
    if class.contains(&Relation::Equal) {
        return unexplained(class);
    }

    let near = plain.angle_rad < tol.near_angle_rad && plain.distance_m < tol.near_distance_m;
    let near_ratio = tol.near_ratio * (crowd(&candidates, t1, tol).max(1) as f64).sqrt();
    let good_enough = (tol.near_ratio * best.gap.score).max(EXACT_SCORE);
    let may_be_named = |c: &&Candidate| {
        in_class(c)
            && c.gap.within
            && c.gap.score <= good_enough
            && !gap(&c.predicted, t1, tol).within
            && (!near || (c.gap.score <= tol.near_best_score && plain.score >= near_ratio * c.gap.score))
    };
    match candidates.iter().find(may_be_named) {
        Some(named) => explained(named, class),
        None => unexplained(class),
    }
}

fn members(candidates: &[Candidate], belongs: impl Fn(&Candidate) -> bool) -> Vec<Relation> {
    candidates.iter().filter(|c| belongs(c)).map(|c| c.relation).collect()
}

/// `first`, then the rest of `class` in its order.
fn leading(first: Relation, class: Vec<Relation>) -> Vec<Relation> {
    std::iter::once(first)
        .chain(class.into_iter().filter(|&relation| relation != first))
        .collect()
}

/// How many different predictions lie in the near region of `t1`, apart from those within tolerance of it.
///
/// A genuine error of the size of a prediction's step hits one of `n` predictions within `1/ratio` of its length with a
/// chance that grows as `n / ratio^2`: the ratio must grow as the root of `n` to keep that chance.
fn crowd(candidates: &[Candidate], t1: &Isometry3<f64>, tol: &Tolerance) -> usize {
    let mut distinct: Vec<&Isometry3<f64>> = Vec::new();
    for predicted in candidates.iter().map(|c| &c.predicted) {
        let step = gap(predicted, t1, tol);
        let near = step.angle_rad < tol.near_angle_rad && step.distance_m < tol.near_distance_m;
        let counted = |other: &&Isometry3<f64>| gap(predicted, other, tol).score < tol.near_best_score;
        if near && !step.within && !distinct.iter().any(counted) {
            distinct.push(predicted);
        }
    }
    distinct.len()
}
