//! AXES14: whether z of the frames that poses are expressed in points up.

use crate::analysis::axes::worlds::{Frame, Gravity, Heights, Limits, Worlds};
use crate::rules::prelude::*;

pub(crate) struct MapZUp;

impl Rule for MapZUp {
    const NEEDS: &'static [Need] = &[Need::Bag];
    type Limits = Limits;

    fn judge(world: &Estimates, limits: &Limits, out: &mut Judge) {
        for frame in Worlds::of(world).frames() {
            let subject = |by: &str| format!("z of `{}`, by {by}", frame.name);
            let is_off = match &frame.gravity {
                Ok(gravity) => judge_gravity(frame, subject("gravity"), gravity, limits, out),
                Err((why, reason)) => {
                    out.not_evaluated(subject("gravity"), *why, reason);
                    false
                }
            };
            match &frame.heights {
                Ok(heights) => {
                    let cause = is_off.then(|| subject("gravity"));
                    judge_heights(frame, subject("altitude"), cause, heights, limits, out);
                }
                Err((why, reason)) => out.not_evaluated(subject("altitude"), *why, reason),
            }
        }
    }
}

/// Whether there is a finding.
fn judge_gravity(frame: &Frame, subject: String, gravity: &Gravity, limits: &Limits, out: &mut Judge) -> bool {
    let degrees = gravity.angle_deg();
    let measured = [
        Measured::new("angle between up (by gravity) and z", degrees, "deg")
            .turn()
            .limit(limits.warning_deg)
            .samples(gravity.rows),
        Measured::new(
            "constancy of the direction of gravity (1: constant)",
            gravity.concentration,
            "1",
        )
        .at_least(limits.min_concentration),
        Measured::new("duration of the data that were used", gravity.seconds, "s"),
    ];
    if degrees <= limits.warning_deg {
        out.pass(subject, measured);
        return false;
    }
    let is_small = degrees <= limits.error_deg;
    if is_small && (gravity.tilt_rad.to_degrees() < limits.planar_deg || gravity.seconds < limits.steady_s) {
        let why = format!(
            "up is {degrees:.0} deg from z, which a slope (the poses may have no roll and pitch) or a manoeuvre of {} s explains",
            gravity.seconds.round()
        );
        out.too_little(subject, why);
        return false;
    }
    // A sensor with a wrong yaw leans as far as the body, but to another side.
    let [by_sensor, by_poses] = gravity.leans_rad.map(f64::to_degrees);
    if is_small && (by_sensor - by_poses).abs() < degrees / 2.0 {
        let why = format!(
            "up is {degrees:.0} deg from z, and the body leans by {by_sensor:.0} deg by {} and by {by_poses:.0} deg by the poses: a \
             sensor rotated on its mount looks the same",
            gravity.sensor
        );
        out.too_little(subject, why);
        return false;
    }
    // No other rule checks the sign of a sensor that is not on a base.
    let is_sure = !is_small && gravity.sensor_is_right == Some(true);
    let severity = if is_sure { Severity::Error } else { Severity::Warning };
    let (relation, kind, help) = named(frame, gravity, limits);
    let mut doubt = String::new();
    if is_sure {
        doubt = format!(
            " Through its mounting transform, {} measures gravity upwards, so that sensor is not the cause.",
            gravity.sensor
        );
    } else if !is_small {
        doubt = format!(
            " Not excluded: the accelerometer of {} may have the opposite sign.",
            gravity.sensor
        );
    }
    if !gravity.turns_with && !is_small {
        doubt.push_str(
            " Not excluded: the orientation may be expressed in other body axes, or with w first: the recording has too little rotation to \
             compare the orientation with the gyro.",
        );
    }
    let message = format!("`{}`: z is {degrees:.0} deg from up{kind}", frame.name);
    let detail = format!(
        "By the acceleration of {} and the orientation of {}, up is ({:+.2}, {:+.2}, {:+.2}) in `{}`.{doubt}",
        gravity.sensor, frame.stream, gravity.up.x, gravity.up.y, gravity.up.z, frame.name
    );
    let finding = Finding::new(severity, subject, message, frame.place.clone())
        .likely()
        .detail(detail)
        .relation(relation)
        .help(help);
    let mut finding = by_name(frame, finding);
    if gravity.sensor_is_right == Some(false) {
        finding = finding.unless_about(codes::AXES01, gravity.sensor.as_str());
    }
    out.fail(finding.measured(measured));
    true
}

