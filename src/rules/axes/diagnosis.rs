//! The faults that fit what was seen of an inertial sensor, and which rule reports them.
//!
//! One wrong setting shows in several measurements. Where they fit a fault that is known, one rule reports it, and the others
//! point there. Must not measure.

use std::sync::Arc;

use crate::rules::motion::ToldIn;
use crate::tables::InsDriver;
use crate::verdict::Finding;

use super::causes::{Base, CAUSES, Cause, HEALTHY, Heading, Push, Seen, Sense, Turn, World};

/// The rules that see a sensor, in the order in which one of them reports what fits several faults.
const ORDER: [&str; 6] = ["AXES03", "AXES01", "QUAT01", "AXES04", "AXES05", "AXES06"];

/// What the faults make of one sensor.
#[derive(Clone, Debug, Default)]
pub(crate) struct Diagnosis {
    /// The faults that fit everything that was measured; none where nothing is wrong, or no fault that is known fits.
    pub(crate) causes: Vec<&'static Cause>,
    /// The rule that reports them.
    pub(crate) owner: Option<&'static str>,
    /// What the sensor's numbers were told in.
    told_in: ToldIn,
    /// The driver, where names tell it.
    driver: Option<Arc<InsDriver>>,
}

impl Diagnosis {
    /// Finds the faults that fit.
    pub(crate) fn of(mut seen: Seen, told_in: &ToldIn, driver: Option<Arc<InsDriver>>) -> Self {
        if seen.turn == Some(Turn::Ordered) {
            // QUAT03 reports the order by itself. Wrong roll and pitch tilt the world; whatever else is seen has a cause of
            // its own.
            let tilted = seen.world == Some(World::Elsewhere);
            seen.turn = Some(Turn::Agree);
            seen.world = seen.world.filter(|_| !tilted);
            let rest = Self::of(seen, told_in, driver);
            let owner = rest.owner.or(tilted.then_some("QUAT03"));
            return Self { owner, ..rest };
        }
        if seen.turn == Some(Turn::Partly) {
            // About one axis it does not follow, which QUAT01 tells; about the others it says nothing that would be a cause.
            seen.turn = None;
        }
        let told_in = told_in.clone();
        if HEALTHY.fits(seen) {
            return Self {
                told_in,
                driver,
                ..Self::default()
            };
        }
        let fitting = CAUSES.iter().filter(|cause| cause.fits(seen));
        let causes: Vec<&'static Cause> = fitting.map(|cause| cause.seen_from(&told_in)).collect();
        let shows = |code: &&str| shows(seen, code);
        let owners = causes.iter().map(|cause| cause.owner);
        let one = owners
            .clone()
            .next()
            .filter(|first| owners.clone().all(|owner| owner == *first));
        let owner = one
            .filter(shows)
            .or_else(|| ORDER.into_iter().find(shows).filter(|_| !causes.is_empty()));
        Self {
            causes,
            owner,
            told_in,
            driver,
        }
    }

    /// Leaves to another rule what looks like a wrong mounting: where the base itself is turned, its sensors look so.
    pub(crate) fn leave_mounting_to(&mut self, owner: &'static str) {
        if self.causes.iter().any(|cause| cause.is_of_mounting) {
            self.owner = Some(owner);
        }
    }

    /// Why a rule does not report what it sees: another reports the fault that it is part of.
    pub(crate) fn reported_elsewhere(&self, code: &str, seen: &str) -> Option<String> {
        let owner = self.owner.filter(|owner| *owner != code)?;
        Some(format!("{seen}: part of what {owner} reports of this sensor"))
    }

    /// A finding with the fault's name and help, and how the numbers were read; `otherwise` is the help where no fault that
    /// is known fits.
    pub(crate) fn explain(&self, finding: Finding, otherwise: &str) -> Finding {
        let finding = self.told_in.tell(finding);
        let finding = finding.help(self.help().unwrap_or_else(|| otherwise.to_owned()));
        match self.word() {
            Some(word) => finding.relation(word),
            None => finding,
        }
    }

    /// The faults in words, for the end of a message; empty where none is known.
    pub(crate) fn words(&self) -> String {
        match self.causes.as_slice() {
            [] => String::new(),
            [one] => format!(": {}", one.text),
            several => {
                let texts: Vec<&str> = several.iter().map(|cause| cause.text).collect();
                format!(
                    "; what fits all that was measured: {}. These data cannot tell which",
                    texts.join("; or: ")
                )
            }
        }
    }

