//! AXES04: which way the yaw of an orientation turns, and where its zero is.

use std::sync::Arc;

use nalgebra::Vector3;
use serde::Deserialize;

use crate::math::readings::Reading;
use crate::rules::motion::{Imu, Motion, Track, Yaws};
use crate::rules::{Evidence, Judge, Need, Rule};
use crate::source::Place;
use crate::tables::Offset;
use crate::verdict::{Finding, Measured, NotEvaluated, Plot};
use crate::world::World;

use super::causes;
use super::diagnosis::Diagnosis;
use super::heading::{Heading, Sense};
use super::plots;
use super::sensors::{Look, Sensor, Sensors, TRACK, needed};

/// AXES04.
pub struct HeadingConvention;

/// Limits of AXES04.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Limits {
    pub(crate) min_speed_m_s: f64,
    odometry_speed_m_s: f64,
    pub(super) window_s: f64,
    pub(super) window_turn_deg: f64,
    pub(crate) min_turn_deg: f64,
    pub(crate) min_span_s: f64,
    pub(super) min_way_m: f64,
    pub(crate) min_resultant: f64,
    pub(crate) variance_ratio: f64,
    pub(crate) min_agreement: f64,
    max_offset_deg: f64,
    max_spread_deg: f64,
}

impl Rule for HeadingConvention {
    const PAGE: &'static str = include_str!("../../../rules/axes/heading-convention.md");
    const NEEDS: &'static [Need] = &[Need::Bag];
    const EVIDENCE: Evidence = Evidence::MOTION;
    type Limits = Limits;

    fn judge(world: &World, limits: &Limits, out: &mut Judge) {
        let (motion, sensors) = (Motion::of(world), Sensors::of(world));
        for (imu, sensor) in sensors.each(&motion) {
            let subject = format!("yaw of {}", imu.stream.subject);
            let decided = match &sensor.heading {
                Ok(decided) => decided,
                Err((why, reason)) => {
                    out.not_evaluated(subject, *why, reason);
                    continue;
                }
            };
            // Which way it turns is no matter where it turns as it should: the zero is what is looked for then.
            let plotted = match decided.class() {
                causes::Heading::Against => subject.clone(),
                causes::Heading::With => zero_of(&subject),
            };
            out.plot(&plotted, || Some(decided.plot(&imu.stream.topic)));
            match decided.class() {
                causes::Heading::Against if decided.is_by_a_simulator(sensor) => {
                    let why = "it turns against the poses of a simulator, which SENSOR09 judges";
                    out.not_evaluated(subject, NotEvaluated::NotApplicable, why);
                }
                causes::Heading::Against => judge_against(imu, subject, decided, &sensor.diagnosis, limits, out),
                causes::Heading::With => {
                    out.pass(&subject, decided.measured(limits));
                    judge_zero(imu, zero_of(&subject), decided, sensor, limits, out);
                }
            }
        }
    }
}

/// What is judged of where a yaw is zero.
fn zero_of(subject: &str) -> String {
    format!("zero of the {subject}")
}

/// A yaw that turns against the course.
fn judge_against(
    imu: &Imu,
    subject: String,
    decided: &Decided,
    diagnosis: &Diagnosis,
    limits: &Limits,
    out: &mut Judge,
) {
    let seen = "the yaw turns against the course";
    match diagnosis.reported_elsewhere("AXES04", seen) {
        Some(why) => out.not_evaluated(subject, NotEvaluated::NotApplicable, why),
        None => out.fail(clockwise(imu, &subject, decided, diagnosis, decided.measured(limits))),
    }
}

/// Where the zero of a yaw is that turns with the course.
fn judge_zero(imu: &Imu, subject: String, decided: &Decided, sensor: &Sensor, limits: &Limits, out: &mut Judge) {
    if sensor.offset.is_some() {
        let why = "it is what SENSOR06 reports of its driver";
        return out.not_evaluated(subject, NotEvaluated::NotApplicable, why);
    }
    let offset = match decided.offset_rad() {
        Ok(offset_rad) => format!("{:.0} deg", offset_rad.to_degrees()),
        Err((why, reason)) => return out.not_evaluated(subject, why, reason),
    };
    if decided.heading.offset_resultant < limits.min_resultant {
        let why = format!("{offset} from the course on the whole, and not steadily so");
        return out.not_evaluated(subject, NotEvaluated::TooLittleEvidence, why);
    }
    let Some(finding) = offset_finding(imu, &subject, decided, limits) else {
        return out.pass(subject, [decided.offset()]);
    };
    // What nothing ties to a base may hang as it likes.
    if imu.mount.is_some() && !is_upright(imu) {
        let why = format!(
            "{offset} from the course, by an orientation on its side or on its head: that is no matter of its zero"
        );
        return out.not_evaluated(subject, NotEvaluated::NotApplicable, why);
    }
    let seen = format!("the yaw is {offset} from the course");
    if let Some(why) = sensor.diagnosis.reported_elsewhere("AXES04", &seen) {
        return out.not_evaluated(subject, NotEvaluated::NotApplicable, why);
    }
    // A base whose x does not point forward turns every sensor on it.
    let by_base = |rad: f64| {
        let offset_deg = decided.heading.offset_rad.to_degrees();
        apart_deg(offset_deg, rad.to_degrees()) <= limits.max_spread_deg
    };
    if sensor.base_yaw_rad.is_some_and(by_base) {
        let why = format!("{seen}: part of what AXES13 reports of the base");
        return out.not_evaluated(subject, NotEvaluated::NotApplicable, why);
    }
    let finding = finding.related(decided.track_at.clone(), TRACK);
    out.fail(decided.measured(limits).into_iter().fold(finding, Finding::measured));
}

