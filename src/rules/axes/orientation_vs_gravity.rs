//! AXES03: where the acceleration points in the world, by the orientation.

use crate::advice::diagnosis::explain;
use crate::analysis::axes::causes::{Aspect, World};
use crate::analysis::axes::world_up::{Above, Limits};
use crate::analysis::motion::{Imu, Motion};
use crate::analysis::{axes::diagnosis::Diagnosis, axes::sensors::Sensors};
use crate::rules::prelude::*;
use crate::verdict::UNEXPLAINED;

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
        World::Far => (
            Severity::Error,
            format!("points {degrees:.0} deg away from up in the mean, where a healthy one stays within some degrees"),
        ),
        _ => (
            Severity::Warning,
            format!("points {degrees:.1} deg away from up, steadily"),
        ),
    };
    let message = format!(
        "turned into the world by its own orientation, the acceleration of `{}` {what} ({:+.2} m/s2 along z over {:.0} s, \
         concentration {:.3}){}",
        imu.stream.topic,
        above.force.mean_m_s2.z,
        above.seconds,
        above.force.concentration,
        if above.class == World::Leaning { String::new() } else { diagnosis.words() }
    );
    let otherwise =
        "align the orientation with gravity: level and at rest `R(q) * acceleration` is +9.81 along z (REP-145)";
    let finding = Finding::new(severity, subject, message, imu.stream.place()).likely();
    let finding = match above.class {
        // What turns wrongly points anywhere.
        World::Far => explain(diagnosis, imu, Aspect::World, finding.relation(UNEXPLAINED), otherwise)
            .unless(codes::QUAT01)
            .unless(codes::QUAT03),
        World::Leaning => finding.relation("tilted").help(otherwise),
        _ => explain(diagnosis, imu, Aspect::World, finding, otherwise),
    };
    out.fail(finding.measured(measured));
}
