//! AXES03: direction of the acceleration, rotated into the world by the orientation.

use crate::advice::diagnosis::{explain, judge_each};
use crate::analysis::axes::causes::{Aspect, World};
use crate::analysis::axes::sensors::Sensor;
use crate::analysis::axes::world_up::{Limits, WorldUp};
use crate::analysis::motion::Imu;
use crate::math::readings::Reading;
use crate::rules::prelude::*;
use crate::verdict::UNEXPLAINED;

pub(crate) struct OrientationVsGravity;

impl Rule for OrientationVsGravity {
    const NEEDS: &'static [Need] = &[Need::Bag];
    type Limits = Limits;

    fn judge(world: &Estimates, limits: &Limits, out: &mut Judge) {
        let named = |imu: &str| format!("orientation of {imu}");
        judge_each((world, limits), named, |sensor| &sensor.world, judge_above, out);
    }
}

fn judge_above((imu, sensor): (&Imu, &Sensor), subject: String, above: &WorldUp, limits: &Limits, out: &mut Judge) {
    let rows = above.rows as u64;
    let degrees = above.force.from_up_rad.to_degrees();
    let measured = [
        Measured::new("angle between the mean acceleration and z of the world", degrees, "deg")
            .turn()
            .limit(limits.max_tilt_deg)
            .samples(rows),
        Measured::new(
            "steadiness of its direction (1: always the same)",
            above.force.concentration,
            "1",
        )
        .at_least(limits.min_concentration)
        .samples(rows),
        Measured::new("duration of the data", above.seconds, "s"),
    ];
    if above.class == World::Up {
        return out.pass(subject, measured);
    }
    let along_z = above.force.mean_m_s2.z;
    let (severity, what) = match above.class {
        World::Down => (Severity::Error, format!("points down (z {along_z:+.2} m/s2)")),
        World::Far => (Severity::Error, format!("is {degrees:.0} deg from up on average")),
        _ => (Severity::Warning, format!("is steadily {degrees:.1} deg from up")),
    };
    let message = format!(
        "`{}`: acceleration, rotated into the world by the orientation, {what}",
        imu.stream.topic
    );
    let detail = match above.class {
        World::Down => "Along z of the world, which is up, +9.81 m/s2 is expected.".to_owned(),
        World::Far => format!(
            "It is {along_z:+.2} m/s2 along z of the world; a healthy mean stays within a few degrees of up. {}",
            other_readings(above)
        ),
        _ => format!("It is {along_z:+.2} m/s2 along z of the world."),
    };
    let otherwise = "look at the raw acceleration at rest and level. If it is about -9.81 m/s2 along z, the driver publishes gravity or axes with z down: \
         negate it, or convert FRD to FLU. If it is +9.81 m/s2, the orientation is wrong: convert it from NED to ENU, or check the filter that computes it";
    let finding = Finding::new(severity, subject, message, imu.stream.place())
        .likely()
        .detail(detail);
    let finding = match above.class {
        // An orientation that rotates wrongly points anywhere.
        World::Far => finding
            .relation(above.read_otherwise(limits).map_or(UNEXPLAINED, named))
            .help(otherwise)
            .unless(codes::QUAT01)
            .unless(codes::QUAT03),
        World::Leaning => finding.relation("tilted").help(otherwise),
        _ => explain(&sensor.diagnosis, imu, Aspect::World, finding, otherwise),
    };
    out.fail(finding.measured(measured));
}

/// Direction of the acceleration with the quaternion in other conventions.
fn other_readings(above: &WorldUp) -> String {
    let words = above.others.iter().map(|mean| {
        let degrees = mean.from_up_rad.to_degrees();
        let how = match mean.reading {
            Reading::Conjugate => "as the inverse",
            Reading::Wxyz => "as w, x, y, z",
            _ => "as w, x, y, z and inverted",
        };
        format!("{how}: {degrees:.0} deg from up (agreement {:.3})", mean.concentration)
    });
    format!(
        "Other readings of the quaternion do not explain it: {}.",
        words.collect::<Vec<_>>().join("; ")
    )
}

fn named(reading: Reading) -> &'static str {
    match reading {
        Reading::Conjugate => "inverse",
        Reading::WxyzConjugate => "wxyz-inverse",
        _ => "wxyz",
    }
}
