//! Conventions that the user declares for topics, frames and files: what the numbers there are expressed in.
//!
//! Owns the words, and which declaration applies to what. Must not know how a configuration is written, nor convert
//! anything.

use globset::GlobMatcher;

use crate::source::Place;

use super::contract::Contract;
use super::frame::FrameId;
use super::projection::Projection;

/// Axes of a world frame.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum WorldAxes {
    /// x east, y north, z up: the convention of ROS (REP-103).
    Enu,
    /// x north, y east, z down.
    Ned,
    /// x north, y west, z up.
    Nwu,
}

/// Axes of a body.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum BodyAxes {
    /// x forward, y left, z up: the convention of ROS (REP-103).
    Flu,
    /// x forward, y right, z down.
    Frd,
}

/// The order of the four numbers of a quaternion.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum QuaternionOrder {
    /// As ROS messages name them.
    Xyzw,
    /// Scalar first.
    Wxyz,
}

/// The algebra that a quaternion is of.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum QuaternionAlgebra {
    /// `ij = k`, as ROS, Eigen and nearly all software.
    Hamilton,
    /// `ji = k`: the same rotation has the conjugate numbers.
    Jpl,
}

/// The scale that stamps count in.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum TimeScale {
    /// As the clocks of computers (POSIX).
    Utc,
    /// Of the satellites: ahead of UTC by the leap seconds since 1980.
    Gps,
    /// Atomic time, as in PTP: ahead of GPS by 19 s.
    Tai,
}

/// Whether fields are what their names suggest, if no type states it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Fields {
    /// They are: results based on them are not guesses.
    Confirmed,
}

macro_rules! words {
    ($type:ty { $($word:literal => $value:ident),* }) => {
        impl $type {
            /// Every value with its word.
            pub const WORDS: &'static [(&'static str, Self)] = &[$(($word, Self::$value)),*];

            /// The word of this value.
            pub fn word(self) -> &'static str {
                match self {
                    $(Self::$value => $word,)*
                }
            }
        }
    };
}

words!(WorldAxes { "ENU" => Enu, "NED" => Ned, "NWU" => Nwu });
words!(BodyAxes { "FLU" => Flu, "FRD" => Frd });
words!(QuaternionOrder { "xyzw" => Xyzw, "wxyz" => Wxyz });
words!(QuaternionAlgebra { "hamilton" => Hamilton, "jpl" => Jpl });
words!(Fields { "confirmed" => Confirmed });
words!(TimeScale { "utc" => Utc, "gps" => Gps, "tai" => Tai });

/// What numbers are expressed in; `None` if nothing is declared.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Convention {
    /// The world frame's axes.
    pub world: Option<WorldAxes>,
    /// The body's axes.
    pub body: Option<BodyAxes>,
    /// The order of quaternions.
    pub order: Option<QuaternionOrder>,
    /// The algebra of quaternions.
    pub algebra: Option<QuaternionAlgebra>,
    /// The scale of stamps.
    pub time: Option<TimeScale>,
    /// Whether fields are what their names suggest.
    pub fields: Option<Fields>,
}

impl Convention {
    /// Takes over the values of another one.
    fn overlay(&mut self, other: Self) {
        self.world = other.world.or(self.world);
        self.body = other.body.or(self.body);
        self.order = other.order.or(self.order);
        self.algebra = other.algebra.or(self.algebra);
        self.time = other.time.or(self.time);
        self.fields = other.fields.or(self.fields);
    }

    /// Whether it declares nothing.
    pub fn is_empty(&self) -> bool {
        *self == Self::default()
    }

    /// Its values in words, with commas: `world NED, body FRD`.
    pub fn words(&self) -> String {
        let parts = [
            self.world.map(|axes| format!("world {}", axes.word())),
            self.body.map(|axes| format!("body {}", axes.word())),
            self.order.map(|order| format!("quaternion order {}", order.word())),
            self.algebra
                .map(|algebra| format!("quaternion algebra {}", algebra.word())),
            self.time
                .map(|scale| format!("stamps in {}", scale.word().to_uppercase())),
        ];
        parts.into_iter().flatten().collect::<Vec<_>>().join(", ")
    }
}

