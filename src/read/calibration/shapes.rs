//! Shapes of transforms: matrices, quaternions and roll-pitch-yaw, as lists or as mappings, converted to drafts of claims.
//!
//! Owns spelling, units and order of numbers. Knows no frames and no paths.

use crate::source::Span;
use crate::world::{Literal, Pose, Spelling};

use super::dialect::Terms;
use super::document::Node;
use super::names::{self, PairHalf};
use super::numbers::{self, array, matrix_pose, rpy_pose, values};

/// The numbers of a claim, before its name is known.
#[derive(Clone, Debug)]
pub(super) struct Draft {
    /// As written, in metres and radians.
    pub(super) spelling: Spelling,
    /// The transform, if the numbers are one.
    pub(super) pose: Option<Pose>,
    /// Whether a rotation was stated.
    pub(super) has_rotation: bool,
    /// Whether a translation was stated.
    pub(super) has_translation: bool,
    /// Literals of the translation, in the file's units.
    pub(super) translation: Vec<Literal>,
    /// Literals of the rotation or the whole matrix; quaternions always as x, y, z, w; in the file's units.
    pub(super) rotation: Vec<Literal>,
    /// The value in the text.
    pub(super) span: Span,
}

impl Draft {
    /// Whether the order of a quaternion had to be guessed.
    pub(super) fn order_guessed(&self) -> bool {
        matches!(self.spelling, Spelling::Quaternion { order_known: false, .. })
    }
}

/// One half of a transform: its rotation.
#[derive(Clone, Debug)]
pub(super) enum Rotation {
    /// Nine numbers, row-major.
    Matrix(Vec<Literal>),
    /// Four numbers, put into the order x, y, z, w.
    Quaternion { literals: Vec<Literal>, order_known: bool },
    /// Roll, pitch, yaw.
    Rpy { literals: Vec<Literal>, degrees: bool },
}

/// A 3x3, 3x4 or 4x4.
pub(super) fn matrix(rows: usize, cols: usize, literals: &[Literal], metres: f64, span: Span) -> Draft {
    let mut numbers = values(literals);
    let mut translation = Vec::new();
    if cols == 4 {
        for at in [3, 7, 11] {
            if let Some(value) = numbers.get_mut(at) {
                *value *= metres;
            }
            translation.extend(literals.get(at).cloned());
        }
    }
    Draft {
        pose: matrix_pose(rows, cols, &numbers),
        has_rotation: true,
        has_translation: cols == 4,
        spelling: Spelling::Matrix {
            rows,
            cols,
            values: numbers,
        },
        translation,
        rotation: literals.to_vec(),
        span,
    }
}

/// A translation, a rotation, or both. `None` without either.
pub(super) fn combine(
    translation: Option<&[Literal]>,
    rotation: Option<&Rotation>,
    metres: f64,
    span: Span,
) -> Option<Draft> {
    let xyz = match translation {
        Some(literals) => array::<3>(literals)?.map(|v| v * metres),
        None => [0.0; 3],
    };
    let (spelling, pose, literals) = match rotation {
        None => {
            translation?;
            (
                Spelling::Translation { xyz },
                Pose::from_raw(xyz, Pose::IDENTITY.rotation_xyzw),
                Vec::new(),
            )
        }
        Some(Rotation::Matrix(literals)) => {
            let numbers = values(literals);
            let pose = matrix_pose(3, 3, &numbers).and_then(|pose| Pose::from_raw(xyz, pose.rotation_xyzw));
            let spelling = Spelling::Matrix {
                rows: 3,
                cols: 3,
                values: numbers,
            };
            (spelling, pose, literals.clone())
        }
        Some(Rotation::Quaternion { literals, order_known }) => {
            let xyzw = array::<4>(literals)?;
            let order_known = *order_known;
            let spelling = Spelling::Quaternion { xyz, xyzw, order_known };
            (spelling, Pose::from_raw(xyz, xyzw), literals.clone())
        }
        Some(Rotation::Rpy { literals, degrees }) => {
            let written = array::<3>(literals)?;
            let rpy = if *degrees {
                written.map(f64::to_radians)
            } else {
                written
            };
            (Spelling::Rpy { xyz, rpy }, rpy_pose(xyz, rpy), literals.clone())
        }
    };
    Some(Draft {
        spelling,
        pose,
        has_rotation: rotation.is_some(),
        has_translation: translation.is_some(),
        translation: translation.map(<[Literal]>::to_vec).unwrap_or_default(),
        rotation: literals,
        span,
    })
}

