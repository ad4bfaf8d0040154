//! Rewrites a transform where it is written: other numbers in the same layout.
//!
//! Which layout that is (the order of a quaternion, the sequence of angles, rows or columns, metres or millimetres, the direction) is found by
//! combining the literals in every known way and keeping those that give the transform which was read. If two ways do, and would
//! write different numbers, nothing is written.

use nalgebra::{Isometry3, Matrix3, Quaternion, Translation3, UnitQuaternion, Vector3};

use crate::advice::literal::rewrite_values;
use crate::math::rotation::{from_rpy, nearest_rotation, rotation_angle_between, to_rpy};
use crate::verdict::Edit;
use crate::world::{Claim, Literal, World};

/// How far a layout may be off the transform that was read: rounding of double precision and printed digits.
const SAME_RAD: f64 = 1e-6;
/// Metres.
const SAME_M: f64 = 1e-6;

/// What a rotation is written as.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Form {
    /// A quaternion: the place of `w`, and whether it is conjugated (JPL).
    Quaternion { w_first: bool, is_conjugate: bool },
    /// Three angles: whether yaw is first, and whether they are degrees.
    Angles { yaw_first: bool, degrees: bool },
    /// A matrix of so many columns, row by row or column by column.
    Matrix { cols: usize, by_columns: bool },
}

/// How a transform is written.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Layout {
    form: Form,
    /// Metres in one unit of the translation.
    unit_m: f64,
    /// Whether it is the other direction that is written.
    is_inverse: bool,
}

/// The edits that make a claim state `pose`, in its own direction. `None` where its numbers can't be edited.
pub(crate) fn restated(world: &World, claim: &Claim, pose: &Isometry3<f64>) -> Option<Vec<Edit>> {
    if !(claim.has_rotation && claim.has_translation) {
        return None;
    }
    let stated = claim.pose?.isometry();
    let mut answer: Option<Vec<Edit>> = None;
    for layout in layouts(claim) {
        if !layout.read(claim).is_some_and(|read| is_same(&read, &stated)) {
            continue;
        }
        let edits = layout.write(world, claim, pose)?;
        if answer.as_ref().is_some_and(|known| *known != edits) {
            return None;
        }
        answer = Some(edits);
    }
    answer.filter(|edits| !edits.is_empty())
}

fn is_same(a: &Isometry3<f64>, b: &Isometry3<f64>) -> bool {
    let off_m = (a.translation.vector - b.translation.vector).norm();
    rotation_angle_between(&a.rotation, &b.rotation) <= SAME_RAD
        && off_m <= SAME_M * (1.0 + b.translation.vector.norm())
}

/// Every layout that has as many numbers as the claim.
fn layouts(claim: &Claim) -> Vec<Layout> {
    let forms: Vec<Form> = match (claim.rotation_literals.len(), claim.translation_literals.len()) {
        (4, 3) => [(false, false), (true, false), (false, true), (true, true)]
            .map(|(w_first, is_conjugate)| Form::Quaternion { w_first, is_conjugate })
            .to_vec(),
        (3, 3) => [(false, false), (false, true), (true, false), (true, true)]
            .map(|(yaw_first, degrees)| Form::Angles { yaw_first, degrees })
            .to_vec(),
        (9, 3) => matrices(3),
        (12, _) => matrices(4).into_iter().take(1).collect(),
        (16, _) => matrices(4),
        _ => Vec::new(),
    };
    let units = [1.0, 0.001, 0.01];
    let each = |form: Form| {
        units.into_iter().flat_map(move |unit_m| {
            [false, true].map(|is_inverse| Layout {
                form,
                unit_m,
                is_inverse,
            })
        })
    };
    forms.into_iter().flat_map(each).collect()
}

fn matrices(cols: usize) -> Vec<Form> {
    [false, true]
        .map(|by_columns| Form::Matrix { cols, by_columns })
        .to_vec()
}

