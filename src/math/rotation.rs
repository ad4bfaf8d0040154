//! Forms of rotations, and the validity of a matrix that should be a rotation.
//!
//! Owns: fixed-axis rpy, a pose of its two halves, the angle between rotations, the diagnosis of a raw 3x3 (determinant, orthogonality, nearest
//! rotation, mirror, scale) and how much of an error its printed digits explain. Must not know where the numbers came
//! from or how severe an error is: rules decide that. Nothing here assumes that its input is a rotation unless
//! the type says so.

use nalgebra::{Isometry3, Matrix3, Rotation3, Translation3, UnitQuaternion, Vector3};

use super::stats::rounded;

/// URDF `rpy` (radians, about the fixed axes x, then y, then z of the parent) to `parent_from_child`:
/// `R = Rz(yaw) * Ry(pitch) * Rx(roll)` (URDF specification, `origin` element; the same as tf2 `setRPY`).
pub fn from_rpy(roll: f64, pitch: f64, yaw: f64) -> UnitQuaternion<f64> {
    UnitQuaternion::from_euler_angles(roll, pitch, yaw)
}

/// The fixed-axis `(roll, pitch, yaw)` of a rotation, in radians: `from_rpy` of it is the same rotation.
///
/// Roll and yaw are in -pi..=pi, pitch in -pi/2..=pi/2. At pitch = +-pi/2 only roll -+ yaw is defined and yaw is set
/// to 0, as tf2 does. Never compare rotations by these numbers: two different triples can be one rotation.
pub fn to_rpy(rotation: &UnitQuaternion<f64>) -> (f64, f64, f64) {
    let m = rotation.to_rotation_matrix();
    let m = m.matrix();
    let cos_pitch = m.m11.hypot(m.m21);
    let pitch = (-m.m31).atan2(cos_pitch);
    // Below this the entries that hold roll and yaw are rounding noise. A literal of 1.5708 is off by 4e-6.
    if cos_pitch < 1e-9 {
        return ((-m.m23).atan2(m.m22), pitch, 0.0);
    }
    (m.m32.atan2(m.m33), pitch, m.m21.atan2(m.m11))
}

/// A rotation as text, in whole degrees: `RPY(0, 0, 90) deg`.
pub(crate) fn rpy_in_words(rotation: &UnitQuaternion<f64>) -> String {
    let (roll, pitch, yaw) = to_rpy(rotation);
    let [roll, pitch, yaw] = [roll, pitch, yaw].map(|angle| rounded(angle.to_degrees(), 0));
    format!("RPY({roll}, {pitch}, {yaw}) deg")
}

/// A rotation as a text: `180.0 deg about x` along an axis, else as [`rpy_in_words`].
pub(crate) fn turn_in_words(rotation: &UnitQuaternion<f64>) -> String {
    const AXES: [&str; 3] = ["x", "y", "z"];
    let along = rotation.axis_angle().and_then(|(axis, angle)| {
        let (part, name) = axis.iter().zip(AXES).find(|(part, _)| part.abs() > 0.9999)?;
        // Half a turn has no sign.
        let is_half = (angle.to_degrees() - 180.0).abs() < 0.05;
        let signed = if is_half { angle } else { angle * part.signum() };
        Some(format!("{:.1} deg about {name}", signed.to_degrees()))
    });
    along.unwrap_or_else(|| rpy_in_words(rotation))
}

/// A rotation as the text of a quaternion x y z w; of the two quaternions that are this rotation, the one with w >= 0.
pub(crate) fn xyzw_in_words(rotation: &UnitQuaternion<f64>, decimals: i32) -> String {
    let q = rotation.coords;
    let sign = if q.w < -1e-9 { -1.0 } else { 1.0 };
    let digits = usize::try_from(decimals).unwrap_or_default();
    let [x, y, z, w] = <[f64; 4]>::from(q * sign).map(|value| rounded(value, decimals));
    format!("[{x:.digits$}, {y:.digits$}, {z:.digits$}, {w:.digits$}]")
}

/// `target_from_source` of its rotation and of a translation (metres) that is stated apart: the origin of the source in the
/// target, or, with `is_inverse`, the origin of the target in the source.
pub fn pose_of_halves(
    rotation: UnitQuaternion<f64>,
    translation: Translation3<f64>,
    is_inverse: bool,
) -> Isometry3<f64> {
    if is_inverse {
        Isometry3::from_parts(translation, rotation.inverse()).inverse()
    } else {
        Isometry3::from_parts(translation, rotation)
    }
}

