//! AXES05: the gyro's yaw rate against the turning of the track.

use std::sync::Arc;

use serde::Deserialize;

use crate::rules::motion::{Imu, Motion, Track};
use crate::rules::{Evidence, Judge, Need, Rule};
use crate::source::Place;
use crate::verdict::{Finding, Measured, NotEvaluated};
use crate::world::World;

use super::causes::Sense;
use super::diagnosis::Diagnosis;
use super::rates::{Integrals, Rates, Slope};
use super::sensors::{Look, Sensor, Sensors, TRACK, needed};

/// AXES05.
pub struct GyroVsTurnSign;

/// Limits of AXES05.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Limits {
    speed_m_s: f64,
    odometry_speed_m_s: f64,
    min_rate: f64,
    min_s: f64,
    min_t: f64,
    min_correlation: f64,
}

/// What was seen.
pub(super) struct Turned {
    pub(super) class: Sense,
    slope: Slope,
    pub(super) track: String,
    track_at: Place,
    is_geodetic: bool,
}

impl Turned {
    /// Whether an upright gyro turns against poses that a simulator may have given the other hand.
    pub(super) fn is_by_a_simulator(&self, sensor: &Sensor) -> bool {
        self.class == Sense::Against && sensor.may_doubt(self.is_geodetic)
    }
}

impl Limits {
    /// Whether a slope is one.
    fn tells(&self, slope: &Slope) -> bool {
        slope.excitation >= self.min_rate
            && slope.seconds() >= self.min_s
            && slope.t().abs() >= self.min_t
            && slope.correlation.abs() >= self.min_correlation
    }
}

/// Yaw rate over the turning of one track; `None` where the two do not tell.
pub(crate) fn gain(imu: &Imu, track: &Track, limits: &Limits) -> Option<f64> {
    let integrals = Integrals::of(imu);
    // As the rule itself looks: poses tell a course at less speed than satellites do.
    let slow = (!track.is_geodetic).then_some(limits.odometry_speed_m_s);
    let slopes = [Some(limits.speed_m_s), slow].into_iter().flatten();
    let mut slopes = slopes.map(|speed_m_s| Rates::of(&integrals, &track.courses(speed_m_s)).turning);
    Some(slopes.find(|slope| limits.tells(slope))?.gain)
}

impl Rule for GyroVsTurnSign {
    const PAGE: &'static str = include_str!("../../../rules/axes/gyro-vs-turn-sign.md");
    const NEEDS: &'static [Need] = &[Need::Bag];
    const EVIDENCE: Evidence = Evidence::MOTION;
    type Limits = Limits;

    fn judge(world: &World, limits: &Limits, out: &mut Judge) {
        let (motion, sensors) = (Motion::of(world), Sensors::of(world));
        for (imu, sensor) in sensors.each(&motion) {
            let subject = format!("yaw rate of {}", imu.stream.subject);
            match &sensor.sense {
                Ok(turned) if turned.is_by_a_simulator(sensor) => {
                    let why = "it turns against the poses of a simulator, which SENSOR09 judges";
                    out.not_evaluated(subject, NotEvaluated::NotApplicable, why);
                }
                Ok(turned) => judge_turned(imu, subject, turned, &sensor.diagnosis, limits, out),
                Err((why, reason)) => out.not_evaluated(subject, *why, reason),
            }
        }
    }
}

fn judge_turned(imu: &Imu, subject: String, turned: &Turned, diagnosis: &Diagnosis, limits: &Limits, out: &mut Judge) {
    let Slope {
        gain: slope,
        correlation,
        pairs,
        ..
    } = turned.slope;
    let measured = [
        Measured::new("yaw rate over the turning of the course", slope, "1").samples(pairs as u64),
        Measured::new("correlation", correlation, "1").limit(limits.min_correlation),
        Measured::new("t", turned.slope.t().abs(), "1").limit(limits.min_t),
    ];
    if turned.class == Sense::With {
        return out.pass(subject, measured);
    }
    let seen = "the yaw rate turns against the course";
    if let Some(why) = diagnosis.reported_elsewhere("AXES05", seen) {
        return out.not_evaluated(subject, NotEvaluated::NotApplicable, why);
    }
    let message = format!(
        "the gyro of `{}` turns against the course of {}: {slope:+.2} times, correlation {correlation:+.2} over {:.0} s; {}{}",
        imu.stream.topic,
        turned.track,
        turned.slope.seconds(),
        imu.mounting(),
        diagnosis.words()
    );
    let otherwise = "counter-clockwise turns are positive about z up (REP-103): negate y and z of a gyro in FRD axes, or tell TF how the \
         sensor is mounted";
    let finding = diagnosis.explain(Finding::error(subject, message, imu.stream.place()).likely(), otherwise);
    let finding = finding.related(turned.track_at.clone(), TRACK);
    out.fail(measured.into_iter().fold(finding, Finding::measured));
}

/// How the gyro turns against the first track that tells.
pub(super) fn look(integrals: &Integrals, tracks: &[Arc<Track>], limits: &Limits) -> Look<Turned> {
    needed(tracks)?;
    let mut best: Option<Slope> = None;
    let slow = tracks.iter().filter(|track| !track.is_geodetic);
    let tried = tracks.iter().map(|track| (track, limits.speed_m_s));
    for (track, speed_m_s) in tried.chain(slow.map(|track| (track, limits.odometry_speed_m_s))) {
        let slope = Rates::of(integrals, &track.courses(speed_m_s)).turning;
        if limits.tells(&slope) {
            let class = if slope.gain > 0.0 { Sense::With } else { Sense::Against };
            return Ok(Turned {
                class,
                slope,
                track: track.subject.clone(),
                is_geodetic: track.is_geodetic,
                track_at: track.place.clone(),
            });
        }
        if best.is_none_or(|best| slope.t().abs() > best.t().abs()) {
            best = Some(slope);
        }
    }
    let best = best.unwrap_or_default();
    let why = format!(
        "the course turns by {:.3} rad/s (rms) in {:.0} s of motion, with a correlation of {:+.2}; {} rad/s, {} s and {} are \
         needed",
        best.excitation,
        best.seconds(),
        best.correlation,
        limits.min_rate,
        limits.min_s,
        limits.min_correlation
    );
    Err((NotEvaluated::TooLittleEvidence, why))
}
