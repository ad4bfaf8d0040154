//! Mistakes in how numbers of a transform are written: what the text says is not the transform that was meant.
//!
//! The pose is what the reader makes of the numbers; none where they are no transform.

use nalgebra::{Matrix3, UnitQuaternion};

use crate::math::rotation;
use crate::world::bag::{TfEdge, TfFault};
use crate::world::{Claim, ClaimKind, Pose, Spelling, World};

use super::subject::constant_edges;
use super::{Change, Fault, Subject, SubjectPlace, restate};

/// Deviation from a rotation beyond which a reader takes a matrix for none.
const POSE: f64 = 0.1;

/// A mistake in the numbers of a claim, and of a static transform where it can have the same.
struct Written {
    claim: fn(&Claim) -> Option<Spelling>,
    edge: Option<fn([f64; 4]) -> [f64; 4]>,
}

impl Change for Written {
    fn subjects(&self, world: &World) -> Vec<Subject> {
        let claims = world.claims.iter().enumerate();
        let claims = claims.filter(|(_, claim)| claim.pose.is_some() && (self.claim)(claim).is_some());
        let mut subjects: Vec<Subject> = claims.map(|(number, claim)| of_claim(number, claim)).collect();
        if self.edge.is_some() {
            let edges = constant_edges(world).into_iter();
            subjects.extend(edges.map(|(at, edge)| of_edge(at, edge)));
        }
        subjects
    }

    fn apply(&self, world: &mut World, subject: &Subject) -> bool {
        match &subject.at {
            SubjectPlace::Claim(number) => rewrite(world, *number, self.claim),
            SubjectPlace::Edge { bag, edge } => {
                let edge = world.bags.get_mut(*bag).and_then(|bag| bag.tf.get_mut(*edge));
                edge.zip(self.edge).is_some_and(|(edge, change)| drop_all(edge, change))
            }
            _ => false,
        }
    }

    fn same_as(&self, world: &World, subject: &Subject) -> Vec<&'static str> {
        let SubjectPlace::Claim(number) = subject.at else {
            return Vec::new();
        };
        let claim = world.claims.get(number);
        let both = claim.and_then(|claim| Some((claim.pose?, read(&(self.claim)(claim)?, &claim.pose?)?)));
        both.map_or_else(Vec::new, |(truth, held)| {
            restate::relations_between(&truth.isometry(), &held.isometry())
        })
    }
}

fn of_claim(number: usize, claim: &Claim) -> Subject {
    let name = match &claim.kind {
        ClaimKind::Joint { joint, .. } => format!("joint `{joint}`"),
        ClaimKind::File { .. } => format!("`{}`", claim.label),
    };
    let frames = claim
        .frames
        .iter()
        .map(|(target, source)| format!("`{target}` from `{source}`"));
    Subject {
        words: std::iter::once(format!("`{}`", claim.label)).chain(frames).collect(),
        name,
        at: SubjectPlace::Claim(number),
    }
}

pub(super) fn of_edge([bag, edge]: [usize; 2], of: &TfEdge) -> Subject {
    let name = format!("`{}` from `{}` on {}", of.parent, of.child, of.topic);
    Subject {
        words: vec![name.clone(), format!("`{}`", of.child)],
        name,
        at: SubjectPlace::Edge { bag, edge },
    }
}

/// Writes other numbers into a claim.
fn rewrite(world: &mut World, number: usize, change: fn(&Claim) -> Option<Spelling>) -> bool {
    let claim = world.claims.get(number);
    let Some((spelling, truth)) = claim.and_then(|claim| change(claim).zip(claim.pose)) else {
        return false;
    };
    let pose = read(&spelling, &truth);
    restate::respell_claim(world, number, spelling, pose);
    world.forget();
    true
}

/// The pose that a reader makes of a spelling; the translation of a rotation alone is that of the true pose.
fn read(spelling: &Spelling, truth: &Pose) -> Option<Pose> {
    match spelling {
        Spelling::Quaternion { xyz, xyzw, .. } => Pose::from_raw(*xyz, *xyzw),
        Spelling::Rpy { .. } | Spelling::Translation { .. } => Some(*truth),
        Spelling::Matrix { rows, cols, values } => {
            let at = |row: usize, col: usize| values.get(row * cols + col).copied().unwrap_or(f64::NAN);
            let turn = Matrix3::from_fn(at);
            let is_rotation = rotation::det(&turn) > 0.0 && rotation::orthogonality_error(&turn) <= POSE;
            let ends_well = *rows < 4 || (0..4).all(|col| (at(3, col) - f64::from(u8::from(col == 3))).abs() <= 1e-6);
            if !is_rotation || !ends_well {
                return None;
            }
            let turn = UnitQuaternion::from_rotation_matrix(&rotation::nearest_rotation(&turn)?.rotation).coords;
            let xyz = if *cols == 4 {
                [at(0, 3), at(1, 3), at(2, 3)]
            } else {
                truth.translation_m
            };
            Pose::from_raw(xyz, [turn.x, turn.y, turn.z, turn.w])
        }
    }
}

