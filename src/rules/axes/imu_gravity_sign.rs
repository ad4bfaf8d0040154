//! AXES01: where an accelerometer's up is, in the platform's base.

use crate::advice::diagnosis::{explain, judge_each};
use crate::analysis::axes::base_up::{Limits, Up};
use crate::analysis::axes::causes::{Aspect, Base};
use crate::analysis::motion::Imu;
use crate::analysis::axes::sensors::Sensor;
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

fn judge_up((imu, sensor): (&Imu, &Sensor), subject: String, up: &Up, limits: &Limits, out: &mut Judge) {
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
        sensor.diagnosis.words()
    );
    let otherwise = "give the sensor's frame its rotation in TF or URDF; an accelerometer reads +9.81 on the axis that points \
                     up (REP-145)";
    let finding = Finding::new(severity, subject, message, imu.stream.place()).likely();
    let finding = explain(&sensor.diagnosis, imu, Aspect::Base, finding, otherwise);
    out.fail(finding.measured(measured));
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
