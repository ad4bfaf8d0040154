//! AXES14: z of the frames that poses are expressed in points up.

use crate::analysis::axes::worlds::{Frame, Gravity, Heights, Limits, Worlds};
use crate::rules::prelude::*;

pub(crate) struct MapZUp;

impl Rule for MapZUp {
    const NEEDS: &'static [Need] = &[Need::Bag];
    type Limits = Limits;

    fn judge(world: &Estimates, limits: &Limits, out: &mut Judge) {
        for frame in Worlds::of(world).frames() {
            let subject = |by: &str| format!("z of `{}`, by {by}", frame.name);
            let is_told = match &frame.gravity {
                Ok(gravity) => judge_gravity(frame, subject("gravity"), gravity, limits, out),
                Err((why, reason)) => {
                    out.not_evaluated(subject("gravity"), *why, reason);
                    false
                }
            };
            match &frame.heights {
                Ok(heights) => {
                    let cause = is_told.then(|| subject("gravity"));
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
        Measured::new("angle of gravity's up to z", degrees, "deg")
            .turn()
            .limit(limits.warning_deg)
            .samples(gravity.rows),
        Measured::new("agreement", gravity.concentration, "1").limit(limits.min_concentration),
        Measured::new("time", gravity.seconds, "s"),
    ];
    if degrees <= limits.warning_deg {
        out.pass(subject, measured);
        return false;
    }
    let is_small = degrees <= limits.error_deg;
    if is_small && (gravity.tilt_rad.to_degrees() < limits.planar_deg || gravity.seconds < limits.steady_s) {
        let why = format!(
            "gravity's up is {degrees:.0} deg from z: a slope, to poses that know no roll and pitch, or {} s of a manoeuvre",
            gravity.seconds.round()
        );
        out.too_little(subject, why);
        return false;
    }
    // A sensor that is turned about z of the body leans as far as the body does, and to another side.
    let [by_sensor, by_poses] = gravity.leans_rad.map(f64::to_degrees);
    if is_small && (by_sensor - by_poses).abs() < degrees / 2.0 {
        let why = format!(
            "gravity's up is {degrees:.0} deg from z, and the body leans by {by_sensor:.0} deg by {} and by {by_poses:.0} deg by the poses: \
             a sensor that is turned on its mount looks alike",
            gravity.sensor
        );
        out.too_little(subject, why);
        return false;
    }
    // Of a sensor that is not on a base nobody else looks at the sign.
    let is_sure = !is_small && gravity.sensor_is_right == Some(true);
    let severity = if is_sure { Severity::Error } else { Severity::Warning };
    let (relation, kind, help) = named(frame, gravity, limits);
    let mut doubt = String::new();
    if !is_sure && !is_small {
        doubt = format!("; or the accelerometer of {} has the other sign", gravity.sensor);
    }
    if !gravity.turns_with && !is_small {
        doubt.push_str(
            "; or the orientation is expressed in other axes of the body, or with w first: it does not turn enough with the gyro to tell",
        );
    }
    let message = format!(
        "up is {degrees:.0} deg from z of `{}`{kind}: gravity by {}, turned by {}, points along ({:+.2}, {:+.2}, {:+.2}) for {:.0} s{doubt}",
        frame.name, gravity.sensor, frame.stream, gravity.up.x, gravity.up.y, gravity.up.z, gravity.seconds
    );
    let finding = Finding::new(severity, subject, message, frame.place.clone())
        .likely()
        .relation(relation)
        .help(help);
    let mut finding = by_name(frame, finding);
    if gravity.sensor_is_right == Some(false) {
        finding = finding.unless_about(codes::AXES01, gravity.sensor.as_str());
    }
    out.fail(finding.measured(measured));
    true
}

/// A finding on a frame whose name may promise other axes: then the rule of such names says it better.
fn by_name(frame: &Frame, finding: Finding) -> Finding {
    let finding = frame.expressed_in.tell(finding);
    if frame.expressed_in.is_ned() {
        finding.unless_about(codes::NAME04, format!("`{}`", frame.name))
    } else {
        finding
    }
}

/// What a frame with this up may be: a word, words, and what to do.
fn named(frame: &Frame, gravity: &Gravity, limits: &Limits) -> (&'static str, &'static str, &'static str) {
    let near = |x: f64, y: f64, z: f64| {
        let cosine = gravity.up.x * x + gravity.up.y * y + gravity.up.z * z;
        cosine >= limits.error_deg.to_radians().cos()
    };
    if near(0.0, 0.0, -1.0) && frame.expressed_in.is_ned() {
        let help = "the data have z up: call the frame by a name without `ned`, or convert its poses to NED";
        ("z-up", " (z up, where north-east-down has it down)", help)
    } else if near(0.0, 0.0, -1.0) {
        let help = "REP-103 wants z up: convert NED poses, `R_enu_flu = P * R_ned_frd * F` and (y, x, -z), or call the frame `_ned`";
        ("z-down", " (z down, as in NED)", help)
    } else if near(0.0, -1.0, 0.0) {
        let help = "tie the map to the camera's first optical frame by a frame of its own: `map` from `camera_map` is RPY(-90, 0, -90) deg, \
                    then levelled by gravity";
        ("optical", " (y down: the optical axes of the first camera)", help)
    } else if near(0.0, 1.0, 0.0) {
        (
            "y-up",
            " (y up, as in graphics)",
            "turn the frame by 90 deg about x: z points up (REP-103)",
        )
    } else {
        (
            "tilted",
            "",
            "level the frame by gravity when it is started: z points up (REP-103)",
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
        Measured::new("change of z over that of the altitude", heights.slope, "1").samples(heights.points as u64),
        Measured::new("correlation", heights.correlation, "1").limit(limits.min_correlation),
        Measured::new("rms of the altitude", heights.rms_m[0], "m").limit(limits.min_rms_m),
    ];
    if heights.slope > 0.0 {
        return out.pass(subject, measured);
    }
    let message = format!(
        "z of `{}` falls where the altitude rises: {:+.2} times, correlation {:+.2}, of {} against {}",
        frame.name, heights.slope, heights.correlation, frame.stream, heights.receiver
    );
    let finding = Finding::error(subject, message, frame.place.clone())
        .likely()
        .relation("z-down")
        .help("z points up (REP-103): negate z, or convert poses from NED, (y, x, -z)");
    let finding = cause.into_iter().fold(finding, Finding::same_cause_as);
    out.fail(by_name(frame, finding).measured(measured));
}