/// What was seen.
pub(super) struct Decided {
    /// What reports call the track.
    pub(super) track: String,
    track_at: Place,
    /// Whether the track knows where east is.
    is_geodetic: bool,
    heading: Heading,
}

impl Decided {
    /// Whether the yaw of an upright sensor turns against poses that a simulator may have given the other hand.
    pub(super) fn is_by_a_simulator(&self, sensor: &Sensor) -> bool {
        self.class() == causes::Heading::Against && sensor.may_doubt(self.is_geodetic)
    }

    pub(super) fn class(&self) -> causes::Heading {
        match self.heading.winner() {
            Sense::Left => causes::Heading::With,
            Sense::Right => causes::Heading::Against,
        }
    }

    fn measured(&self, limits: &Limits) -> [Measured; 4] {
        let heading = &self.heading;
        let samples = heading.samples as u64;
        let [left, right] = heading.resultants;
        let (best, other) = match heading.winner() {
            Sense::Left => (left, right),
            Sense::Right => (right, left),
        };
        [
            Measured::new("resultant of the better sense", best, "1")
                .limit(limits.min_resultant)
                .samples(samples),
            Measured::new("resultant of the other sense", other, "1").samples(samples),
            self.offset(),
            Measured::count("windows with a turn", heading.votes.iter().sum()),
        ]
    }

    fn plot(&self, topic: &str) -> Plot {
        let title = format!("Yaw of `{topic}` against the course of {}", self.track);
        plots::yaw(title, &self.heading, self.is_geodetic)
    }

    fn offset(&self) -> Measured {
        Measured::new("offset", self.heading.offset_rad.to_degrees(), "deg").samples(self.heading.samples as u64)
    }

    /// Yaw minus course, radians; or why it says nothing of east.
    pub(super) fn offset_rad(&self) -> Look<f64> {
        if self.is_geodetic {
            Ok(self.heading.offset_rad)
        } else {
            let why = format!("{} does not know where east is", self.track);
            Err((NotEvaluated::MissingInput, why))
        }
    }

    /// Yaw minus course, degrees, where it is steady, and too large for a mounting.
    fn large_offset_deg(&self, limits: &Limits) -> Option<f64> {
        let is_steady = self.heading.offset_resultant >= limits.min_resultant;
        let offset = self.offset_rad().ok()?.to_degrees();
        (is_steady && offset.abs() > limits.max_offset_deg).then_some(offset)
    }

    /// What the driver's profile says of a large offset.
    pub(super) fn known_offset(&self, imu: &Imu, limits: &Limits) -> Option<Offset> {
        let offset = self
            .large_offset_deg(limits)
            .filter(|_| self.class() == causes::Heading::With)?;
        let near = |known: &&Offset| apart_deg(offset, known.deg) <= limits.max_spread_deg;
        imu.driver.as_ref()?.offsets.iter().find(near).cloned()
    }
}

/// Whether z of what the sensor is mounted on points up by its orientation, all in all.
fn is_upright(imu: &Imu) -> bool {
    let imu_from_base = imu.base_from_imu().inverse();
    let ups = imu.stream.rows().filter_map(|timed| {
        let world_from_imu = Reading::Xyzw.world_from_body(timed.row.orientation)?;
        Some((world_from_imu * imu_from_base * Vector3::z()).z)
    });
    let (sum, count) = ups.fold((0.0, 0.0), |(sum, count), up| (sum + up, count + 1.0));
    sum >= 0.5 * count
}

/// Between two angles, degrees, 0 to 180.
fn apart_deg(a: f64, b: f64) -> f64 {
    ((a - b + 540.0).rem_euclid(360.0) - 180.0).abs()
}