/// A list of seven: x y z qx qy qz qw, the order of TUM trajectories, GLIM and tf's command line. The order of the
/// last four is known only if the key states it.
pub(super) fn seven(key: &str, literals: &[Literal], terms: Terms, span: Span) -> Option<Draft> {
    let (translation, four) = literals.split_at_checked(3)?;
    let rotation = quaternion(four, names::says_order(key).or(terms.xyzw))?;
    combine(Some(translation), Some(&rotation), terms.metres, span)
}

/// Four numbers; `xyzw` is their order, x y z w or w x y z, if it is known.
fn quaternion(four: &[Literal], xyzw: Option<bool>) -> Option<Rotation> {
    let [a, b, c, d] = four else { return None };
    let literals = match xyzw {
        Some(false) => vec![b.clone(), c.clone(), d.clone(), a.clone()],
        _ => four.to_vec(),
    };
    Some(Rotation::Quaternion {
        literals,
        order_known: xyzw.is_some(),
    })
}

const POSITIONS: &[[&str; 3]] = &[
    ["x", "y", "z"],
    ["px", "py", "pz"],
    ["tx", "ty", "tz"],
    ["p_x", "p_y", "p_z"],
    ["t_x", "t_y", "t_z"],
    ["x_m", "y_m", "z_m"],
    ["tx_m", "ty_m", "tz_m"],
    ["pose_x", "pose_y", "pose_z"],
];
const POSITIONS_MM: &[[&str; 3]] = &[["x_mm", "y_mm", "z_mm"], ["tx_mm", "ty_mm", "tz_mm"]];
const QUATERNIONS: &[[&str; 4]] = &[["qx", "qy", "qz", "qw"], ["q_x", "q_y", "q_z", "q_w"]];
const ANGLES: &[[&str; 3]] = &[
    ["roll", "pitch", "yaw"],
    ["roll_rad", "pitch_rad", "yaw_rad"],
    ["pose_roll", "pose_pitch", "pose_yaw"],
];
const ANGLES_DEG: &[[&str; 3]] = &[
    ["roll_deg", "pitch_deg", "yaw_deg"],
    ["roll_degrees", "pitch_degrees", "yaw_degrees"],
];

/// The literals under the first set of keys that a mapping has all of, most of them numbers.
fn fields<const N: usize>(node: &Node, sets: &[[&str; N]]) -> Option<Vec<Literal>> {
    if node.cut {
        return None;
    }
    sets.iter().find_map(|keys| {
        let literals: Vec<Literal> = keys.iter().filter_map(|key| numbers::literal(node.get(key)?)).collect();
        let good = literals.iter().filter(|l| numbers::number(&l.text).is_some()).count();
        (literals.len() == N && good * 2 > N).then_some(literals)
    })
}

/// A translation: a mapping of three numbers with its factor to metres, or a list of three.
pub(super) fn translation(key: &str, node: &Node, source: &str, terms: Terms) -> Option<(Vec<Literal>, f64)> {
    let metres = if names::says_millimetres(key) {
        1e-3
    } else {
        terms.metres
    };
    if let Some(found) = numbers::numbers(node, source) {
        return found.vector(3).map(|literals| (literals.to_vec(), metres));
    }
    // A `w` makes it a quaternion.
    if node.get("w").is_some() {
        return None;
    }
    let plain = fields(node, POSITIONS).map(|literals| (literals, metres));
    plain.or_else(|| fields(node, POSITIONS_MM).map(|literals| (literals, 1e-3)))
}

