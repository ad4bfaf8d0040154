//! Axes of an optical frame, and of the link that it belongs to.

use std::f64::consts::FRAC_PI_2;

use nalgebra::UnitQuaternion;

use super::Limits;
use crate::analysis::motion::mount::Mount;
use crate::math::{constants::AxisTurn, stats::rounded};

/// Whether the link of an optical frame is pitched by 90 degrees, and not rotated otherwise.
pub(super) fn is_pitched(base_from_optical: &UnitQuaternion<f64>, limits: &Limits) -> bool {
    let base_from_link = base_from_optical * AxisTurn::Optical.quaternion().inverse();
    let off_deg = |pitch: f64| {
        let pitched = UnitQuaternion::from_euler_angles(0.0, pitch, 0.0);
        base_from_link.angle_to(&pitched).to_degrees()
    };
    off_deg(FRAC_PI_2).min(off_deg(-FRAC_PI_2)) <= limits.pure_pitch_deg
}

/// RPY of the frame in the base with optical axes, if the frame has those of a link.
pub(super) fn as_optical(mount: &Mount) -> String {
    let (roll, pitch, yaw) = (mount.base_from_sensor.rotation * AxisTurn::Optical.quaternion()).euler_angles();
    let [roll, pitch, yaw] = [roll, pitch, yaw].map(|angle| rounded(angle, 4));
    format!("rpy {roll} {pitch} {yaw} in `{}`", mount.base)
}
