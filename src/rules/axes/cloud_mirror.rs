//! AXES11: whether a cloud is a mirror image, by how it turns against a gyro.

use crate::analysis::axes::sensors::{Sensor, Sensors};
use crate::analysis::motion::{Imu, Motion};
use crate::analysis::scan_motion::{ScanMotion, Steps};
use crate::analysis::{axes::rates::Integrals, hand_eye::HandEye, lidar::Clouds, motion::mount::mount, scan_motion::moved::Moved};
use crate::math::regress::{Through, fit_huber};
use crate::rules::prelude::*;
use crate::world::{FrameId, World};

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

/// What turns beside the scans.
struct Beside {
    /// `the gyro of `/imu``.
    name: String,
    place: Place,
    /// The frame whose turning it is, and whether that is tied to a base.
    frame: Option<FrameId>,
    is_tied: bool,
    is_of_poses: bool,
    /// Its turning, and that of the scans, radians, over the same times.
    pairs: Vec<(f64, f64)>,
}

/// The scans' turning over that of a gyro.
struct Turned {
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
                out.not_applicable(subject, "nothing says that these are the points of a lidar as it measured them");
                continue;
            }
            let imus = motion.bags.get(clouds.index).map_or(&[][..], |bag| &bag.imus);
            let known = imus.iter().zip(sensors.of_bag(clouds.index));
            match (scans.steps(&clouds), gyro(known)) {
                (Some(steps), Ok(imu)) => {
                    let beside = Beside::gyro(steps, imu, limits);
                    judge_clouds(world, &clouds, steps, &beside, limits, out);
                }
                (Some(steps), Err(why)) => match Beside::poses(world, &clouds, limits) {
                    Some(beside) => judge_clouds(world, &clouds, steps, &beside, limits, out),
                    None => out.missing(subject, why),
                },
                (None, _) => {
                    let why =
                        "no gyro turns beside it: a mirror image has every distance right, and shows in turns alone";
                    out.missing(subject, why);
                }
            }
        }
    }
}

/// A gyro of which nothing wrong is known: the one that is mounted on a base first.
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
            || "no gyro turns beside it: a mirror image has every distance right, and shows in turns alone".to_owned(),
            |imu| {
                format!(
                    "its gyro would be `{}`, of which another rule reports a fault",
                    imu.stream.topic
                )
            },
        )
    })
}

impl Beside {
    fn gyro(steps: &Steps, imu: &Imu, limits: &Limits) -> Self {
        let integrals = Integrals::of(imu);
        let offset_s = imu.stream.stamp_offset_s;
        let seconds = |moved: &Moved| moved.to.on(offset_s) - moved.from.on(offset_s);
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

    /// For planar scanners, which robots have that have no gyro; the wheels may be mirrored themselves, so that it is a hint.
    fn poses(world: &Estimates, clouds: &Clouds, limits: &Limits) -> Option<Self> {
        clouds.laser?;
        let seconds = |moved: &Moved| moved.to.on(None) - moved.from.on(None);
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

fn judge_clouds(world: &World, clouds: &Clouds, steps: &Steps, beside: &Beside, limits: &Limits, out: &mut Judge) {
    let subject = clouds.subject("handedness");
    if let (Some(_), None) = (clouds.laser, steps.is_up) {
        return out.missing(subject, steps.why);
    }
    let turned = match turned(steps, &beside.pairs, limits) {
        Ok(turned) => turned,
        Err(why) => return out.too_little(subject, why),
    };
    let measured = [
        Measured::new("turning of the scans over that of the gyro", turned.gain, "1").samples(turned.pairs as u64),
        Measured::new("t", turned.t, "1").limit(limits.min_t),
        Measured::new("turning of a pair, root mean square", turned.turn_deg, "deg").limit(limits.min_turn_deg),
    ];
    let Some(is_up) = steps.is_up else {
        let why = format!(
            "it turns {:+.2} times as {} does, and no ground shows whether its z points up: with z down that is right",
            turned.gain, beside.name
        );
        return out.too_little(subject, why);
    };
    // A proper cloud with z up turns with the gyro, one with z down against it.
    if is_up == (turned.gain > 0.0) {
        return out.pass(subject, measured);
    }
    let (relation, what, help) = if clouds.laser.is_some() {
        (
            if is_up { "upside-down" } else { "upright" },
            "it hangs the other way up than its transform says, or its ranges are expressed in the other order, which is the same in one plane",
            "give the transform a roll of 180 deg more if the scanner hangs so; if not, let its driver tell the ranges in the order of \
             growing angles (`inverted`, `flip_x_axis` or the like, once)",
        )
    } else if is_up {
        (
            "mirrored",
            "x or y has the wrong sign, or the two are exchanged",
            "look for x and y where ranges and angles become points: an angle that is counted the other way, or axes of a left-handed world \
             (x, -y, z)",
        )
    } else {
        (
            "z-negated",
            "z has the wrong sign",
            "look for z where ranges and angles become points: a sensor that hangs on its head is turned by 180 deg, which negates two axes",
        )
    };
    let frame = clouds.frame();
    let mount = frame.as_ref().and_then(|frame| mount(world, frame));
    let message = if clouds.laser.is_some() {
        format!(
            "the scans on `{}` turn {:+.2} times as {} does, where by its transform z points {}: {what}",
            clouds.topic.topic,
            turned.gain,
            beside.name,
            if is_up { "up" } else { "down" }
        )
    } else {
        format!(
            "the cloud on `{}` is a mirror image: it turns {:+.2} times as {} does, with the ground {} its z: {what}",
            clouds.topic.topic,
            turned.gain,
            beside.name,
            if is_up { "beneath" } else { "above" }
        )
    };
    let finding = Finding::error(subject, message, clouds.place())
        .likely()
        .relation(relation)
        .related(beside.place.clone(), "what it is held against")
        .help(help);
    // Nothing says how a gyro sits that is tied to no base.
    let is_loose = !beside.is_tied && mount.is_none() && beside.frame != frame;
    let finding = if is_loose || beside.is_of_poses {
        finding.hint()
    } else {
        finding
    };
    out.fail(finding.measured(measured));
}

/// How the scans turn against a gyro, by pairs of their turning.
fn turned(steps: &Steps, pairs: &[(f64, f64)], limits: &Limits) -> Result<Turned, String> {
    if pairs.len() < limits.min_pairs {
        return Err(format!(
            "{} pairs of scans could be matched beside the gyro or the poses ({} steps between neighbours); {} are needed",
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
            "it turned by {turn_deg:.2} deg in {} s, root mean square; {} are needed",
            limits.pair_s, limits.min_turn_deg
        ));
    }
    let line = fit_huber(pairs, Through::Origin, pairs.len() as f64);
    let told = line.and_then(|line| Some((line.slope, line.t?.abs())));
    let Some((gain, t)) =
        told.filter(|(gain, t)| (limits.min_gain..=limits.max_gain).contains(&gain.abs()) && *t >= limits.min_t)
    else {
        let (gain, t) = told.unwrap_or_default();
        return Err(format!(
            "the scans turn {gain:+.2} times as the gyro or the poses do, t {t:.1}: that is neither with them nor against them"
        ));
    };
    Ok(Turned {
        gain,
        t,
        pairs: pairs.len(),
        turn_deg,
    })
}
