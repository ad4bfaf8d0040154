//! What may be wrong with an inertial sensor, and what each fault makes the measurements say.
//!
//! Owns the words for what is measured, and the table. Must not measure, nor decide who reports.

use crate::analysis::motion::ExpressedIn;

/// What is measured of a sensor.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Aspect {
    /// Where the acceleration points in the base.
    Base,
    /// Where the acceleration points in the world.
    World,
    /// How the orientation turns against the gyro.
    Turn,
    /// How the yaw turns against the course.
    Heading,
    /// How the gyro turns against the track.
    Sense,
    /// Which axis speeds up.
    Push,
    /// In which order the angles behind the orientation are put together.
    AngleOrder,
    /// How the base that the sensor is mounted on is turned.
    Body,
}

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
    /// Beside up, steadily, by less than any convention error turns it.
    Leaning,
    /// Far from up in the mean, though not steadily. It says which fault it is as little as it is healthy.
    Far,
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
    /// As its integral once it is read otherwise; of several readings it cannot be told which.
    OneOf(Readings),
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

/// Readings of an orientation and its gyro that serve alike.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct Readings(u8);

impl Readings {
    const KNOWN: [Turn; 6] = [
        Turn::Inverse,
        Turn::Reordered,
        Turn::ReorderedInverse,
        Turn::Frd,
        Turn::Negated,
        Turn::Yaw,
    ];

    /// Those of a list that have a name.
    pub(crate) fn of(turns: &[Turn]) -> Self {
        let bits = Self::KNOWN.iter().enumerate();
        Self(bits.fold(0, |sum, (bit, known)| sum | u8::from(turns.contains(known)) << bit))
    }

    fn has(self, turn: Turn) -> bool {
        let bit = Self::KNOWN.iter().position(|known| *known == turn);
        bit.is_some_and(|bit| self.0 >> bit & 1 == 1)
    }
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
    /// The measurement that shows it best, where it shows there.
    pub(crate) shown_by: Aspect,
    /// Whether a setting of the driver may give it.
    pub(crate) is_of_driver: bool,
    /// Whether a base that is turned itself makes its sensors look like that.
    pub(crate) is_of_mounting: bool,
    base: &'static [Base],
    world: &'static [World],
    pub(crate) turn: &'static [Turn],
    heading: &'static [Heading],
    sense: &'static [Sense],
    push: &'static [Push],
}

/// Of a sensor that is mounted with a yaw, an axis with the other sign may be any of the base's.
const ANY_PUSH: &[Push] = &[Push::Forward, Push::Backward, Push::Sideways];

/// A healthy sensor's measurements.
pub(crate) const HEALTHY: Cause = Cause {
    word: "healthy",
    text: "",
    help: "",
    shown_by: Aspect::Base,
    is_of_driver: false,
    is_of_mounting: false,
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
    text: "all of it is expressed in NED/FRD axes (x forward, y right, z down, in a world of north, east, down)",
    help: "switch the driver to ENU, or convert: `R_enu_flu = P * R_ned_frd * F`, and negate y and z of gyro and accelerometer",
    shown_by: Aspect::World,
    is_of_driver: true,
    is_of_mounting: false,
    base: &[Base::Down],
    world: &[World::Down],
    turn: &[Turn::Agree, Turn::Tilting],
    heading: &[Heading::Against],
    sense: &[Sense::Against],
    push: ANY_PUSH,
};

