//! A lidar and an inertial sensor, by their motion: rotations about two axes, accelerations, and the times of points.

use nalgebra::{UnitQuaternion, Vector3};

use crate::analysis::Estimates;
use crate::analysis::lidar::Clouds;
use crate::analysis::motion::{Imu, Motion, TimedRow};
use crate::math::excitation::{BodyRotation, LEAST_RAD, integrated, rotations};
use crate::math::stats::median;
use crate::rules::codes;
use crate::verdict::{Measured, Severity, Verdict};
use crate::world::BagEvidence;
use crate::world::content::CovarianceEvidence;
use crate::world::motion::InertialRow;

use super::conditions::{Absence, absent, by_rules, clocks, initial_guess, lidars, rate, together};
use super::excited::{self, Body};
use super::stamped::Stamped;
use super::{Condition, ConditionState, Pair, best};

/// Time that both must be recorded, seconds.
const LEAST_S: f64 = 20.0;
const LEAST_CLOUD_HZ: f64 = 5.0;
const LEAST_IMU_HZ: f64 = 50.0;
/// Longest duration of a rotation, seconds: 10 degrees in that time are faster than any bias of a gyro.
const LONGEST_S: f64 = 2.0;
/// Longest step that is integrated, seconds.
const MAX_STEP_S: f64 = 0.5;
/// Windows of acceleration: their length, seconds, the deviation of the force from its mean in axes that do not rotate, m/s^2, and how
/// many must have it.
const WINDOW_S: f64 = 2.0;
const LEAST_M_S2: f64 = 0.5;
const LEAST_WINDOWS: usize = 5;

const MOVE: &str = "move for a minute: rotate by 20 deg and more about each of three axes (roll, pitch, yaw), and accelerate along each; a \
                    vehicle on flat ground must be lifted, or drive over ramps and bumps";

pub(super) fn all(world: &Estimates, verdict: &Verdict) -> Vec<Pair> {
    let motion = Motion::of(world);
    let imus = || {
        motion
            .bags
            .iter()
            .zip(&world.bags)
            .flat_map(|(of, bag)| of.imus.iter().map(move |imu| (bag, imu)))
    };
    let asks = "clouds of a lidar, and an inertial sensor with gyro and accelerometer";
    let no_imu = || Absence {
        lacks: "no inertial sensor in the recording".to_owned(),
        is_sure: true,
    };
    let clouds = lidars(world).and_then(|clouds| imus().next().map(|_| clouds).ok_or_else(no_imu));
    let clouds = match clouds {
        Ok(clouds) => clouds,
        Err(absence) => {
            let record =
                "record the driver's clouds (sensor_msgs/PointCloud2) and the inertial sensor (sensor_msgs/Imu)";
            return vec![absent(world, asks, &absence, record)];
        }
    };
    let each = clouds
        .iter()
        .filter_map(|clouds| best(imus().map(|(bag, imu)| pair(world, verdict, clouds, (bag, imu)))));
    each.collect()
}

fn pair(world: &Estimates, verdict: &Verdict, clouds: &Clouds, (bag, imu): (&BagEvidence, &Imu)) -> Pair {
    let points = Stamped::of(clouds.topic);
    let inertial = bag.topics.get(&imu.stream.topic).map(Stamped::of);
    let Some(inertial) = inertial else {
        // A stream of motion has a topic.
        let open = Condition::open("streams", "an inertial sensor", "its topic is not in the recording");
        return (imu.stream.subject.clone(), vec![open]);
    };
    let parts = parts(bag, imu);
    let is_whole = parts.state == ConditionState::Met;
    let mut conditions = vec![
        parts,
        together([&points, &inertial], LEAST_S),
        rate(&points, LEAST_CLOUD_HZ),
        rate(&inertial, LEAST_IMU_HZ),
        clocks(
            verdict,
            &[codes::TIME02, codes::TIME03, codes::TIME04, codes::TIME09],
            &[&points, &inertial],
        ),
        times_of_points(verdict, &points.subject),
        by_rules(
            verdict,
            ("units", "m/s^2 with gravity, and rad/s"),
            (&[codes::AXES02], Severity::Warning),
            &[
                &format!("acceleration of {}", inertial.subject),
                &format!("angular velocity of {}", inertial.subject),
            ],
        ),
    ];
    if is_whole {
        let bias = bias(imu);
        let turned: Vec<BodyRotation> = runs(imu)
            .flat_map(|run| rotations(&turned(run, bias), LEAST_RAD, LONGEST_S))
            .collect();
        conditions.extend(excited::conditions(bag, &turned, &body(imu), MOVE));
        conditions.push(accelerations(bag, imu));
    }
    conditions.push(initial_guess(
        world,
        [clouds.frame().as_ref(), imu.stream.frame.as_ref()],
    ));
    (format!("{} and {}", points.subject, imu.stream.subject), conditions)
}

/// Whether points have times. For a map, clouds without them are worth a note; here they are useless.
fn times_of_points(verdict: &Verdict, subject: &str) -> Condition {
    let words = (
        "times of points",
        "each point has a time, in a known unit: without them the motion distorts each cloud",
    );
    let there = by_rules(verdict, words, (&[codes::TIME05], Severity::Note), &[subject]);
    if there.state != ConditionState::Met {
        return there;
    }
    let rules = [codes::TIME05, codes::TIME06, codes::TIME08];
    by_rules(verdict, words, (&rules, Severity::Warning), &[subject])
}

