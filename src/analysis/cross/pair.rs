//! Statements about rigid transforms, and two of them side by side.

use nalgebra::Isometry3;

use crate::math::relation::{Classification, Tolerance, classify, classify_rotation};
use crate::source::{Confidence, Place};
use crate::world::{FrameId, World};

/// How far a source is trusted to be the one that is right, when two disagree: descriptions before files.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Rank {
    Urdf,
    Description,
    Tf,
    File,
}

/// How a statement was brought to a pair.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Direction {
    /// As it was stated.
    AsStated,
    /// It was stated as `source_from_target`.
    TurnedRound,
}

/// One source's word on `target_from_source`, of a rigid pair.
#[derive(Clone, Debug)]
pub(crate) struct Statement {
    /// Target (parent) frame, canonical.
    pub(crate) target: FrameId,
    /// Source (child) frame, canonical.
    pub(crate) source_frame: FrameId,
    /// `target_from_source`.
    pub(crate) pose: Isometry3<f64>,
    /// Whether a rotation was stated.
    pub(crate) has_rotation: bool,
    /// Whether a translation was stated.
    pub(crate) has_translation: bool,
    /// Who says so, in words.
    pub(crate) who: String,
    /// Where.
    pub(crate) place: Place,
    /// How sure the reading of the statement is.
    pub(crate) reading: Confidence,
    /// The key or joint it stands under.
    pub(crate) label: String,
    /// The angles it is spelled in, radians as read.
    pub(crate) rpy: Option<[f64; 3]>,
    /// Whether `pose` is as stated.
    pub(crate) direction: Direction,
    pub(super) rank: Rank,
    pub(super) bare_quaternion: bool,
    /// What the source itself calls the two frames.
    pub(crate) called: (FrameId, FrameId),
    /// The dialect whose names for its sensors (`lidar`, `imu`) its frames are; `None` where they are names of the platform's frames.
    pub(super) roles: Option<String>,
}

impl Statement {
    /// Whether it was spelled as a quaternion.
    pub(crate) fn is_bare_quaternion(&self) -> bool {
        self.bare_quaternion
    }

    /// Whether its frames are a program's words for its sensors.
    pub(crate) fn is_guess(&self) -> bool {
        self.roles.is_some()
    }

    /// Whether a calibration file states it.
    pub(crate) fn is_of_a_file(&self) -> bool {
        self.rank == Rank::File
    }
}

/// Two statements about one pair, the more trusted one first, both as `target_from_source` of the first.
#[derive(Clone, Debug)]
pub(crate) struct Pair {
    /// The statement taken for the reference.
    pub(crate) reference: Statement,
    /// The statement held against it, turned to the reference's direction where it was stated the other way round.
    pub(crate) other: Statement,
    /// Whether the two stand under the same key of sibling files: perhaps alternatives, not a disagreement.
    pub(crate) alternatives: bool,
    /// Why it says nothing new, where an earlier pair is of the same two transforms: other sources repeat what these say.
    pub(crate) repeats: Option<String>,
    /// Statements that agree with the first of the two (`false`) or with the second (`true`).
    pub(crate) seconded_by: Vec<(bool, Place, String)>,
}

impl Pair {
    /// What is judged, in words.
    pub(crate) fn subject(&self, world: &World) -> String {
        format!(
            "`{}` from `{}`: {} and {}",
            self.reference.target,
            self.reference.source_frame,
            world.path(self.reference.place.source),
            world.path(self.other.place.source),
        )
    }

    /// How sure the reading of both is.
    pub(crate) fn reading(&self) -> Confidence {
        self.reading_with(Confidence::Hint)
    }

    /// The same, where the names of a program's sensors are as sure as this. That two files mean one sensor by `lidar` is a guess, unless
    /// their numbers tell.
    pub(crate) fn reading_with(&self, roles: Confidence) -> Confidence {
        let most = if self.is_by_role() { roles } else { Confidence::Certain };
        self.reference.reading.min(self.other.reading).min(most)
    }

    /// Whether only a program's words for its sensors say that both speak of the same frames.
    pub(crate) fn is_by_role(&self) -> bool {
        let (a, b) = (&self.reference, &self.other);
        (a.roles.is_some() || b.roles.is_some()) && a.place.source != b.place.source
    }

    /// Which names were taken for which: `` `body` and `cam0` for `imu` and `camera` ``.
    pub(crate) fn taken(&self) -> String {
        let names = |one: &Statement| format!("`{}` and `{}`", one.called.0, one.called.1);
        format!("{} for {}", names(&self.other), names(&self.reference))
    }

    /// The same pair in the other direction. `None` where one of the two states a half, which cannot be turned.
    pub(crate) fn turned(&self) -> Option<Self> {
        let turn = |one: &Statement| {
            (one.has_rotation && one.has_translation).then(|| Statement {
                target: one.source_frame.clone(),
                source_frame: one.target.clone(),
                called: (one.called.1.clone(), one.called.0.clone()),
                pose: one.pose.inverse(),
                direction: match one.direction {
                    Direction::AsStated => Direction::TurnedRound,
                    Direction::TurnedRound => Direction::AsStated,
                },
                who: match one.who.strip_suffix(TURNED) {
                    Some(who) => who.to_owned(),
                    None => format!("{}{TURNED}", one.who),
                },
                ..one.clone()
            })
        };
        Some(Self {
            reference: turn(&self.reference)?,
            other: turn(&self.other)?,
            ..self.clone()
        })
    }

    /// Takes the other statement for the reference.
    pub(crate) fn swap(&mut self) {
        std::mem::swap(&mut self.reference, &mut self.other);
        for (with_other, ..) in &mut self.seconded_by {
            *with_other = !*with_other;
        }
    }

    /// The relation between the two and their plain difference; parts that one does not state are not compared.
    pub(crate) fn classify(&self) -> Classification {
        let tolerance = Tolerance::default();
        let (a, b) = (&self.reference, &self.other);
        if a.has_translation && b.has_translation {
            let mut a_pose = a.pose;
            if !(a.has_rotation && b.has_rotation) {
                a_pose.rotation = b.pose.rotation;
            }
            return classify(&a_pose, &b.pose, &tolerance);
        }
        classify_rotation(&a.pose.rotation, &b.pose.rotation, &tolerance)
    }
}

/// Behind who states a transform the other way round than it is compared.
pub(super) const TURNED: &str = " (the other way round)";
