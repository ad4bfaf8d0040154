//! Known faults of inertial sensors, and what each of them does to every measurement.
//!
//! Owns the classes of the measurements and the table of faults. Must not measure, nor decide which rule reports.

use crate::analysis::motion::StreamConvention;

/// A measurement of a sensor.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Aspect {
    /// Direction of the acceleration in the base.
    Base,
    /// Direction of the acceleration in the world.
    World,
    /// Rotation of the orientation compared with the gyro.
    Turn,
    /// Sense of the yaw compared with the course.
    Heading,
    /// Sense of the gyro compared with the track.
    Sense,
    /// The axis of the acceleration when the platform speeds up.
    Push,
    /// Whether the acceleration in curves and the one when the platform speeds up are right-handed.
    Hand,
    /// Order of the Euler angles behind the orientation.
    AngleOrder,
    /// Axes of the base that the sensor is mounted on.
    Body,
}

/// Direction of the acceleration at rest in the base.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Base {
    /// Up, which is correct.
    Up,
    /// Down.
    Down,
    /// Neither.
    Side,
}

/// Direction of the acceleration, rotated into the world by the orientation.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum World {
    /// Up, which is correct.
    Up,
    /// Down.
    Down,
    /// Another direction, steadily.
    Elsewhere,
    /// Steadily off up, but by less than any convention error.
    Leaning,
    /// Far from up on average, but not steadily: faulty, with an unknown fault.
    Far,
}

/// Rotation of the orientation compared with the gyro.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Turn {
    /// As its integral.
    Agree,
    /// As its integral, with hardly any rotation about z.
    Tilting,
    /// Opposite; the inverse orientation agrees best.
    Inverse,
    /// Opposite; a gyro with y and z negated agrees best.
    Frd,
    /// Opposite; a negated gyro agrees best.
    Negated,
    /// Opposite about z alone.
    Yaw,
    /// Opposite; the data cannot distinguish the four above.
    Reversed,
    /// As its integral in another reading; the data cannot distinguish these readings.
    OneOf(Readings),
    /// As its integral when the quaternion is read as `w x y z`.
    Reordered,
    /// As its integral when it is read as `w x y z` and inverted.
    ReorderedInverse,
    /// Not about every axis.
    Partly,
    /// As its integral when its Euler angles are composed in the order of ROS.
    Ordered,
    /// Not as its integral in any reading.
    Unrelated,
}

/// Readings of an orientation and its gyro that explain the data equally well.
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

    /// The named readings of a list.
    pub(crate) fn of(turns: &[Turn]) -> Self {
        let bits = Self::KNOWN.iter().enumerate();
        Self(bits.fold(0, |sum, (bit, known)| sum | u8::from(turns.contains(known)) << bit))
    }

    fn has(self, turn: Turn) -> bool {
        let bit = Self::KNOWN.iter().position(|known| *known == turn);
        bit.is_some_and(|bit| self.0 >> bit & 1 == 1)
    }
}

/// Sense of the orientation's yaw compared with the course.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Heading {
    /// With it.
    With,
    /// Against it.
    Against,
}

/// Sense of the gyro's yaw rate compared with the track.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Sense {
    /// With it.
    With,
    /// Against it.
    Against,
}

/// The axis of the base along which the platform's changes of speed are measured.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Push {
    /// x.
    Forward,
    /// -x.
    Backward,
    /// y or -y.
    Sideways,
    /// Between axes.
    Oblique,
}

/// The acceleration in a curve to the left, compared with the one when the platform speeds up.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Hand {
    /// To its left, which is correct.
    Right,
    /// To its right.
    Left,
}

/// The classes of one sensor's measurements; `None` where a measurement was not possible.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct Symptoms {
    pub(crate) base: Option<Base>,
    pub(crate) world: Option<World>,
    pub(crate) turn: Option<Turn>,
    pub(crate) heading: Option<Heading>,
    pub(crate) sense: Option<Sense>,
    pub(crate) push: Option<Push>,
    pub(crate) hand: Option<Hand>,
}

/// A fault.
#[derive(Debug, PartialEq, Eq)]
pub(crate) struct Cause {
    /// A stable word.
    pub(crate) word: &'static str,
    /// What it is, as a clause for reports.
    pub(crate) text: &'static str,
    /// What to do, in the imperative.
    pub(crate) help: &'static str,
    /// Another cause with the same measurements, and what to do then.
    pub(crate) twin: Option<(&'static str, &'static str)>,
    /// The measurement that shows it best, if it shows there.
    pub(crate) shown_by: Aspect,
    /// Whether a driver setting can cause it.
    pub(crate) is_of_driver: bool,
    /// Whether a rotated base makes its sensors look like that.
    pub(crate) is_of_mounting: bool,
    base: &'static [Base],
    world: &'static [World],
    pub(crate) turn: &'static [Turn],
    heading: &'static [Heading],
    sense: &'static [Sense],
    push: &'static [Push],
    hand: &'static [Hand],
}

