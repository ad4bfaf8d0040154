//! What is wrong with an origin by itself: it moves, it was a first fix without corrections, or nothing states it.
//!
//! Owns these parts of GEO07.

use crate::analysis::Estimates;
use crate::analysis::motion::{Motion, Stream};
use crate::math::geodesy::Geodetic;
use crate::verdict::Judge;
use crate::verdict::{Finding, Measured, Severity};
use crate::world::motion::FixRow;
use crate::world::{LocalOrigin, OriginSource};

use crate::analysis::geo::apart::{direction, position_text};
use crate::analysis::geo::origins::Limits;
use crate::analysis::geo::origins::states_origin;
use crate::analysis::geo::overlay::geodetic;

/// `NavSatStatus.status` with corrections from a ground station.
const CORRECTED: i8 = 2;

/// Judges each origin alone.
pub(crate) fn judge(world: &Estimates, all: &[LocalOrigin], limits: &Limits, out: &mut Judge) {
    let motion = Motion::of(world);
    for origin in all {
        if let Some(later) = &origin.later {
            judge_later(origin, later, limits, out);
        }
        let is_stated = matches!(origin.by, OriginSource::Transform | OriginSource::Topic);
        let Some(id) = origin.bag.filter(|_| is_stated) else {
            continue;
        };
        let mut bags = world.bags.iter().zip(&motion.bags);
        let Some((_, bag)) = bags.find(|(bag, _)| bag.source == id) else {
            continue;
        };
        let receivers = bag.fixes.iter().filter(|fixes| !states_origin(&fixes.topic));
        for fixes in receivers.filter(|fixes| !fixes.guessed) {
            judge_first_fix(origin, fixes, limits, out);
        }
    }
}

/// Whether an origin stays where it is.
fn judge_later(origin: &LocalOrigin, later: &Geodetic, limits: &Limits, out: &mut Judge) {
    let subject = format!("first and last origin by {}", origin.who);
    let apart = origin.at.enu_of(later);
    let distance_m = apart.norm();
    let measured = Measured::new("largest distance from the first origin", distance_m, "m").limit(limits.warning_m);
    if distance_m <= limits.warning_m {
        return out.pass(subject, [measured]);
    }
    let severity = if distance_m > limits.error_m {
        Severity::Error
    } else {
        Severity::Warning
    };
    let message = format!(
        "{}: the origin moves by {distance_m:.2} m during the recording",
        origin.who
    );
    let detail = format!(
        "The first origin is {}.{}",
        position_text(origin),
        direction(&apart, "the farthest later origin")
    );
    out.fail(
        Finding::new(severity, subject, message, origin.place.clone())
            .likely()
            .relation("origin-changed")
            .detail(detail)
            .help("set the origin once, and start a new map with a new origin: what was mapped before the change is shifted")
            .measured(measured),
    );
}

/// Whether an origin is a first fix, and of what quality.
fn judge_first_fix(origin: &LocalOrigin, fixes: &Stream<FixRow>, limits: &Limits, out: &mut Judge) {
    let subject = format!("first fix of {} as the origin by {}", fixes.subject, origin.who);
    let valid = || fixes.rows().filter(|timed| timed.row.status >= 0);
    let first = valid().find_map(|timed| Some((timed, geodetic(&timed.row)?)));
    let Some((first, place)) = first else {
        return out.missing(subject, "no message has a fix (status >= 0)");
    };
    let distance_m = origin.at.enu_of(&place).xy().norm();
    let what = "horizontal distance of the origin from the first fix (smaller: copied)";
    let distance = Measured::new(what, distance_m, "m");
    let is_copied = distance_m <= limits.copied_m;
    if is_copied && first.row.status >= CORRECTED {
        return out.pass(subject, [distance]);
    }
    let measured = distance.at_least(limits.copied_m);
    if !is_copied {
        return out.pass(subject, [measured]);
    }
    let sd_m = first.row.horizontal_sd_m();
    let stated = sd_m.map(|sd_m| {
        Measured::new(
            "horizontal standard deviation of the first fix, by its covariance",
            sd_m,
            "m",
        )
    });
    let better = valid().find(|timed| timed.row.status >= CORRECTED);
    let message = format!(
        "{}: origin is the first fix of {}, without corrections (status {})",
        origin.who, fixes.subject, first.row.status
    );
    let (severity, detail) = match better {
        Some(better) => (
            Severity::Warning,
            format!(
                "The receiver has corrections {:.0} s later (status {}): the map keeps the error of the first fix.",
                better.t_s - first.t_s,
                better.row.status
            ),
        ),
        None => (
            Severity::Note,
            "The next drive will have another origin, metres away.".to_owned(),
        ),
    };
    out.fail(
        Finding::new(severity, subject, message, origin.place.clone())
            .likely()
            .relation("first-fix")
            .detail(detail)
            .related(fixes.place(), "the fixes")
            .help("set the origin from a surveyed point or a fix with corrections, and save the origin with the map")
            .measured(measured)
            .measured(stated),
    );
}

/// A finding, where poses in `map` are expressed in east and north, and nothing states the origin.
pub(crate) fn missing(track: &LocalOrigin, limits: &Limits) -> Option<Finding> {
    let (turned_rad, within_rad) = track.turned_rad?;
    let turned_deg = turned_rad.to_degrees();
    if turned_deg.abs() > limits.aligned_deg || limits.sigmas * within_rad.to_degrees() > limits.aligned_deg {
        return None;
    }
    let message = "the axes of the map are east and north, but nothing states the latitude and longitude of its origin";
    let detail = format!(
        "By {}, the origin of the map is at {}, within {:.1} m.",
        track.who,
        position_text(track),
        track.within_m
    );
    let finding = Finding::note("origin", message, track.place.clone()).likely();
    let finding = finding
        .relation("missing")
        .detail(detail)
        .help("record the transform from `earth` to the map, or a topic with the origin (such as `/gps/origin`), or keep the file that states the origin with the recording");
    Some(finding.measured(
        Measured::new("rotation of the x axis of the map from east", turned_deg, "deg").limit(limits.aligned_deg),
    ))
}
