//! AXES06: the acceleration along the base's axes compared with the change of speed.

use crate::advice::diagnosis::{explain, judge_each};
use crate::analysis::axes::causes::{Aspect, Push};
use crate::analysis::axes::push::{AccelFit, Limits};
use crate::analysis::motion::Imu;
use crate::analysis::{axes::sensors::Sensor, look::TRACK};
use crate::rules::prelude::*;

pub(crate) struct AccelVsSpeed;

impl Rule for AccelVsSpeed {
    const NEEDS: &'static [Need] = &[Need::Bag];
    type Limits = Limits;

    fn judge(world: &Estimates, limits: &Limits, out: &mut Judge) {
        let named = |imu: &str| format!("forward acceleration of {imu}");
        judge_each((world, limits), named, |sensor| &sensor.push, judge_pushed, out);
    }
}

fn judge_pushed((imu, sensor): (&Imu, &Sensor), subject: String, pushed: &AccelFit, limits: &Limits, out: &mut Judge) {
    let pairs = pushed.forward.pairs as u64;
    let measured = [
        Measured::new(
            "acceleration along x over the change of speed",
            pushed.forward.gain,
            "1",
        )
        .samples(pairs),
        Measured::new(
            "acceleration along y over the change of speed",
            pushed.sideways.gain,
            "1",
        )
        .samples(pairs),
        Measured::new("t", pushed.forward.t().abs().max(pushed.sideways.t().abs()), "1").at_least(limits.min_t),
    ];
    if pushed.class == Push::Forward {
        return out.pass(subject, measured);
    }
    let (axis, gain) = match pushed.class {
        Push::Sideways if pushed.sideways.gain < 0.0 => ("-y", pushed.sideways.gain),
        Push::Sideways => ("y", pushed.sideways.gain),
        _ => ("-x", pushed.forward.gain),
    };
    let message = format!(
        "`{}`: acceleration when speeding up is along {axis}, not along x (gain {gain:+.2})",
        imu.stream.topic
    );
    // Forward in the sensor's axes is (cos, -sin) of its yaw.
    let yaw_deg = (-pushed.sideways.gain).atan2(pushed.forward.gain).to_degrees();
    let yaw = match sensor.diagnosis.word() {
        Some("turned-mount") => format!(" A yaw of about {yaw_deg:+.0} deg of the sensor explains it."),
        _ => String::new(),
    };
    let detail = format!(
        "Compared with the change of speed of {}.{yaw} Mounting: {}.",
        pushed.track,
        imu.mounting()
    );
    let otherwise = "add the sensor's yaw to its frame in TF, or negate an accelerometer that measures gravity instead of specific \
         force: x points forward (REP-103). A drive in reverse looks the same";
    let finding = explain(
        &sensor.diagnosis,
        imu,
        Aspect::Push,
        Finding::warning(subject, message, imu.stream.place())
            .likely()
            .detail(detail),
        otherwise,
    );
    let finding = finding.related(pushed.track_at.clone(), TRACK);
    out.fail(finding.measured(measured));
}
