//! AXES05: the gyro's yaw rate against the turning of the track.

use serde::Deserialize;

use crate::rules::motion::{Imu, Motion, Track};
use crate::rules::{Evidence, Judge, Need, Rule};
use crate::verdict::{Finding, Measured, NotEvaluated};
use crate::world::World;

use super::causes::{Diagnosis, Sense};
use super::rates::{Rates, Slope};
use super::sensors::{Look, Sensors, needed};

/// AXES05.
pub struct GyroVsTurnSign;

/// Limits of AXES05.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Limits {
    speed_m_s: f64,
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
    out.fail(measured.into_iter().fold(finding, Finding::measured));
}

/// How the gyro turns against the first track that tells.
pub(super) fn look(imu: &Imu, tracks: &[Track], limits: &Limits) -> Look<Turned> {
    needed(tracks)?;
    let mut best: Option<Slope> = None;
    for track in tracks {
        let slope = Rates::of(imu, &track.courses(limits.speed_m_s)).turning;
        let tells = slope.excitation >= limits.min_rate
            && slope.seconds() >= limits.min_s
            && slope.t().abs() >= limits.min_t
            && slope.correlation.abs() >= limits.min_correlation;
        if tells {
            let class = if slope.gain > 0.0 { Sense::With } else { Sense::Against };
            return Ok(Turned {
                class,
                slope,
                track: track.subject.clone(),
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