/// With an unknown mounting yaw, a negated axis may be along any horizontal axis of the base.
const ANY_PUSH: &[Push] = &[Push::Forward, Push::Backward, Push::Sideways, Push::Oblique];
const ANY_HAND: &[Hand] = &[Hand::Right, Hand::Left];

/// A healthy sensor's measurements.
pub(crate) const HEALTHY: Cause = Cause {
    word: "healthy",
    text: "",
    help: "",
    twin: None,
    shown_by: Aspect::Base,
    is_of_driver: false,
    is_of_mounting: false,
    base: &[Base::Up],
    world: &[World::Up],
    turn: &[Turn::Agree, Turn::Tilting],
    heading: &[Heading::With],
    sense: &[Sense::With],
    push: &[Push::Forward],
    hand: &[Hand::Right],
};

/// All data of a sensor in the other convention.
const NED: Cause = Cause {
    word: "ned-frd",
    text: "all of its data are expressed in NED/FRD axes (world: north, east, down; body: forward, right, down)",
    help: "switch the driver to ENU, or convert `R_enu_flu = P * R_ned_frd * F` (P: NED to ENU, F: FRD to FLU) and negate y and z \
           of gyro and accelerometer",
    twin: None,
    shown_by: Aspect::World,
    is_of_driver: true,
    is_of_mounting: false,
    base: &[Base::Down],
    world: &[World::Down],
    turn: &[Turn::Agree, Turn::Tilting],
    heading: &[Heading::Against],
    sense: &[Sense::Against],
    push: ANY_PUSH,
    hand: &[Hand::Left],
};

