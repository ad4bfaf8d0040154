//! Whether a pose turns with the gyro of a sensor on its body.

use nalgebra::{UnitQuaternion, Vector3};

use crate::analysis::motion::{Imu, Turned};

/// Squared turns of half a second that a pose and a gyro must show to contradict each other, rad²: four of 0.25 rad.
const MIN_TURN_RAD2: f64 = 0.25;

/// Correlation of their turns from which on they do, as in AXES05: the wheels of a real skid-steered robot reach 0.64.
const AGREES: f64 = 0.5;

/// Whether a pose turns with the gyro of a sensor on its body, or against it: then the two mean other axes of it, and neither turns
/// what the other measures. What hardly turns says nothing.
pub(crate) fn turns_with(
    turned: &Turned,
    imu: &Imu,
    child_from_imu: &UnitQuaternion<f64>,
    max_step_s: f64,
) -> Option<bool> {
    let (mut together, mut by_pose, mut by_gyro) = (0.0, 0.0, 0.0);
    for stretch in &imu.stream.stretches {
        // Where a turn began, and what the gyro has turned since, up to the row before.
        let mut known: Option<(f64, UnitQuaternion<f64>)> = None;
        let (mut told, mut before) = (0.0, None);
        for timed in stretch {
            // About z alone: odometry in a plane knows nothing of the roll and pitch that a gyro feels.
            let rate = (child_from_imu * Vector3::from(timed.row.angular_velocity)).z;
            let here = turned.at(timed.t_s, max_step_s).filter(|_| rate.is_finite());
            let ((Some((from_s, from)), Some((last_s, last))), Some(here)) = ((known, before), here) else {
                known = here.map(|here| (timed.t_s, here));
                before = here.map(|_| (timed.t_s, rate));
                told = 0.0;
                continue;
            };
            told += f64::midpoint(last, rate) * (timed.t_s - last_s);
            before = Some((timed.t_s, rate));
            // Long against the noise of a pose, short against a turn.
            if timed.t_s - from_s < max_step_s {
                continue;
            }
            let turn = (from.inverse() * here).scaled_axis().z;
            together += turn * told;
            by_pose += turn * turn;
            by_gyro += told * told;
            known = Some((timed.t_s, here));
            told = 0.0;
        }
    }
    let correlation = together / (by_pose * by_gyro).sqrt();
    (by_pose.min(by_gyro) >= MIN_TURN_RAD2 && correlation.abs() > AGREES).then_some(correlation > 0.0)
}
