//! The maps: what a file with a given convention error holds when the truth is known.
//!
//! Owns the algebra of every relation. Must not decide anything: no tolerance lives here.

use nalgebra::{Isometry3, Quaternion, Translation3, UnitQuaternion, Vector3};

use super::Relation;
use crate::math::constants::AxisTurn;
use crate::math::rotation::{from_rpy, to_rpy};

type Pose = Isometry3<f64>;
type Turn = UnitQuaternion<f64>;

impl Relation {
    /// The transform that a file with this error holds when `truth` (`target_from_source`, metres) is the truth.
    ///
    /// The relations about roll, pitch and yaw take the truth's angles as [`to_rpy`] gives them: a file that spells the
    /// same rotation with other angles (yaw 270 for -90 degrees) holds something else in [`Relation::Degrees`].
    /// `None` when the result is not finite.
    pub fn apply(self, truth: &Isometry3<f64>) -> Option<Isometry3<f64>> {
        let (r, t) = (truth.rotation, truth.translation.vector);
        let held = match self {
            Relation::Equal => *truth,
            Relation::Inverse => truth.inverse(),
            Relation::Transposed => pose(r.inverse(), t),
            Relation::InverseTranslation => pose(r, truth.inverse().translation.vector),
            Relation::Wxyz => pose(quaternion(r.j, r.k, r.w, r.i), t),
            Relation::Xyzw => pose(quaternion(r.w, r.i, r.j, r.k), t),
            Relation::RotationLost => pose(Turn::identity(), t),
            Relation::TranslationLost => pose(r, Vector3::zeros()),
            Relation::TranslationNegated => pose(r, -t),
            Relation::Millimetres => pose(r, t * 1000.0),
            Relation::Metres => pose(r, t / 1000.0),
            Relation::Z180 => truth * AxisTurn::Z180.quaternion(),
            Relation::NedEnu => truth * AxisTurn::NedEnu.quaternion(),
            Relation::FluFrd => truth * AxisTurn::FluFrd.quaternion(),
            Relation::Optical => truth * AxisTurn::Optical.quaternion(),
            Relation::OpticalInverse => truth * AxisTurn::OpticalInverse.quaternion(),
            Relation::Z90 => truth * AxisTurn::Z90.quaternion(),
            Relation::ZMinus90 => truth * AxisTurn::ZMinus90.quaternion(),
            Relation::Y180 => truth * AxisTurn::Y180.quaternion(),
            Relation::X90 => truth * AxisTurn::X90.quaternion(),
            Relation::XMinus90 => truth * AxisTurn::XMinus90.quaternion(),
            Relation::Y90 => truth * AxisTurn::Y90.quaternion(),
            Relation::YMinus90 => truth * AxisTurn::YMinus90.quaternion(),
            Relation::LeftZ180 => AxisTurn::Z180.quaternion() * truth,
            Relation::LeftNedEnu => AxisTurn::NedEnu.quaternion() * truth,
            Relation::LeftFluFrd => AxisTurn::FluFrd.quaternion() * truth,
            Relation::LeftOptical => AxisTurn::Optical.quaternion() * truth,
            Relation::LeftOpticalInverse => AxisTurn::OpticalInverse.quaternion() * truth,
            Relation::LeftZ90 => AxisTurn::Z90.quaternion() * truth,
            Relation::LeftZMinus90 => AxisTurn::ZMinus90.quaternion() * truth,
            Relation::EnuFluNedFrd => AxisTurn::NedEnu.quaternion() * truth * AxisTurn::FluFrd.quaternion(),
            Relation::BothFluFrd => AxisTurn::FluFrd.quaternion() * truth * AxisTurn::FluFrd.quaternion(),
            Relation::BothNedEnu => AxisTurn::NedEnu.quaternion() * truth * AxisTurn::NedEnu.quaternion(),
            Relation::RpyRotating => {
                let (roll, pitch, yaw) = to_rpy(&r);
                // Rx(roll) Ry(pitch) Rz(yaw) is the inverse of Rz(-yaw) Ry(-pitch) Rx(-roll).
                pose(from_rpy(-roll, -pitch, -yaw).inverse(), t)
            }
            Relation::RpyFixed => {
                let (roll, pitch, yaw) = to_rpy(&r.inverse());
                pose(from_rpy(-roll, -pitch, -yaw), t)
            }
            Relation::Ypr => {
                let (roll, pitch, yaw) = to_rpy(&r);
                pose(from_rpy(yaw, pitch, roll), t)
            }
            Relation::Degrees => pose(scaled_rpy(&r, f64::to_degrees), t),
            Relation::Radians => pose(scaled_rpy(&r, f64::to_radians), t),
            // Conjugation by diag(1, -1, 1): a rotation vector keeps its y and loses the sign of x and z.
            Relation::MirroredY => pose(quaternion(-r.i, r.j, -r.k, r.w), Vector3::new(t.x, -t.y, t.z)),
            Relation::MirroredZ => pose(quaternion(-r.i, -r.j, r.k, r.w), Vector3::new(t.x, t.y, -t.z)),
            Relation::InverseZ180 => truth.inverse() * AxisTurn::Z180.quaternion(),
            Relation::Z180Inverse => AxisTurn::Z180.quaternion() * truth.inverse(),
            Relation::AppliedTwice => truth * truth,
        };
        is_finite(&held).then_some(held)
    }
}

/// Whether every number of a transform is finite.
pub(super) fn is_finite(t: &Pose) -> bool {
    t.translation
        .vector
        .iter()
        .chain(t.rotation.coords.iter())
        .all(|v| v.is_finite())
}

fn pose(rotation: Turn, translation: Vector3<f64>) -> Pose {
    Isometry3::from_parts(Translation3::from(translation), rotation)
}

/// From components in the order x, y, z, w, which are a permutation of a unit quaternion's up to signs.
fn quaternion(x: f64, y: f64, z: f64, w: f64) -> Turn {
    Turn::new_unchecked(Quaternion::new(w, x, y, z))
}

fn scaled_rpy(r: &Turn, scale: fn(f64) -> f64) -> Turn {
    let (roll, pitch, yaw) = to_rpy(r);
    from_rpy(scale(roll), scale(pitch), scale(yaw))
}
