//! Whether the gyro has the same sign as the turns of the track.

use std::sync::Arc;

use serde::Deserialize;

use crate::analysis::axes::causes::Sense;
use crate::analysis::axes::rates::{Integrals, Rates, Slope};
use crate::analysis::look::{Estimate, needed};
use crate::analysis::motion::{Imu, Track};
use crate::source::Place;
use crate::verdict::NotEvaluated;

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Limits {
    pub(crate) speed_m_s: f64,
    pub(crate) odometry_speed_m_s: f64,
    pub(crate) min_rate: f64,
    pub(crate) min_s: f64,
    pub(crate) min_t: f64,
    pub(crate) min_correlation: f64,
}

/// The yaw rate compared with the rotation of a track.
pub(crate) struct GyroFit {
    pub(crate) class: Sense,
    pub(crate) slope: Slope,
    pub(crate) track: String,
    pub(crate) track_at: Place,
    pub(crate) is_geodetic: bool,
}

impl GyroFit {
    /// Whether the magnitudes of both turn rates match, so that the gyro is in rad/s.
    pub(crate) fn confirms_gyro(&self) -> bool {
        (0.5..=2.0).contains(&self.slope.gain.abs())
    }
}

impl Limits {
    /// Whether a slope is significant.
    pub(crate) fn is_significant(&self, slope: &Slope) -> bool {
        self.turns(slope) && slope.t().abs() >= self.min_t && slope.correlation.abs() >= self.min_correlation
    }

    /// Whether the course turns enough.
    fn turns(&self, slope: &Slope) -> bool {
        slope.excitation >= self.min_rate && slope.seconds() >= self.min_s
    }
}

/// Yaw rate over the turn rate of one track; `None` if there is too little evidence.
pub(crate) fn gain(imu: &Imu, track: &Track, limits: &Limits) -> Option<f64> {
    let integrals = Integrals::of(imu);
    // As in the rule: poses give a course at lower speeds than GNSS.
    let slow = (!track.is_geodetic).then_some(limits.odometry_speed_m_s);
    let slopes = [Some(limits.speed_m_s), slow].into_iter().flatten();
    let mut slopes = slopes.map(|speed_m_s| Rates::of(&integrals, &track.courses(speed_m_s)).turning);
    Some(slopes.find(|slope| limits.is_significant(slope))?.gain)
}

/// Whether the course of a track turns, but unlike the gyro: the vehicle does not move where it faces.
pub(crate) fn is_uncoupled(integrals: &Integrals, track: &Track, limits: &Limits) -> bool {
    let slope = Rates::of(integrals, &track.courses(limits.speed_m_s)).turning;
    limits.turns(&slope) && slope.correlation.abs() < limits.min_correlation
}

/// Sign of the gyro, by the first track with enough turns.
pub(crate) fn look(integrals: &Integrals, tracks: &[Arc<Track>], limits: &Limits) -> Estimate<GyroFit> {
    needed(tracks)?;
    let mut best: Option<Slope> = None;
    let slow = tracks.iter().filter(|track| !track.is_geodetic);
    let tried = tracks.iter().map(|track| (track, limits.speed_m_s));
    for (track, speed_m_s) in tried.chain(slow.map(|track| (track, limits.odometry_speed_m_s))) {
        let slope = Rates::of(integrals, &track.courses(speed_m_s)).turning;
        if limits.is_significant(&slope) {
            let class = if slope.gain > 0.0 { Sense::With } else { Sense::Against };
            return Ok(GyroFit {
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
        "the course turns by only {:.3} rad/s (rms) in {:.0} s of motion (correlation {:+.2}); {} rad/s, {} s and {} are needed",
        best.excitation,
        best.seconds(),
        best.correlation,
        limits.min_rate,
        limits.min_s,
        limits.min_correlation
    );
    Err((NotEvaluated::TooLittleEvidence, why))
}
