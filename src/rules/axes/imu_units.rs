//! AXES02: the units of an inertial sensor.

use nalgebra::Vector3;

use crate::analysis::motion::{Imu, Motion};
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
}

impl Rule for ImuUnits {
    const NEEDS: &'static [Need] = &[Need::Bag];
    type Limits = Limits;

    fn judge(world: &Estimates, limits: &Limits, out: &mut Judge) {
        for bag in &Motion::of(world).bags {
            for imu in &bag.imus {
                judge_acceleration(imu, limits, out);
                judge_rate(imu, limits, out);
            }
        }
    }
}

fn judge_acceleration(imu: &Imu, limits: &Limits, out: &mut Judge) {
    let subject = format!("acceleration of {}", imu.stream.subject);
    let Some(force) = imu.inertial.force.filter(|force| *force > 0.0) else {
        return out.not_applicable(subject, "it gives no acceleration: zeros in every message");
    };
    let seconds = imu.stream.seconds();
    if seconds < limits.min_s {
        return out.too_little(subject, format!("{seconds:.1} s of it, {} s are needed", limits.min_s));
    }
    let measured = Measured::new("median length of the acceleration", force, "m/s2")
        .limit(limits.gravity)
        .samples(imu.stream.rows().count() as u64);
    let is_near = |length: f64, unit: f64| (length / unit - 1.0).abs() <= limits.gravity_share;
    let near = |unit: f64| is_near(force, unit);
    if near(limits.gravity) {
        return out.pass(subject, measured);
    }
    // Lift and curves make what is felt longer, all the way: turned into the world it is gravity again.
    let world = world_mean(imu).map(|mean| mean.norm());
    if let Some(world) = world.filter(|world| is_near(*world, limits.gravity)) {
        let of_world = Measured::new("length of the mean, turned into the world", world, "m/s2");
        return out.pass(subject, [measured, of_world.limit(limits.gravity)]);
    }
    // A drive ends as fast as it began: without gravity nothing is left in the mean.
    let is_free = force <= limits.max_free
        && seconds >= limits.min_motion_s
        && mean_length(imu).is_some_and(|mean| mean <= limits.max_mean && mean <= force / 2.0);
    let is_removed = force <= limits.max_removed || is_free;
    if near(1.0) && !is_free && !is_steady(imu, force, limits) {
        let why = format!(
            "its length is {force:.2} in the median, as in units of g, or of a vehicle that speeds up without gravity"
        );
        return out.too_little(subject, why);
    }
    let (what, help, relation) = if near(1.0) && !is_free {
        let help = "multiply it by 9.80665: REP-145 and sensor_msgs/Imu want m/s2";
        ("as in units of gravity (g)", help, None)
    } else if near(100.0 * limits.gravity) || near(1000.0) {
        // 981 and 1000: no drive tells them apart.
        let help = "divide it by 100, or multiply it by 0.00980665, as the data sheet says: sensor_msgs/Imu wants m/s2";
        ("as in cm/s2 or in thousandths of g", help, None)
    } else if near(1000.0 * limits.gravity) {
        ("as in mm/s2", "divide it by 1000: sensor_msgs/Imu wants m/s2", None)
    } else if is_removed {
        let help = "publish the specific force, gravity included (REP-145): filters take it off themselves";
        ("as where gravity was taken off", help, None)
    } else if force > limits.max_free
        && seconds >= limits.min_motion_s
        && is_steady(imu, force, limits)
        && !reaches_gravity(imu, force, limits)
    {
        let help = "compare the full scale of the accelerometer (LSB per g) with its data sheet, and the fields with the message's";
        ("steady, and gravity in no unit that is known", help, Some(UNEXPLAINED))
    } else {
        let why = format!("its length is {force:.2} in the median, which is gravity in no unit that is known");
        return out.too_little(subject, why);
    };
    let message = format!(
        "the acceleration of `{}` has a length of {force:.2} in the median of {seconds:.0} s, {what}, where m/s2 with gravity are 9.81",
        imu.stream.topic
    );
    let place = imu.stream.place();
    let finding = match relation {
        None if is_removed => Finding::warning(subject, message, place),
        None => Finding::error(subject, message, place),
        Some(relation) => Finding::error(subject, message, place).relation(relation),
    };
    out.fail(finding.likely().help(help).measured(measured));
}

/// Length of the mean of the acceleration in the sensor's axes, m/s² by definition.
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

/// Whether an acceleration is as steady as gravity is, and as the orientation turns it into the world, vertical: another reading
/// makes a vertical of anything.
fn is_steady(imu: &Imu, force: f64, limits: &Limits) -> bool {
    let off: Vec<f64> = lengths(imu).map(|length| (length - force).abs()).collect();
    let is_even = median(&off).is_some_and(|off| off <= limits.max_uneven * force);
    let is_upright = |mean: Vector3<f64>| mean.z.abs() >= limits.min_vertical * mean.norm();
    is_even && (imu.inertial.gravity.is_none() || world_mean(imu).is_some_and(is_upright))
}

