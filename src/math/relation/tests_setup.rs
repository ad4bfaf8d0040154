//! Test support: classes of mounts, and how a case is counted.

use nalgebra::{Isometry3, Translation3, UnitQuaternion};

use super::{Classification, Relation};
use crate::math::rotation::from_rpy;
use crate::math::tests_support::Rng;

/// How a sensor sits on its robot.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Mount {
    /// Any rotation at all.
    Generic,
    /// Any yaw; roll and pitch of 8 to 45 degrees.
    Tilted,
    /// Yaw of 0, 90, 180 or -90 degrees, and a rotation vector of 2 degrees per axis on top.
    NearNominal,
    /// Any of the 24 axis-aligned rotations (cameras, poles of rpy), and a rotation vector of 3 degrees per axis on top.
    AxisAligned,
}

impl Mount {
    pub(super) const ALL: [Mount; 4] = [Mount::Generic, Mount::Tilted, Mount::NearNominal, Mount::AxisAligned];

    pub(super) fn draw(self, rng: &mut Rng) -> Isometry3<f64> {
        let rotation = match self {
            Mount::Generic => rng.rotation(),
            Mount::Tilted => {
                let mut tilt = || rng.range(8.0, 45.0).to_radians() * (rng.unit() - 0.5).signum();
                let (roll, pitch) = (tilt(), tilt());
                from_rpy(roll, pitch, rng.range(-180.0, 180.0).to_radians())
            }
            Mount::NearNominal => {
                let tilt = UnitQuaternion::from_scaled_axis(rng.normal3() * 2f64.to_radians());
                tilt * from_rpy(0.0, 0.0, quarter(rng))
            }
            Mount::AxisAligned => {
                let tilt = UnitQuaternion::from_scaled_axis(rng.normal3() * 3f64.to_radians());
                tilt * from_rpy(quarter(rng), quarter(rng), quarter(rng))
            }
        };
        Isometry3::from_parts(Translation3::from(rng.in_ball(3.0)), rotation)
    }
}

/// 0, 90, 180 or 270 degrees, in radians.
fn quarter(rng: &mut Rng) -> f64 {
    (rng.unit() * 4.0).floor() * 90f64.to_radians()
}

/// The noise of a good calibration: standard deviations per axis, so the errors are 0.5 degrees and 1.7 cm long on
/// average (harder than one draw of 0.3 degrees and 1 cm in a random direction).
pub(super) fn calibration_noise(rng: &mut Rng, t: &Isometry3<f64>) -> Isometry3<f64> {
    rng.noisy(t, 0.3f64.to_radians(), 0.01)
}

/// Whether the truth is the named relation or in its class.
pub(super) fn holds(answer: &Classification, truth: Relation) -> bool {
    answer.best.is_some() && answer.class.contains(&truth)
}
