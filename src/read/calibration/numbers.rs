//! Numbers of a document: literals with places, lists, matrices, and the shape and rotation that they form.
//!
//! Knows no keys: whether twelve numbers are meant as a transform is decided by `names` and `generic`.

use nalgebra::{Matrix3, UnitQuaternion};

use crate::math::rotation;
use crate::source::Span;
use crate::world::{Literal, Pose};

use super::document::{Kind, Node};

/// Longest list that is read: nothing of interest is longer, and clouds of points are not copied.
const LONGEST: usize = 160;
/// Distance from orthogonality (Frobenius norm of `RᵀR - I`) under which numbers are taken for a rotation by
/// themselves. Rounding to one decimal stays below it; three arbitrary axes do not.
const NEAR: f64 = 0.3;
/// The same, under which a matrix is converted to a pose: beyond it, the nearest rotation means little.
const POSE: f64 = 0.1;

/// Numbers as they are arranged.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Numbers {
    /// A list.
    Flat(Vec<Literal>),
    /// Rows and columns, row-major.
    Grid {
        rows: usize,
        cols: usize,
        literals: Vec<Literal>,
    },
    /// Meant as rows and columns, but the counts contradict each other.
    Misfit(String),
}

impl Numbers {
    /// As a matrix: 3x3, 3x4 or 4x4; lists of 9, 12 and 16 are row-major.
    pub(super) fn matrix(&self) -> Option<(usize, usize, &[Literal])> {
        match self {
            Self::Grid { rows, cols, literals } if matches!((rows, cols), (3, 3) | (3 | 4, 4)) => {
                Some((*rows, *cols, literals))
            }
            Self::Flat(literals) | Self::Grid { rows: 1, literals, .. } | Self::Grid { cols: 1, literals, .. } => {
                match literals.len() {
                    9 => Some((3, 3, literals)),
                    12 => Some((3, 4, literals)),
                    16 => Some((4, 4, literals)),
                    _ => None,
                }
            }
            _ => None,
        }
    }

    /// As a list of this length: a flat list, a single row or a single column.
    pub(super) fn vector(&self, length: usize) -> Option<&[Literal]> {
        let (Self::Flat(literals) | Self::Grid { rows: 1, literals, .. } | Self::Grid { cols: 1, literals, .. }) = self
        else {
            return None;
        };
        (literals.len() == length).then_some(literals)
    }

    /// All numbers, in order.
    pub(super) fn literals(&self) -> &[Literal] {
        match self {
            Self::Flat(literals) | Self::Grid { literals, .. } => literals,
            Self::Misfit(_) => &[],
        }
    }
}

/// The numbers of a value: a list, a list of lists, `{rows, cols, data}`, or a text of several numbers.
pub(super) fn numbers(node: &Node, source: &str) -> Option<Numbers> {
    match &node.kind {
        Kind::Scalar { .. } => words(node, source).map(Numbers::Flat),
        Kind::Sequence(items) => list(items),
        Kind::Mapping(_) => declared(node, source),
    }
}

fn list(items: &[Node]) -> Option<Numbers> {
    if items.is_empty() || items.len() > LONGEST {
        return None;
    }
    if items.iter().all(|item| item.items().is_some()) {
        let rows: Vec<Vec<Literal>> = items.iter().filter_map(|item| scalars(item.items()?)).collect();
        if rows.len() != items.len() || rows.len() > 16 {
            return None;
        }
        let cols = rows.first()?.len();
        if rows.iter().any(|row| row.len() != cols) {
            let counts: Vec<String> = rows.iter().map(|row| row.len().to_string()).collect();
            return Some(Numbers::Misfit(format!("its rows have {} numbers", counts.join(", "))));
        }
        return Some(Numbers::Grid {
            rows: rows.len(),
            cols,
            literals: rows.into_iter().flatten().collect(),
        });
    }
    scalars(items).map(Numbers::Flat)
}

