//! AXES01: direction of an accelerometer's reading at rest, in the platform's base.

use crate::advice::diagnosis::{explain, judge_each};
use crate::analysis::axes::base_up::{BaseUp, Limits};
use crate::analysis::axes::causes::{Aspect, Base};
use crate::analysis::axes::sensors::Sensor;
use crate::analysis::motion::Imu;
use crate::rules::prelude::*;

pub(crate) struct ImuGravitySign;

impl Rule for ImuGravitySign {
    const NEEDS: &'static [Need] = &[Need::Bag];
    type Limits = Limits;

    fn judge(world: &Estimates, limits: &Limits, out: &mut Judge) {
        let named = |imu: &str| format!("acceleration of {imu}");
        judge_each((world, limits), named, |sensor| &sensor.base, judge_up, out);
    }
}

fn judge_up((imu, sensor): (&Imu, &Sensor), subject: String, up: &BaseUp, limits: &Limits, out: &mut Judge) {
    let degrees = up.angle_rad.to_degrees();
    let measured = [
        Measured::new("angle between the acceleration and z of the base", degrees, "deg")
            .limit(limits.warning_deg)
            .samples(up.rows),
        Measured::new(
            if up.at_rest {
                "time at rest"
            } else {
                "duration of the data"
            },
            up.seconds,
            "s",
        ),
    ];
    if up.class == Base::Up {
        return out.pass(subject, measured);
    }
    let severity = if degrees > limits.error_deg {
        Severity::Error
    } else {
        Severity::Warning
    };
    let base = imu
        .mount
        .as_ref()
        .map_or_else(|| "the base".to_owned(), |mount| format!("`{}`", mount.base));
    let message = format!(
        "`{}`: acceleration points {} in {base} ({degrees:.0} deg from up)",
        imu.stream.topic,
        words(up)
    );
    let detail = format!(
        "At rest and level, an accelerometer reads +9.81 m/s2 along the axis that points up. Mounting: {}.",
        imu.mounting()
    );
    let otherwise = "look at the sensor: if it is rotated, state that rotation in its transform (TF or URDF); if it is mounted as the transform \
                     states, its driver publishes gravity or other axes: negate the acceleration, or convert its axes (REP-145)";
    let finding = Finding::new(severity, subject, message, imu.stream.place())
        .likely()
        .detail(detail);
    let finding = explain(&sensor.diagnosis, imu, Aspect::Base, finding, otherwise);
    out.fail(finding.measured(measured));
}

/// Direction of the acceleration, in words.
fn words(up: &BaseUp) -> &'static str {
    let [x, y, z] = [up.direction.x, up.direction.y, up.direction.z];
    let most = x.abs().max(y.abs()).max(z.abs());
    if z.abs() >= most {
        if z > 0.0 { "obliquely up" } else { "down" }
    } else if x.abs() >= most {
        if x > 0.0 { "forward" } else { "backward" }
    } else if y > 0.0 {
        "left"
    } else {
        "right"
    }
}