/// The faults that are known, each alone.
pub(crate) const CAUSES: &[Cause] = &[
    NED,
    Cause {
        word: "ned-world",
        text: "the world of the orientation is north, east, down, where its body is forward, left, up",
        help: "turn the orientation into ENU: `R_enu_flu = P * R_ned_flu`",
        shown_by: Aspect::World,
        world: &[World::Down],
        heading: &[Heading::Against],
        ..HEALTHY
    },
    Cause {
        word: "mirrored",
        text: "all of it is expressed in left-handed axes (y to the right), or the track that it is held against is a mirror image",
        help: "negate y of the acceleration, x and z of the angular velocity and of the quaternion; or look at the order of latitude \
               and longitude, or x and y, of the track",
        shown_by: Aspect::Heading,
        heading: &[Heading::Against],
        sense: &[Sense::Against],
        push: ANY_PUSH,
        ..HEALTHY
    },
    Cause {
        word: "ned-orientation",
        text: "the orientation alone is expressed in NED/FRD axes",
        help: "convert the orientation: `R_enu_flu = P * R_ned_frd * F`",
        shown_by: Aspect::Turn,
        is_of_driver: true,
        // Of a body that leans, roll and pitch with the other sign lean it twice as far.
        world: &[World::Up, World::Elsewhere],
        turn: &[Turn::Frd, Turn::Reversed],
        heading: &[Heading::Against],
        ..HEALTHY
    },
    Cause {
        word: "compass-yaw",
        text: "the yaw is a compass heading, clockwise from north",
        help: "publish `yaw_ros = pi/2 - heading`",
        shown_by: Aspect::Heading,
        is_of_driver: true,
        turn: &[Turn::Yaw, Turn::Reversed, Turn::Tilting],
        heading: &[Heading::Against],
        ..HEALTHY
    },
    Cause {
        word: "inverse",
        text: "the orientation is the inverse one (from world to body, or JPL numbers read as Hamilton's)",
        help: "conjugate the quaternion (negate x, y and z): it is the inverse, or JPL numbers read as Hamilton's, and the data cannot \
               tell which",
        shown_by: Aspect::Turn,
        world: &[World::Up, World::Elsewhere],
        turn: &[Turn::Inverse, Turn::Reversed],
        heading: &[Heading::Against],
        ..HEALTHY
    },
    Cause {
        word: "wxyz",
        text: "the four numbers of the orientation stand as w, x, y, z",
        help: "write them as x, y, z, w",
        shown_by: Aspect::Turn,
        world: &[World::Up, World::Down, World::Elsewhere],
        turn: &[Turn::Reordered],
        heading: &[Heading::With, Heading::Against],
        ..HEALTHY
    },
    Cause {
        word: "wxyz-inverse",
        text: "the four numbers of the orientation stand as w, x, y, z, of the inverse one",
        help: "write them as x, y, z, w, and conjugate the quaternion (negate x, y and z)",
        shown_by: Aspect::Turn,
        world: &[World::Up, World::Down, World::Elsewhere],
        turn: &[Turn::ReorderedInverse],
        heading: &[Heading::With, Heading::Against],
        ..HEALTHY
    },
    Cause {
        word: "sensor-frd",
        text: "gyro and accelerometer are expressed in FRD axes (y right, z down), the orientation is not",
        help: "negate y and z of gyro and accelerometer, or give them a frame of their own that TF turns by 180 deg about x",
        shown_by: Aspect::Turn,
        is_of_mounting: true,
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
        shown_by: Aspect::Turn,
        turn: &[Turn::Negated, Turn::Reversed],
        sense: &[Sense::Against],
        ..HEALTHY
    },
    Cause {
        word: "gyro-frd",
        text: "the gyro alone is expressed in FRD axes (y right, z down)",
        help: "negate y and z of the angular velocity",
        shown_by: Aspect::Turn,
        turn: &[Turn::Frd, Turn::Reversed],
        sense: &[Sense::Against],
        ..HEALTHY
    },
    Cause {
        word: "frd-body",
        text: "the body of the orientation alone is forward, right, down: its world is as it should be",
        help: "turn the body of the orientation into FLU: `R_enu_flu = R_enu_frd * F`",
        shown_by: Aspect::World,
        world: &[World::Down],
        turn: &[Turn::Frd, Turn::Reversed],
        ..HEALTHY
    },
    Cause {
        word: "gravity-sign",
        text: "the accelerometer has the other sign: it gives gravity, not specific force",
        help: "negate the acceleration: at rest and level z reads +9.81 (REP-145)",
        shown_by: Aspect::Base,
        is_of_mounting: true,
        base: &[Base::Down],
        world: &[World::Down],
        push: &[Push::Backward],
        ..HEALTHY
    },
    Cause {
        word: "upside-down",
        text: "the sensor is mounted upside down, and TF does not say so",
        help: "turn the sensor's frame by 180 deg about x in TF or URDF",
        shown_by: Aspect::Base,
        is_of_mounting: true,
        base: &[Base::Down],
        sense: &[Sense::Against],
        push: ANY_PUSH,
        ..HEALTHY
    },
    Cause {
        word: "on-its-side",
        text: "the sensor is mounted on its side, and TF does not say so",
        help: "give the sensor's frame its rotation in TF or URDF",
        shown_by: Aspect::Base,
        is_of_mounting: true,
        base: &[Base::Side],
        sense: &[Sense::With, Sense::Against],
        push: ANY_PUSH,
        ..HEALTHY
    },
    Cause {
        word: "turned-mount",
        text: "the sensor is mounted turned about z, or its y axis points forward, and TF does not say so",
        help: "give the sensor's frame its yaw in TF or URDF",
        shown_by: Aspect::Push,
        is_of_mounting: true,
        push: &[Push::Backward, Push::Sideways],
        ..HEALTHY
    },
];

/// What the first of the faults is of a sensor that is said to be expressed in NED.
const NOT_NED: Cause = Cause {
    word: "enu-flu",
    text: "all of it is expressed in ENU and FLU axes (x forward, y left, z up, in a world of east, north, up)",
    help: "correct the declaration or the frame's name; or switch the driver to NED",
    is_of_driver: false,
    ..NED
};

impl Cause {
    /// What the fault is of a sensor whose numbers were brought from what they are said to be expressed in.
    pub(crate) fn seen_from(&'static self, expressed_in: &ExpressedIn) -> &'static Self {
        if *self == NED && expressed_in.is_ned() {
            &NOT_NED
        } else {
            self
        }
    }

    pub(crate) fn fits(&self, seen: Seen) -> bool {
        fn any<T: PartialEq>(seen: Option<T>, told: &[T]) -> bool {
            seen.is_none_or(|seen| told.contains(&seen))
        }
        any(seen.base, self.base)
            && any(seen.world, self.world)
            && self.turns_as(seen.turn)
            && any(seen.heading, self.heading)
            && any(seen.sense, self.sense)
            && any(seen.push, self.push)
    }

    fn turns_as(&self, seen: Option<Turn>) -> bool {
        match seen {
            None => true,
            Some(Turn::OneOf(readings)) => self.turn.iter().any(|turn| readings.has(*turn)),
            Some(turn) => self.turn.contains(&turn),
        }
    }
}