/// Publishes quaternions that tf2 drops, in place of all that it accepts.
fn drop_all(edge: &mut TfEdge, change: fn([f64; 4]) -> [f64; 4]) -> bool {
    let examples = edge.samples.iter().map(|sample| TfFault {
        at: sample.at.clone(),
        translation: sample.pose.translation_m,
        rotation: change(sample.pose.rotation_xyzw),
    });
    let examples: Vec<TfFault> = examples.take(crate::world::bag::MAX_EXAMPLES).collect();
    let is_zero = examples
        .iter()
        .all(|fault| fault.rotation.iter().all(|value| *value == 0.0));
    let has_changed = !examples.is_empty();
    let faults = if is_zero {
        &mut edge.zero_quaternion
    } else {
        &mut edge.denormalized
    };
    faults.count = edge.count;
    faults.examples = examples;
    edge.samples.clear();
    (edge.extreme, edge.motion, edge.contradictions) = (None, None, None);
    edge.worst_norm_error = 0.0;
    has_changed
}

/// The numbers of a matrix, changed row by row; `None` where they stay.
fn matrix(claim: &Claim, change: fn([usize; 2], &mut [f64])) -> Option<Spelling> {
    let (rows, cols, values) = claim.matrix()?;
    let mut changed = values.to_vec();
    change([rows, cols], &mut changed);
    let differs = changed.iter().zip(values).any(|(a, b)| (a - b).abs() > 1e-6);
    differs.then_some(Spelling::Matrix {
        rows,
        cols,
        values: changed,
    })
}

/// Columns where rows are meant: of three rows of four, twelve numbers column by column.
fn transpose([rows, cols]: [usize; 2], values: &mut [f64]) {
    let by_columns = (0..cols).flat_map(|col| (0..rows).map(move |row| row * cols + col));
    let changed: Vec<f64> = by_columns.filter_map(|at| values.get(at).copied()).collect();
    values
        .iter_mut()
        .zip(changed)
        .for_each(|(value, changed)| *value = changed);
}

fn mirror([_, cols]: [usize; 2], values: &mut [f64]) {
    for value in values.iter_mut().skip(cols).take(3) {
        *value = -*value;
    }
}

fn lose_last_one([rows, _]: [usize; 2], values: &mut [f64]) {
    if rows == 4 {
        values.iter_mut().skip(12).for_each(|value| *value = 1.0);
    }
}

fn quaternion(claim: &Claim, factor: f64) -> Option<Spelling> {
    match &claim.spelling {
        Spelling::Quaternion { xyz, xyzw, order_known } => Some(Spelling::Quaternion {
            xyz: *xyz,
            xyzw: xyzw.map(|value| value * factor),
            order_known: *order_known,
        }),
        _ => None,
    }
}

/// A mistake in numbers.
macro_rules! written {
    ($name:literal, $claim:expr, $edge:expr, $sentence:literal, $($named:tt)*) => {
        fault!(Statement, $name, $sentence, Written { claim: $claim, edge: $edge }, $($named)*)
    };
}

/// Every mistake of this kind.
pub(super) static FAULTS: &[Fault] = &[
    written!(
        "matrix-transposed",
        |claim| matrix(claim, transpose),
        None,
        "A matrix is written column by column where rows are read.",
        ["transposed"],
        [],
        ["ROT03", "CROSS02"],
        "a second statement of the transform, or all four rows of the matrix"
    ),
    written!(
        "matrix-mirrored",
        |claim| matrix(claim, mirror),
        None,
        "A row of a rotation matrix has the opposite sign: the matrix mirrors.",
        [
            "mirrored-x",
            "mirrored-y",
            "mirrored-z",
            "swapped-xy",
            "swapped-yz",
            "swapped-zx"
        ],
        ["is mirrored: its determinant is"],
        ["ROT01"],
        "the rotation as a matrix or a quaternion in the file"
    ),
    written!(
        "matrix-bottom-row",
        |claim| matrix(claim, lose_last_one),
        None,
        "The bottom row of a homogeneous matrix is not 0 0 0 1.",
        [],
        ["not 0 0 0 1"],
        ["ROT03"],
        "all four rows of the matrix in the file"
    ),
    written!(
        "quaternion-not-normalised",
        |claim| quaternion(claim, 1.01),
        Some(|xyzw| xyzw.map(|value| value * 1.01)),
        "A quaternion is not normalised.",
        [],
        ["is not normalised", "are not normalised", "have the norm"],
        ["ROT04"],
        "the quaternion as it is written or published"
    ),
    written!(
        "quaternion-zero",
        |claim| quaternion(claim, 0.0),
        Some(|_| [0.0; 4]),
        "A quaternion is all zeros: it was never filled in.",
        [],
        ["which is no rotation", "all-zero quaternion"],
        ["ROT05"],
        "the quaternion as it is written or published"
    ),
];

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn matrices_are_transposed_as_they_are_written() {
        let mut values: Vec<f64> = (0..12).map(f64::from).collect();
        transpose([3, 4], &mut values);
        assert_eq!(values, [0.0, 4.0, 8.0, 1.0, 5.0, 9.0, 2.0, 6.0, 10.0, 3.0, 7.0, 11.0]);
    }

    #[test]
    fn a_reader_makes_no_pose_of_a_mirror() {
        let mut values = vec![1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0];
        let matrix = |values: &Vec<f64>| Spelling::Matrix {
            rows: 3,
            cols: 3,
            values: values.clone(),
        };
        assert_eq!(read(&matrix(&values), &Pose::IDENTITY), Some(Pose::IDENTITY));
        mirror([3, 3], &mut values);
        assert_eq!(read(&matrix(&values), &Pose::IDENTITY), None);
    }
}
