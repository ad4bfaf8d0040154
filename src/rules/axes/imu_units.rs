//! AXES02: the units of an inertial sensor.

mod unoriented;

use nalgebra::Vector3;

use crate::analysis::axes::sensors::{Sensor, Sensors};
use crate::analysis::motion::{Imu, Motion};
use crate::math::turns::{Score, Turns};
use crate::math::{readings::Reading, regress::bound_that_reaches_one, stats::median};
use crate::rules::prelude::*;
use crate::verdict::UNEXPLAINED;

pub(crate) struct ImuUnits;

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Limits {
    min_s: f64,
    gravity: f64,
    gravity_share: f64,
    max_removed: f64,
    min_motion_s: f64,
    max_mean: f64,
    max_free: f64,
    max_uneven: f64,
    max_reached: f64,
    min_vertical: f64,
    min_t: f64,
    min_rotation_deg: f64,
    min_turning_s: f64,
    gain_share: f64,
    min_correlation: f64,
    max_factor: f64,
    min_tilting: f64,
    min_range_deg: f64,
}

impl Rule for ImuUnits {
    const NEEDS: &'static [Need] = &[Need::Bag];
    type Limits = Limits;

    fn judge(world: &Estimates, limits: &Limits, out: &mut Judge) {
        let (motion, sensors) = (Motion::of(world), Sensors::of(world));
        for (imu, sensor) in sensors.each(&motion) {
            judge_acceleration(imu, limits, out);
            judge_rate(imu, sensor, limits, out);
        }
    }
}

fn judge_acceleration(imu: &Imu, limits: &Limits, out: &mut Judge) {
    let subject = format!("acceleration of {}", imu.stream.subject);
    let Some(force) = imu.inertial.force.filter(|force| *force > 0.0) else {
        return out.not_applicable(subject, "its messages hold no acceleration (all zero)");
    };
    let seconds = imu.stream.seconds();
    if seconds < limits.min_s {
        return out.too_little(
            subject,
            format!("only {seconds:.1} s are recorded, {} s are needed", limits.min_s),
        );
    }
    let measured = Measured::new("median magnitude of the acceleration", force, "m/s2")
        .expected(limits.gravity)
        .samples(imu.stream.rows().count() as u64);
    let is_near = |length: f64, unit: f64| (length / unit - 1.0).abs() <= limits.gravity_share;
    let near = |unit: f64| is_near(force, unit);
    if near(limits.gravity) {
        return out.pass(subject, measured);
    }
    // Lift and curves can raise the magnitude throughout a recording: rotated into the world the mean is gravity again.
    let world = world_mean(imu).map(|mean| mean.norm());
    if let Some(world) = world.filter(|world| is_near(*world, limits.gravity)) {
        let of_world = Measured::new("magnitude of the mean acceleration in the world", world, "m/s2");
        return out.pass(subject, [measured, of_world.expected(limits.gravity)]);
    }
    // A drive ends about as fast as it began: without gravity the mean is near zero.
    let is_free = force <= limits.max_free
        && seconds >= limits.min_motion_s
        && mean_length(imu).is_some_and(|mean| mean <= limits.max_mean && mean <= force / 2.0);
    let is_removed = force <= limits.max_removed || is_free;
    if near(1.0) && !is_free && !is_steady(imu, force, limits) {
        let why = format!(
            "median magnitude {force:.2}: either the unit is g, or gravity is removed and the vehicle accelerates"
        );
        return out.too_little(subject, why);
    }
    let (what, help, relation) = if near(1.0) && !is_free {
        let help = "multiply the acceleration by 9.80665: sensor_msgs/Imu requires m/s2 (REP-145)";
        ("the unit is g", help, None)
    } else if near(100.0 * limits.gravity) || near(1000.0) {
        // 981 and 1000: no drive distinguishes them.
        let help = "divide the acceleration by 100 (cm/s2) or multiply it by 0.00980665 (mg), whichever unit the data sheet \
                    states: sensor_msgs/Imu requires m/s2";
        ("the unit is cm/s2 or mg", help, None)
    } else if near(1000.0 * limits.gravity) {
        let help = "divide the acceleration by 1000: sensor_msgs/Imu requires m/s2";
        ("the unit is mm/s2", help, None)
    } else if is_removed {
        let help = "publish the specific force, gravity included (REP-145): filters subtract gravity themselves";
        ("gravity is removed", help, None)
    } else if force > limits.max_free
        && seconds >= limits.min_motion_s
        && is_steady(imu, force, limits)
        && !reaches_gravity(imu, force, limits)
    {
        let help = "compare the accelerometer's full scale (LSB per g) with its data sheet, and the fields with the message definition";
        ("no known unit fits", help, Some(UNEXPLAINED))
    } else {
        let why = format!(
            "median magnitude {force:.2} m/s2 is more than {:.0} % from gravity, and strong motion could explain that: record a minute \
             in which the sensor is at rest or moves gently",
            100.0 * limits.gravity_share
        );
        return out.too_little(subject, why);
    };
    let message = format!(
        "`{}`: median acceleration is {force:.2} m/s2 instead of 9.81: {what}",
        imu.stream.topic
    );
    let place = imu.stream.place();
    let finding = match relation {
        None if is_removed => Finding::warning(subject, message, place),
        None => Finding::error(subject, message, place),
        Some(relation) => Finding::error(subject, message, place).relation(relation),
    };
    let detail = format!("The median is taken over {seconds:.0} s.");
    out.fail(finding.likely().detail(detail).help(help).measured(measured));
}

