//! SENSOR06: what an inertial navigation system publishes, compared with the known settings of its driver.

use crate::analysis::axes::sensors::{Sensor, Sensors};
use crate::analysis::motion::{Imu, Motion};
use crate::rules::prelude::*;
use crate::tables::InsDriver;

pub(crate) struct InsProfile;

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Limits {
    max_tilt_deg: f64,
    max_offset_deg: f64,
}

impl Rule for InsProfile {
    const NEEDS: &'static [Need] = &[Need::Bag];
    type Limits = Limits;

    fn judge(world: &Estimates, limits: &Limits, out: &mut Judge) {
        let (motion, sensors) = (Motion::of(world), Sensors::of(world));
        for (imu, sensor) in sensors.each(&motion) {
            if let Some(driver) = &imu.driver {
                judge_up(imu, sensor, driver, limits, out);
                judge_zero(imu, sensor, driver, limits, out);
            }
        }
    }
}

/// Up of the world, which distinguishes ENU and FLU from NED and FRD.
fn judge_up(imu: &Imu, sensor: &Sensor, driver: &InsDriver, limits: &Limits, out: &mut Judge) {
    let subject = format!("axes of {} ({})", imu.stream.subject, driver.name);
    if let Some(why) = hidden(sensor) {
        return out.not_applicable(subject, why);
    }
    match sensor.up_rad() {
        Ok(angle) if angle.to_degrees() <= limits.max_tilt_deg => {
            if let Some(unseen) = sensor.unseen {
                let why = format!(
                    "the acceleration points up, as it also does if {}: record a turn to distinguish these",
                    unseen.text
                );
                return out.too_little(subject, why);
            }
            let what = "angle between the mean acceleration and z of the world";
            let measured = Measured::new(what, angle.to_degrees(), "deg");
            out.pass(subject, [measured.limit(limits.max_tilt_deg)]);
        }
        Ok(angle) => {
            let why = format!(
                "the acceleration is {:.0} deg from up, which no setting of this driver explains alone",
                angle.to_degrees()
            );
            out.not_applicable(subject, why);
        }
        Err((why, reason)) => out.not_evaluated(subject, why, reason),
    }
}

/// The zero of the yaw.
fn judge_zero(imu: &Imu, sensor: &Sensor, driver: &InsDriver, limits: &Limits, out: &mut Judge) {
    let subject = format!("zero of the yaw of {} ({})", imu.stream.subject, driver.name);
    if let Some(why) = hidden(sensor) {
        return out.not_applicable(subject, why);
    }
    let offset = match sensor.offset_rad() {
        Ok(offset) => offset.to_degrees(),
        Err((why, reason)) => return out.not_evaluated(subject, why, reason),
    };
    let measured = Measured::new("yaw minus course", offset, "deg").limit(limits.max_offset_deg);
    let Some(known) = &sensor.offset else {
        if offset.abs() <= limits.max_offset_deg {
            return out.pass(subject, [measured]);
        }
        let why = format!("the yaw is {offset:.0} deg from the course, which no setting of this driver explains");
        return out.not_applicable(subject, why);
    };
    let heading = sensor.heading.as_ref().ok();
    let compared = heading.map_or_else(String::new, |by| format!("Compared with the course of {}. ", by.track));
    let state = match &imu.mount {
        Some(mount) if mount.is_base => format!(
            "publish the messages in a frame of the sensor (such as `imu_link`), and that frame as a child of `{}` with that yaw",
            mount.base
        ),
        _ => "add that yaw to the sensor's transform (TF or URDF)".to_owned(),
    };
    let message = format!(
        "`{}`: yaw minus course is {offset:.0} deg, probably by a driver setting ({})",
        imu.stream.topic, driver.name
    );
    let finding = Finding::error(subject, message, imu.stream.place())
        .likely()
        .relation("driver-setting")
        .detail(format!(
            "{compared}{} has this offset where {}. Mounting: {}.",
            driver.name,
            known.what,
            imu.mounting()
        ))
        .help(format!(
            "correct the driver, or the mounting:\n(1) {}\n(2) if (1) is done already, and the mounting of the sensor has a yaw of {offset:+.0} deg, {state}",
            known.setting
        ))
        .measured(measured);
    let finding = heading.into_iter().fold(finding, |finding, by| {
        finding.related(by.track_at.clone(), "compared with this track")
    });
    out.fail(imu.stream.expressed_in.annotate(finding));
}

/// Why the setting of the driver cannot be judged.
fn hidden(sensor: &Sensor) -> Option<&'static str> {
    let why = "its measurements contradict each other, and that fault hides the setting of the driver: fix it first";
    sensor.diagnosis.shown_by.is_some().then_some(why)
}
