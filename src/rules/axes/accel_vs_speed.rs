//! AXES06: the acceleration along the base's axes against the change of speed.

use std::sync::Arc;

use serde::Deserialize;

use crate::rules::motion::{Imu, Motion, Track};
use crate::rules::{Evidence, Judge, Need, Rule};
use crate::source::Place;
use crate::verdict::{Finding, Measured, NotEvaluated};
use crate::world::World;

use super::causes::Push;
use super::diagnosis::Diagnosis;
use super::rates::{Integrals, Rates, Slope};
use super::sensors::{Look, Sensors, TRACK, needed};

/// AXES06.
pub struct AccelVsSpeed;

/// Limits of AXES06.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Limits {
    min_speed_m_s: f64,
    min_acceleration: f64,
    min_effective: f64,
    min_t: f64,
    least_slope: f64,
    most_slope: f64,
    gravity: f64,
}

/// What was seen.
pub(super) struct Pushed {
    pub(super) class: Push,
    forward: Slope,
    sideways: Slope,
    track: String,
    track_at: Place,
}

impl Rule for AccelVsSpeed {
    const PAGE: &'static str = include_str!("../../../rules/axes/accel-vs-speed.md");
    const NEEDS: &'static [Need] = &[Need::Bag];
    const EVIDENCE: Evidence = Evidence::MOTION;
    type Limits = Limits;

    fn judge(world: &World, limits: &Limits, out: &mut Judge) {
        let (motion, sensors) = (Motion::of(world), Sensors::of(world));
        for (imu, sensor) in sensors.each(&motion) {
            let subject = format!("forward acceleration of {}", imu.stream.subject);
            match &sensor.push {
                Ok(pushed) => judge_pushed(imu, subject, pushed, &sensor.diagnosis, limits, out),
                Err((why, reason)) => out.not_evaluated(subject, *why, reason),
            }
        }
    }
}

fn judge_pushed(imu: &Imu, subject: String, pushed: &Pushed, diagnosis: &Diagnosis, limits: &Limits, out: &mut Judge) {
    let pairs = pushed.forward.pairs as u64;
    let measured = [
        Measured::new(
            "acceleration along x over the change of speed",
            pushed.forward.gain,
            "1",
        )
        .samples(pairs),
        Measured::new(
            "acceleration along y over the change of speed",
            pushed.sideways.gain,
            "1",
        )
        .samples(pairs),
        Measured::new("t", pushed.forward.t().abs().max(pushed.sideways.t().abs()), "1").limit(limits.min_t),
    ];
    if pushed.class == Push::Forward {
        return out.pass(subject, measured);
    }
    let seen = "the acceleration is not along x";
    if let Some(why) = diagnosis.reported_elsewhere("AXES06", seen) {
        return out.not_evaluated(subject, NotEvaluated::NotApplicable, why);
    }
    let what = match pushed.class {
        Push::Sideways => "speeding up shows along y, not along x",
        _ => "speeding up shows along -x",
    };
    let message = format!(
        "in the acceleration of `{}` {what} (x {:+.2}, y {:+.2} times the change of speed of {}); {}{}",
        imu.stream.topic,
        pushed.forward.gain,
        pushed.sideways.gain,
        pushed.track,
        imu.mounting(),
        diagnosis.words()
    );
    let otherwise = "x points forward (REP-103): give the sensor's frame its yaw in TF, or negate an accelerometer that gives gravity; a \
         drive in reverse looks the same";
    let finding = diagnosis.explain(
        Finding::warning(subject, message, imu.stream.place()).likely(),
        otherwise,
    );
    let finding = finding.related(pushed.track_at.clone(), TRACK);
    out.fail(measured.into_iter().fold(finding, Finding::measured));
}

/// Along which axis the first track that tells speeds up.
pub(super) fn look(imu: &Imu, integrals: &Integrals, tracks: &[Arc<Track>], limits: &Limits) -> Look<Pushed> {
    needed(tracks)?;
    let force = imu.inertial.force.unwrap_or(0.0);
    // The unit is AXES02's.
    let unit = if (0.9..1.1).contains(&force) {
        limits.gravity
    } else {
        1.0
    };
    let mut best: Option<Rates> = None;
    for track in tracks {
        let mut rates = Rates::of(integrals, &track.courses(limits.min_speed_m_s));
        rates.forward.gain *= unit;
        rates.sideways.gain *= unit;
        let Rates { forward, sideways, .. } = rates;
        let is_slope = |slope: f64| (limits.least_slope..=limits.most_slope).contains(&slope.abs());
        let excited = forward.excitation >= limits.min_acceleration && forward.effective >= limits.min_effective;
        let tells = |slope: &Slope| slope.t().abs() >= limits.min_t && is_slope(slope.gain);
        let along_x = tells(&forward) && forward.gain.abs() >= 2.0 * sideways.gain.abs();
        let along_y = tells(&sideways) && sideways.gain.abs() >= 2.0 * forward.gain.abs();
        if excited && (along_x || along_y) {
            let class = match (along_y, forward.gain > 0.0) {
                (true, _) => Push::Sideways,
                (false, true) => Push::Forward,
                (false, false) => Push::Backward,
            };
            return Ok(Pushed {
                class,
                forward,
                sideways,
                track: track.subject.clone(),
                track_at: track.place.clone(),
            });
        }
        if best.is_none_or(|best| forward.t().abs() > best.forward.t().abs()) {
            best = Some(rates);
        }
    }
    let best = best.unwrap_or_default();
    let why = format!(
        "the speed changes by {:.2} m/s2 (rms), which shows {:+.2} times along x (t {:.1}) and {:+.2} times along y (t {:.1}); {} \
         m/s2 and t {} are needed",
        best.forward.excitation,
        best.forward.gain,
        best.forward.t(),
        best.sideways.gain,
        best.sideways.t(),
        limits.min_acceleration,
        limits.min_t
    );
    Err((NotEvaluated::TooLittleEvidence, why))
}