/// Magnitude of the mean acceleration in the sensor's axes, m/s² by definition.
fn mean_length(imu: &Imu) -> Option<f64> {
    let forces = imu
        .stream
        .rows()
        .map(|timed| Vector3::from(timed.row.linear_acceleration));
    let forces: Vec<Vector3<f64>> = forces
        .filter(|force| force.iter().all(|value| value.is_finite()))
        .collect();
    (!forces.is_empty()).then(|| (forces.iter().sum::<Vector3<f64>>() / forces.len() as f64).norm())
}

/// Whether an acceleration is as steady as gravity and, rotated into the world by the orientation as published, vertical.
fn is_steady(imu: &Imu, force: f64, limits: &Limits) -> bool {
    let off: Vec<f64> = lengths(imu).map(|length| (length - force).abs()).collect();
    let is_even = median(&off).is_some_and(|off| off <= limits.max_uneven * force);
    let is_upright = |mean: Vector3<f64>| mean.z.abs() >= limits.min_vertical * mean.norm();
    is_even && (imu.inertial.gravity.is_none() || world_mean(imu).is_some_and(is_upright))
}

/// Whether the magnitude reaches gravity at times, so that motion explains the rest.
fn reaches_gravity(imu: &Imu, force: f64, limits: &Limits) -> bool {
    let reaches = |length: &f64| (length - limits.gravity) * (force - limits.gravity) <= 0.0;
    lengths(imu).filter(reaches).count() as f64 > limits.max_reached * lengths(imu).count() as f64
}

/// Magnitudes of the acceleration, m/s² by definition.
fn lengths(imu: &Imu) -> impl Iterator<Item = f64> {
    imu.stream
        .rows()
        .map(|timed| Vector3::from(timed.row.linear_acceleration).norm())
}

/// Mean acceleration, rotated into the world by the orientation, m/s² by definition.
fn world_mean(imu: &Imu) -> Option<Vector3<f64>> {
    Some(imu.inertial.gravity.as_ref()?.mean(Reading::Xyzw)?.mean_m_s2)
}

/// What is wrong with a gyro's unit, and what to do.
const IN_DEGREES: (&str, &str) = (
    "the gyro is in deg/s",
    "multiply the angular velocity by pi/180: sensor_msgs/Imu requires rad/s",
);
const TWICE_IN_RADIANS: (&str, &str) = (
    "the gyro is converted to radians twice",
    "remove one of the two multiplications by pi/180",
);

