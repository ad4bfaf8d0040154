//! AXES03: where the acceleration points in the world, by the orientation.

use crate::analysis::Estimates;
use crate::analysis::axes::world_up::{Above, Limits};

use crate::analysis::motion::{Imu, Motion};
use crate::rules::{Evidence, Need, Rule};
use crate::verdict::{Finding, Judge, Measured, Severity};

use crate::advice::diagnosis::explain;
use crate::analysis::axes::causes::{Aspect, World};
use crate::analysis::axes::diagnosis::Diagnosis;
use crate::analysis::axes::sensors::Sensors;

/// AXES03.
pub(crate) struct OrientationVsGravity;

impl Rule for OrientationVsGravity {
    const PAGE: &'static str = include_str!("../../../rules/axes/orientation-vs-gravity.md");
    const NEEDS: &'static [Need] = &[Need::Bag];
    const EVIDENCE: Evidence = Evidence::MOTION;
    type Limits = Limits;

    fn judge(world: &Estimates, limits: &Limits, out: &mut Judge) {
        let (motion, sensors) = (Motion::of(world), Sensors::of(world));
        for (imu, sensor) in sensors.each(&motion) {
            let subject = format!("orientation of {}", imu.stream.subject);
            match &sensor.world {
                Ok(above) => judge_above(imu, subject, above, &sensor.diagnosis, limits, out),
                Err((why, reason)) => out.not_evaluated(subject, *why, reason),
            }
        }
    }
}

fn judge_above(imu: &Imu, subject: String, above: &Above, diagnosis: &Diagnosis, limits: &Limits, out: &mut Judge) {
    let rows = above.rows as u64;
    let degrees = above.force.from_up_rad.to_degrees();
    let measured = [
        Measured::new("angle of the mean acceleration to z of the world", degrees, "deg")
            .turn()
            .limit(limits.max_tilt_deg)
            .samples(rows),
        Measured::new("concentration", above.force.concentration, "1")
            .limit(limits.min_concentration)
            .samples(rows),
        Measured::new("time", above.seconds, "s"),
    ];
    if above.class == World::Up {
        return out.pass(subject, measured);
    }
    let (severity, what) = match above.class {
        World::Down => (Severity::Error, "points down".to_owned()),
        _ => (
            Severity::Warning,
            format!("points {degrees:.0} deg away from up, steadily"),
        ),
    };
    let message = format!(
        "turned into the world by its own orientation, the acceleration of `{}` {what} ({:+.2} m/s2 along z over {:.0} s, \
         concentration {:.3}){}",
        imu.stream.topic,
        above.force.mean_m_s2.z,
        above.seconds,
        above.force.concentration,
        diagnosis.words()
    );
    let otherwise =
        "align the orientation with gravity: level and at rest `R(q) * acceleration` is +9.81 along z (REP-145)";
    let finding = explain(
        diagnosis,
        imu,
        Aspect::World,
        Finding::new(severity, subject, message, imu.stream.place()).likely(),
        otherwise,
    );
    out.fail(measured.into_iter().fold(finding, Finding::measured));
}