/// Whether it has both a gyro and an accelerometer.
fn parts(bag: &BagEvidence, imu: &Imu) -> Condition {
    let has = |of: fn(&InertialRow) -> [f64; 3]| {
        let mut values = imu.stream.rows().map(|timed| Vector3::from(of(&timed.row)));
        values.any(|value| value.norm().is_finite() && value != Vector3::zeros())
    };
    let is_declared = |field: &str| {
        let topic = bag.topics.get(&imu.stream.topic);
        let covariance = topic.and_then(|topic| topic.content.covariances.get(field));
        !covariance.is_some_and(CovarianceEvidence::is_declared_absent)
    };
    let gyro = is_declared("angular_velocity_covariance") && has(|row| row.angular_velocity);
    let force = is_declared("linear_acceleration_covariance") && has(|row| row.linear_acceleration);
    let lacks = match (gyro, force) {
        (false, false) => {
            "it has neither angular velocities nor accelerations: zeros, no numbers, or declared as not measured"
        }
        (false, true) => "it has no angular velocities: zeros, no numbers, or declared as not measured",
        _ => "it has no accelerations: zeros, no numbers, or declared as not measured",
    };
    Condition::judged("streams", "clouds, angular velocities and accelerations", gyro && force)
        .because(format!("{}: {lacks}", imu.stream.subject))
        .record("record the raw data of the inertial sensor, with angular_velocity and linear_acceleration")
}

/// Rows without a long step.
fn runs(imu: &Imu) -> impl Iterator<Item = &[TimedRow<InertialRow>]> {
    let near = |a: &TimedRow<InertialRow>, b: &TimedRow<InertialRow>| b.t_s - a.t_s <= MAX_STEP_S;
    imu.stream
        .stretches
        .iter()
        .flat_map(move |stretch| stretch.chunk_by(near))
}

/// The median rate about each axis, rad/s: the bias of a gyro that rotates now and then. A steady rotation would be taken for one, and shows
/// no second axis.
fn bias(imu: &Imu) -> Vector3<f64> {
    let of = |axis: usize| {
        let rates = imu
            .stream
            .rows()
            .filter_map(|timed| timed.row.angular_velocity.get(axis).copied());
        median(&rates.filter(|rate| rate.is_finite()).collect::<Vec<_>>()).unwrap_or_default()
    };
    Vector3::new(of(0), of(1), of(2))
}

fn turned(run: &[TimedRow<InertialRow>], bias: Vector3<f64>) -> Vec<(f64, UnitQuaternion<f64>)> {
    let rates = run
        .iter()
        .map(|timed| (timed.t_s, Vector3::from(timed.row.angular_velocity) - bias));
    integrated(rates.filter(|(_, rate)| rate.norm().is_finite()))
}

/// The base that the sensor is mounted on, if it is known; else the sensor.
fn body(imu: &Imu) -> Body {
    let frame = match (&imu.mount, &imu.stream.frame) {
        (Some(mount), _) => format!("`{}`", mount.base),
        (None, Some(frame)) => format!("`{frame}`"),
        (None, None) => "the inertial sensor".to_owned(),
    };
    Body {
        frame,
        from_stream: imu.base_from_imu(),
    }
}

/// Whether it accelerates: the force in axes that do not rotate changes by more than noise.
fn accelerations(bag: &BagEvidence, imu: &Imu) -> Condition {
    let windows = imu.stream.windows(WINDOW_S, MAX_STEP_S);
    let deviations: Vec<f64> = windows.iter().filter_map(|window| deviation(window)).collect();
    let moving = deviations.iter().filter(|deviation| **deviation >= LEAST_M_S2).count();
    let largest = deviations.iter().copied().fold(0.0, f64::max);
    Condition::judged(
        "accelerations",
        format!("{LEAST_WINDOWS} windows of {WINDOW_S} s in which the acceleration changes by {LEAST_M_S2} m/s^2 (rms) or more"),
        moving >= LEAST_WINDOWS,
    )
    .measured([
        Measured::count("windows with acceleration", moving)
            .at_least(LEAST_WINDOWS as f64)
            .samples(deviations.len() as u64),
        Measured::new("largest change of acceleration", largest, "m/s^2"),
    ])
    .because(format!("{moving} of {} windows", deviations.len()))
    .record(MOVE)
    .unless_partly_read(bag)
}

/// The deviation of the force from its mean, in the axes of the window's start, m/s^2.
fn deviation(window: &[TimedRow<InertialRow>]) -> Option<f64> {
    let turned = turned(window, Vector3::zeros());
    let forces = window.iter().map(|timed| Vector3::from(timed.row.linear_acceleration));
    let forces: Vec<Vector3<f64>> = (turned.len() == window.len()).then(|| {
        turned
            .iter()
            .zip(forces)
            .map(|((_, turned), force)| turned * force)
            .collect()
    })?;
    let count = forces.len() as f64;
    let mean = forces.iter().sum::<Vector3<f64>>() / count;
    let square = forces.iter().map(|force| (force - mean).norm_squared()).sum::<f64>() / count;
    Some(square.sqrt()).filter(|deviation| deviation.is_finite())
}