/// How far the orientation rotates compared with the gyro, where both rotate enough; or why that is not known.
fn by_orientation<'i>(imu: &'i Imu, limits: &Limits) -> Result<(&'i Turns, &'i Score), String> {
    if let Some(why) = imu.no_orientation {
        return Err(why.to_owned());
    }
    let best = imu.inertial.turns.as_ref().and_then(|turns| {
        let scores = turns.scores.iter();
        let best = scores.max_by(|a, b| a.gain_correlation.abs().total_cmp(&b.gain_correlation.abs()));
        Some((turns, best?))
    });
    let Some((turns, score)) = best else {
        return Err("no gap-free second with both orientation and angular velocity".to_owned());
    };
    // Rotation by the orientation, which does not depend on the gyro's unit.
    let turned_deg = turned_rad(score.turn_power, turns.active).to_degrees();
    if turned_deg < limits.min_rotation_deg || !score.gain.is_finite() {
        return Err(format!(
            "the orientation rotates by only {turned_deg:.0} deg while the gyro is recorded, {} deg are needed",
            limits.min_rotation_deg
        ));
    }
    if turns.covered_s < limits.min_turning_s {
        return Err(format!(
            "only {:.1} s of orientation with angular velocity, {} s are needed to separate a scale factor from noise",
            turns.covered_s, limits.min_turning_s
        ));
    }
    if score.gain_correlation.abs() < limits.min_correlation {
        return Err(format!(
            "the orientation does not follow the gyro in any quaternion convention (best correlation {:.2}, as {})",
            score.gain_correlation,
            score.reading.word()
        ));
    }
    Ok((turns, score))
}

fn judge_rate(imu: &Imu, sensor: &Sensor, limits: &Limits, out: &mut Judge) {
    let subject = format!("angular velocity of {}", imu.stream.subject);
    let (turns, score) = match by_orientation(imu, limits) {
        Ok(found) => found,
        Err(why) => return unoriented::judge((imu, sensor), subject, &why, limits, out),
    };
    let gain = score.gain.abs();
    let measured = Measured::new("rotation by the orientation over rotation by the gyro", gain, "1")
        .expected(1.0)
        .samples(turns.active as u64);
    let near = |value: f64| (gain / value - 1.0).abs() <= limits.gain_share;
    // Standard error of a slope, three numbers a window.
    let rest = (1.0 - score.gain_correlation * score.gain_correlation).max(0.0);
    let error = gain / score.gain_correlation.abs() * (rest / (3.0 * turns.active as f64 - 1.0).max(1.0)).sqrt();
    if !near(1.0) && (gain - 1.0).abs() < limits.min_t * error {
        let why = format!(
            "the orientation rotates {gain:.2} +- {error:.2} times as far as its gyro: not distinguishable from 1"
        );
        return out.too_little(subject, why);
    }
    if near(1.0) {
        return out.pass(subject, [measured]);
    }
    if let Some(upper) = bound_that_reaches_one(gain, score.gain_correlation, limits.gain_share) {
        let why = format!(
            "the orientation rotates {gain:.2} to {upper:.2} times as far as its gyro, depending on which of the two is noisy"
        );
        return out.too_little(subject, why);
    }
    let message = |what: &str| {
        format!(
            "`{}`: {what} (the orientation rotates {gain:.4} times as far)",
            imu.stream.topic
        )
    };
    let place = imu.stream.place();
    let finding = if near(1f64.to_radians()) {
        Finding::error(subject, message(IN_DEGREES.0), place).help(IN_DEGREES.1)
    } else if near(1f64.to_degrees()) {
        Finding::error(subject, message(TWICE_IN_RADIANS.0), place).help(TWICE_IN_RADIANS.1)
    } else {
        Finding::warning(subject, message("the gyro's scale factor is wrong"), place)
            .help("compare the gyro's scale factor with its data sheet")
    };
    let mut finding = finding.likely().measured(measured);
    if score.reading != Reading::Xyzw {
        finding = finding.related(
            imu.stream.place(),
            format!("with the quaternion read as {}", score.reading.word()),
        );
    }
    out.fail(finding);
}

/// Lower bound of the rotation in windows with this power, radians: windows of equal rotation have the most for their power.
fn turned_rad(power: f64, windows: usize) -> f64 {
    (power * windows as f64).sqrt()
}
