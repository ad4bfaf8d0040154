//! AXES03: where the acceleration points in the world, by the orientation.

use crate::advice::diagnosis::{explain, judge_each};
use crate::analysis::axes::causes::{Aspect, World};
use crate::analysis::axes::world_up::{Above, Limits};
use crate::analysis::motion::Imu;
use crate::math::readings::Reading;
use crate::analysis::axes::sensors::Sensor;
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

fn judge_above((imu, sensor): (&Imu, &Sensor), subject: String, above: &Above, limits: &Limits, out: &mut Judge) {
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
        match above.class {
            World::Leaning => String::new(),
            World::Far => other_readings(above),
            _ => sensor.diagnosis.words(),
        }
    );
    let otherwise =
        "align the orientation with gravity: level and at rest `R(q) * acceleration` is +9.81 along z (REP-145)";
    let finding = Finding::new(severity, subject, message, imu.stream.place()).likely();
    let finding = match above.class {
        // What turns wrongly points anywhere.
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

/// Where the acceleration points when the four numbers of the orientation are read in other ways.
fn other_readings(above: &Above) -> String {
    let words = above.others.iter().map(|mean| {
        let degrees = mean.from_up_rad.to_degrees();
        let how = match mean.reading {
            Reading::Conjugate => "as the inverse",
            Reading::Wxyz => "as w, x, y, z",
            _ => "as w, x, y, z of the inverse",
        };
        format!("{how} {degrees:.0} deg away (concentration {:.3})", mean.concentration)
    });
    format!("; read {}", words.collect::<Vec<_>>().join(", "))
}

fn named(reading: Reading) -> &'static str {
    match reading {
        Reading::Conjugate => "inverse",
        Reading::WxyzConjugate => "wxyz-inverse",
        _ => "wxyz",
    }
}
