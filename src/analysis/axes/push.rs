//! The axis of the base along which changes of speed are measured.

use std::sync::Arc;

use serde::Deserialize;

use crate::analysis::axes::causes::Push;
use crate::analysis::axes::rates::{Integrals, Rates, Slope};
use crate::analysis::look::{Estimate, needed};
use crate::analysis::motion::{Imu, Track};
use crate::source::Place;
use crate::verdict::NotEvaluated;

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Limits {
    pub(crate) min_speed_m_s: f64,
    pub(crate) min_acceleration: f64,
    pub(crate) min_effective: f64,
    pub(crate) min_t: f64,
    pub(crate) least_slope: f64,
    pub(crate) most_slope: f64,
    pub(crate) gravity: f64,
}

/// The acceleration compared with the change of speed.
pub(crate) struct AccelFit {
    pub(crate) class: Push,
    pub(crate) forward: Slope,
    pub(crate) sideways: Slope,
    pub(crate) track: String,
    pub(crate) track_at: Place,
}

/// The axis of the changes of speed, by the first track with enough of them.
pub(crate) fn look(imu: &Imu, integrals: &Integrals, tracks: &[Arc<Track>], limits: &Limits) -> Estimate<AccelFit> {
    needed(tracks)?;
    let force = imu.inertial.force.unwrap_or(0.0);
    // AXES02 judges the unit.
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
        let is_clear = |slope: &Slope| slope.t().abs() >= limits.min_t && is_slope(slope.gain);
        let along_x = is_clear(&forward) && forward.gain.abs() >= 2.0 * sideways.gain.abs();
        let along_y = is_clear(&sideways) && sideways.gain.abs() >= 2.0 * forward.gain.abs();
        if excited && (along_x || along_y) {
            let class = match (along_y, forward.gain > 0.0) {
                (true, _) => Push::Sideways,
                (false, true) => Push::Forward,
                (false, false) => Push::Backward,
            };
            return Ok(AccelFit {
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
        "the speed changes by only {:.2} m/s2 (rms), measured with gain {:+.2} along x (t {:.1}) and {:+.2} along y (t {:.1}); {} m/s2 \
         and t {} are needed",
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