/// The subject of a declaration. `None` matches anything.
#[derive(Clone, Debug, Default)]
pub struct Scope {
    /// Topics.
    pub topic: Option<GlobMatcher>,
    /// Frames: the header's, or the child's.
    pub frame: Option<GlobMatcher>,
    /// Files, by the end of their path.
    pub file: Option<GlobMatcher>,
}

/// One declaration.
#[derive(Clone, Debug)]
pub struct Declaration {
    /// Its subject.
    pub scope: Scope,
    /// Its values.
    pub convention: Convention,
    /// Its place, in words: `frames-lint.yaml:4`.
    pub origin: String,
    /// Its place; `None` if the configuration is not a source of the run.
    pub place: Option<Place>,
}

/// What applies to one subject, and the last declaration of it.
#[derive(Clone, Debug, PartialEq)]
pub struct AppliedConvention {
    /// What was declared.
    pub convention: Convention,
    /// Where, in words.
    pub origin: String,
    /// Where.
    pub place: Option<Place>,
}

/// All declarations, in the order of the configuration: later ones override earlier ones.
#[derive(Clone, Debug, Default)]
pub struct Conventions {
    /// The declarations.
    pub declarations: Vec<Declaration>,
    /// Projections that are declared.
    pub projections: Vec<Projection>,
    /// What recordings hold.
    pub contract: Contract,
    /// Names that files use for frames of the platform, in the order of the configuration.
    pub aliases: Vec<Alias>,
    /// The frames of statements in files.
    pub transforms: Vec<DeclaredTransform>,
}

/// A name that files use for a frame of the platform.
#[derive(Clone, Debug)]
pub struct Alias {
    /// Files, by the end of their path; all where `None`.
    pub file: Option<GlobMatcher>,
    /// The name in files.
    pub name: FrameId,
    /// The frame.
    pub frame: FrameId,
    /// Its place, in words.
    pub origin: String,
}

impl Alias {
    /// Whether it applies to a file.
    pub(crate) fn holds(&self, file: &str) -> bool {
        is_for(self.file.as_ref(), file)
    }
}

/// The frames and direction of a statement, as declared by the user.
#[derive(Clone, Debug)]
pub struct DeclaredTransform {
    /// Files, by the end of their path; all where `None`.
    pub file: Option<GlobMatcher>,
    /// Its key.
    pub key: GlobMatcher,
    /// The frame to which it takes points.
    pub target: FrameId,
    /// The frame from which it takes points.
    pub source: FrameId,
    /// Its place, in words.
    pub origin: String,
}

/// A possible subject of a declaration: a stream of a recording, or a statement in a file.
#[derive(Clone, Copy, Debug, Default)]
pub struct Subject<'a> {
    /// Path of the file.
    pub file: &'a str,
    /// Topic, in a recording.
    pub topic: Option<&'a str>,
    /// Frames that it names.
    pub frames: &'a [&'a FrameId],
}

impl Conventions {
    /// Whether anything is declared that may apply to this file.
    pub fn declare_of(&self, file: &str) -> bool {
        let holds = |one: &Declaration| is_for(one.scope.file.as_ref(), file);
        self.declarations.iter().any(holds)
    }

    /// The platform's frame for a name in a file; later declarations override.
    pub fn frame_of(&self, file: &str, name: &FrameId) -> Option<&FrameId> {
        let name = name.canonical();
        let mut known = self.aliases.iter().rev();
        known
            .find(|alias| alias.name == name && alias.holds(file))
            .map(|alias| &alias.frame)
    }

    /// The frames and direction that are declared for a statement; later declarations override.
    pub fn transform_of(&self, file: &str, key: &str) -> Option<(&FrameId, &FrameId)> {
        let holds = |one: &&DeclaredTransform| one.key.is_match(key) && is_for(one.file.as_ref(), file);
        self.transforms
            .iter()
            .rev()
            .find(holds)
            .map(|one| (&one.target, &one.source))
    }

    /// What is declared for a subject; `None` if nothing is.
    pub fn of(&self, subject: &Subject<'_>) -> Option<AppliedConvention> {
        let mut known: Option<AppliedConvention> = None;
        for declaration in self.declarations.iter().filter(|one| one.scope.holds(subject)) {
            let known = known.get_or_insert_with(|| AppliedConvention {
                convention: Convention::default(),
                origin: String::new(),
                place: None,
            });
            known.convention.overlay(declaration.convention);
            known.origin.clone_from(&declaration.origin);
            known.place.clone_from(&declaration.place);
        }
        known.filter(|known| !known.convention.is_empty())
    }
}

