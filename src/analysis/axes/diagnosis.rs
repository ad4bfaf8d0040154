//! The faults that fit all measurements of an inertial sensor, and the measurement that shows them best.
//!
//! One wrong setting shows in several measurements. Must not measure.

use std::sync::Arc;

use crate::analysis::motion::StreamConvention;
use crate::tables::InsDriver;

use super::causes::{Aspect, Base, CAUSES, Cause, HEALTHY, Hand, Heading, Push, Sense, Symptoms, Turn, World};

/// The measurements in the order in which they are reported when several faults fit.
const ORDER: [Aspect; 7] = [
    Aspect::World,
    Aspect::Base,
    Aspect::Turn,
    Aspect::Heading,
    Aspect::Sense,
    Aspect::Push,
    Aspect::Hand,
];

/// The faults of one sensor.
#[derive(Clone, Debug, Default)]
pub(crate) struct Diagnosis {
    /// The faults that fit all measurements; empty if nothing is wrong, or if no known fault fits.
    pub(crate) causes: Vec<&'static Cause>,
    /// The measurement that shows them best.
    pub(crate) shown_by: Option<Aspect>,
    /// Whether the base moves backwards throughout, which a healthy one may do.
    pub(crate) goes_backward: bool,
    /// The convention that the sensor's data are declared in.
    pub(crate) expressed_in: StreamConvention,
    /// The driver, if names identify it.
    driver: Option<Arc<InsDriver>>,
}

impl Diagnosis {
    /// Finds the faults that fit.
    pub(crate) fn of(mut seen: Symptoms, expressed_in: &StreamConvention, driver: Option<Arc<InsDriver>>) -> Self {
        if seen.turn == Some(Turn::Ordered) {
            // The order is a fault by itself. Wrong roll and pitch tilt the world; everything else has its own cause.
            let tilted = seen.world == Some(World::Elsewhere);
            seen.turn = Some(Turn::Agree);
            seen.world = seen.world.filter(|_| !tilted);
            let rest = Self::of(seen, expressed_in, driver);
            let shown_by = rest.shown_by.or(tilted.then_some(Aspect::AngleOrder));
            return Self { shown_by, ..rest };
        }
        if seen.turn == Some(Turn::Partly) {
            // One axis does not follow, which is reported by itself; it identifies no cause here.
            seen.turn = None;
        }
        let expressed_in = expressed_in.clone();
        if HEALTHY.fits(seen) {
            return Self {
                expressed_in,
                driver,
                ..Self::default()
            };
        }
        let fitting = CAUSES.iter().filter(|cause| cause.fits(seen));
        let causes: Vec<&'static Cause> = fitting.map(|cause| cause.seen_from(&expressed_in)).collect();
        let shows = |aspect: &Aspect| shows(seen, *aspect);
        let aspects = causes.iter().map(|cause| cause.shown_by);
        let one = aspects
            .clone()
            .next()
            .filter(|first| aspects.clone().all(|aspect| aspect == *first));
        let shown_by = one
            .filter(shows)
            .or_else(|| ORDER.into_iter().find(shows).filter(|_| !causes.is_empty()));
        Self {
            causes,
            shown_by,
            expressed_in,
            driver,
            ..Self::default()
        }
    }

    /// A rotated base, or one that moves backwards, makes its sensors look wrongly mounted.
    pub(crate) fn leave_mounting_to_body(&mut self, goes_backward: bool) {
        self.goes_backward = goes_backward;
        if self.causes.iter().any(|cause| cause.is_of_mounting) {
            self.shown_by = Some(Aspect::Body);
        }
    }

    /// A sentence on the faults, for the detail of a finding; empty if none is known.
    pub(crate) fn sentence(&self) -> String {
        match self.causes.as_slice() {
            [] => String::new(),
            [one] if one.twin.is_none() => format!("Only this cause fits all measurements: {}.", one.text),
            _ => "Several causes fit all measurements, and the data do not show which it is: see the help.".to_owned(),
        }
    }

    /// The word of the relation, if one fault fits.
    pub(crate) fn word(&self) -> Option<&'static str> {
        match self.causes.as_slice() {
            [one] => Some(one.word),
            _ => None,
        }
    }

    /// What to do: where several causes fit, each with its remedy.
    pub(crate) fn help(&self) -> Option<String> {
        let help = match self.causes.as_slice() {
            [] => return None,
            [one] if one.twin.is_none() => one.help.to_owned(),
            several => format!(
                "look up the sensor's axes in its data sheet, and correct the cause that applies:{}",
                numbered(several)
            ),
        };
        let is_of_driver = self.causes.iter().any(|cause| cause.is_of_driver);
        Some(match self.driver.as_ref().filter(|_| is_of_driver) {
            Some(driver) => format!(
                "the driver seems to be that of {}, which measures in {}: {}. If that is not it, {help}",
                driver.name, driver.native, driver.setting
            ),
            None => help,
        })
    }
}

