//! AXES05: the gyro's yaw rate compared with the turns of the track.

use crate::advice::diagnosis::{explain, judge_each, unless_swapped};
use crate::analysis::axes::causes::{Aspect, Sense};
use crate::analysis::axes::gyro_vs_track::{GyroFit, Limits};
use crate::analysis::axes::sensors::Sensor;
use crate::analysis::motion::Imu;
use crate::analysis::{axes::rates::Slope, look::TRACK};
use crate::rules::prelude::*;

pub(crate) struct GyroVsTurnSign;

impl Rule for GyroVsTurnSign {
    const NEEDS: &'static [Need] = &[Need::Bag];
    type Limits = Limits;

    fn judge(world: &Estimates, limits: &Limits, out: &mut Judge) {
        let named = |imu: &str| format!("yaw rate of {imu}");
        judge_each((world, limits), named, |sensor| &sensor.sense, judge_turned, out);
    }
}

fn judge_turned((imu, sensor): (&Imu, &Sensor), subject: String, turned: &GyroFit, limits: &Limits, out: &mut Judge) {
    let Slope {
        gain: slope,
        correlation,
        pairs,
        ..
    } = turned.slope;
    let measured = [
        Measured::new("yaw rate / turn rate of the course", slope, "1").samples(pairs as u64),
        Measured::new("strength of their correlation", correlation.abs(), "1").at_least(limits.min_correlation),
        Measured::new("t statistic of their ratio", turned.slope.t().abs(), "1").at_least(limits.min_t),
    ];
    if turned.class == Sense::With {
        return out.pass(subject, measured);
    }
    let message = format!(
        "`{}`: yaw rate has the opposite sign to the turns of {} (ratio {slope:+.2})",
        imu.stream.topic, turned.track
    );
    let detail = format!(
        "Compared for {:.0} s. Mounting: {}.",
        turned.slope.seconds(),
        imu.mounting()
    );
    let otherwise = "negate y and z of the angular velocity if the gyro is in FRD axes, or correct the mounting transform: a turn to the left is \
         positive about z up (REP-103)";
    let finding = explain(
        &sensor.diagnosis,
        imu,
        Aspect::Sense,
        Finding::error(subject, message, imu.stream.place())
            .likely()
            .detail(detail),
        otherwise,
    );
    let finding = unless_swapped(&turned.track, finding.related(turned.track_at.clone(), TRACK));
    // The simulator's poses may be the left-handed ones.
    let finding = if sensor.sense_is_against_a_simulator() {
        finding.unless(codes::SENSOR09)
    } else {
        finding
    };
    out.fail(finding.measured(measured));
}