/// The angle in radians, 0..=pi, of the rotation that takes `a` to `b`.
///
/// By atan2 of the quaternion's vector part: exact to rounding at 0 and at pi, where the arccosine of a trace loses
/// half of the digits.
pub fn rotation_angle_between(a: &UnitQuaternion<f64>, b: &UnitQuaternion<f64>) -> f64 {
    let turn = a.conjugate() * b;
    2.0 * turn.imag().norm().atan2(turn.w.abs())
}

/// Whether two transforms between the same frames differ by no more than an angle (radians) and a distance (metres).
pub fn is_near(a: &Isometry3<f64>, b: &Isometry3<f64>, [angle_rad, distance_m]: [f64; 2]) -> bool {
    rotation_angle_between(&a.rotation, &b.rotation) <= angle_rad
        && (a.translation.vector - b.translation.vector).norm() <= distance_m
}

/// The norm of a raw quaternion `[x, y, z, w]`. 1 for a rotation; not finite when a component is not.
pub fn quaternion_norm(xyzw: [f64; 4]) -> f64 {
    let [x, y, z, w] = xyzw;
    x.hypot(y).hypot(z.hypot(w))
}

/// The determinant of a raw 3x3: 1 for a rotation, -1 for a reflection.
pub fn det(m: &Matrix3<f64>) -> f64 {
    m.determinant()
}

/// The Frobenius norm of `m^T m - I`: 0 for a rotation or a reflection.
///
/// To first order it is twice the Frobenius distance of `m` to the nearest orthogonal matrix.
pub fn orthogonality_error(m: &Matrix3<f64>) -> f64 {
    (m.tr_mul(m) - Matrix3::identity()).norm()
}

/// The singular values of a raw 3x3, largest first. All 1 for a rotation. `None` when an entry is not finite
/// or its square overflows.
pub fn singular_values(m: &Matrix3<f64>) -> Option<[f64; 3]> {
    let svd = finite(m)?.try_svd(false, false, CONVERGED, MAX_ITERATIONS)?;
    let mut values: [f64; 3] = svd.singular_values.into();
    values.sort_by(|a, b| b.total_cmp(a));
    Some(values)
}

/// The rotation nearest to a raw 3x3, with how far away it was.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct NearestRotation {
    /// The proper rotation with the smallest Frobenius distance to the matrix.
    pub rotation: Rotation3<f64>,
    /// The Frobenius distance between the matrix and `rotation`. Dimensionless.
    pub distance: f64,
    /// The angle in radians by which the axis moves that moves most, when the matrix (its columns made unit length) is
    /// replaced by `rotation`: what a fix would change. pi/2 or more for a reflection.
    pub angle_moved_rad: f64,
}

/// The proper rotation nearest to `m` in the Frobenius norm: `U diag(1, 1, det(U V^T)) V^T` of the singular value
/// decomposition (Kabsch 1976; Umeyama 1991, lemma).
///
/// `None` when an entry is not finite or its square overflows, or when the matrix is so singular that no single rotation is nearest (the second
/// singular value is under 1e-9 of the first).
pub fn nearest_rotation(m: &Matrix3<f64>) -> Option<NearestRotation> {
    let svd = finite(m)?.try_svd(true, true, CONVERGED, MAX_ITERATIONS)?;
    let [largest, second, _]: [f64; 3] = svd.singular_values.into();
    if second.is_nan() || second <= 1e-9 * largest {
        return None;
    }
    let (u, v_t) = (svd.u?, svd.v_t?);
    let sign = (u * v_t).determinant().signum();
    let r = u * Matrix3::from_diagonal(&Vector3::new(1.0, 1.0, sign)) * v_t;
    let angle_moved_rad = m
        .column_iter()
        .zip(r.column_iter())
        .map(|(a, b)| a.cross(&b).norm().atan2(a.dot(&b)))
        .fold(0.0, f64::max);
    Some(NearestRotation {
        rotation: Rotation3::from_matrix_unchecked(r),
        distance: (m - r).norm(),
        angle_moved_rad,
    })
}

/// Far more sweeps than a 3x3 needs; a bound so that no input can make the decomposition run on.
const MAX_ITERATIONS: usize = 200;

/// The convergence limit that nalgebra itself takes for a singular value decomposition.
const CONVERGED: f64 = 5.0 * f64::EPSILON;

fn finite(m: &Matrix3<f64>) -> Option<Matrix3<f64>> {
    m.iter().all(|v| v.is_finite()).then_some(*m)
}

