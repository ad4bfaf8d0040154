//! TIME12: two files state the time offset between a camera and the IMU with opposite signs.

use crate::rules::prelude::*;
use crate::world::camera::StatedDelay;

pub(crate) struct CameraImuOffset;

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Limits {
    min_offset_ms: f64,
    same_ms: f64,
}

impl Rule for CameraImuOffset {
    const NEEDS: &'static [Need] = &[];
    type Limits = Limits;

    fn judge(world: &Estimates, limits: &Limits, out: &mut Judge) {
        for (index, one) in world.delays.iter().enumerate() {
            let subject = format!(
                "`{}` of `cam{}` of {}",
                one.key,
                one.camera,
                world.path(one.place.source)
            );
            let others = world
                .delays
                .iter()
                .enumerate()
                .filter(|(_, other)| other.camera == one.camera && other.place.source != one.place.source);
            let sum_ms = |other: &StatedDelay| 1e3 * (one.offset_s + other.offset_s).abs();
            let Some((at, other)) = others.min_by(|(_, a), (_, b)| sum_ms(a).total_cmp(&sum_ms(b))) else {
                out.not_applicable(subject, "no other file states the offset of this camera");
                continue;
            };
            if 1e3 * one.offset_s.abs() < limits.min_offset_ms {
                out.too_little(subject, "the offset is too small to judge its sign");
                continue;
            }
            let sum = Measured::new("sum of the offset and that of the other file", sum_ms(other), "ms")
                .at_least(limits.same_ms);
            // Reported at the one that was not measured, else at the last one.
            let rank = |delay: &StatedDelay, index: usize| (delay.key != "timeshift_cam_imu", index);
            if sum_ms(other) > limits.same_ms {
                out.pass(subject, [sum]);
            } else if rank(one, index) > rank(other, at) {
                out.fail(opposite(one, other, subject).measured(sum));
            }
        }
    }
}

fn opposite(one: &StatedDelay, other: &StatedDelay, subject: String) -> Finding {
    let message = format!(
        "`{}` of `cam{}` is {} s, but `{}` of another file is {} s: opposite signs",
        one.key, one.camera, one.offset_s, other.key, other.offset_s
    );
    Finding::warning(subject, message, one.place.clone())
        .likely()
        .label(format!("`{}`", one.key))
        .related(other.place.clone(), format!("`{}`", other.key))
        .detail("Kalibr, OpenVINS and VINS all define t_imu = t_cam + offset: the sign is not changed between them.")
        .help(format!(
            "write {} for `{}`, if the other file has the result of the calibration",
            other.offset_s, one.key
        ))
}
