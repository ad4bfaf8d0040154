//! Direction of an inertial sensor's acceleration at rest, in the base.

use nalgebra::Vector3;
use serde::Deserialize;

use crate::analysis::{axes::causes::Base, look::Estimate, motion::Imu};
use crate::verdict::NotEvaluated;

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Limits {
    pub(crate) min_rest_s: f64,
    pub(crate) min_motion_s: f64,
    pub(crate) gravity: f64,
    pub(crate) gravity_share: f64,
    pub(crate) warning_deg: f64,
    pub(crate) error_deg: f64,
    pub(crate) down_deg: f64,
}

/// The direction of gravity in the axes of the base.
pub(crate) struct BaseUp {
    pub(crate) class: Base,
    /// Angle between the acceleration and the base's z axis, radians.
    pub(crate) angle_rad: f64,
    /// Direction of the acceleration in the base.
    pub(crate) direction: Vector3<f64>,
    /// Whether it was measured at rest; else over a drive.
    pub(crate) at_rest: bool,
    pub(crate) seconds: f64,
    pub(crate) rows: u64,
}

/// Direction of the acceleration, at rest or over a drive.
pub(crate) fn look(imu: &Imu, limits: &Limits) -> Estimate<BaseUp> {
    let little = |reason: String| (NotEvaluated::TooLittleEvidence, reason);
    if imu.mount.is_none() {
        let reason = match &imu.stream.frame {
            Some(frame) => {
                format!("`{frame}` is not tied to a base such as `base_link`: add a URDF or record `/tf_static`")
            }
            None => "its header names no frame, so its mounting is unknown".to_owned(),
        };
        return Err((NotEvaluated::MissingInput, reason));
    }
    let is_gravity = |length: f64| (length / limits.gravity - 1.0).abs() <= limits.gravity_share;
    let Some(force) = imu.inertial.force.filter(|force| *force > 0.0) else {
        return Err((
            NotEvaluated::NotApplicable,
            "its messages hold no acceleration (all zero)".to_owned(),
        ));
    };
    // AXES02 judges the unit.
    let unit = if is_gravity(force * limits.gravity) {
        1.0 / limits.gravity
    } else {
        1.0
    };
    let rest = &imu.inertial.rest;
    let at_rest = rest.force_m_s2().filter(|_| rest.seconds() >= limits.min_rest_s);
    let (mean, seconds) = if let Some(mean) = at_rest {
        (mean, rest.seconds())
    } else {
        let seconds = imu.stream.seconds();
        if seconds < limits.min_motion_s {
            return Err(little(format!(
                "only {:.1} s at rest and {seconds:.1} s in total, {} s or {} s are needed",
                rest.seconds(),
                limits.min_rest_s,
                limits.min_motion_s
            )));
        }
        let rows = imu.stream.rows();
        let forces: Vec<Vector3<f64>> = rows
            .map(|timed| Vector3::from(timed.row.linear_acceleration))
            .filter(|force| force.iter().all(|value| value.is_finite()))
            .collect();
        (
            forces.iter().sum::<Vector3<f64>>() / forces.len().max(1) as f64,
            seconds,
        )
    };
    if !is_gravity(mean.norm() / unit) {
        return Err(little(format!(
            "the magnitude of the mean acceleration is {:.2} as published, which is not gravity",
            mean.norm()
        )));
    }
    let direction = imu.base_from_imu() * mean.normalize();
    let angle_rad = direction.xy().norm().atan2(direction.z);
    let class = match angle_rad.to_degrees() {
        degrees if degrees <= limits.warning_deg => Base::Up,
        degrees if degrees >= limits.down_deg => Base::Down,
        _ => Base::Side,
    };
    Ok(BaseUp {
        class,
        angle_rad,
        direction,
        at_rest: at_rest.is_some(),
        seconds,
        rows: imu.stream.rows().count() as u64,
    })
}
