//! Statements about rigid transforms, and two of them side by side.

use nalgebra::Isometry3;

use crate::math::relation::{Classification, Tolerance, classify, classify_rotation};
use crate::source::{Confidence, Place};
use crate::world::{FrameId, World};

/// Which source is taken as the reference when two disagree: descriptions before files.
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
    /// It was stated as `source_from_target`, and inverted.
    TurnedRound,
}

/// `target_from_source` of a rigid pair, as one source states it.
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
    /// The name of the statement in messages.
    pub(crate) who: String,
    /// Where.
    pub(crate) place: Place,
    /// How sure the reading of the statement is.
    pub(crate) reading: Confidence,
    /// Its key or joint.
    pub(crate) label: String,
    /// Its angles where it is written with angles, radians as read.
    pub(crate) rpy: Option<[f64; 3]>,
    /// Whether `pose` is as stated or inverted.
    pub(crate) direction: Direction,
    pub(super) rank: Rank,
    pub(super) bare_quaternion: bool,
    /// The key of no known program that alone states its direction: it may mean the other one.
    pub(crate) key: Option<String>,
    /// The names of the two frames in the source.
    pub(crate) called: (FrameId, FrameId),
    /// The dialect whose sensor names (`lidar`, `imu`) its frames are; `None` where they are names of the platform's frames.
    pub(super) roles: Option<String>,
}

impl Statement {
    /// Whether it is written as a quaternion.
    pub(crate) fn is_bare_quaternion(&self) -> bool {
        self.bare_quaternion
    }

    /// Whether its numbers are those of a quaternion: of one that is written, or of TF.
    pub(crate) fn is_quaternion(&self) -> bool {
        self.bare_quaternion || self.rank == Rank::Tf
    }

    /// Whether its frames are a program's names for its sensors.
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
    /// The statement compared with it, inverted where it was stated in the other direction.
    pub(crate) other: Statement,
    /// Whether the two have the same key in two files of one folder: perhaps alternatives, no contradiction.
    pub(crate) alternatives: bool,
    /// Why it adds nothing, where an earlier pair has the same two transforms from other sources.
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

    /// The same, where the names of a program's sensors are as sure as this. That two files mean the same sensor by `lidar` is a guess
    /// unless their numbers show it.
    pub(crate) fn reading_with(&self, roles: Confidence) -> Confidence {
        let most = if self.is_by_role() { roles } else { Confidence::Certain };
        self.reference.reading.min(self.other.reading).min(most)
    }

    /// Whether both are taken to be about the same frames only because of a program's names for its sensors.
    pub(crate) fn is_by_role(&self) -> bool {
        let (a, b) = (&self.reference, &self.other);
        (a.roles.is_some() || b.roles.is_some()) && a.place.source != b.place.source
    }

    /// What both are called in a headline, the other one first; with their files where the names are equal.
    pub(crate) fn names(&self, world: &World) -> [String; 2] {
        let is_same = self.other.who == self.reference.who;
        [&self.other, &self.reference].map(|one| {
            if is_same {
                format!("{} of `{}`", one.who, world.path(one.place.source))
            } else {
                one.who.clone()
            }
        })
    }

    /// The sentence that says which transform both state.
    pub(crate) fn frames_stated(&self) -> String {
        format!(
            "Both are stated as the transform that takes points from `{}` to `{}`.",
            self.reference.source_frame, self.reference.target
        )
    }

    /// Which names were identified: `` `body` and `cam0` are `imu` and `camera` ``.
    pub(crate) fn taken(&self) -> String {
        let names = |one: &Statement| format!("`{}` and `{}`", one.called.0, one.called.1);
        format!("{} are {}", names(&self.other), names(&self.reference))
    }

    /// The same pair in the other direction. `None` where one of the two states only a rotation or a translation, which cannot be inverted.
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

    /// Exchanges the reference and the other statement.
    pub(crate) fn swap(&mut self) {
        std::mem::swap(&mut self.reference, &mut self.other);
        for (with_other, ..) in &mut self.seconded_by {
            *with_other = !*with_other;
        }
    }

    /// The limits of a relation between the two, and whether one of them is written as a quaternion.
    pub(crate) fn tolerance(&self) -> Tolerance {
        Tolerance {
            has_quaternion: self.reference.is_quaternion() || self.other.is_quaternion(),
            ..Tolerance::default()
        }
    }

    /// The relation between the two and their plain difference; parts that one does not state are not compared.
    pub(crate) fn classify(&self) -> Classification {
        let tolerance = self.tolerance();
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

/// Behind the name of a statement that was inverted to be compared.
pub(crate) const TURNED: &str = " (inverted)";
