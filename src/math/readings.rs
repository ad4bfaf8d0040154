//! The ways to read four published numbers as a rotation.
//!
//! Owns the four readings of a quaternion that data can distinguish. Must not know how: see [`turns`](super::turns) and
//! [`gravity`](super::gravity). Source: `rules/quat/quaternion-convention.md`.

use nalgebra::{Quaternion, UnitQuaternion};

/// The meaning of the four numbers in the slots x, y, z, w of a message.
///
/// A conjugate is a quaternion of the other algebra (JPL) read as Hamilton's, or the rotation from world to body where
/// that from body to world is expected: the same four numbers, so no data can distinguish these two.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Reading {
    /// As the slots say, `world_from_body`: the convention of ROS.
    Xyzw,
    /// As the slots say, but `body_from_world`.
    Conjugate,
    /// The slots x, y, z, w hold w, x, y, z.
    Wxyz,
    /// The slots x, y, z, w hold w, x, y, z, of `body_from_world`.
    WxyzConjugate,
}

impl Reading {
    /// Every reading, the standard one first.
    pub const ALL: [Reading; 4] = [Reading::Xyzw, Reading::Conjugate, Reading::Wxyz, Reading::WxyzConjugate];

    /// The stable word of this reading, as used in reports.
    pub fn word(self) -> &'static str {
        match self {
            Reading::Xyzw => "xyzw",
            Reading::Conjugate => "conjugate",
            Reading::Wxyz => "wxyz",
            Reading::WxyzConjugate => "wxyz-conjugate",
        }
    }

    /// `world_from_body` under this reading of the numbers in the slots `[x, y, z, w]`, made unit length.
    ///
    /// `None` when a number is not finite or the norm is under 1e-6: zeros are no rotation.
    pub fn world_from_body(self, slots: [f64; 4]) -> Option<UnitQuaternion<f64>> {
        let [a, b, c, d] = slots;
        let q = match self {
            Reading::Xyzw => Quaternion::new(d, a, b, c),
            Reading::Conjugate => Quaternion::new(d, -a, -b, -c),
            Reading::Wxyz => Quaternion::new(a, b, c, d),
            Reading::WxyzConjugate => Quaternion::new(a, -b, -c, -d),
        };
        let norm = q.norm();
        (norm.is_finite() && norm >= 1e-6).then(|| UnitQuaternion::new_unchecked(q / norm))
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;
    use crate::math::rotation::from_rpy;

    #[test]
    fn each_reading_undoes_its_own_spelling() {
        let truth = from_rpy(0.3, -0.5, 2.0);
        let (q, p) = (truth, truth.inverse());
        let spelled = [
            (Reading::Xyzw, [q.i, q.j, q.k, q.w]),
            (Reading::Conjugate, [p.i, p.j, p.k, p.w]),
            (Reading::Wxyz, [q.w, q.i, q.j, q.k]),
            (Reading::WxyzConjugate, [p.w, p.i, p.j, p.k]),
        ];
        for (reading, slots) in spelled {
            let read = reading.world_from_body(slots.map(|v| 1.02 * v)).unwrap();
            assert!(read.angle_to(&truth) < 1e-7, "{}", reading.word());
        }
        for slots in [
            [0.0; 4],
            [f64::NAN, 0.0, 0.0, 1.0],
            [f64::INFINITY, 0.0, 0.0, 1.0],
            [1e200; 4],
        ] {
            assert_eq!(Reading::Xyzw.world_from_body(slots), None);
        }
    }
}
