//! AXES11: whether a cloud is mirrored, by its rotation compared with a gyro.

use crate::analysis::axes::sensors::{Sensor, Sensors};
use crate::analysis::motion::{Imu, Motion};
use crate::analysis::scan_motion::{ScanMotion, Steps};
use crate::analysis::time::sweep::{self, sweeps_the_other_way};
use crate::analysis::{
    axes::rates::Integrals, hand_eye::HandEye, lidar::Clouds, motion::mount::mount, scan_motion::moved::ScanStep,
};
use crate::math::regress::{LineForm, fit_huber};
use crate::rules::prelude::*;
use crate::world::FrameId;

pub(crate) struct CloudMirror;

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Limits {
    pair_s: f64,
    max_sigma_deg: f64,
    min_pairs: usize,
    min_turn_deg: f64,
    min_gain: f64,
    max_gain: f64,
    min_t: f64,
}

/// The rotation that scans are compared with.
struct ReferenceTurn {
    /// `the gyro of `/imu``.
    name: String,
    place: Place,
    /// The frame that rotates, and whether it is tied to a base.
    frame: Option<FrameId>,
    is_tied: bool,
    is_of_poses: bool,
    /// Its rotation and that of the scans over the same times, radians.
    pairs: Vec<(f64, f64)>,
}

/// Rotation of the scans over that of a gyro.
struct TurnGain {
    gain: f64,
    t: f64,
    pairs: usize,
    turn_deg: f64,
}

impl Rule for CloudMirror {
    const NEEDS: &'static [Need] = &[Need::Bag];
    type Limits = Limits;

    fn judge(world: &Estimates, limits: &Limits, out: &mut Judge) {
        Clouds::say_packets(world, "handedness", out);
        let (motion, sensors, scans) = (Motion::of(world), Sensors::of(world), ScanMotion::of(world));
        for clouds in Clouds::scanners(world) {
            let subject = clouds.subject("handedness");
            if !clouds.is_of_a_lidar() {
                out.not_applicable(
                    subject,
                    "not recognised as raw points of a lidar by its fields, topic or frame",
                );
                continue;
            }
            let imus = motion.bags.get(clouds.index).map_or(&[][..], |bag| &bag.imus);
            let known = imus.iter().zip(sensors.of_bag(clouds.index));
            match (scans.steps(&clouds), gyro(known)) {
                (Some(steps), Ok(imu)) => {
                    let beside = ReferenceTurn::gyro(steps, imu, limits);
                    judge_clouds(world, &clouds, steps, &beside, limits, out);
                }
                (Some(steps), Err(why)) => match ReferenceTurn::poses(world, &clouds, limits) {
                    Some(beside) => judge_clouds(world, &clouds, steps, &beside, limits, out),
                    None => out.missing(subject, why),
                },
                (None, _) => {
                    out.missing(subject, NO_GYRO);
                }
            }
        }
    }
}

/// Why a cloud without a gyro is not judged.
const NO_GYRO: &str = "no gyro: a mirrored cloud has correct distances and shows in turns alone";

/// A gyro without known faults; one with a known mounting first.
fn gyro<'m>(known: impl Iterator<Item = (&'m Imu, &'m Sensor)>) -> Result<&'m Imu, String> {
    let (mut sound, mut doubted) = (Vec::new(), Vec::new());
    for (imu, sensor) in known {
        if sensor.diagnosis.causes.is_empty() {
            sound.push(imu);
        } else {
            doubted.push(imu);
        }
    }
    sound.sort_by_key(|imu| imu.mount.is_none());
    sound.first().copied().ok_or_else(|| {
        doubted.first().map_or_else(
            || NO_GYRO.to_owned(),
            |imu| {
                format!(
                    "its only gyro is `{}`, for which another rule reports a fault",
                    imu.stream.topic
                )
            },
        )
    })
}

impl ReferenceTurn {
    fn gyro(steps: &Steps, imu: &Imu, limits: &Limits) -> Self {
        let integrals = Integrals::of(imu);
        let offset_s = imu.stream.stamp_offset_s;
        let seconds = |moved: &ScanStep| moved.to.on(offset_s) - moved.from.on(offset_s);
        let chained = steps.chained(|moved| seconds(moved) >= limits.pair_s);
        let sure = chained
            .iter()
            .filter(|moved| moved.sigma[0].to_degrees() <= limits.max_sigma_deg);
        Self {
            name: format!("the gyro of `{}`", imu.stream.topic),
            place: imu.stream.place(),
            frame: imu.stream.frame.clone(),
            is_tied: imu.mount.is_some(),
            is_of_poses: false,
            pairs: sure
                .filter_map(|moved| {
                    let by_gyro = integrals.turned_rad(moved.from.on(offset_s), moved.to.on(offset_s))?;
                    Some((by_gyro, moved.turned_rad()))
                })
                .collect(),
        }
    }

    /// For planar scanners of robots without a gyro. The odometry may be mirrored itself, so the finding is a hint.
    fn poses(world: &Estimates, clouds: &Clouds, limits: &Limits) -> Option<Self> {
        clouds.laser?;
        let seconds = |moved: &ScanStep| moved.to.on(None) - moved.from.on(None);
        let known = HandEye::unchecked(world, clouds, |steps| {
            steps.chained(|moved| seconds(moved) >= limits.pair_s)
        })
        .ok()?;
        let sure = known
            .pairs
            .iter()
            .filter(|pair| pair.sigma_rad.to_degrees() <= limits.max_sigma_deg);
        let turns = sure.map(|pair| (pair.body.rotation.scaled_axis().z, pair.lidar.rotation.scaled_axis().z));
        Some(Self {
            name: known.poses.0.clone(),
            place: known.poses.1.clone(),
            frame: None,
            is_tied: true,
            is_of_poses: true,
            pairs: turns.collect(),
        })
    }
}