/// Whether the acceleration is at times as long as gravity, so that it is the motion that makes it longer or shorter.
fn reaches_gravity(imu: &Imu, force: f64, limits: &Limits) -> bool {
    let reaches = |length: &f64| (length - limits.gravity) * (force - limits.gravity) <= 0.0;
    lengths(imu).filter(reaches).count() as f64 > limits.max_reached * lengths(imu).count() as f64
}

/// Lengths of the acceleration, m/s² by definition.
fn lengths(imu: &Imu) -> impl Iterator<Item = f64> {
    imu.stream
        .rows()
        .map(|timed| Vector3::from(timed.row.linear_acceleration).norm())
}

/// Mean of the acceleration, turned into the world by the orientation, m/s² by definition.
fn world_mean(imu: &Imu) -> Option<Vector3<f64>> {
    Some(imu.inertial.gravity.as_ref()?.mean(Reading::Xyzw)?.mean_m_s2)
}

fn judge_rate(imu: &Imu, limits: &Limits, out: &mut Judge) {
    let subject = format!("angular velocity of {}", imu.stream.subject);
    if let Some(why) = imu.no_orientation {
        return out.not_applicable(subject, why);
    }
    let Some(turns) = &imu.inertial.turns else {
        return out.too_little(subject, "no unbroken second of orientation and rate");
    };
    let Some(score) = turns
        .scores
        .iter()
        .max_by(|a, b| a.gain_correlation.abs().total_cmp(&b.gain_correlation.abs()))
    else {
        return;
    };
    // What the orientation turned, whatever the gyro's unit.
    let turned_deg = turned_rad(score.turn_power, turns.active).to_degrees();
    if turned_deg < limits.min_rotation_deg || !score.gain.is_finite() {
        let why = format!(
            "the orientation turns by {turned_deg:.0} deg in windows with a rate, {} deg are needed",
            limits.min_rotation_deg
        );
        return out.too_little(subject, why);
    }
    if turns.covered_s < limits.min_turning_s {
        let why = format!(
            "{:.1} s of orientation and rate: what a scale looks like in so short a time may be noise, {} s are needed",
            turns.covered_s, limits.min_turning_s
        );
        return out.too_little(subject, why);
    }
    if score.gain_correlation.abs() < limits.min_correlation {
        let why = format!(
            "the orientation does not follow the rate under any reading (correlation {:.2} as {})",
            score.gain_correlation,
            score.reading.word()
        );
        return out.too_little(subject, why);
    }
    let gain = score.gain.abs();
    let measured = Measured::new("turning of the orientation, over that of the gyro", gain, "1")
        .limit(limits.gain_share)
        .samples(turns.active as u64);
    let near = |value: f64| (gain / value - 1.0).abs() <= limits.gain_share;
    // Standard error of a slope, three numbers a window.
    let rest = (1.0 - score.gain_correlation * score.gain_correlation).max(0.0);
    let error = gain / score.gain_correlation.abs() * (rest / (3.0 * turns.active as f64 - 1.0).max(1.0)).sqrt();
    if !near(1.0) && (gain - 1.0).abs() < limits.min_t * error {
        let why = format!("the orientation turns {gain:.2} times as far as its gyro says, give or take {error:.2}");
        return out.too_little(subject, why);
    }
    if near(1.0) {
        return out.pass(subject, [measured]);
    }
    if let Some(upper) = bound_that_reaches_one(gain, score.gain_correlation, limits.gain_share) {
        let why = format!(
            "the orientation turns {gain:.2} to {upper:.2} times as far as its gyro says, by which of the two is noise"
        );
        return out.too_little(subject, why);
    }
    let (what, help) = if near(1f64.to_radians()) {
        (
            "the gyro is in deg/s",
            "multiply it by pi/180: sensor_msgs/Imu wants rad/s",
        )
    } else if near(1f64.to_degrees()) {
        (
            "the gyro was made radians twice",
            "take one multiplication by pi/180 out",
        )
    } else {
        ("its scale is wrong", "compare the gyro's scale with its data sheet")
    };
    let message = format!(
        "the orientation of `{}` turns {gain:.4} times as far as its gyro says: {what}",
        imu.stream.topic
    );
    let mut finding = if near(1f64.to_radians()) || near(1f64.to_degrees()) {
        Finding::error(subject, message, imu.stream.place())
    } else {
        Finding::warning(subject, message, imu.stream.place())
    };
    finding = finding.likely().help(help).measured(measured);
    if score.reading != Reading::Xyzw {
        finding = finding.related(
            imu.stream.place(),
            format!("under the reading {}", score.reading.word()),
        );
    }
    out.fail(finding);
}

/// Rotation that windows with this power hold at least, radians: windows of one size hold the most for their power.
fn turned_rad(power: f64, windows: usize) -> f64 {
    (power * windows as f64).sqrt()
}
