//! A yaw compared with an angle that is known clockwise from north: in which direction it grows, and where its zero is.
//!
//! Must not report.

use std::f64::consts::FRAC_PI_2;

use serde::Deserialize;

use crate::analysis::axes::heading::{Heading, Sense};
use crate::analysis::motion::{Compass, Track, Yaws};
use crate::math::circular::{CircularMean, Span, circular_mean, wrapped};
use crate::source::Place;

/// What a yaw was found to be.
#[derive(Debug)]
pub(crate) struct YawZero {
    /// Whether it grows clockwise, seen from above.
    pub(crate) is_clockwise: bool,
    /// The yaw minus the compass heading, or minus the yaw by REP-103, depending on the direction; `None` where the zero of the other
    /// angle is not known.
    pub(crate) zero_rad: Option<f64>,
    /// Resultant of that difference, and of the difference by the other sense.
    pub(crate) resultants: [f64; 2],
    /// How many angles were compared.
    pub(crate) samples: usize,
    /// What it was compared with.
    pub(crate) other: String,
    /// The place of that.
    pub(crate) other_at: Place,
}

/// Compares a yaw with stated headings. A turn shows the direction. Without one, where none is required, a yaw is a compass heading if it
/// has the same value, and the yaw by REP-103 would be far from it.
pub(crate) fn by_compass(
    yaws: &Yaws,
    compass: &Compass,
    needs_turn: bool,
    turns: &crate::analysis::axes::heading::Limits,
    limits: &Limits,
) -> Option<YawZero> {
    let angles = compass.angles.iter();
    let pairs: Vec<(f64, f64)> = angles
        .filter_map(|(t_s, heading)| Some((yaws.at(*t_s)?, *heading)))
        .collect();
    let mean = |difference: fn(f64, f64) -> f64| {
        circular_mean(pairs.iter().map(|(yaw, heading)| (difference(*yaw, *heading), 1.0)))
    };
    let same = mean(|yaw, heading| wrapped(yaw - heading))?;
    let enu = mean(|yaw, heading| wrapped(yaw + heading - FRAC_PI_2))?;
    if pairs.len() < limits.min_samples {
        return None;
    }
    let found = |is_clockwise: bool, [best, other]: [&CircularMean; 2]| YawZero {
        is_clockwise,
        zero_rad: Some(best.mean_rad),
        resultants: [best.resultant, other.resultant],
        samples: pairs.len(),
        other: compass.subject.clone(),
        other_at: compass.place.clone(),
    };
    let mut span = Span::default();
    for (_, heading) in &pairs {
        span.add(*heading);
    }
    let has_turned = span.rad() >= turns.min_turn_deg.to_radians();
    let is = |[best, other]: [&CircularMean; 2]| {
        let is_clear = if has_turned {
            1.0 - other.resultant >= turns.variance_ratio * (1.0 - best.resultant)
        } else {
            !needs_turn
                && best.mean_rad.abs() <= limits.same_deg.to_radians()
                && other.mean_rad.abs() >= limits.apart_deg.to_radians()
        };
        best.resultant >= turns.min_resultant && is_clear
    };
    let (compass, rep) = ([&same, &enu], [&enu, &same]);
    match (is(compass), is(rep)) {
        (true, false) => Some(found(true, compass)),
        (false, true) => Some(found(false, rep)),
        _ => None,
    }
}

/// Compares a yaw with the courses of a track, as AXES04 does. `knows_north`: whether a course of zero is east.
pub(crate) fn by_track(
    yaws: &Yaws,
    track: &Track,
    knows_north: bool,
    turns: &crate::analysis::axes::heading::Limits,
) -> Option<YawZero> {
    let heading = Heading::of(yaws, &track.courses(turns.min_speed_m_s), turns);
    if heading.agreement().is_none_or(|share| share < turns.min_agreement) {
        return None;
    }
    let is_clockwise = heading.winner() == Sense::Right;
    // Clockwise, the offset is `yaw + course`, and `heading = pi/2 - course`.
    let from_zero = if is_clockwise { FRAC_PI_2 } else { 0.0 };
    let is_steady = heading.offset_resultant >= turns.min_resultant;
    let [left, right] = heading.resultants;
    Some(YawZero {
        is_clockwise,
        zero_rad: (knows_north && is_steady).then(|| wrapped(heading.offset_rad - from_zero)),
        resultants: if is_clockwise { [right, left] } else { [left, right] },
        samples: heading.samples,
        other: format!("the course of {}", track.subject),
        other_at: track.place.clone(),
    })
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Limits {
    pub(crate) min_samples: usize,
    pub(crate) same_deg: f64,
    pub(crate) apart_deg: f64,
    pub(crate) max_offset_deg: f64,
    pub(crate) max_tilt_deg: f64,
}
