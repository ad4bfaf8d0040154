//! AXES04: which way the yaw of an orientation turns, and where its zero is.

use serde::Deserialize;

use crate::rules::motion::{Imu, Motion, Track};
use crate::rules::{Judge, Need, Rule};
use crate::verdict::{Finding, Measured, NotEvaluated};
use crate::world::World;

use super::heading::{Heading, Sense};

/// AXES04.
pub struct HeadingConvention;

/// Limits of AXES04.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Limits {
    min_speed_m_s: f64,
    pub(super) window_s: f64,
    pub(super) window_turn_deg: f64,
    pub(super) min_turn_deg: f64,
    pub(super) min_way_m: f64,
    pub(super) min_resultant: f64,
    pub(super) variance_ratio: f64,
    min_agreement: f64,
    max_offset_deg: f64,
    max_spread_deg: f64,
}

impl Rule for HeadingConvention {
    const PAGE: &'static str = include_str!("../../../rules/axes/heading-convention.md");
    const NEEDS: &'static [Need] = &[Need::Bag];
    type Limits = Limits;

    fn judge(world: &World, limits: &Limits, out: &mut Judge) {
        for bag in &Motion::of(world).bags {
            let tracks = bag.tracks();
            for imu in &bag.imus {
                judge_imu(imu, &tracks, limits, out);
            }
        }
    }
}

fn judge_imu(imu: &Imu, tracks: &[Track], limits: &Limits, out: &mut Judge) {
    let subject = format!("yaw of {}", imu.stream.subject);
    if let Some(why) = imu.no_orientation {
        return out.not_evaluated(&subject, NotEvaluated::NotApplicable, why);
    }
    if tracks.is_empty() {
        let why = "no satellite fixes, odometry or poses show where it went";
        return out.not_evaluated(&subject, NotEvaluated::MissingInput, why);
    }
    let against = |track: &Track| {
        let courses = track.courses(limits.min_speed_m_s);
        Heading::of(&imu.stream, &imu.base_from_imu(), &courses, limits)
    };
    let headings: Vec<(&Track, Heading)> = tracks.iter().map(|track| (track, against(track))).collect();
    // Satellites first: odometry is often made of this very yaw.
    let decided = headings
        .iter()
        .find(|(_, heading)| heading.agreement().is_some_and(|share| share >= limits.min_agreement));
    let Some((track, heading)) = decided else {
        let why = undecided(&headings, limits);
        return out.not_evaluated(&subject, NotEvaluated::TooLittleEvidence, why);
    };
    let [left, right] = heading.resultants;
    let (best, other) = match heading.winner() {
        Sense::Left => (left, right),
        Sense::Right => (right, left),
    };
    let samples = heading.samples as u64;
    let measured = [
        Measured::new("resultant of the better sense", best, "1")
            .limit(limits.min_resultant)
            .samples(samples),
        Measured::new("resultant of the other sense", other, "1").samples(samples),
        Measured::new("offset", heading.offset_rad.to_degrees(), "deg").samples(samples),
        Measured::count("windows with a turn", heading.votes.iter().sum()),
    ];
    if heading.winner() == Sense::Right {
        return out.fail(clockwise(imu, &subject, track, heading, measured));
    }
    match offset_finding(imu, &subject, track, heading, limits) {
        Some(finding) => out.fail(measured.into_iter().fold(finding, Finding::measured)),
        None => out.pass(&subject, measured),
    }
}

/// Why no track decided: what the best of them lacked.
fn undecided(headings: &[(&Track, Heading)], limits: &Limits) -> String {
    let widest = headings
        .iter()
        .map(|(_, heading)| heading.widest_rad)
        .fold(0.0, f64::max);
    let windows: usize = headings.iter().map(|(_, heading)| heading.windows).sum();
    if windows == 0 {
        return format!(
            "the course turns by {:.0} deg at most while both are there and it moves, {} deg within {} s are needed",
            widest.to_degrees(),
            limits.min_turn_deg,
            limits.window_s
        );
    }
    let votes: [usize; 2] = headings.iter().fold([0, 0], |sum, (_, heading)| {
        [sum[0] + heading.votes[0], sum[1] + heading.votes[1]]
    });
    format!(
        "the yaw follows the course clearly neither way: of {windows} windows with a turn {} say counter-clockwise, {} \
         clockwise",
        votes[0], votes[1]
    )
}

fn clockwise(imu: &Imu, subject: &str, track: &Track, heading: &Heading, measured: [Measured; 4]) -> Finding {
    let offset = heading.offset_rad.to_degrees();
    let (from, to) = heading.span_s.unwrap_or_default();
    let zero = if !track.is_geodetic {
        "where its zero is cannot be told from this track".to_owned()
    } else if (offset - 90.0).abs() <= 30.0 {
        format!("its zero is {offset:.0} deg from that of a compass's at east, as a heading from north has")
    } else {
        format!("with an offset of {offset:.0} deg, where a heading from north has 90")
    };
    let message = format!(
        "the yaw of `{}` grows clockwise: it turns against the course of {} from {from:.0} to {to:.0} s; {zero}",
        imu.stream.topic, track.subject
    );
    let finding = Finding::error(subject, message, imu.stream.place())
        .likely()
        .relation("clockwise-yaw")
        .help(
            "REP-103 counts yaw counter-clockwise from east: publish `yaw_ros = pi/2 - heading`; of a whole NED/FRD \
             orientation `R_enu_flu = P * R_ned_frd * F`",
        );
    measured.into_iter().fold(finding, Finding::measured)
}

/// A zero that is far from east, where the track knows east.
fn offset_finding(imu: &Imu, subject: &str, track: &Track, heading: &Heading, limits: &Limits) -> Option<Finding> {
    let offset = heading.offset_rad.to_degrees();
    let is_steady = heading.offset_resultant >= limits.min_resultant;
    if !track.is_geodetic || !is_steady || offset.abs() <= limits.max_offset_deg {
        return None;
    }
    let near = |degrees: f64| {
        let rest = (offset - degrees + 540.0).rem_euclid(360.0) - 180.0;
        rest.abs() <= limits.max_spread_deg
    };
    let what = if near(90.0) {
        "as of a body whose y axis points forward, or a sensor turned so and not said"
    } else if near(-90.0) {
        "as of a yaw that is zero in the north, or a sensor turned so and not said"
    } else if near(180.0) {
        "as of a sensor mounted backwards, or a drive in reverse"
    } else {
        "as of a magnetometer beside steel, or a mounting angle that is not said"
    };
    let message = format!(
        "the yaw of `{}` is {offset:.0} deg from the course of {}, {what}; {}",
        imu.stream.topic,
        track.subject,
        imu.mounting()
    );
    Some(
        Finding::warning(subject, message, imu.stream.place())
            .hint()
            .help("compare with the mounting, and with `yaw_offset` and `magnetic_declination_radians` of the filter that uses it"),
    )
}
