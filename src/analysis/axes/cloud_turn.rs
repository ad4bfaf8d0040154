//! How far scans turn compared with a gyro or poses: the opposite sign shows a mirrored cloud.
//!
//! Must not judge.

use serde::Deserialize;

use crate::analysis::axes::sensors::{Sensor, Sensors};
use crate::analysis::motion::{Imu, Motion, mount::mount};
use crate::analysis::scan_motion::{ScanMotion, Steps, moved::ScanStep};
use crate::analysis::{Estimates, axes::rates::Integrals, hand_eye::HandEye, lidar::Clouds};
use crate::math::regress::{LineForm, fit_huber};
use crate::source::Place;
use crate::verdict::NotEvaluated;
use crate::world::FrameId;

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Limits {
    pub(crate) pair_s: f64,
    pub(crate) max_sigma_deg: f64,
    pub(crate) min_pairs: usize,
    pub(crate) min_turn_deg: f64,
    pub(crate) min_gain: f64,
    pub(crate) max_gain: f64,
    pub(crate) min_t: f64,
}

/// How far the scans of a lidar turn compared with a reference.
pub(crate) struct CloudTurn {
    pub(crate) beside: ReferenceTurn,
    pub(crate) turned: TurnGain,
    /// Whether z of the cloud points up; `None` where that is unknown.
    pub(crate) is_up: Option<bool>,
}

impl CloudTurn {
    /// Of a lidar, or why there is none.
    pub(crate) fn of(world: &Estimates, clouds: &Clouds, limits: &Limits) -> Result<Self, (NotEvaluated, String)> {
        let (motion, sensors, scans) = (Motion::of(world), Sensors::of(world), ScanMotion::of(world));
        let missing = |why: String| (NotEvaluated::MissingInput, why);
        let steps = scans.steps(clouds).ok_or_else(|| missing(NO_GYRO.to_owned()))?;
        let imus = motion.bags.get(clouds.index).map_or(&[][..], |bag| &bag.imus);
        let beside = match gyro(imus.iter().zip(sensors.of_bag(clouds.index))) {
            Ok(imu) => ReferenceTurn::gyro(steps, imu, limits),
            Err(why) => ReferenceTurn::poses(world, clouds, limits).ok_or_else(|| missing(why))?,
        };
        if let (Some(_), None) = (clouds.laser, steps.is_up) {
            return Err(missing(steps.why.to_owned()));
        }
        let turned = turned(steps, &beside.pairs, limits).map_err(|why| (NotEvaluated::TooLittleEvidence, why))?;
        Ok(Self {
            beside,
            turned,
            is_up: steps.is_up,
        })
    }

    /// Whether its axes are right-handed: with z up it turns as the reference does, with z down against it.
    pub(crate) fn is_right_handed(&self) -> Option<bool> {
        Some(self.is_up? == (self.turned.gain > 0.0))
    }

    /// Whether the reference may be wrong itself: the mounting of a gyro that is tied to no base is unknown.
    pub(crate) fn is_loose(&self, world: &Estimates, clouds: &Clouds) -> bool {
        let frame = clouds.frame();
        let is_tied = self.beside.is_tied || self.beside.frame == frame;
        let is_loose = !is_tied && frame.is_none_or(|frame| mount(world, &frame).is_none());
        is_loose || self.beside.is_of_poses
    }
}

/// The rotation that scans are compared with.
pub(crate) struct ReferenceTurn {
    /// `the gyro of `/imu``.
    pub(crate) name: String,
    pub(crate) place: Place,
    /// The frame that rotates, and whether it is tied to a base.
    frame: Option<FrameId>,
    is_tied: bool,
    is_of_poses: bool,
    /// Its rotation and that of the scans over the same times, radians.
    pairs: Vec<(f64, f64)>,
}

/// Rotation of the scans over that of a gyro.
pub(crate) struct TurnGain {
    pub(crate) gain: f64,
    pub(crate) t: f64,
    pub(crate) pairs: usize,
    pub(crate) turn_deg: f64,
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
