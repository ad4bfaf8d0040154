//! The axes of the base along which changes of speed and curves are measured.

use std::sync::Arc;

use nalgebra::Vector2;
use serde::Deserialize;

use crate::analysis::axes::causes::{Hand, Push};
use crate::analysis::axes::rates::{Integrals, PlanarGain, Rates};
use crate::analysis::look::{Estimate, needed};
use crate::analysis::motion::{Imu, Track};
use crate::math::circular::wrapped;
use crate::source::Place;
use crate::verdict::NotEvaluated;

/// A direction this near to an axis is along it, radians: half as much is along the other axis.
const ALONG_RAD: f64 = 0.4636;

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Limits {
    pub(crate) min_speed_m_s: f64,
    pub(crate) min_acceleration: f64,
    pub(crate) min_effective: f64,
    pub(crate) min_t: f64,
    pub(crate) least_slope: f64,
    pub(crate) most_slope: f64,
    pub(crate) max_yaw_deg: f64,
    pub(crate) sigmas: f64,
    pub(crate) gravity: f64,
}

/// The acceleration in the plane of the base compared with that of a track.
pub(crate) struct AccelFit {
    /// The direction of the acceleration when speeding up.
    pub(crate) class: Push,
    /// Whether the acceleration in a curve to the left is to the left of that.
    pub(crate) hand: Option<Hand>,
    /// Yaw of the sensor that its mounting lacks, degrees, and its standard error.
    pub(crate) yaw_deg: f64,
    pub(crate) error_deg: f64,
    /// Acceleration along x and y over the change of speed, and over speed times turn rate; `None` where too little changes.
    pub(crate) speeding: Option<PlanarGain>,
    pub(crate) curving: Option<PlanarGain>,
    pub(crate) track: String,
    pub(crate) track_at: Place,
    pub(crate) is_geodetic: bool,
}

impl AccelFit {
    /// Whether the direction is beyond the limit, and surely so.
    pub(crate) fn is_turned(&self, limits: &Limits) -> bool {
        self.yaw_deg.abs() > limits.max_yaw_deg.max(limits.sigmas * self.error_deg)
    }
}

/// The directions of the acceleration, by the first track with enough of it.
pub(crate) fn look(imu: &Imu, integrals: &Integrals, tracks: &[Arc<Track>], limits: &Limits) -> Estimate<AccelFit> {
    needed(tracks)?;
    let force = imu.inertial.force.unwrap_or(0.0);
    // AXES02 judges the unit.
    let unit = if (0.9..1.1).contains(&force) {
        limits.gravity
    } else {
        1.0
    };
    let mut best: Option<[PlanarGain; 2]> = None;
    for track in tracks {
        let rates = Rates::of(integrals, &track.courses(limits.min_speed_m_s));
        let gains = [rates.speeding, rates.curving].map(|gain| gain.times(unit));
        if let Some(found) = fitted(track, gains, limits) {
            return Ok(found);
        }
        let excited = |gains: &[PlanarGain; 2]| gains.iter().map(|gain| gain.excitation).sum::<f64>();
        if best.is_none_or(|best| excited(&gains) > excited(&best)) {
            best = Some(gains);
        }
    }
    let [speeding, curving] = best.unwrap_or_default();
    let said = |gain: &PlanarGain| {
        format!(
            "{:.2} m/s2 (rms), measured along x with gain {:+.2} +- {:.2} and along y with {:+.2} +- {:.2}",
            gain.excitation, gain.gain.x, gain.error.x, gain.gain.y, gain.error.y
        )
    };
    let why = format!(
        "the speed changes by {}, and curves by {}; {} m/s2 and a gain of {} standard errors are needed",
        said(&speeding),
        said(&curving),
        limits.min_acceleration,
        limits.min_t
    );
    Err((NotEvaluated::TooLittleEvidence, why))
}

/// A direction of the acceleration in the base: its angle from where it should be, and its standard error, radians.
#[derive(Clone, Copy)]
struct Direction {
    off_rad: f64,
    error_rad: f64,
}

impl Direction {
    /// The direction of a gain; `ahead` is where it should be.
    fn of(fit: &PlanarGain, ahead: Vector2<f64>, limits: &Limits) -> Option<Self> {
        let (size, error) = (fit.gain.norm(), fit.error.max());
        let is_excited = fit.excitation >= limits.min_acceleration && fit.effective >= limits.min_effective;
        let is_clear = size >= limits.min_t * error && (limits.least_slope..=limits.most_slope).contains(&size);
        (is_excited && is_clear).then(|| Self {
            off_rad: ahead.perp(&fit.gain).atan2(ahead.dot(&fit.gain)),
            error_rad: error / size,
        })
    }
}

fn fitted(track: &Track, [speeding, curving]: [PlanarGain; 2], limits: &Limits) -> Option<AccelFit> {
    let by_speed = Direction::of(&speeding, Vector2::x(), limits);
    let by_curves = Direction::of(&curving, Vector2::y(), limits);
    let near = |rad: f64, deg: f64| wrapped(rad - deg.to_radians()).abs() <= ALONG_RAD;
    let hand = by_speed.zip(by_curves).and_then(|(speed, curves)| {
        let apart = curves.off_rad - speed.off_rad;
        let is_right = near(apart, 0.0).then_some(Hand::Right);
        is_right.or_else(|| near(apart, 180.0).then_some(Hand::Left))
    });
    let direction = match (by_speed, by_curves, hand) {
        (Some(speed), Some(curves), Some(Hand::Right)) => mean(speed, curves),
        (Some(one), _, _) | (None, Some(one), _) => one,
        (None, None, _) => return None,
    };
    let off_deg = direction.off_rad.to_degrees();
    let is_along = |deg: f64| near(direction.off_rad, deg);
    let mut found = AccelFit {
        class: Push::Forward,
        hand,
        // The sensor is turned against what it measures.
        yaw_deg: -off_deg,
        error_deg: direction.error_rad.to_degrees(),
        speeding: by_speed.map(|_| speeding),
        curving: by_curves.map(|_| curving),
        track: track.subject.clone(),
        track_at: track.place.clone(),
        is_geodetic: track.is_geodetic,
    };
    if found.is_turned(limits) {
        found.class = if is_along(180.0) {
            Push::Backward
        } else if is_along(90.0) || is_along(-90.0) {
            Push::Sideways
        } else {
            Push::Oblique
        };
    }
    Some(found)
}

/// The mean of two directions, weighted by their errors.
fn mean(a: Direction, b: Direction) -> Direction {
    let [of_a, of_b] = [a, b].map(|one| one.error_rad.powi(-2));
    Direction {
        off_rad: wrapped(a.off_rad + wrapped(b.off_rad - a.off_rad) * of_b / (of_a + of_b)),
        error_rad: (of_a + of_b).powf(-0.5),
    }
}
