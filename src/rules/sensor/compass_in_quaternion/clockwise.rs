//! What SENSOR08 reports of a yaw: its numbers, and the finding where it grows clockwise.

use crate::analysis::axes::heading::{self, Sense};
use crate::analysis::motion::Stream;
use crate::verdict::{Finding, Measured};
use crate::world::motion::Row;

use crate::analysis::sensor::yaw_zero::Limits;
use crate::analysis::sensor::yaw_zero::YawZero;

/// Where the zero of a yaw is that grows clockwise, in degrees from north.
enum Zero {
    North,
    East,
    Elsewhere(f64),
    Unsteady,
}

impl YawZero {
    /// The numbers.
    pub(crate) fn measured(&self, turns: &heading::Limits) -> Vec<Measured> {
        let samples = self.samples as u64;
        let sense = if self.is_clockwise { Sense::Right } else { Sense::Left };
        let mut measured = sense.agreements(self.resultants, samples, turns).to_vec();
        let zero = self.zero_rad.map(f64::to_degrees);
        let what = if self.is_clockwise {
            "yaw minus compass heading"
        } else {
            "yaw minus pi/2 - heading"
        };
        measured.extend(zero.map(|zero| Measured::new(what, zero, "deg").samples(samples)));
        measured
    }

    /// Where the zero of a yaw is that grows clockwise.
    fn zero(&self, limits: &Limits) -> Zero {
        match self.zero_rad.map(f64::to_degrees) {
            Some(deg) if deg.abs() <= limits.max_offset_deg => Zero::North,
            Some(deg) if (deg + 90.0).abs() <= limits.max_offset_deg => Zero::East,
            Some(deg) => Zero::Elsewhere(deg),
            None => Zero::Unsteady,
        }
    }

    /// Why a yaw that grows clockwise matches no known convention: its zero is neither north nor east. It may be chance, and no known fault
    /// explains it.
    pub(crate) fn stray(&self, limits: &Limits) -> Option<String> {
        let zero = match self.zero(limits) {
            Zero::North | Zero::East => return None,
            Zero::Elsewhere(deg) => format!("its zero is {deg:.0} deg from north"),
            Zero::Unsteady => "its zero is not constant".to_owned(),
        };
        Some(format!(
            "compared with {}, the yaw grows clockwise, and {zero}: no known convention explains that",
            self.other
        ))
    }

    /// The finding for a yaw that grows clockwise.
    pub(crate) fn finding<R: Row>(
        &self,
        stream: &Stream<R>,
        subject: &str,
        turns: &heading::Limits,
        limits: &Limits,
    ) -> Finding {
        let (relation, what, help) = match self.zero(limits) {
            Zero::North => (
                "compass-yaw",
                "is a compass heading: clockwise from north, not counter-clockwise from east".to_owned(),
                "publish pi/2 - heading as the yaw".to_owned(),
            ),
            Zero::East => (
                "clockwise-yaw",
                "is clockwise from east, not counter-clockwise as in REP-103".to_owned(),
                "negate the yaw; if the whole quaternion is inverted, invert the quaternion instead".to_owned(),
            ),
            Zero::Elsewhere(deg) => (
                "clockwise-yaw",
                format!("grows clockwise, and is {deg:+.0} deg from the compass heading"),
                format!(
                    "publish pi/2 - heading as the yaw, where heading = present yaw {:+.0} deg",
                    -deg
                ),
            ),
            Zero::Unsteady => (
                "clockwise-yaw",
                "grows clockwise, not counter-clockwise as in REP-103".to_owned(),
                "negate the yaw, then check where the yaw is zero: the comparison does not show that".to_owned(),
            ),
        };
        let driver = if stream.topic.ends_with("heading") {
            " The driver nmea_navsat_driver publishes its topic `heading` in this way."
        } else {
            ""
        };
        let message = format!("`{}`: yaw {what}", stream.topic);
        let finding = Finding::error(subject, message, stream.place())
            .likely()
            .relation(relation)
            .related(self.other_at.clone(), "compared with this")
            .detail(format!(
                "Compared with {}. REP-103 counts yaw counter-clockwise from east.{driver}",
                self.other
            ))
            .help(help);
        let finding = stream.expressed_in.annotate(finding);
        finding.measured(self.measured(turns))
    }
}