/// One axis negated, or two axes exchanged: the ways a right-handed triad becomes left-handed by one error.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Flip {
    /// The first column (the child's x axis, seen from the parent) is negated.
    ColumnX,
    /// The second column (the child's y axis) is negated.
    ColumnY,
    /// The third column (the child's z axis) is negated.
    ColumnZ,
    /// The first row (the parent's x coordinate) is negated.
    RowX,
    /// The second row (the parent's y coordinate) is negated.
    RowY,
    /// The third row (the parent's z coordinate) is negated.
    RowZ,
    /// The columns x and y are exchanged.
    SwapXY,
    /// The columns y and z are exchanged.
    SwapYZ,
    /// The columns z and x are exchanged.
    SwapZX,
}

impl Flip {
    /// Every flip, simplest first: a tie goes to the earlier one.
    pub fn all() -> &'static [Flip] {
        &[
            Flip::ColumnX,
            Flip::ColumnY,
            Flip::ColumnZ,
            Flip::RowX,
            Flip::RowY,
            Flip::RowZ,
            Flip::SwapXY,
            Flip::SwapYZ,
            Flip::SwapZX,
        ]
    }

    /// What happened, for a message: "the y axis is negated (second column)".
    pub fn describe(self) -> &'static str {
        match self {
            Flip::ColumnX => "the x axis is negated (first column)",
            Flip::ColumnY => "the y axis is negated (second column)",
            Flip::ColumnZ => "the z axis is negated (third column)",
            Flip::RowX => "the x coordinate is negated (first row)",
            Flip::RowY => "the y coordinate is negated (second row)",
            Flip::RowZ => "the z coordinate is negated (third row)",
            Flip::SwapXY => "the x and y axes are exchanged (first and second column)",
            Flip::SwapYZ => "the y and z axes are exchanged (second and third column)",
            Flip::SwapZX => "the z and x axes are exchanged (third and first column)",
        }
    }

    /// The matrix with this error undone. Each flip is its own inverse.
    pub fn undo(self, m: &Matrix3<f64>) -> Matrix3<f64> {
        let diag = |x, y, z| Matrix3::from_diagonal(&Vector3::new(x, y, z));
        let mut r = *m;
        match self {
            Flip::ColumnX => r *= diag(-1.0, 1.0, 1.0),
            Flip::ColumnY => r *= diag(1.0, -1.0, 1.0),
            Flip::ColumnZ => r *= diag(1.0, 1.0, -1.0),
            Flip::RowX => r = diag(-1.0, 1.0, 1.0) * r,
            Flip::RowY => r = diag(1.0, -1.0, 1.0) * r,
            Flip::RowZ => r = diag(1.0, 1.0, -1.0) * r,
            Flip::SwapXY => r.swap_columns(0, 1),
            Flip::SwapYZ => r.swap_columns(1, 2),
            Flip::SwapZX => r.swap_columns(2, 0),
        }
        r
    }
}

/// What is wrong with a raw 3x3 that should be a rotation.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Diagnosis {
    /// A rotation within the allowed error.
    Proper,
    /// Orthogonal with determinant -1: a mirror image, which no rotation of a rigid body is.
    ///
    /// Undoing *any* flip of an exact reflection gives a proper rotation, so the matrix alone cannot show which axis was
    /// negated (the smallest residual is 0 for all). `flip` is the one with the smallest remaining angle to
    /// the reference; `residual_rad` is that angle.
    Reflection {
        /// The flip with the smallest remaining rotation relative to the reference.
        flip: Flip,
        /// The residual angle after undoing it, in radians.
        residual_rad: f64,
    },
    /// A positive multiple of a rotation: all singular values equal, and not 1 (a similarity, or a unit mix).
    Scaled {
        /// The common singular value.
        factor: f64,
    },
    /// Neither: sheared, unequal scales, a wrong or missing entry, or something that was never a rotation.
    NotOrthogonal,
    /// An entry is NaN or infinite.
    NotFinite,
}

/// Below this Frobenius norm of `m^T m - I` a matrix with a negative determinant is called a reflection: it belongs to
/// det in [-1.05, -0.95].
const REFLECTION_ORTHOGONALITY: f64 = 0.1;

/// Singular values within this share of their mean count as equal when a common scale is looked for.
const EQUAL_SCALE: f64 = 1e-3;

