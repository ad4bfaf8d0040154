//! AXES01: where an accelerometer's up is, in the platform's base.

use nalgebra::Vector3;
use serde::Deserialize;

use crate::rules::motion::{Imu, Motion};
use crate::rules::{Evidence, Judge, Need, Rule};
use crate::verdict::{Finding, Measured, NotEvaluated, Severity};
use crate::world::World;

use super::causes::Base;
use super::diagnosis::Diagnosis;
use super::sensors::{Look, Sensors};

/// AXES01.
pub struct ImuGravitySign;

/// Limits of AXES01.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Limits {
    min_rest_s: f64,
    min_motion_s: f64,
    gravity: f64,
    gravity_share: f64,
    warning_deg: f64,
    error_deg: f64,
    down_deg: f64,
}

/// What was seen.
pub(super) struct Up {
    pub(super) class: Base,
    /// Angle between the acceleration and the base's z axis, radians.
    angle_rad: f64,
    /// Direction of the acceleration in the base.
    pub(super) direction: Vector3<f64>,
    /// Whether it was measured at rest; else over a drive.
    at_rest: bool,
    seconds: f64,
    rows: u64,
}

impl Rule for ImuGravitySign {
    const PAGE: &'static str = include_str!("../../../rules/axes/imu-gravity-sign.md");
    const NEEDS: &'static [Need] = &[Need::Bag];
    const EVIDENCE: Evidence = Evidence::MOTION;
    type Limits = Limits;

    fn judge(world: &World, limits: &Limits, out: &mut Judge) {
        let (motion, sensors) = (Motion::of(world), Sensors::of(world));
        for (imu, sensor) in sensors.each(&motion) {
            let subject = format!("acceleration of {}", imu.stream.subject);
            match &sensor.base {
                Ok(up) => judge_up(imu, subject, up, &sensor.diagnosis, limits, out),
                Err((why, reason)) => out.not_evaluated(subject, *why, reason),
            }
        }
    }
}

fn judge_up(imu: &Imu, subject: String, up: &Up, diagnosis: &Diagnosis, limits: &Limits, out: &mut Judge) {
    let degrees = up.angle_rad.to_degrees();
    let measured = [
        Measured::new("angle of the acceleration to z of the base", degrees, "deg")
            .limit(limits.warning_deg)
            .samples(up.rows),
        Measured::new(if up.at_rest { "time at rest" } else { "time" }, up.seconds, "s"),
    ];
    if up.class == Base::Up {
        return out.pass(subject, measured);
    }
    let seen = format!("the acceleration points {}", words(up));
    if let Some(why) = diagnosis.reported_elsewhere("AXES01", &seen) {
        return out.not_evaluated(subject, NotEvaluated::NotApplicable, why);
    }
    let severity = if degrees > limits.error_deg {
        Severity::Error
    } else {
        Severity::Warning
    };
    let message = format!(
        "at rest and level the acceleration of `{}` should point up, and points {} ({degrees:.0} deg from z of the base; {}){}",
        imu.stream.topic,
        words(up),
        imu.mounting(),
        diagnosis.words()
    );
    let otherwise = "give the sensor's frame its rotation in TF or URDF; an accelerometer reads +9.81 on the axis that points \
                     up (REP-145)";
    let finding = Finding::new(severity, subject, message, imu.stream.place()).likely();
    let finding = diagnosis.explain(finding, otherwise);
    out.fail(measured.into_iter().fold(finding, Finding::measured));
}

/// Where the acceleration points, in words.
fn words(up: &Up) -> &'static str {
    let [x, y, z] = [up.direction.x, up.direction.y, up.direction.z];
    let most = x.abs().max(y.abs()).max(z.abs());
    if z.abs() >= most {
        if z > 0.0 { "aslant up" } else { "down" }
    } else if x.abs() >= most {
        if x > 0.0 { "forward" } else { "backward" }
    } else if y > 0.0 {
        "left"
    } else {
        "right"
    }
}

/// Where the acceleration points, at rest or over a drive.
pub(super) fn look(imu: &Imu, limits: &Limits) -> Look<Up> {
    let little = |reason: String| (NotEvaluated::TooLittleEvidence, reason);
    if imu.mount.is_none() {
        let reason = imu.mounting();
        return Err((NotEvaluated::MissingInput, reason));
    }
    let is_gravity = |length: f64| (length / limits.gravity - 1.0).abs() <= limits.gravity_share;
    let Some(force) = imu.inertial.force.filter(|force| *force > 0.0) else {
        return Err((NotEvaluated::NotApplicable, "it gives no acceleration".to_owned()));
    };
    // The unit is AXES02's.
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
                "{:.1} s at rest and {seconds:.1} s in all; {} s or {} s are needed",
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
            "the mean acceleration is {:.2} long as published, which is no gravity",
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
    Ok(Up {
        class,
        angle_rad,
        direction,
        at_rest: at_rest.is_some(),
        seconds,
        rows: imu.stream.rows().count() as u64,
    })
}
