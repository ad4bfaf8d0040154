//! QUAT01: an orientation against the integral of its gyro.

use crate::advice::diagnosis::{explain, judge_each};
use crate::analysis::axes::causes::{Aspect, Turn};
use crate::analysis::motion::Imu;
use crate::analysis::quat::ways::{Limits, Turned};
use crate::analysis::axes::sensors::Sensor;
use crate::rules::prelude::*;
use crate::verdict::UNEXPLAINED;

pub(crate) struct QuaternionConvention;

impl Rule for QuaternionConvention {
    const NEEDS: &'static [Need] = &[Need::Bag];
    type Limits = Limits;

    fn judge(world: &Estimates, limits: &Limits, out: &mut Judge) {
        let named = |imu: &str| format!("orientation of {imu} against its gyro");
        judge_each((world, limits), named, |sensor| &sensor.turn, judge_turned, out);
    }
}

fn judge_turned((imu, sensor): (&Imu, &Sensor), subject: String, turned: &Turned, limits: &Limits, out: &mut Judge) {
    let windows = turned.windows as u64;
    let measured = [
        Measured::new("residual as published", turned.as_published.residual, "1")
            .limit(turned.limit)
            .samples(windows),
        Measured::new("residual of the inverse", turned.inverse.residual, "1").samples(windows),
        Measured::new("residual read as w x y z", turned.reordered.residual, "1").samples(windows),
        Measured::new("rotation", turned.rotation_deg, "deg").limit(limits.min_rotation_deg),
    ];
    if matches!(turned.class, Turn::Agree | Turn::Tilting) {
        return out.pass(subject, measured);
    }
    let what = match turned.class {
        Turn::Reordered => "follows its gyro only when the four numbers are read as w, x, y, z".to_owned(),
        Turn::ReorderedInverse => {
            "follows its gyro only when the four numbers are read as w, x, y, z, of the inverse".to_owned()
        }
        Turn::Partly => {
            let axis = turned.axis.and_then(|axis| ["x", "y", "z"].get(axis)).unwrap_or(&"one");
            format!("follows its gyro about one axis, and not about {axis}")
        }
        Turn::Ordered => "follows its gyro only when its angles are put together in another order".to_owned(),
        Turn::Unrelated => "is not the integral of its gyro".to_owned(),
        Turn::OneOf(_) => {
            "follows its gyro only when it is read in another way, of which several serve alike".to_owned()
        }
        _ => "turns against its gyro".to_owned(),
    };
    let message = format!(
        "the orientation of `{}` {what}: over {:.0} deg of rotation {:.0} % of the gyro's turning is left unexplained as published, \
         {:.0} % by the inverse, {:.0} % read as w x y z{}{}",
        imu.stream.topic,
        turned.rotation_deg,
        100.0 * turned.as_published.residual,
        100.0 * turned.inverse.residual,
        100.0 * turned.reordered.residual,
        if turned.class == Turn::Unrelated {
            format!(
                ", {:.0} % with the gyro's axes changed or negated",
                100.0 * turned.other_axes
            )
        } else {
            String::new()
        },
        sensor.diagnosis.words()
    );
    let otherwise = match turned.class {
        Turn::Partly => {
            "look at the order in which roll, pitch and yaw are put together: ROS is Rz(yaw) Ry(pitch) Rx(roll)"
        }
        Turn::Unrelated => "look for fields of another message, degrees for radians, or an Euler order",
        _ => "compare the driver's axes of orientation and gyro: both are of the sensor's frame (REP-145)",
    };
    let finding = Finding::error(subject, message, imu.stream.place()).likely();
    let finding = if turned.class == Turn::Unrelated {
        finding.relation(UNEXPLAINED)
    } else {
        finding
    };
    let finding = explain(&sensor.diagnosis, imu, Aspect::Turn, finding, otherwise);
    let finding = if turned.class == Turn::Ordered {
        finding.unless(codes::QUAT03)
    } else {
        finding
    };
    out.fail(finding.measured(measured));
}
