//! The axes that a frame's name states, and the rotations that match them.
//!
//! Must not know the world.

use crate::math::constants::AxisTurn;
use crate::world::FrameId;

/// The axes that a name states.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(crate) enum Axes {
    /// North, east, down.
    Ned,
    /// East, north, up.
    Enu,
    /// North, west, up.
    Nwu,
}

impl Axes {
    /// The axes that the tokens of a name state.
    pub(crate) fn of(frame: &FrameId) -> Option<Self> {
        [Self::Ned, Self::Enu, Self::Nwu]
            .into_iter()
            .find(|axes| frame.has_token(axes.word()))
    }

    /// The token.
    pub(crate) fn word(self) -> &'static str {
        match self {
            Self::Ned => "ned",
            Self::Enu => "enu",
            Self::Nwu => "nwu",
        }
    }

    /// The rotations that `sibling_from_frame` may have, where the sibling has the axes of REP-103. A platform's `_ned`
    /// frame is either its forward-right-down frame or rotated like the world axes, depending on who defined it.
    pub(crate) fn expected(self, is_world: bool) -> &'static [Option<AxisTurn>] {
        match (self, is_world) {
            (Self::Ned, true) => &[Some(AxisTurn::NedEnu)],
            (Self::Ned, false) => &[Some(AxisTurn::FluFrd), Some(AxisTurn::NedEnu)],
            (Self::Enu, true) => &[None],
            (Self::Enu, false) => &[None, Some(AxisTurn::ZMinus90), Some(AxisTurn::Z90)],
            (Self::Nwu, true) => &[Some(AxisTurn::Z90)],
            (Self::Nwu, false) => &[None, Some(AxisTurn::Z90)],
        }
    }
}

/// The body axes that a word in a name states.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(crate) enum BodyAxes {
    /// Forward, right, down.
    Frd,
    /// Forward, left, up.
    Flu,
    /// No word: forward-left-up by REP-103.
    Plain,
}

impl BodyAxes {
    /// The axes that the tokens of a name state; `None` without such a token.
    pub(crate) fn of(frame: &FrameId) -> Option<Self> {
        [Self::Frd, Self::Flu]
            .into_iter()
            .find(|axes| frame.has_token(axes.word()))
    }

    /// The token.
    pub(crate) fn word(self) -> &'static str {
        match self {
            Self::Frd => "frd",
            Self::Flu => "flu",
            Self::Plain => "",
        }
    }

    /// The rotation between a frame of these axes and one of the other's.
    pub(crate) fn turn(self, other: Self) -> Option<AxisTurn> {
        ((self == Self::Frd) != (other == Self::Frd)).then_some(AxisTurn::FluFrd)
    }

    /// The axes of a name, and its other tokens.
    pub(crate) fn split(frame: &FrameId) -> (Self, Vec<String>) {
        let axes = Self::of(frame).unwrap_or(Self::Plain);
        let stem = frame.tokens().into_iter().filter(|token| token != axes.word());
        (axes, stem.collect())
    }
}
