//! Whether the yaw of an orientation turns with the course, and its offset from the course.

use std::sync::Arc;

use nalgebra::Vector3;

use crate::analysis::axes::heading::{Heading, Limits, Sense};
use crate::analysis::axes::{causes, plots};
use crate::analysis::look::{Estimate, needed};
use crate::analysis::motion::{Imu, Track, Yaws};
use crate::math::readings::Reading;
use crate::source::Place;
use crate::tables::Offset;
use crate::verdict::{Measured, NotEvaluated, Plot};

/// The yaw compared with the course of a track.
pub(crate) struct HeadingFit {
    /// What reports call the track.
    pub(crate) track: String,
    pub(crate) track_at: Place,
    /// Whether the track knows where east is.
    pub(crate) is_geodetic: bool,
    pub(crate) heading: Heading,
}

impl HeadingFit {
    pub(crate) fn class(&self) -> causes::Heading {
        match self.heading.winner() {
            Sense::Left => causes::Heading::With,
            Sense::Right => causes::Heading::Against,
        }
    }

    pub(crate) fn measured(&self, limits: &Limits) -> [Measured; 4] {
        let heading = &self.heading;
        let [left, right] = heading.resultants;
        let sense = heading.winner();
        let own_first = match sense {
            Sense::Left => [left, right],
            Sense::Right => [right, left],
        };
        let [own, other] = sense.agreements(own_first, heading.samples as u64, limits);
        let turns = Measured::count("parts of the drive with a turn", heading.votes.iter().sum());
        [self.offset(), own, other, turns]
    }

    pub(crate) fn plot(&self, topic: &str) -> Plot {
        let title = format!("Yaw of `{topic}` over the course of {}", self.track);
        plots::yaw(title, &self.heading, self.is_geodetic)
    }

    pub(crate) fn offset(&self) -> Measured {
        Measured::new("yaw minus course", self.heading.offset_rad.to_degrees(), "deg")
            .samples(self.heading.samples as u64)
    }

    /// Yaw minus course, radians; or why it is unknown.
    pub(crate) fn offset_rad(&self) -> Estimate<f64> {
        if self.is_geodetic {
            Ok(self.heading.offset_rad)
        } else {
            let why = format!(
                "{} does not know east; record GNSS fixes to judge the zero of the yaw",
                self.track
            );
            Err((NotEvaluated::MissingInput, why))
        }
    }

    /// Yaw minus course, degrees, if it is steady and too large for a mounting error.
    pub(crate) fn large_offset_deg(&self, limits: &Limits) -> Option<f64> {
        let is_steady = self.heading.offset_resultant >= limits.min_resultant;
        let offset = self.offset_rad().ok()?.to_degrees();
        (is_steady && offset.abs() > limits.max_offset_deg).then_some(offset)
    }

    /// Whether an offset is 90 degrees to either side, in all directions.
    pub(crate) fn is_a_quarter_turn(&self, offset_deg: f64, limits: &Limits) -> bool {
        (offset_deg.abs() - 90.0).abs() <= limits.quarter_deg
            && self.heading.offset_spread_deg() <= limits.quarter_spread_deg
            && self.heading.widest_gap_deg() <= limits.max_gap_deg
    }

    /// The entry of the driver's profile for a large offset.
    pub(crate) fn known_offset(&self, imu: &Imu, limits: &Limits) -> Option<Offset> {
        let offset = self
            .large_offset_deg(limits)
            .filter(|_| self.class() == causes::Heading::With)?;
        let near = |known: &&Offset| apart_deg(offset, known.deg) <= limits.max_spread_deg;
        imu.driver.as_ref()?.offsets.iter().find(near).cloned()
    }
}

/// Whether z of the body that the sensor is mounted on points up on average, by its orientation.
pub(crate) fn is_upright(imu: &Imu) -> bool {
    let imu_from_base = imu.base_from_imu().inverse();
    let ups = imu.stream.rows().filter_map(|timed| {
        let world_from_imu = Reading::Xyzw.world_from_body(timed.row.orientation)?;
        Some((world_from_imu * imu_from_base * Vector3::z()).z)
    });
    let (sum, count) = ups.fold((0.0, 0.0), |(sum, count), up| (sum + up, count + 1.0));
    sum >= 0.5 * count
}

/// Between two angles, degrees, 0 to 180.
pub(crate) fn apart_deg(a: f64, b: f64) -> f64 {
    ((a - b + 540.0).rem_euclid(360.0) - 180.0).abs()
}

/// Sense of the yaw, by the first track with enough turns. GNSS comes first: odometry often uses this very yaw.
pub(crate) fn look(imu: &Imu, tracks: &[Arc<Track>], limits: &Limits) -> Estimate<HeadingFit> {
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
            return Ok(HeadingFit {
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

/// Why no track decided.
pub(crate) fn undecided(headings: &[Heading], limits: &Limits) -> String {
    let widest = headings.iter().map(|heading| heading.widest_rad).fold(0.0, f64::max);
    let windows: usize = headings.iter().map(|heading| heading.windows).sum();
    if windows == 0 && widest.to_degrees() >= limits.min_turn_deg {
        let longest = headings.iter().map(|heading| heading.longest_m).fold(0.0, f64::max);
        return format!(
            "the course turns by {:.0} deg within {} s, but covers only {longest:.1} m in such a turn, {} m are needed",
            widest.to_degrees(),
            limits.window_s,
            limits.min_way_m
        );
    }
    if windows == 0 {
        return format!(
            "the course turns by only {:.0} deg while both are recorded and it moves, {} deg within {} s are needed",
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
            "only {longest:.1} s of turns, {} s are needed to rule out wind or slip",
            limits.min_span_s
        );
    }
    format!(
        "the yaw follows the course in neither sense clearly: of {windows} windows with a turn, {left} are counter-clockwise and {right} \
         clockwise"
    )
}
