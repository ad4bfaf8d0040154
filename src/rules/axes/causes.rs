//! What may be wrong with an inertial sensor, and what each fault makes the measurements say.
//!
//! One wrong setting shows in several of them. Where they fit a fault that is known, one rule reports it, and the others
//! point there. Owns the table; must not measure.

use crate::rules::motion::ToldIn;
use crate::tables::{InsDriver, Known};
use crate::verdict::Finding;

/// Where the acceleration at rest points in the base.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Base {
    /// Up, as it should.
    Up,
    /// Down.
    Down,
    /// Neither.
    Side,
}

/// Where the acceleration points in the world, by the orientation.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum World {
    /// Up, as it should.
    Up,
    /// Down.
    Down,
    /// Elsewhere, steadily.
    Elsewhere,
}

/// How the orientation turns against the gyro.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Turn {
    /// As its integral.
    Agree,
    /// As its integral, while it hardly turns about z.
    Tilting,
    /// The other way, and the inverse orientation agrees best.
    Inverse,
    /// The other way, and a gyro with y and z negated agrees best.
    Frd,
    /// The other way, and a negated gyro agrees best.
    Negated,
    /// The other way about z alone.
    Yaw,
    /// The other way; of these it cannot be told which.
    Reversed,
    /// As its integral once the four numbers are read as `w x y z`.
    Reordered,
    /// As its integral once they are read as `w x y z` of the inverse.
    ReorderedInverse,
    /// About one axis only.
    Partly,
    /// As its integral once the angles behind it are put together in the order of ROS.
    Ordered,
    /// It does not.
    Unrelated,
}

/// How the yaw of the orientation turns against the course.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Heading {
    /// With it.
    With,
    /// Against it.
    Against,
}

/// How the gyro's yaw rate turns against the track.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Sense {
    /// With it.
    With,
    /// Against it.
    Against,
}

/// Which axis of the base speeds up when the platform does.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Push {
    /// x.
    Forward,
    /// -x.
    Backward,
    /// y or -y.
    Sideways,
}

/// What the measurements of one sensor say, as far as they could be made.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct Seen {
    pub(crate) base: Option<Base>,
    pub(crate) world: Option<World>,
    pub(crate) turn: Option<Turn>,
    pub(crate) heading: Option<Heading>,
    pub(crate) sense: Option<Sense>,
    pub(crate) push: Option<Push>,
}

/// A fault.
#[derive(Debug, PartialEq, Eq)]
pub(crate) struct Cause {
    /// A stable word.
    pub(crate) word: &'static str,
    /// What it is.
    pub(crate) text: &'static str,
    /// What to do.
    pub(crate) help: &'static str,
    /// The rule that reports it, where it shows there.
    owner: &'static str,
    base: &'static [Base],
    world: &'static [World],
    turn: &'static [Turn],
    heading: &'static [Heading],
    sense: &'static [Sense],
    push: &'static [Push],
}

/// The rules that see a sensor, in the order in which one of them reports what fits several faults.
const ORDER: [&str; 6] = ["AXES03", "AXES01", "QUAT01", "AXES04", "AXES05", "AXES06"];

/// Of a sensor that is mounted with a yaw, an axis with the other sign may be any of the base's.
const ANY_PUSH: &[Push] = &[Push::Forward, Push::Backward, Push::Sideways];

/// A healthy sensor's measurements.
const HEALTHY: Cause = Cause {
    word: "healthy",
    text: "",
    help: "",
    owner: "",
    base: &[Base::Up],
    world: &[World::Up],
    turn: &[Turn::Agree, Turn::Tilting],
    heading: &[Heading::With],
    sense: &[Sense::With],
    push: &[Push::Forward],
};

/// All of a sensor in the other convention.
const NED: Cause = Cause {
    word: "ned-frd",
    text: "all of it is told in NED/FRD axes (x forward, y right, z down, in a world of north, east, down)",
    help: "switch the driver to ENU, or convert: `R_enu_flu = P * R_ned_frd * F`, and negate y and z of gyro and accelerometer",
    owner: "AXES03",
    base: &[Base::Down],
    world: &[World::Down],
    turn: &[Turn::Agree, Turn::Tilting],
    heading: &[Heading::Against],
    sense: &[Sense::Against],
    push: ANY_PUSH,
};