impl Layout {
    /// The transform of the claim's literals in this layout.
    fn read(&self, claim: &Claim) -> Option<Isometry3<f64>> {
        let values: Vec<f64> = claim.rotation_literals.iter().map(|literal| literal.value).collect();
        let (rotation, in_matrix) = match (self.form, values.as_slice()) {
            (Form::Quaternion { w_first, is_conjugate }, [a, b, c, d]) => {
                let q = if w_first {
                    Quaternion::new(*a, *b, *c, *d)
                } else {
                    Quaternion::new(*d, *a, *b, *c)
                };
                let q = UnitQuaternion::try_new(q, 1e-9)?;
                (if is_conjugate { q.inverse() } else { q }, None)
            }
            (Form::Angles { yaw_first, degrees }, [a, b, c]) => {
                let [roll, pitch, yaw] = if yaw_first { [*c, *b, *a] } else { [*a, *b, *c] };
                let radians = |angle: f64| if degrees { angle.to_radians() } else { angle };
                (from_rpy(radians(roll), radians(pitch), radians(yaw)), None)
            }
            (Form::Matrix { .. }, values) => {
                let at = |row: usize, col: usize| values.get(self.index(row, col)).copied().unwrap_or(f64::NAN);
                let nearest = nearest_rotation(&Matrix3::from_fn(at))?;
                let translation = (values.len() > 9).then(|| Vector3::from_fn(|row, _| at(row, 3)));
                (UnitQuaternion::from_rotation_matrix(&nearest.rotation), translation)
            }
            _ => return None,
        };
        let translation = match (in_matrix, claim.translation_literals.as_slice()) {
            (Some(translation), _) => translation,
            (None, [x, y, z]) => Vector3::new(x.value, y.value, z.value),
            _ => return None,
        };
        let read = Isometry3::from_parts(Translation3::from(translation * self.unit_m), rotation);
        Some(if self.is_inverse { read.inverse() } else { read })
    }

    /// The index of an entry of the matrix among the literals.
    fn index(&self, row: usize, col: usize) -> usize {
        match self.form {
            Form::Matrix { cols, by_columns } if by_columns => col * cols + row,
            Form::Matrix { cols, .. } => row * cols + col,
            _ => usize::MAX,
        }
    }

    /// The edits that write a transform in this layout.
    fn write(&self, world: &World, claim: &Claim, pose: &Isometry3<f64>) -> Option<Vec<Edit>> {
        let pose = if self.is_inverse { pose.inverse() } else { *pose };
        let translation = pose.translation.vector / self.unit_m;
        // Of a matrix with four columns the translation is one of them.
        let apart = claim.rotation_literals.len() <= 9;
        let own = claim.translation_literals.iter().filter(|_| apart);
        let mut wanted: Vec<(&Literal, f64)> = own.zip(translation.iter().copied()).collect();
        match self.form {
            Form::Quaternion { w_first, is_conjugate } => {
                let mut q = if is_conjugate {
                    pose.rotation.inverse()
                } else {
                    pose.rotation
                };
                // Of the two quaternions of one rotation, the one whose w keeps its sign.
                let w = claim.rotation_literals.get(if w_first { 0 } else { 3 })?.value;
                if (w < 0.0) != (q.w < 0.0) {
                    q = UnitQuaternion::new_unchecked(-q.into_inner());
                }
                let numbers = if w_first {
                    [q.w, q.i, q.j, q.k]
                } else {
                    [q.i, q.j, q.k, q.w]
                };
                wanted.extend(claim.rotation_literals.iter().zip(numbers));
            }
            Form::Angles { yaw_first, degrees } => {
                let (roll, pitch, yaw) = to_rpy(&pose.rotation);
                let angles = if yaw_first {
                    [yaw, pitch, roll]
                } else {
                    [roll, pitch, yaw]
                };
                let angles = angles.map(|angle| if degrees { angle.to_degrees() } else { angle });
                wanted.extend(claim.rotation_literals.iter().zip(angles));
            }
            Form::Matrix { .. } => {
                let matrix = pose.rotation.to_rotation_matrix();
                for row in 0..3 {
                    for col in 0..3 {
                        let value = matrix.matrix().get((row, col)).copied()?;
                        wanted.push((claim.rotation_literals.get(self.index(row, col))?, value));
                    }
                    if !apart {
                        let value = translation.get(row).copied()?;
                        wanted.push((claim.rotation_literals.get(self.index(row, 3))?, value));
                    }
                }
            }
        }
        rewrite_values(world, claim.place.source, wanted)
    }
}
