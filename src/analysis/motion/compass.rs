//! Angles clockwise from north that a recording states.
//!
//! Owns which they are. Must not judge.

use crate::analysis::motion::stream::{Stream, TimedRow};
use crate::source::Place;
use crate::world::motion::NmeaRow;

/// A course over ground is noise below this speed, m/s.
const MIN_SPEED_M_S: f64 = 0.5;

/// Kind of an angle, the most reliable first.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) enum Kind {
    /// Heading from true north.
    True,
    /// Heading from magnetic north.
    Magnetic,
    /// Course over ground, from true north.
    Course,
}

/// Angles over time.
#[derive(Clone, Debug)]
pub(crate) struct Compass {
    /// Their name in reports: ``true heading on topic `/nmea` ``.
    pub(crate) subject: String,
    /// First message.
    pub(crate) place: Place,
    /// Their kind.
    pub(crate) kind: Kind,
    /// Seconds after the recording's start, and radians clockwise from north, in order.
    pub(crate) angles: Vec<(f64, f64)>,
}

impl Compass {
    /// The angles in the sentences.
    pub(crate) fn all(stream: &Stream<NmeaRow>) -> Vec<Self> {
        let course = |row: &NmeaRow| {
            if row.speed_m_s >= MIN_SPEED_M_S {
                row.course_deg
            } else {
                f64::NAN
            }
        };
        let heading = |row: &NmeaRow| row.true_heading_deg;
        let magnetic = |row: &NmeaRow| row.magnetic_heading_deg;
        [
            Self::of(stream, Kind::True, heading),
            Self::of(stream, Kind::Magnetic, magnetic),
            Self::of(stream, Kind::Course, course),
        ]
        .into_iter()
        .filter(|compass| !compass.angles.is_empty())
        .collect()
    }

    fn of(stream: &Stream<NmeaRow>, kind: Kind, degrees: impl Fn(&NmeaRow) -> f64) -> Self {
        let word = match kind {
            Kind::True => "true heading",
            Kind::Magnetic => "magnetic heading",
            Kind::Course => "course over ground",
        };
        let angle = |timed: &TimedRow<NmeaRow>| (timed.t_s, degrees(&timed.row).to_radians());
        Self {
            subject: format!("{word} on {}", stream.subject),
            place: stream.place(),
            kind,
            angles: stream
                .rows()
                .map(angle)
                .filter(|(_, angle)| angle.is_finite())
                .collect(),
        }
    }
}