/// How the yaw turns against the first track that tells. Satellites come first: odometry is often made of this very yaw.
pub(super) fn look(imu: &Imu, tracks: &[Arc<Track>], limits: &Limits) -> Look<Decided> {
    if let Some(why) = imu.no_orientation {
        return Err((NotEvaluated::NotApplicable, why.to_owned()));
    }
    needed(tracks)?;
    let mut undecided_by = Vec::new();
    let yaws = Yaws::of(&imu.stream, &imu.base_from_imu());
    let slow = tracks.iter().filter(|track| !track.is_geodetic);
    let tried = tracks.iter().map(|track| (track, limits.min_speed_m_s));
    for (track, speed_m_s) in tried.chain(slow.map(|track| (track, limits.odometry_speed_m_s))) {
        let heading = Heading::of(&yaws, &track.courses(speed_m_s), limits);
        let is_agreed = heading.agreement().is_some_and(|share| share >= limits.min_agreement);
        if is_agreed && heading.span_s() >= limits.min_span_s {
            return Ok(Decided {
                track: track.subject.clone(),
                track_at: track.place.clone(),
                is_geodetic: track.is_geodetic,
                heading,
            });
        }
        undecided_by.push(heading);
    }
    Err((NotEvaluated::TooLittleEvidence, undecided(&undecided_by, limits)))
}

/// Why no track decided: what the best of them lacked.
fn undecided(headings: &[Heading], limits: &Limits) -> String {
    let widest = headings.iter().map(|heading| heading.widest_rad).fold(0.0, f64::max);
    let windows: usize = headings.iter().map(|heading| heading.windows).sum();
    if windows == 0 && widest.to_degrees() >= limits.min_turn_deg {
        let longest = headings.iter().map(|heading| heading.longest_m).fold(0.0, f64::max);
        return format!(
            "the course turns by {:.0} deg within {} s, and goes {longest:.1} m at most in such a turn; {} m are needed",
            widest.to_degrees(),
            limits.window_s,
            limits.min_way_m
        );
    }
    if windows == 0 {
        return format!(
            "the course turns by {:.0} deg at most while both are there and it moves, {} deg within {} s are needed",
            widest.to_degrees(),
            limits.min_turn_deg,
            limits.window_s
        );
    }
    let [left, right] = headings.iter().fold([0, 0], |[left, right], heading| {
        let [more_left, more_right] = heading.votes;
        [left + more_left, right + more_right]
    });
    let longest = headings.iter().map(Heading::span_s).fold(0.0, f64::max);
    if longest > 0.0 && longest < limits.min_span_s {
        return format!(
            "{longest:.1} s of a turn, {} s are needed: a gust or a slip lasts as long",
            limits.min_span_s
        );
    }
    format!(
        "the yaw follows the course clearly neither way: of {windows} windows with a turn {left} say counter-clockwise, {right} \
         clockwise"
    )
}

fn clockwise(imu: &Imu, subject: &str, decided: &Decided, diagnosis: &Diagnosis, measured: [Measured; 4]) -> Finding {
    let heading = &decided.heading;
    let offset = heading.offset_rad.to_degrees();
    let (from, to) = heading.span_s.unwrap_or_default();
    let zero = if !decided.is_geodetic {
        "where its zero is cannot be told from this track".to_owned()
    } else if (offset - 90.0).abs() <= 30.0 {
        format!("the offset of {offset:.0} deg is that of a heading counted from north")
    } else {
        format!("with an offset of {offset:.0} deg, where a heading from north has 90")
    };
    let message = format!(
        "the yaw of `{}` grows clockwise: it turns against the course of {} from {from:.0} to {to:.0} s; {zero}{}",
        imu.stream.topic,
        decided.track,
        diagnosis.words()
    );
    let otherwise = "REP-103 counts yaw counter-clockwise from east: publish `yaw_ros = pi/2 - heading`; of a whole NED/FRD orientation \
         `R_enu_flu = P * R_ned_frd * F`";
    let finding = Finding::error(subject, message, imu.stream.place())
        .likely()
        .relation("clockwise-yaw");
    let finding = diagnosis
        .explain(finding, otherwise)
        .related(decided.track_at.clone(), TRACK);
    measured.into_iter().fold(finding, Finding::measured)
}

/// A zero that is far from east, where the track knows east.
fn offset_finding(imu: &Imu, subject: &str, decided: &Decided, limits: &Limits) -> Option<Finding> {
    let offset = decided.large_offset_deg(limits)?;
    let near = |degrees: f64| apart_deg(offset, degrees) <= limits.max_spread_deg;
    let what = if near(90.0) {
        "as of a sensor turned to the left and not said"
    } else if near(-90.0) {
        "as of a yaw that is zero in the north, a body whose y axis points forward, or a sensor turned to the right and not said"
    } else if near(180.0) {
        "as of a sensor mounted backwards, or a drive in reverse"
    } else {
        "as of a magnetometer beside steel, or a mounting angle that is not said"
    };
    let message = format!(
        "the yaw of `{}` is {offset:.0} deg from the course of {}, {what}; {}",
        imu.stream.topic,
        decided.track,
        imu.mounting()
    );
    let finding = Finding::warning(subject, message, imu.stream.place());
    // Where yaw is zero is a guess, unless the user says it.
    let finding = if imu.stream.told_in.declares_world() {
        finding.likely()
    } else {
        finding.hint()
    };
    Some(
        imu.stream.told_in.tell(finding).help("compare with the mounting, and with `yaw_offset` and `magnetic_declination_radians` of the filter that uses it"),
    )
}