    /// The word of the relation.
    fn word(&self) -> Option<&'static str> {
        match self.causes.as_slice() {
            [one] => Some(one.word),
            _ => None,
        }
    }

    /// What to do.
    fn help(&self) -> Option<String> {
        let helps: Vec<&str> = self.causes.iter().map(|cause| cause.help).collect();
        let help = (!helps.is_empty()).then(|| helps.join("; or: "))?;
        Some(match &self.driver {
            Some(driver) if self.causes.iter().any(|cause| cause.is_of_driver) => format!(
                "{help}. {} measures in {}: {}",
                driver.name, driver.native, driver.setting
            ),
            _ => help,
        })
    }
}

/// A wrong setting of a driver that what was seen does not rule out. A heading in place of a yaw is judged by itself.
pub(super) fn unseen(seen: Seen) -> Option<&'static Cause> {
    let is_setting = |cause: &&Cause| cause.is_of_driver && cause.word != "compass-yaw";
    CAUSES.iter().find(|cause| is_setting(cause) && cause.fits(seen))
}

/// Whether a rule sees something wrong.
fn shows(seen: Seen, code: &str) -> bool {
    match code {
        "AXES01" => seen.base.is_some_and(|base| base != Base::Up),
        "AXES03" => seen.world.is_some_and(|world| world != World::Up),
        "QUAT01" => seen
            .turn
            .is_some_and(|turn| turn != Turn::Ordered && !HEALTHY.turn.contains(&turn)),
        "AXES04" => seen.heading == Some(Heading::Against),
        "AXES05" => seen.sense == Some(Sense::Against),
        "AXES06" => seen.push.is_some_and(|push| push != Push::Forward),
        _ => false,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rules::axes::causes::Readings;

    fn words(seen: Seen) -> (Vec<&'static str>, Option<&'static str>) {
        let diagnosis = Diagnosis::of(seen, &ToldIn::default(), None);
        (
            diagnosis.causes.iter().map(|cause| cause.word).collect(),
            diagnosis.owner,
        )
    }

    #[test]
    fn a_healthy_sensor_has_no_fault_however_little_was_seen() {
        assert_eq!(words(Seen::default()), (vec![], None));
        let seen = Seen {
            base: Some(Base::Up),
            turn: Some(Turn::Agree),
            ..Seen::default()
        };
        assert_eq!(words(seen), (vec![], None));
    }

    #[test]
    fn a_track_tells_a_negated_accelerometer_from_a_sensor_in_ned() {
        let still = Seen {
            world: Some(World::Down),
            base: Some(Base::Down),
            turn: Some(Turn::Agree),
            ..Seen::default()
        };
        assert_eq!(words(still), (vec!["ned-frd", "gravity-sign"], Some("AXES03")));
        let driven = Seen {
            heading: Some(Heading::Against),
            ..still
        };
        assert_eq!(words(driven), (vec!["ned-frd"], Some("AXES03")));
        let pushed = Seen {
            heading: Some(Heading::With),
            push: Some(Push::Backward),
            ..still
        };
        assert_eq!(words(pushed), (vec!["gravity-sign"], Some("AXES01")));
    }

    #[test]
    fn of_readings_that_serve_alike_the_other_measurements_leave_some() {
        let seen = Seen {
            turn: Some(Turn::OneOf(Readings::of(&[Turn::Inverse, Turn::Reordered]))),
            ..Seen::default()
        };
        assert_eq!(words(seen), (vec!["inverse", "wxyz"], Some("QUAT01")));
        let down = Seen {
            world: Some(World::Down),
            ..seen
        };
        assert_eq!(words(down), (vec!["wxyz"], Some("QUAT01")));
    }

    #[test]
    fn what_no_single_fault_explains_has_no_owner() {
        let seen = Seen {
            base: Some(Base::Side),
            heading: Some(Heading::Against),
            ..Seen::default()
        };
        assert_eq!(words(seen), (vec![], None));
    }

    #[test]
    fn the_order_of_angles_is_a_fault_beside_the_others() {
        let seen = Seen {
            turn: Some(Turn::Ordered),
            world: Some(World::Elsewhere),
            ..Seen::default()
        };
        assert_eq!(words(seen), (vec![], Some("QUAT03")));
        let in_ned = Seen {
            world: Some(World::Down),
            base: Some(Base::Down),
            heading: Some(Heading::Against),
            ..seen
        };
        assert_eq!(words(in_ned), (vec!["ned-frd"], Some("AXES03")));
    }

    #[test]
    fn every_fault_shows_at_its_owner() {
        for cause in CAUSES {
            assert!(ORDER.contains(&cause.owner), "{}", cause.word);
            assert!(!HEALTHY.eq(cause));
        }
    }
}
