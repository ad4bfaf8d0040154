//! AXES06: the acceleration along the base's axes against the change of speed.

use crate::advice::diagnosis::{explain, judge_each};
use crate::analysis::axes::causes::{Aspect, Push};
use crate::analysis::axes::push::{Limits, Pushed};
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

fn judge_pushed((imu, sensor): (&Imu, &Sensor), subject: String, pushed: &Pushed, limits: &Limits, out: &mut Judge) {
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
        Measured::new("t", pushed.forward.t().abs().max(pushed.sideways.t().abs()), "1").limit(limits.min_t),
    ];
    if pushed.class == Push::Forward {
        return out.pass(subject, measured);
    }
    let what = match pushed.class {
        Push::Sideways => "speeding up shows along y, not along x",
        _ => "speeding up shows along -x",
    };
    let message = format!(
        "in the acceleration of `{}` {what} (x {:+.2}, y {:+.2} times the change of speed of {}); {}{}",
        imu.stream.topic,
        pushed.forward.gain,
        pushed.sideways.gain,
        pushed.track,
        imu.mounting(),
        sensor.diagnosis.words()
    );
    let otherwise = "x points forward (REP-103): give the sensor's frame its yaw in TF, or negate an accelerometer that gives gravity; a \
         drive in reverse looks the same";
    let finding = explain(
        &sensor.diagnosis,
        imu,
        Aspect::Push,
        Finding::warning(subject, message, imu.stream.place()).likely(),
        otherwise,
    );
    let finding = finding.related(pushed.track_at.clone(), TRACK);
    out.fail(finding.measured(measured));
}
