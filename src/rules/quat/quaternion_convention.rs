//! QUAT01: an orientation compared with the integral of its gyro.

use crate::advice::diagnosis::{explain, judge_each};
use crate::analysis::axes::causes::{Aspect, Turn};
use crate::analysis::axes::sensors::Sensor;
use crate::analysis::motion::Imu;
use crate::analysis::quat::ways::{GyroAgreement, Limits};
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

fn judge_turned(
    (imu, sensor): (&Imu, &Sensor),
    subject: String,
    turned: &GyroAgreement,
    limits: &Limits,
    out: &mut Judge,
) {
    let windows = turned.windows as u64;
    let mut measured = vec![
        Measured::new(
            "error of the rotation / rotation of the gyro, as published",
            turned.as_published.residual,
            "1",
        )
        .limit(turned.limit)
        .samples(windows),
        Measured::new("the same, with the orientation inverted", turned.inverse.residual, "1").samples(windows),
        Measured::new(
            "the same, with the quaternion read as w, x, y, z",
            turned.reordered.residual,
            "1",
        )
        .samples(windows),
        Measured::new("rotation that was compared", turned.rotation_deg, "deg").at_least(limits.min_rotation_deg),
    ];
    if matches!(turned.class, Turn::Agree | Turn::Tilting) {
        return out.pass(subject, measured);
    }
    let about = turned
        .axis
        .and_then(|axis| turned.correlations().get(axis).copied().flatten());
    if let (Turn::Partly, Some(correlation)) = (turned.class, about) {
        measured.push(Measured::new("correlation about that axis", correlation, "1").at_least(limits.axis_agrees));
    }
    let what = match turned.class {
        Turn::Reordered => "orientation follows its gyro only when read as w, x, y, z".to_owned(),
        Turn::ReorderedInverse => "orientation follows its gyro only when read as w, x, y, z and inverted".to_owned(),
        Turn::Partly => {
            let axis = turned.axis.and_then(|axis| ["x", "y", "z"].get(axis)).unwrap_or(&"one");
            format!("orientation does not follow its gyro about {axis}")
        }
        Turn::Ordered => "orientation follows its gyro only with its Euler angles in another order".to_owned(),
        Turn::Unrelated => "orientation is not the integral of its gyro".to_owned(),
        Turn::OneOf(_) => "orientation follows its gyro only in another convention".to_owned(),
        _ => "orientation and gyro rotate in opposite directions".to_owned(),
    };
    let message = format!(
        "`{}`: {what} (error {:.0} %)",
        imu.stream.topic,
        100.0 * turned.as_published.residual
    );
    let other_axes = if turned.class == Turn::Unrelated {
        format!(
            " With the axes of the gyro permuted or negated, the error is {:.0} %.",
            100.0 * turned.other_axes
        )
    } else {
        String::new()
    };
    let detail = format!(
        "The error is the difference between the rotations of orientation and gyro, as a share of the gyro's: more than 100 % if they are opposite.{other_axes}"
    );
    let otherwise = match turned.class {
        Turn::Partly => {
            "check the order in which roll, pitch and yaw are composed (ROS: Rz(yaw) Ry(pitch) Rx(roll)), and that axis of the gyro"
        }
        Turn::Unrelated => {
            "check for fields filled from another message, degrees instead of radians, or a wrong Euler order"
        }
        _ => "make the driver publish orientation and gyro in the same axes: both are of the sensor's frame (REP-145)",
    };
    let finding = Finding::error(subject, message, imu.stream.place())
        .likely()
        .detail(detail);
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
