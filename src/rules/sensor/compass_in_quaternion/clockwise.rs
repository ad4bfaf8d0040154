//! What SENSOR08 says of a yaw: its numbers, and the finding where it grows clockwise.

use crate::analysis::motion::Stream;
use crate::verdict::{Finding, Measured};
use crate::world::motion::Row;

use crate::analysis::sensor::yaw_zero::Found;
use crate::analysis::sensor::yaw_zero::Limits;

/// Where the zero of a yaw is that grows clockwise, degrees from north where that is worth telling.
enum Zero {
    North(f64),
    East,
    Elsewhere(f64),
    Unsteady,
}

impl Found {
    /// The numbers.
    pub(crate) fn measured(&self, turns: &crate::analysis::axes::heading::Limits) -> Vec<Measured> {
        let samples = self.samples as u64;
        let [best, other] = self.resultants;
        let mut measured = vec![
            Measured::new("resultant of the better sense", best, "1")
                .limit(turns.min_resultant)
                .samples(samples),
            Measured::new("resultant of the other sense", other, "1").samples(samples),
        ];
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
            Some(deg) if deg.abs() <= limits.max_offset_deg => Zero::North(deg),
            Some(deg) if (deg + 90.0).abs() <= limits.max_offset_deg => Zero::East,
            Some(deg) => Zero::Elsewhere(deg),
            None => Zero::Unsteady,
        }
    }

    /// Why a yaw that grows clockwise is none that is known: its zero is neither in the north nor in the east. What is no more than
    /// that may be chance, and no fault has a name for it.
    pub(crate) fn stray(&self, limits: &Limits) -> Option<String> {
        let zero = match self.zero(limits) {
            Zero::North(_) | Zero::East => return None,
            Zero::Elsewhere(deg) => format!("has its zero {deg:.0} deg from north"),
            Zero::Unsteady => "has no steady zero".to_owned(),
        };
        Some(format!(
            "the yaw grows clockwise with {}, and {zero}: no heading is told so",
            self.other
        ))
    }

    /// What a yaw that grows clockwise is.
    pub(crate) fn finding<R: Row>(
        &self,
        stream: &Stream<R>,
        subject: &str,
        turns: &crate::analysis::axes::heading::Limits,
        limits: &Limits,
    ) -> Finding {
        let (relation, what) = match self.zero(limits) {
            Zero::North(deg) => (
                "compass-yaw",
                format!("it is a compass heading, clockwise from north, off by {deg:.1} deg"),
            ),
            Zero::East => (
                "clockwise-yaw",
                "it counts from east as REP-103 does, but clockwise: the quaternion is the inverse one, or its yaw is negated"
                    .to_owned(),
            ),
            Zero::Elsewhere(deg) => ("clockwise-yaw", format!("its zero is {deg:.0} deg from north")),
            Zero::Unsteady => ("clockwise-yaw", "where its zero is cannot be told from that".to_owned()),
        };
        let message = format!(
            "the yaw of `{}` grows clockwise with {}: {what} ({} samples)",
            stream.topic, self.other, self.samples
        );
        let finding = Finding::error(subject, message, stream.place())
            .likely()
            .relation(relation)
            .related(self.other_at.clone(), "what it was held against")
            .help(
                "REP-103 counts yaw counter-clockwise from east: publish `yaw_ros = pi/2 - heading` (the topic `heading` of \
                 nmea_navsat_driver holds the compass heading itself)",
            );
        let finding = stream.expressed_in.tell(finding);
        finding.measured(self.measured(turns))
    }
}