/// The faults that are known, each alone.
const CAUSES: &[Cause] = &[
    NED,
    Cause {
        word: "ned-world",
        text: "the world of the orientation is north, east, down, where its body is forward, left, up",
        help: "turn the orientation into ENU: `R_enu_flu = P * R_ned_flu`",
        owner: "AXES03",
        world: &[World::Down],
        heading: &[Heading::Against],
        ..HEALTHY
    },
    Cause {
        word: "mirrored",
        text: "all of it is told in left-handed axes (y to the right), or the track that it is held against is a mirror image",
        help: "negate y of the acceleration, x and z of the angular velocity and of the quaternion; or look at the order of latitude \
               and longitude, or x and y, of the track",
        owner: "AXES04",
        heading: &[Heading::Against],
        sense: &[Sense::Against],
        push: ANY_PUSH,
        ..HEALTHY
    },
    Cause {
        word: "ned-orientation",
        text: "the orientation alone is told in NED/FRD axes",
        help: "convert the orientation: `R_enu_flu = P * R_ned_frd * F`",
        owner: "QUAT01",
        turn: &[Turn::Frd, Turn::Reversed],
        heading: &[Heading::Against],
        ..HEALTHY
    },
    Cause {
        word: "compass-yaw",
        text: "the yaw is a compass heading, clockwise from north",
        help: "publish `yaw_ros = pi/2 - heading`",
        owner: "AXES04",
        turn: &[Turn::Yaw, Turn::Reversed, Turn::Tilting],
        heading: &[Heading::Against],
        ..HEALTHY
    },
    Cause {
        word: "inverse",
        text: "the orientation is the inverse one (from world to body, or JPL numbers read as Hamilton's)",
        help: "conjugate the quaternion (negate x, y and z): it is the inverse, or JPL numbers read as Hamilton's, and the data cannot \
               tell which",
        owner: "QUAT01",
        world: &[World::Up, World::Elsewhere],
        turn: &[Turn::Inverse, Turn::Reversed],
        heading: &[Heading::Against],
        ..HEALTHY
    },
    Cause {
        word: "wxyz",
        text: "the four numbers of the orientation stand as w, x, y, z",
        help: "write them as x, y, z, w",
        owner: "QUAT01",
        world: &[World::Up, World::Down, World::Elsewhere],
        turn: &[Turn::Reordered],
        heading: &[Heading::With, Heading::Against],
        ..HEALTHY
    },
    Cause {
        word: "wxyz-inverse",
        text: "the four numbers of the orientation stand as w, x, y, z, of the inverse one",
        help: "write them as x, y, z, w, and conjugate the quaternion (negate x, y and z)",
        owner: "QUAT01",
        world: &[World::Up, World::Down, World::Elsewhere],
        turn: &[Turn::ReorderedInverse],
        heading: &[Heading::With, Heading::Against],
        ..HEALTHY
    },
    Cause {
        word: "sensor-frd",
        text: "gyro and accelerometer are told in FRD axes (y right, z down), the orientation is not",
        help: "negate y and z of gyro and accelerometer, or give them a frame of their own that TF turns by 180 deg about x",
        owner: "QUAT01",
        base: &[Base::Down],
        world: &[World::Down, World::Elsewhere],
        turn: &[Turn::Frd, Turn::Reversed],
        sense: &[Sense::Against],
        push: ANY_PUSH,
        ..HEALTHY
    },
    Cause {
        word: "gyro-negated",
        text: "the gyro's rates have the other sign",
        help: "negate the angular velocity",
        owner: "QUAT01",
        turn: &[Turn::Negated, Turn::Reversed],
        sense: &[Sense::Against],
        ..HEALTHY
    },
    Cause {
        word: "gyro-frd",
        text: "the gyro alone is told in FRD axes (y right, z down)",
        help: "negate y and z of the angular velocity",
        owner: "QUAT01",
        turn: &[Turn::Frd, Turn::Reversed],
        sense: &[Sense::Against],
        ..HEALTHY
    },
    Cause {
        word: "frd-body",
        text: "the body of the orientation alone is forward, right, down: its world is as it should be",
        help: "turn the body of the orientation into FLU: `R_enu_flu = R_enu_frd * F`",
        owner: "AXES03",
        world: &[World::Down],
        turn: &[Turn::Frd, Turn::Reversed],
        ..HEALTHY
    },
    Cause {
        word: "gravity-sign",
        text: "the accelerometer has the other sign: it gives gravity, not specific force",
        help: "negate the acceleration: at rest and level z reads +9.81 (REP-145)",
        owner: "AXES01",
        base: &[Base::Down],
        world: &[World::Down],
        push: &[Push::Backward],
        ..HEALTHY
    },
    Cause {
        word: "upside-down",
        text: "the sensor is mounted upside down, and TF does not say so",
        help: "turn the sensor's frame by 180 deg about x in TF or URDF",
        owner: "AXES01",
        base: &[Base::Down],
        sense: &[Sense::Against],
        push: ANY_PUSH,
        ..HEALTHY
    },
    Cause {
        word: "on-its-side",
        text: "the sensor is mounted on its side, and TF does not say so",
        help: "give the sensor's frame its rotation in TF or URDF",
        owner: "AXES01",
        base: &[Base::Side],
        sense: &[Sense::With, Sense::Against],
        push: ANY_PUSH,
        ..HEALTHY
    },
    Cause {
        word: "turned-mount",
        text: "the sensor is mounted turned about z, or its y axis points forward, and TF does not say so",
        help: "give the sensor's frame its yaw in TF or URDF",
        owner: "AXES06",
        push: &[Push::Backward, Push::Sideways],
        ..HEALTHY
    },
];