/// Diagnoses a raw 3x3. `allowed` is the Frobenius norm of `m^T m - I` that still counts as a rotation, for example
/// [`allowed_orthogonality_error`] of the same matrix. A mirror's axis is named relative to `reference`: another source's
/// value of the same rotation, or the identity when there is none.
pub fn diagnose(m: &Matrix3<f64>, allowed: f64, reference: &Rotation3<f64>) -> Diagnosis {
    if finite(m).is_none() {
        return Diagnosis::NotFinite;
    }
    // Finite and yet without singular values: entries so large that their squares overflow.
    let Some([s1, s2, s3]) = singular_values(m) else {
        return Diagnosis::NotOrthogonal;
    };
    let error = orthogonality_error(m);
    if det(m) < 0.0 {
        return if error <= allowed.max(REFLECTION_ORTHOGONALITY) {
            reflection(m, reference)
        } else {
            Diagnosis::NotOrthogonal
        };
    }
    if error <= allowed {
        return Diagnosis::Proper;
    }
    let mean = (s1 + s2 + s3) / 3.0;
    // A common scale explains the error only if the spread is small against the scale itself.
    if mean > 0.0 && s1 - s3 <= mean * EQUAL_SCALE && s1 - s3 <= 0.1 * (mean - 1.0).abs() {
        return Diagnosis::Scaled { factor: mean };
    }
    Diagnosis::NotOrthogonal
}

fn reflection(m: &Matrix3<f64>, reference: &Rotation3<f64>) -> Diagnosis {
    let reference = UnitQuaternion::from_rotation_matrix(reference);
    let mut best: Option<(Flip, f64)> = None;
    for &flip in Flip::all() {
        let Some(nearest) = nearest_rotation(&flip.undo(m)) else {
            continue;
        };
        let angle = rotation_angle_between(&reference, &UnitQuaternion::from_rotation_matrix(&nearest.rotation));
        // Rounding must not decide a tie between two flips that are equally good.
        if best.is_none_or(|(_, least)| angle < least - 1e-6) {
            best = Some((flip, angle));
        }
    }
    match best {
        Some((flip, residual_rad)) => Diagnosis::Reflection { flip, residual_rad },
        None => Diagnosis::NotOrthogonal,
    }
}

/// The decimals of the shortest decimal number that reads back as `x`: 0.0356 has 4, also when it was printed as
/// `3.559999999999999970e-02`; 1e-7 has 7; 5, 1e300, NaN and infinities have 0.
pub fn decimals_of(x: f64) -> u32 {
    if !x.is_finite() {
        return 0;
    }
    // `Display` of f64 is the shortest round-trip form and never uses an exponent.
    let text = x.to_string();
    text.split_once('.')
        .map_or(0, |(_, digits)| u32::try_from(digits.len()).unwrap_or(u32::MAX))
}

/// The largest Frobenius norm of `R^T R - I` that rounding the nine entries of a rotation to `decimals` can cause:
/// `3 * 10^-decimals` (twice the norm of nine errors of half a unit; the RMS is `sqrt(9/12) * 2 * 10^-decimals`).
pub fn expected_rounding_error(decimals: u32) -> f64 {
    3.0 * 10f64.powi(-i32::try_from(decimals).unwrap_or(i32::MAX))
}

/// The decimals that decide for a list of printed numbers: the fewest among those that are no integer and at least 0.1
/// in size. +-0.5 is left out as well: it is exact at any precision (cos 60 deg), and would allow an error of 0.3.
/// `None` when no entry decides.
pub fn deciding_decimals(entries: impl IntoIterator<Item = f64>) -> Option<u32> {
    entries
        .into_iter()
        .filter(|x| x.abs() >= 0.1 && x.fract() != 0.0 && (x.abs() - 0.5).abs() > 1e-15)
        .map(decimals_of)
        .min()
}

/// The Frobenius norm of `m^T m - I` that the digits of `m` excuse: `max(2e-6, 3 * 10^-d)`, `d` from
/// [`deciding_decimals`].
///
/// Measured on 715 published rotation matrices: no false alarm, where a flat limit of 1e-5 has four. The floor covers
/// matrices that were composed or truncated upstream (worst 1.24e-6).
pub fn allowed_orthogonality_error(m: &Matrix3<f64>) -> f64 {
    deciding_decimals(m.iter().copied()).map_or(2e-6, |d| expected_rounding_error(d).max(2e-6))
}

/// The `|norm - 1|` that the digits of a raw quaternion `[x, y, z, w]` excuse: `max(1e-6, 10^-d)`, `d` from
/// [`deciding_decimals`].
pub fn allowed_quaternion_norm_error(xyzw: [f64; 4]) -> f64 {
    deciding_decimals(xyzw).map_or(1e-6, |d| (expected_rounding_error(d) / 3.0).max(1e-6))
}
