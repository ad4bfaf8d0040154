//! AXES04: sense and zero of the yaw of an orientation.

use crate::advice::diagnosis::{defer, explain, unless_swapped};
use crate::analysis::axes::sensors::{Sensor, Sensors};
use crate::analysis::axes::yaw_vs_course::{HeadingFit, apart_deg, is_upright};
use crate::analysis::motion::{Imu, Motion};
use crate::analysis::{
    axes::causes, axes::causes::Aspect, axes::diagnosis::Diagnosis, axes::heading::Limits, look::TRACK,
};
use crate::rules::prelude::*;

pub(crate) struct HeadingConvention;

impl Rule for HeadingConvention {
    const NEEDS: &'static [Need] = &[Need::Bag];
    type Limits = Limits;

    fn judge(world: &Estimates, limits: &Limits, out: &mut Judge) {
        let (motion, sensors) = (Motion::of(world), Sensors::of(world));
        for (imu, sensor) in sensors.each(&motion) {
            let subject = format!("yaw of {}", imu.stream.subject);
            let decided = match &sensor.heading {
                Ok(decided) => decided,
                Err((why, reason)) => {
                    out.not_evaluated(subject, *why, reason);
                    continue;
                }
            };
            // With the right sense, the plot is about the zero.
            let plotted = match decided.class() {
                causes::Heading::Against => subject.clone(),
                causes::Heading::With => zero_of(&subject),
            };
            out.plot(&plotted, || Some(decided.plot(&imu.stream.topic)));
            match decided.class() {
                causes::Heading::Against => {
                    let finding = clockwise(imu, &subject, decided, &sensor.diagnosis, limits);
                    // The simulator's poses may be the left-handed ones.
                    out.fail(if sensor.heading_is_against_a_simulator() {
                        finding.unless(codes::SENSOR09)
                    } else {
                        finding
                    });
                }
                causes::Heading::With => {
                    out.pass(&subject, decided.measured(limits));
                    judge_zero(imu, zero_of(&subject), decided, sensor, limits, out);
                }
            }
        }
    }
}

/// Subject of the outcome on the zero of a yaw.
fn zero_of(subject: &str) -> String {
    format!("zero of the {subject}")
}

/// A yaw that increases clockwise.
fn clockwise(imu: &Imu, subject: &str, decided: &HeadingFit, diagnosis: &Diagnosis, limits: &Limits) -> Finding {
    let heading = &decided.heading;
    let offset = heading.offset_rad.to_degrees();
    let (from, to) = heading.span_s.unwrap_or_default();
    let zero = if !decided.is_geodetic {
        "This track does not know east, so the zero of the yaw is not compared.".to_owned()
    } else if (offset - 90.0).abs() <= 30.0 {
        format!("Yaw minus course is {offset:.0} deg.")
    } else {
        format!("The offset is {offset:.0} deg, while a heading counted from north has 90 deg.")
    };
    let message = format!(
        "`{}`: yaw increases clockwise, opposite to the course of {}",
        imu.stream.topic, decided.track
    );
    let otherwise = "publish `yaw_ros = pi/2 - heading` (REP-103: counter-clockwise from east), or convert the whole NED/FRD orientation: \
         `R_enu_flu = P * R_ned_frd * F` (P: NED to ENU, F: FRD to FLU)";
    let finding = Finding::error(subject, message, imu.stream.place())
        .likely()
        .detail(format!("Compared from {from:.0} to {to:.0} s. {zero}"))
        .relation("clockwise-yaw");
    let finding = explain(diagnosis, imu, Aspect::Heading, finding, otherwise).related(decided.track_at.clone(), TRACK);
    unless_swapped(&decided.track, finding).measured(decided.measured(limits))
}

/// Zero of a yaw with the right sense.
fn judge_zero(imu: &Imu, subject: String, decided: &HeadingFit, sensor: &Sensor, limits: &Limits, out: &mut Judge) {
    let offset = match decided.offset_rad() {
        Ok(offset_rad) => format!("{:.0} deg", offset_rad.to_degrees()),
        Err((why, reason)) => return out.not_evaluated(subject, why, reason),
    };
    if decided.heading.offset_resultant < limits.min_resultant {
        return out.too_little(
            subject,
            format!("yaw minus course is {offset} on average, but not steady"),
        );
    }
    let Some(finding) = offset_finding(imu, &subject, decided, limits) else {
        return out.pass(subject, [decided.offset()]);
    };
    // A sensor that is tied to no base may have any attitude.
    if imu.mount.is_some() && !is_upright(imu) {
        let why = format!(
            "yaw minus course is {offset}, but the orientation is on its side or upside down, so its zero is not judged"
        );
        return out.not_applicable(subject, why);
    }
    // A base whose x does not point forward offsets every sensor on it.
    let by_base = |rad: f64| {
        let offset_deg = decided.heading.offset_rad.to_degrees();
        apart_deg(offset_deg, rad.to_degrees()) <= limits.max_spread_deg
    };
    let mut finding =
        defer(&sensor.diagnosis, imu, Some(Aspect::Heading), finding).related(decided.track_at.clone(), TRACK);
    if let (true, Some(mount)) = (sensor.base_yaw_rad.is_some_and(by_base), &imu.mount) {
        finding = finding.unless_about(codes::AXES13, format!("`{}`", mount.base));
    }
    if sensor.offset.is_some() {
        finding = finding.unless(codes::SENSOR06);
    }
    out.fail(finding.measured(decided.measured(limits)));
}

/// A zero that is far from east, if the track knows east.
fn offset_finding(imu: &Imu, subject: &str, decided: &HeadingFit, limits: &Limits) -> Option<Finding> {
    let offset = decided.large_offset_deg(limits)?;
    let near = |degrees: f64| apart_deg(offset, degrees) <= limits.max_spread_deg;
    let (what, help) = if near(90.0) {
        (
            "the sensor is mounted with a yaw of about +90 deg, and TF does not say so",
            "publish the transform from the base to the sensor with a yaw of about 90 deg",
        )
    } else if near(-90.0) {
        (
            "yaw is zero in the north, or the axes of the driver have y forward, or the sensor is mounted with a yaw of about -90 deg and TF does not say so",
            "look at the sensor and its data sheet, and correct the cause that applies:\n(1) yaw is zero in the north: add pi/2 to it (REP-103: zero in the east)\n(2) y forward: set the driver to x forward\n(3) mounting: add a yaw of -90 deg to the transform from the base to the sensor",
        )
    } else if near(180.0) {
        (
            "the sensor is mounted backwards and TF does not say so, or the platform drove in reverse",
            "publish the transform from the base to the sensor with a yaw of about 180 deg; nothing is wrong if this was a drive in reverse",
        )
    } else {
        (
            "the magnetometer is disturbed by steel, or a mounting yaw is missing in TF",
            "calibrate the magnetometer in place, or add the sensor's yaw to its mounting in TF",
        )
    };
    let message = format!(
        "`{}`: yaw differs by {offset:.0} deg from the direction of travel of {}",
        imu.stream.topic, decided.track
    );
    let detail = format!("Probable cause: {what}. Mounting: {}.", imu.mounting());
    let finding = Finding::warning(subject, message, imu.stream.place()).detail(detail);
    // The zero is a guess, unless the user declares it, or it is 90 degrees within a degree in every direction.
    let is_quarter = imu.mount.is_some() && decided.is_a_quarter_turn(offset, limits);
    let finding = if imu.stream.expressed_in.declares_world() || is_quarter {
        finding.likely()
    } else {
        finding.hint()
    };
    Some(imu.stream.expressed_in.annotate(finding).help(help))
}