/// The known faults, each alone.
pub(crate) const CAUSES: &[Cause] = &[
    NED,
    Cause {
        word: "ned-world",
        text: "the world of the orientation is NED, while its body is FLU",
        help: "convert the orientation to an ENU world: `R_enu_flu = P * R_ned_flu` (P: NED to ENU)",
        shown_by: Aspect::World,
        world: &[World::Down],
        heading: &[Heading::Against],
        ..HEALTHY
    },
    Cause {
        word: "mirrored",
        text: "the track that the IMU is compared with is mirrored (on a map, its left curves appear as right curves)",
        help: "correct the track (the order of latitude and longitude, or of x and y), and leave the IMU as it is",
        twin: Some((
            "all of its data are expressed in left-handed axes (y to the right, z up)",
            "negate y of the acceleration, and x and z of the angular velocity and of the quaternion",
        )),
        shown_by: Aspect::Heading,
        heading: &[Heading::Against],
        sense: &[Sense::Against],
        push: ANY_PUSH,
        hand: &[Hand::Left],
        ..HEALTHY
    },
    Cause {
        word: "ned-orientation",
        text: "the orientation alone is expressed in NED/FRD axes",
        help: "convert the orientation: `R_enu_flu = P * R_ned_frd * F` (P: NED to ENU, F: FRD to FLU)",
        shown_by: Aspect::Turn,
        is_of_driver: true,
        // Roll and pitch with the opposite sign double the tilt of a leaning body.
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
        text: "the orientation is inverted (body_from_world, or a JPL quaternion read as Hamilton)",
        help: "conjugate the quaternion (negate x, y and z)",
        shown_by: Aspect::Turn,
        world: &[World::Up, World::Elsewhere],
        turn: &[Turn::Inverse, Turn::Reversed],
        heading: &[Heading::Against],
        ..HEALTHY
    },
    Cause {
        word: "wxyz",
        text: "the quaternion is in the order w, x, y, z",
        help: "publish the quaternion as x, y, z, w",
        shown_by: Aspect::Turn,
        world: &[World::Up, World::Down, World::Elsewhere],
        turn: &[Turn::Reordered],
        heading: &[Heading::With, Heading::Against],
        ..HEALTHY
    },
    Cause {
        word: "wxyz-inverse",
        text: "the quaternion is in the order w, x, y, z, and inverted",
        help: "publish the quaternion as x, y, z, w, and conjugate it (negate x, y and z)",
        shown_by: Aspect::Turn,
        world: &[World::Up, World::Down, World::Elsewhere],
        turn: &[Turn::ReorderedInverse],
        heading: &[Heading::With, Heading::Against],
        ..HEALTHY
    },
    Cause {
        word: "sensor-frd",
        text: "gyro and accelerometer are expressed in FRD axes (y right, z down), but the orientation is not",
        help: "negate y and z of gyro and accelerometer, or give them their own frame, rotated by 180 deg about x in TF",
        shown_by: Aspect::Turn,
        is_of_mounting: true,
        base: &[Base::Down],
        world: &[World::Down, World::Elsewhere],
        turn: &[Turn::Frd, Turn::Reversed],
        sense: &[Sense::Against],
        push: ANY_PUSH,
        hand: &[Hand::Left],
        ..HEALTHY
    },
    Cause {
        word: "gyro-negated",
        text: "the angular velocity has the opposite sign",
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
        text: "only the body of the orientation is FRD; its world is correct",
        help: "convert the body of the orientation to FLU: `R_enu_flu = R_enu_frd * F` (F: FRD to FLU)",
        shown_by: Aspect::World,
        world: &[World::Down],
        turn: &[Turn::Frd, Turn::Reversed],
        ..HEALTHY
    },
    Cause {
        word: "gravity-sign",
        text: "the acceleration has the opposite sign: it is gravity, not specific force",
        help: "negate the acceleration: at rest and level, z reads +9.81 m/s2 (REP-145)",
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
        help: "give the sensor its own frame, and publish its transform with roll = 180 deg in TF or URDF",
        shown_by: Aspect::Base,
        is_of_mounting: true,
        base: &[Base::Down],
        sense: &[Sense::Against],
        push: ANY_PUSH,
        hand: &[Hand::Left],
        ..HEALTHY
    },
    Cause {
        word: "on-its-side",
        text: "the sensor is mounted on its side, and TF does not say so",
        help: "give the sensor a frame of its own where it has none, and add its rotation to its transform in TF or URDF",
        shown_by: Aspect::Base,
        is_of_mounting: true,
        base: &[Base::Side],
        sense: &[Sense::With, Sense::Against],
        push: ANY_PUSH,
        hand: ANY_HAND,
        ..HEALTHY
    },
    Cause {
        word: "turned-mount",
        text: "the sensor is mounted with a yaw, and TF does not say so",
        help: "give the sensor a frame of its own where it has none, and add the missing yaw (measured above) to its transform in TF or URDF",
        shown_by: Aspect::Push,
        is_of_mounting: true,
        push: &[Push::Backward, Push::Sideways, Push::Oblique],
        ..HEALTHY
    },
    Cause {
        word: "left-handed-accelerometer",
        text: "the axes of the accelerometer are left-handed (one is negated, or two are swapped)",
        help: "correct the axes of the acceleration: x must be positive when the platform speeds up, and y in a curve to the left",
        shown_by: Aspect::Hand,
        push: ANY_PUSH,
        hand: &[Hand::Left],
        ..HEALTHY
    },
];

/// The first fault, for a sensor whose data are declared as NED.
const NOT_NED: Cause = Cause {
    word: "enu-flu",
    text: "all of its data are expressed in ENU/FLU axes (world: east, north, up; body: forward, left, up)",
    help: "correct the declaration or the frame's name, or switch the driver to NED",
    is_of_driver: false,
    ..NED
};

impl Cause {
    /// The fault as it is called for a sensor whose data were converted from a declared convention.
    pub(crate) fn seen_from(&'static self, expressed_in: &StreamConvention) -> &'static Self {
        if *self == NED && expressed_in.is_ned() {
            &NOT_NED
        } else {
            self
        }
    }

    pub(crate) fn fits(&self, seen: Symptoms) -> bool {
        fn any<T: PartialEq>(seen: Option<T>, allowed: &[T]) -> bool {
            seen.is_none_or(|seen| allowed.contains(&seen))
        }
        any(seen.base, self.base)
            && any(seen.world, self.world)
            && self.turns_as(seen.turn)
            && any(seen.heading, self.heading)
            && any(seen.sense, self.sense)
            && any(seen.push, self.push)
            && any(seen.hand, self.hand)
            // A direction alone is that of a mounting.
            && (self.shown_by != Aspect::Hand || seen.hand.is_some())
    }

    fn turns_as(&self, seen: Option<Turn>) -> bool {
        match seen {
            None => true,
            Some(Turn::OneOf(readings)) => self.turn.iter().any(|turn| readings.has(*turn)),
            Some(turn) => self.turn.contains(&turn),
        }
    }
}