impl Scope {
    fn holds(&self, subject: &Subject<'_>) -> bool {
        let topic = |glob: &GlobMatcher| subject.topic.is_some_and(|topic| glob.is_match(topic));
        let frame = |glob: &GlobMatcher| {
            subject
                .frames
                .iter()
                .any(|frame| glob.is_match(frame.canonical().as_str()))
        };
        self.topic.as_ref().is_none_or(topic)
            && self.frame.as_ref().is_none_or(frame)
            && is_for(self.file.as_ref(), subject.file)
    }
}

/// Whether a file is one of the named ones; all are if none are named.
fn is_for(files: Option<&GlobMatcher>, path: &str) -> bool {
    files.is_none_or(|glob| ends_with(glob, path))
}

/// Whether the glob matches the whole path, or the part after one of its slashes. A glob that begins with a slash means the whole path after it.
pub(crate) fn ends_with(glob: &GlobMatcher, path: &str) -> bool {
    let behind = path.match_indices('/').filter_map(|(at, _)| path.get(at + 1..));
    let is_end = glob.is_match(path) || behind.into_iter().any(|end| glob.is_match(end));
    is_end || glob.glob().glob().starts_with('/') && glob.is_match(format!("/{path}"))
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use globset::Glob;

    use super::*;

    fn glob(text: &str) -> GlobMatcher {
        Glob::new(text).unwrap().compile_matcher()
    }

    #[test]
    fn a_path_is_meant_by_its_end_or_from_its_start() {
        let meant = |text: &str, path: &str| ends_with(&glob(text), path);
        assert!(meant("*.yaml", "old/a/x.yaml") && meant("a/x.yaml", "old/a/x.yaml"));
        assert!(meant("/a/**/*", "a/b/x.yaml") && meant("/a/**/*", "a/x.yaml"));
        assert!(!meant("/a/**/*", "old/a/x.yaml"), "another folder of that name");
        assert!(!meant("*/x.yaml", "x.yaml"), "it lies in no folder");
    }

    fn declaration(scope: Scope, convention: Convention, line: u32) -> Declaration {
        Declaration {
            scope,
            convention,
            origin: format!("frames-lint.yaml:{line}"),
            place: None,
        }
    }

    #[test]
    fn the_later_declaration_overrides_the_earlier_one_and_adds_to_it() {
        let all = Scope {
            topic: Some(glob("/ins/*")),
            ..Scope::default()
        };
        let one = Scope {
            topic: Some(glob("/ins/imu")),
            ..Scope::default()
        };
        let ned = Convention {
            world: Some(WorldAxes::Ned),
            body: Some(BodyAxes::Frd),
            ..Convention::default()
        };
        let flu = Convention {
            body: Some(BodyAxes::Flu),
            ..Convention::default()
        };
        let conventions = Conventions {
            declarations: vec![declaration(all, ned, 2), declaration(one, flu, 5)],
            ..Conventions::default()
        };
        let of = |topic| {
            conventions.of(&Subject {
                topic: Some(topic),
                ..Subject::default()
            })
        };
        let imu = of("/ins/imu").unwrap();
        assert_eq!(imu.convention.words(), "world NED, body FLU");
        assert_eq!(imu.origin, "frames-lint.yaml:5");
        assert_eq!(of("/ins/odom").unwrap().convention, ned);
        assert_eq!(of("/imu"), None);
    }

    #[test]
    fn a_file_is_meant_by_the_end_of_its_path_and_a_frame_without_its_slash() {
        let scope = Scope {
            frame: Some(glob("*_ned")),
            file: Some(glob("run_*.mcap")),
            ..Scope::default()
        };
        let (ned, enu) = (FrameId::new("/odom_ned"), FrameId::new("odom"));
        let holds = |file, frame| {
            scope.holds(&Subject {
                file,
                frames: &[frame],
                ..Subject::default()
            })
        };
        assert!(holds("data/run_1.mcap", &ned));
        assert!(holds("run_1.mcap", &ned));
        assert!(!holds("data/rerun_1.mcap", &ned));
        assert!(!holds("data/run_1.mcap", &enu));
    }
}