/// `{rows, cols, data}` of OpenCV, camera_info and EuRoC.
fn declared(node: &Node, source: &str) -> Option<Numbers> {
    let data = node.get("data")?;
    if node.cut {
        return None;
    }
    let found = numbers(data, source)?;
    let count = |key: &str| node.get(key)?.text()?.trim().parse::<usize>().ok();
    let (Some(rows), Some(cols)) = (count("rows"), count("cols")) else {
        return Some(found);
    };
    match found {
        Numbers::Flat(literals) | Numbers::Grid { literals, .. } if rows.checked_mul(cols) == Some(literals.len()) => {
            Some(Numbers::Grid { rows, cols, literals })
        }
        Numbers::Misfit(why) => Some(Numbers::Misfit(why)),
        other => Some(Numbers::Misfit(format!(
            "it declares {rows} rows of {cols}, but its data has {} numbers",
            other.literals().len()
        ))),
    }
}

/// A list of scalars as literals, if most of them are numbers. A text in between becomes a literal without value.
fn scalars(items: &[Node]) -> Option<Vec<Literal>> {
    if items.is_empty() || items.len() > LONGEST {
        return None;
    }
    let literals: Vec<Literal> = items.iter().filter_map(literal).collect();
    let bad = literals.iter().filter(|l| number(&l.text).is_none()).count();
    (literals.len() == items.len() && bad * 2 < literals.len()).then_some(literals)
}

/// A scalar as a literal; its value is NaN if the text is not a number.
pub(super) fn literal(node: &Node) -> Option<Literal> {
    let Kind::Scalar { text, quoted } = &node.kind else {
        return None;
    };
    let inset = usize::from(*quoted && node.span.end >= node.span.start + 2);
    Some(Literal {
        text: text.as_ref().into(),
        value: number(text).unwrap_or(f64::NAN),
        span: Span::new(node.span.start + inset, node.span.end.saturating_sub(inset)),
    })
}

/// Several numbers in one text (`"0.1 0 1.2"`), each with its place.
fn words(node: &Node, source: &str) -> Option<Vec<Literal>> {
    let Kind::Scalar { text, quoted } = &node.kind else {
        return None;
    };
    if text.len() > 2000 || !text.contains([' ', ',']) {
        return None;
    }
    let start = node.span.start + usize::from(*quoted);
    // Escapes and folded lines would move the places.
    if source.get(start..start + text.len()) != Some(text) {
        return None;
    }
    let mut literals = Vec::new();
    let mut at = start;
    for piece in text.split_inclusive([' ', ',', '\t', '\n']) {
        let word = piece.trim_matches([' ', ',', '\t', '\n', '\r']);
        if !word.is_empty() {
            literals.push(Literal {
                text: word.into(),
                value: number(word)?,
                span: Span::new(at, at + word.len()),
            });
        }
        at += piece.len();
    }
    (literals.len() > 1 && literals.len() <= LONGEST).then_some(literals)
}

/// A number in the spelling of YAML, JSON and their readers.
pub(super) fn number(text: &str) -> Option<f64> {
    let text = text.trim();
    match text.trim_start_matches(['+', '-']).to_ascii_lowercase().as_str() {
        ".nan" | "nan" => return Some(f64::NAN),
        ".inf" | "inf" | "infinity" => {
            return Some(if text.starts_with('-') {
                f64::NEG_INFINITY
            } else {
                f64::INFINITY
            });
        }
        _ => {}
    }
    let plausible = text.contains(|c: char| c.is_ascii_digit())
        && text
            .chars()
            .all(|c| c.is_ascii_digit() || matches!(c, '+' | '-' | '.' | 'e' | 'E'));
    plausible.then(|| text.parse().ok()).flatten()
}

/// The values of literals.
pub(super) fn values(literals: &[Literal]) -> Vec<f64> {
    literals.iter().map(|l| l.value).collect()
}

