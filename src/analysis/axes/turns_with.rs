//! Whether a pose rotates with the gyro of a sensor on its body.

use nalgebra::{UnitQuaternion, Vector3};

use crate::analysis::motion::{Imu, Orientations};

/// Sum of squared rotations over half a second that a pose and a gyro must show, rad²: four of 0.25 rad.
const MIN_TURN_RAD2: f64 = 0.25;

/// Correlation from which on they agree or contradict, as in AXES05: the wheels of a real skid-steered robot reach 0.64.
const AGREES: f64 = 0.5;

/// Whether a pose rotates with the gyro of a sensor on its body, or opposite to it: then the two use different axes of the body. `None`
/// if there is too little rotation.
pub(crate) fn turns_with(
    turned: &Orientations,
    imu: &Imu,
    child_from_imu: &UnitQuaternion<f64>,
    max_step_s: f64,
) -> Option<bool> {
    let (mut together, mut by_pose, mut by_gyro) = (0.0, 0.0, 0.0);
    for stretch in &imu.stream.stretches {
        // Start of a rotation, and the gyro's integral since then, up to the previous row.
        let mut known: Option<(f64, UnitQuaternion<f64>)> = None;
        let (mut by_rate, mut before) = (0.0, None);
        for timed in stretch {
            // About z alone: planar odometry has no roll and pitch.
            let rate = (child_from_imu * Vector3::from(timed.row.angular_velocity)).z;
            let here = turned.at(timed.t_s, max_step_s).filter(|_| rate.is_finite());
            let ((Some((from_s, from)), Some((last_s, last))), Some(here)) = ((known, before), here) else {
                known = here.map(|here| (timed.t_s, here));
                before = here.map(|_| (timed.t_s, rate));
                by_rate = 0.0;
                continue;
            };
            by_rate += f64::midpoint(last, rate) * (timed.t_s - last_s);
            before = Some((timed.t_s, rate));
            // Long compared with the noise of a pose, short compared with a turn.
            if timed.t_s - from_s < max_step_s {
                continue;
            }
            let turn = (from.inverse() * here).scaled_axis().z;
            together += turn * by_rate;
            by_pose += turn * turn;
            by_gyro += by_rate * by_rate;
            known = Some((timed.t_s, here));
            by_rate = 0.0;
        }
    }
    let correlation = together / (by_pose * by_gyro).sqrt();
    (by_pose.min(by_gyro) >= MIN_TURN_RAD2 && correlation.abs() > AGREES).then_some(correlation > 0.0)
}