/// A rotation under a key that names one.
pub(super) fn rotation(key: &str, half: PairHalf, node: &Node, source: &str, terms: Terms) -> Option<Rotation> {
    let degrees = terms.degrees || names::says_degrees(key);
    if let Some(found) = numbers::numbers(node, source) {
        if let Some((3, 3, literals)) = found.matrix() {
            return Some(Rotation::Matrix(literals.to_vec()));
        }
        if let Some(four) = found.vector(4) {
            return quaternion(four, names::says_order(key).or(terms.xyzw));
        }
        let is_of_angles = half == PairHalf::Angles || names::says_degrees(key);
        let three = found.vector(3).filter(|_| is_of_angles)?.to_vec();
        return Some(Rotation::Rpy {
            literals: three,
            degrees,
        });
    }
    // Argoverse wraps the four numbers.
    if let Some(inner) = node.get("coefficients") {
        let found = numbers::numbers(inner, source)?;
        return quaternion(found.vector(4)?, terms.xyzw);
    }
    let four = fields(node, QUATERNIONS).or_else(|| fields(node, &[["x", "y", "z", "w"]]));
    if let Some(literals) = four {
        return Some(Rotation::Quaternion {
            literals,
            order_known: true,
        });
    }
    Some(angles(node, degrees)?.0)
}

/// `{roll, pitch, yaw}`, and where they are.
pub(super) fn angles(node: &Node, degrees: bool) -> Option<(Rotation, Span)> {
    let plain = fields(node, ANGLES).map(|literals| (literals, degrees));
    let (literals, degrees) = plain.or_else(|| Some((fields(node, ANGLES_DEG)?, true)))?;
    let span = literals.iter().map(|literal| literal.span).reduce(Span::cover)?;
    Some((Rotation::Rpy { literals, degrees }, span))
}

/// A pose whose numbers are all keys of one mapping: `{x, y, z, roll, pitch, yaw}`, `{px, py, pz, qx, qy, qz, qw}`.
pub(super) fn flat_pose(key: &str, node: &Node, source: &str, terms: Terms) -> Option<Draft> {
    let (position, metres) = translation(key, node, source, terms)?;
    let rotation = match fields(node, QUATERNIONS) {
        Some(literals) => Rotation::Quaternion {
            literals,
            order_known: true,
        },
        None => angles(node, terms.degrees || names::says_degrees(key))?.0,
    };
    combine(Some(&position), Some(&rotation), metres, node.span)
}

/// A pose whose numbers are under `stem` and `_tx`, `_ty`, `_tz`, `_rx`, `_ry`, `_rz`.
pub(super) fn prefixed_pose(stem: &str, node: &Node, terms: Terms) -> Option<Draft> {
    let three = |kind: char| {
        let of = |axis| numbers::literal(node.get(&format!("{stem}_{kind}{axis}"))?);
        Some(vec![of('x')?, of('y')?, of('z')?])
    };
    let (position, angles) = (three('t')?, three('r')?);
    let span = position.first()?.span.cover(angles.last()?.span);
    let rotation = Rotation::Rpy {
        literals: angles,
        degrees: terms.degrees,
    };
    combine(Some(&position), Some(&rotation), terms.metres, span)
}

/// A rotation or a position whose numbers are under `stem` and `_x`, `_y`, `_z`, for a rotation `_w` as well.
pub(super) fn prefixed_half(stem: &str, node: &Node, terms: Terms) -> Option<Draft> {
    let of = |part| numbers::literal(node.get(&format!("{stem}_{part}"))?);
    let three = vec![of('x')?, of('y')?, of('z')?];
    let span = three.first()?.span.cover(three.last()?.span);
    let Some(w) = of('w') else {
        return combine(Some(&three), None, terms.metres, span);
    };
    let span = span.cover(w.span);
    let rotation = Rotation::Quaternion {
        literals: three.into_iter().chain([w]).collect(),
        order_known: true,
    };
    combine(None, Some(&rotation), 1.0, span)
}

/// A rotation whose numbers are all keys of one mapping: `{x, y, z, w}`, or `{roll, pitch, yaw}` under a key that means
/// a rotation.
pub(super) fn flat_rotation(node: &Node, speaks_of_rotation: bool, degrees: bool) -> Option<Draft> {
    let four = fields(node, QUATERNIONS).or_else(|| fields(node, &[["x", "y", "z", "w"]]));
    let rotation = match four {
        Some(literals) if speaks_of_rotation || numbers::near_unit(&literals) => Rotation::Quaternion {
            literals,
            order_known: true,
        },
        None if speaks_of_rotation => angles(node, degrees)?.0,
        _ => return None,
    };
    combine(None, Some(&rotation), 1.0, node.span)
}