/// The first `N` values.
pub(super) fn array<const N: usize>(literals: &[Literal]) -> Option<[f64; N]> {
    let values = values(literals);
    values.get(..N)?.try_into().ok()
}

/// The upper left 3x3 of a row-major matrix.
pub(super) fn upper_left(cols: usize, values: &[f64]) -> Option<Matrix3<f64>> {
    let mut m = Matrix3::zeros();
    for row in 0..3 {
        for col in 0..3 {
            *m.get_mut((row, col))? = *values.get(row * cols + col)?;
        }
    }
    Some(m)
}

/// Whether a matrix looks like a rotation or a rigid transform by its numbers alone. Diagonal matrices do not count:
/// identities and masks are everywhere.
pub(super) fn looks_rigid(rows: usize, cols: usize, values: &[f64]) -> bool {
    let Some(m) = upper_left(cols, values) else {
        return false;
    };
    let diagonal = (0..3).all(|r| (0..3).all(|c| r == c || m.get((r, c)).is_some_and(|v| *v == 0.0)));
    let bottom = rows < 4 || bottom_row(values).is_some_and(is_homogeneous);
    !diagonal && bottom && near_rotation(&m)
}

/// Whether the numbers of three or four rows of four are a rigid transform, identities among them, or the transpose of one.
pub(super) fn is_rigid_or_turned_over(rows: usize, values: &[f64]) -> bool {
    let is_near = upper_left(4, values).is_some_and(|m| near_rotation(&m));
    let last =
        |step: usize, from: usize| [0, 1, 2, 3].map(|at| values.get(from + step * at).copied().unwrap_or(f64::NAN));
    is_near && (rows == 3 || is_homogeneous(last(1, 12)) || is_homogeneous(last(4, 3)))
}

/// Whether a 3x3 is within [`NEAR`] of an orthogonal matrix.
pub(super) fn near_rotation(m: &Matrix3<f64>) -> bool {
    let error = rotation::orthogonality_error(m);
    error.is_finite() && error <= NEAR
}

/// Whether four numbers could be a quaternion by their norm.
pub(super) fn near_unit(literals: &[Literal]) -> bool {
    array(literals).is_some_and(|q| (rotation::quaternion_norm(q) - 1.0).abs() <= NEAR)
}

/// The fourth row of a 4x4.
fn bottom_row(values: &[f64]) -> Option<[f64; 4]> {
    values.get(12..16)?.try_into().ok()
}

fn is_homogeneous(row: [f64; 4]) -> bool {
    row.iter().zip([0.0, 0.0, 0.0, 1.0]).all(|(a, b)| (a - b).abs() <= 1e-6)
}

/// The pose of a matrix; `None` for a reflection, for anything far from a rotation, and for a 4x4 whose bottom
/// row is not `0 0 0 1`.
pub(super) fn matrix_pose(rows: usize, cols: usize, values: &[f64]) -> Option<Pose> {
    let m = upper_left(cols, values)?;
    let rigid = rotation::det(&m) > 0.0 && rotation::orthogonality_error(&m) <= POSE;
    if !rigid || (rows == 4 && !bottom_row(values).is_some_and(is_homogeneous)) {
        return None;
    }
    let nearest = UnitQuaternion::from_rotation_matrix(&rotation::nearest_rotation(&m)?.rotation).coords;
    let translation = if cols == 4 {
        [*values.get(3)?, *values.get(7)?, *values.get(11)?]
    } else {
        [0.0; 3]
    };
    Pose::from_raw(translation, [nearest.x, nearest.y, nearest.z, nearest.w])
}

/// The pose of a translation and fixed-axis roll, pitch, yaw in radians.
pub(super) fn rpy_pose(xyz: [f64; 3], [roll, pitch, yaw]: [f64; 3]) -> Option<Pose> {
    let q = rotation::from_rpy(roll, pitch, yaw).coords;
    Pose::from_raw(xyz, [q.x, q.y, q.z, q.w])
}