fn judge_clouds(
    world: &Estimates,
    clouds: &Clouds,
    steps: &Steps,
    beside: &ReferenceTurn,
    limits: &Limits,
    out: &mut Judge,
) {
    let subject = clouds.subject("handedness");
    if let (Some(_), None) = (clouds.laser, steps.is_up) {
        return out.missing(subject, steps.why);
    }
    let turned = match turned(steps, &beside.pairs, limits) {
        Ok(turned) => turned,
        Err(why) => return out.too_little(subject, why),
    };
    let measured = [
        Measured::new("rotation of the scans over that of the gyro", turned.gain, "1").samples(turned.pairs as u64),
        Measured::new("t statistic of that factor", turned.t, "1").at_least(limits.min_t),
        Measured::new("rotation between two scans (rms)", turned.turn_deg, "deg").at_least(limits.min_turn_deg),
    ];
    let Some(is_up) = steps.is_up else {
        let why = format!(
            "it rotates {:+.2} times as {} does, but no visible ground shows whether its z points up, so the expected sign is unknown",
            turned.gain, beside.name
        );
        return out.too_little(subject, why);
    };
    // A correct cloud with z up rotates with the gyro, one with z down against it.
    if is_up == (turned.gain > 0.0) {
        return out.pass(subject, measured);
    }
    let (relation, what, help) = if clouds.laser.is_some() {
        (
            if is_up { "upside-down" } else { "upright" },
            "the scanner is mounted the other way up than its transform states, or its ranges are in reverse order; in one plane the two \
             are the same",
            "add a roll of 180 deg to the transform if the scanner is mounted so; if not, make its driver publish ranges in the order of \
             increasing angles (`inverted`, `flip_x_axis` or similar, once)",
        )
    } else if is_up {
        (
            "mirrored",
            "x or y has the wrong sign, or the two are swapped",
            "correct x and y in the code that converts ranges and angles to points: an angle counted in the wrong direction, or \
             left-handed axes (x, -y, z)",
        )
    } else {
        (
            "z-negated",
            "z has the wrong sign",
            "correct z in the code that converts ranges and angles to points: an upside-down sensor is rotated by 180 deg, which negates two axes",
        )
    };
    let frame = clouds.frame();
    let mount = frame.as_ref().and_then(|frame| mount(world, frame));
    let fault = if clouds.laser.is_some() {
        "the scans are upside down or reversed"
    } else {
        "the cloud is mirrored"
    };
    let message = format!(
        "`{}`: {fault}: it turns {:+.2} times as far as {}",
        clouds.topic.topic, turned.gain, beside.name
    );
    let detail = format!(
        "{} z points {}, so {} times is expected. Probable cause: {what}.",
        if clouds.laser.is_some() {
            "By its transform,"
        } else {
            "By the ground in the cloud,"
        },
        if is_up { "up" } else { "down" },
        if is_up { "+1" } else { "-1" }
    );
    let finding = Finding::error(subject, message, clouds.place())
        .likely()
        .relation(relation)
        .detail(detail)
        .related(beside.place.clone(), "compared with this")
        .help(help);
    // The mounting of a gyro that is tied to no base is unknown.
    let is_loose = !beside.is_tied && mount.is_none() && beside.frame != frame;
    let finding = if relation == "mirrored" && sweeps_the_other_way(clouds, &world.limits::<sweep::Limits>()) {
        finding.detail("The points sweep in the direction of a mirrored cloud, too.")
    } else if is_loose || beside.is_of_poses {
        finding.hint()
    } else {
        finding
    };
    out.fail(finding.measured(measured));
}

/// Rotation of the scans over that of a gyro, by pairs of rotations.
fn turned(steps: &Steps, pairs: &[(f64, f64)], limits: &Limits) -> Result<TurnGain, String> {
    if pairs.len() < limits.min_pairs {
        return Err(format!(
            "only {} pairs of scans could be matched and compared with the gyro or the poses ({} steps between neighbours), {} are needed",
            pairs.len(),
            steps.count(),
            limits.min_pairs
        ));
    }
    let turn_deg = (pairs.iter().map(|(x, _)| x * x).sum::<f64>() / pairs.len() as f64)
        .sqrt()
        .to_degrees();
    if turn_deg < limits.min_turn_deg {
        return Err(format!(
            "it rotates by only {turn_deg:.2} deg (rms) in {} s, {} deg are needed",
            limits.pair_s, limits.min_turn_deg
        ));
    }
    let line = fit_huber(pairs, LineForm::Origin, pairs.len() as f64);
    let fitted = line.and_then(|line| Some((line.slope, line.t?.abs())));
    let Some((gain, t)) =
        fitted.filter(|(gain, t)| (limits.min_gain..=limits.max_gain).contains(&gain.abs()) && *t >= limits.min_t)
    else {
        let (gain, t) = fitted.unwrap_or_default();
        return Err(format!(
            "the scans rotate {gain:+.2} times as the gyro or the poses do (t {t:.1}), which is neither with nor against them"
        ));
    };
    Ok(TurnGain {
        gain,
        t,
        pairs: pairs.len(),
        turn_deg,
    })
}