/// A finding on a frame whose name may declare other axes: the rule on such names then reports it.
fn by_name(frame: &Frame, finding: Finding) -> Finding {
    let finding = frame.expressed_in.annotate(finding);
    if frame.expressed_in.is_ned() {
        finding.unless_about(codes::NAME04, format!("`{}`", frame.name))
    } else {
        finding
    }
}

/// What to do with poses in NED.
const FROM_NED: &str = "name the frame `..._ned`, or convert the poses to z up (REP-103), with P = [0 1 0; 1 0 0; 0 0 -1]:\n\
                        (1) world NED, body forward, left, up: position (x, y, z) -> (y, x, -z), rotation R -> P R\n\
                        (2) world NED, body forward, right, down: the same position, rotation R -> P R diag(1, -1, -1)";

/// Relation, description and help for a frame with this up.
fn named(frame: &Frame, gravity: &Gravity, limits: &Limits) -> (&'static str, &'static str, &'static str) {
    let near = |x: f64, y: f64, z: f64| {
        let cosine = gravity.up.x * x + gravity.up.y * y + gravity.up.z * z;
        cosine >= limits.error_deg.to_radians().cos()
    };
    if near(0.0, 0.0, -1.0) && frame.expressed_in.is_ned() {
        let help = "rename the frame without `ned`, or convert its poses to NED: the data have z up";
        ("z-up", " (z up, while NED has z down)", help)
    } else if near(0.0, 0.0, -1.0) {
        ("z-down", " (z down, as in NED)", FROM_NED)
    } else if near(0.0, -1.0, 0.0) {
        let help = "rename this frame to `camera_map`, and publish `map` -> `camera_map` with RPY(-90, 0, -90) deg, corrected so that gravity points \
                    along -z of `map`";
        ("optical", " (y down, as in a camera's optical frame)", help)
    } else if near(0.0, 1.0, 0.0) {
        (
            "y-up",
            " (y up, as in graphics)",
            "rotate the frame by 90 deg about x: z points up (REP-103)",
        )
    } else {
        (
            "tilted",
            "",
            "level the frame by gravity at start-up: z points up (REP-103)",
        )
    }
}

fn judge_heights(
    frame: &Frame,
    subject: String,
    cause: Option<String>,
    heights: &Heights,
    limits: &Limits,
    out: &mut Judge,
) {
    let measured = [
        Measured::new("change of z / change of the altitude", heights.slope, "1").samples(heights.points as u64),
        Measured::new(
            "correlation of z and altitude, without sign",
            heights.correlation.abs(),
            "1",
        )
        .at_least(limits.min_correlation),
        Measured::new("variation of the altitude (rms)", heights.rms_m[0], "m").at_least(limits.min_rms_m),
    ];
    if heights.slope > 0.0 {
        return out.pass(subject, measured);
    }
    let message = format!(
        "`{}`: z falls when the altitude rises ({:+.2} m per metre)",
        frame.name, heights.slope
    );
    let finding = Finding::error(subject, message, frame.place.clone())
        .likely()
        .detail(format!(
            "z of {} is compared with the altitude of {}.",
            frame.stream, heights.receiver
        ))
        .relation("z-down")
        .help(format!(
            "{FROM_NED}\n\
             (3) world and body forward, right, down: position (x, y, z) -> (x, -y, -z), quaternion (x, y, z, w) -> (x, -y, -z, w)\n\
             (4) only z of the position is wrong: negate z, and leave the orientation"
        ));
    let finding = cause.into_iter().fold(finding, Finding::same_cause_as);
    out.fail(by_name(frame, finding).measured(measured));
}