/// The causes with what to do, each on a line of its own, with a number.
fn numbered(causes: &[&Cause]) -> String {
    let pairs = causes
        .iter()
        .flat_map(|cause| [Some((cause.text, cause.help)), cause.twin]);
    let lines = (1..)
        .zip(pairs.flatten())
        .map(|(number, (cause, help))| format!("\n({number}) {cause}: {help}"));
    lines.collect()
}

/// A wrong driver setting that the measurements do not rule out. A heading instead of a yaw is judged by itself.
pub(crate) fn unseen(seen: Symptoms) -> Option<&'static Cause> {
    let is_setting = |cause: &&Cause| cause.is_of_driver && cause.word != "compass-yaw";
    CAUSES.iter().find(|cause| is_setting(cause) && cause.fits(seen))
}

/// Whether a measurement shows something wrong.
fn shows(seen: Symptoms, aspect: Aspect) -> bool {
    match aspect {
        Aspect::Base => seen.base.is_some_and(|base| base != Base::Up),
        Aspect::World => seen.world.is_some_and(|world| world != World::Up),
        Aspect::Turn => seen
            .turn
            .is_some_and(|turn| turn != Turn::Ordered && !HEALTHY.turn.contains(&turn)),
        Aspect::Heading => seen.heading == Some(Heading::Against),
        Aspect::Sense => seen.sense == Some(Sense::Against),
        Aspect::Push => seen.push.is_some_and(|push| push != Push::Forward),
        Aspect::Hand => seen.hand == Some(Hand::Left),
        Aspect::AngleOrder | Aspect::Body => false,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::analysis::axes::causes::Readings;

    fn words(seen: Symptoms) -> (Vec<&'static str>, Option<Aspect>) {
        let diagnosis = Diagnosis::of(seen, &StreamConvention::default(), None);
        (
            diagnosis.causes.iter().map(|cause| cause.word).collect(),
            diagnosis.shown_by,
        )
    }

    #[test]
    fn a_healthy_sensor_has_no_fault_however_little_was_seen() {
        assert_eq!(words(Symptoms::default()), (vec![], None));
        let seen = Symptoms {
            base: Some(Base::Up),
            turn: Some(Turn::Agree),
            ..Symptoms::default()
        };
        assert_eq!(words(seen), (vec![], None));
    }

    #[test]
    fn a_track_distinguishes_a_negated_accelerometer_from_a_sensor_in_ned() {
        let still = Symptoms {
            world: Some(World::Down),
            base: Some(Base::Down),
            turn: Some(Turn::Agree),
            ..Symptoms::default()
        };
        assert_eq!(words(still), (vec!["ned-frd", "gravity-sign"], Some(Aspect::World)));
        let driven = Symptoms {
            heading: Some(Heading::Against),
            ..still
        };
        assert_eq!(words(driven), (vec!["ned-frd"], Some(Aspect::World)));
        let pushed = Symptoms {
            heading: Some(Heading::With),
            push: Some(Push::Backward),
            ..still
        };
        assert_eq!(words(pushed), (vec!["gravity-sign"], Some(Aspect::Base)));
    }

    #[test]
    fn the_other_measurements_rule_out_some_of_several_equal_readings() {
        let seen = Symptoms {
            turn: Some(Turn::OneOf(Readings::of(&[Turn::Inverse, Turn::Reordered]))),
            ..Symptoms::default()
        };
        assert_eq!(words(seen), (vec!["inverse", "wxyz"], Some(Aspect::Turn)));
        let down = Symptoms {
            world: Some(World::Down),
            ..seen
        };
        assert_eq!(words(down), (vec!["wxyz"], Some(Aspect::Turn)));
    }

    #[test]
    fn what_no_single_fault_explains_is_shown_by_none() {
        let seen = Symptoms {
            base: Some(Base::Side),
            heading: Some(Heading::Against),
            ..Symptoms::default()
        };
        assert_eq!(words(seen), (vec![], None));
    }

    #[test]
    fn the_order_of_angles_is_a_fault_beside_the_others() {
        let seen = Symptoms {
            turn: Some(Turn::Ordered),
            world: Some(World::Elsewhere),
            ..Symptoms::default()
        };
        assert_eq!(words(seen), (vec![], Some(Aspect::AngleOrder)));
        let in_ned = Symptoms {
            world: Some(World::Down),
            base: Some(Base::Down),
            heading: Some(Heading::Against),
            ..seen
        };
        assert_eq!(words(in_ned), (vec!["ned-frd"], Some(Aspect::World)));
    }

    #[test]
    fn every_fault_is_shown_by_a_measurement() {
        for cause in CAUSES {
            assert!(ORDER.contains(&cause.shown_by), "{}", cause.word);
            assert!(!HEALTHY.eq(cause));
        }
    }
}