/// What the first of the faults is of a sensor that is said to be told in NED.
const NOT_NED: Cause = Cause {
    word: "enu-flu",
    text: "all of it is told in ENU and FLU axes (x forward, y left, z up, in a world of east, north, up)",
    help: "correct the declaration or the frame's name; or switch the driver to NED",
    ..NED
};

impl Cause {
    /// What the fault is of a sensor whose numbers were brought from what they are said to be told in.
    fn seen_from(&'static self, told_in: &ToldIn) -> &'static Self {
        if *self == NED && told_in.is_ned() {
            &NOT_NED
        } else {
            self
        }
    }

    fn fits(&self, seen: Seen) -> bool {
        fn any<T: PartialEq>(seen: Option<T>, told: &[T]) -> bool {
            seen.is_none_or(|seen| told.contains(&seen))
        }
        any(seen.base, self.base)
            && any(seen.world, self.world)
            && any(seen.turn, self.turn)
            && any(seen.heading, self.heading)
            && any(seen.sense, self.sense)
            && any(seen.push, self.push)
    }
}

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
    driver: Option<Known<InsDriver>>,
}

impl Diagnosis {
    /// Finds the faults that fit.
    pub(crate) fn of(mut seen: Seen, told_in: &ToldIn, driver: Option<Known<InsDriver>>) -> Self {
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
        const MOUNTINGS: [&str; 5] = [
            "upside-down",
            "on-its-side",
            "turned-mount",
            "gravity-sign",
            "sensor-frd",
        ];
        if self.causes.iter().any(|cause| MOUNTINGS.contains(&cause.word)) {
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
        let is_of_driver = |cause: &&Cause| ["ned-frd", "ned-orientation", "compass-yaw"].contains(&cause.word);
        let driver = self.driver.filter(|_| self.causes.iter().any(is_of_driver));
        Some(driver.map_or_else(
            || help.clone(),
            |driver| {
                format!(
                    "{help}. {} measures in {}: {}",
                    driver.name, driver.facts.native, driver.facts.setting
                )
            },
        ))
    }
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
