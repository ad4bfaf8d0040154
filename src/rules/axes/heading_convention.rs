//! AXES04: which way the yaw of an orientation turns, and where its zero is.

use crate::advice::diagnosis::{defer, explain};
use crate::analysis::axes::sensors::{Sensor, Sensors};
use crate::analysis::axes::yaw_vs_course::{Decided, apart_deg, is_upright};
use crate::analysis::motion::{Imu, Motion};
use crate::analysis::{axes::causes, axes::causes::Aspect, axes::diagnosis::Diagnosis, axes::heading::Limits, look::TRACK};
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
            // Which way it turns is no matter where it turns as it should: the zero is what is looked for then.
            let plotted = match decided.class() {
                causes::Heading::Against => subject.clone(),
                causes::Heading::With => zero_of(&subject),
            };
            out.plot(&plotted, || Some(decided.plot(&imu.stream.topic)));
            match decided.class() {
                causes::Heading::Against => {
                    let finding = clockwise(imu, &subject, decided, &sensor.diagnosis, limits);
                    // Poses of a simulator may be the ones with the other hand.
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

/// What is judged of where a yaw is zero.
fn zero_of(subject: &str) -> String {
    format!("zero of the {subject}")
}

/// A yaw that turns against the course.
fn clockwise(imu: &Imu, subject: &str, decided: &Decided, diagnosis: &Diagnosis, limits: &Limits) -> Finding {
    let heading = &decided.heading;
    let offset = heading.offset_rad.to_degrees();
    let (from, to) = heading.span_s.unwrap_or_default();
    let zero = if !decided.is_geodetic {
        "where its zero is cannot be told from this track".to_owned()
    } else if (offset - 90.0).abs() <= 30.0 {
        format!("the offset of {offset:.0} deg is that of a heading counted from north")
    } else {
        format!("with an offset of {offset:.0} deg, where a heading from north has 90")
    };
    let message = format!(
        "the yaw of `{}` grows clockwise: it turns against the course of {} from {from:.0} to {to:.0} s; {zero}{}",
        imu.stream.topic,
        decided.track,
        diagnosis.words()
    );
    let otherwise = "REP-103 counts yaw counter-clockwise from east: publish `yaw_ros = pi/2 - heading`; of a whole NED/FRD orientation \
         `R_enu_flu = P * R_ned_frd * F`";
    let finding = Finding::error(subject, message, imu.stream.place())
        .likely()
        .relation("clockwise-yaw");
    let finding = explain(diagnosis, imu, Aspect::Heading, finding, otherwise).related(decided.track_at.clone(), TRACK);
    finding.measured(decided.measured(limits))
}

/// Where the zero of a yaw is that turns with the course.
fn judge_zero(imu: &Imu, subject: String, decided: &Decided, sensor: &Sensor, limits: &Limits, out: &mut Judge) {
    let offset = match decided.offset_rad() {
        Ok(offset_rad) => format!("{:.0} deg", offset_rad.to_degrees()),
        Err((why, reason)) => return out.not_evaluated(subject, why, reason),
    };
    if decided.heading.offset_resultant < limits.min_resultant {
        return out.too_little(subject, format!("{offset} from the course on the whole, and not steadily so"));
    }
    let Some(finding) = offset_finding(imu, &subject, decided, limits) else {
        return out.pass(subject, [decided.offset()]);
    };
    // What nothing ties to a base may hang as it likes.
    if imu.mount.is_some() && !is_upright(imu) {
        let why = format!(
            "{offset} from the course, by an orientation on its side or on its head: that is no matter of its zero"
        );
        return out.not_applicable(subject, why);
    }
    // A base whose x does not point forward turns every sensor on it.
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

/// A zero that is far from east, where the track knows east.
fn offset_finding(imu: &Imu, subject: &str, decided: &Decided, limits: &Limits) -> Option<Finding> {
    let offset = decided.large_offset_deg(limits)?;
    let near = |degrees: f64| apart_deg(offset, degrees) <= limits.max_spread_deg;
    let what = if near(90.0) {
        "as of a sensor turned to the left and not said"
    } else if near(-90.0) {
        "as of a yaw that is zero in the north, a body whose y axis points forward, or a sensor turned to the right and not said"
    } else if near(180.0) {
        "as of a sensor mounted backwards, or a drive in reverse"
    } else {
        "as of a magnetometer beside steel, or a mounting angle that is not said"
    };
    let message = format!(
        "the yaw of `{}` is {offset:.0} deg from the course of {}, {what}; {}",
        imu.stream.topic,
        decided.track,
        imu.mounting()
    );
    let finding = Finding::warning(subject, message, imu.stream.place());
    // Where yaw is zero is a guess, unless the user says it, or it is a quarter turn to the degree in every direction.
    let is_quarter = imu.mount.is_some() && decided.is_a_quarter_turn(offset, limits);
    let finding = if imu.stream.expressed_in.declares_world() || is_quarter {
        finding.likely()
    } else {
        finding.hint()
    };
    Some(
        imu.stream.expressed_in.tell(finding).help("compare with the mounting, and with `yaw_offset` and `magnetic_declination_radians` of the filter that uses it"),
    )
}
