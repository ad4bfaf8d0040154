//! What an error is: a mistake of the catalogue, or one that is staged beside a recording.

use frames_lint::faults::{self, Family, Fault, Subject, SubjectPlace};
use frames_lint::verdict::{Finding, Row};
use frames_lint::world::World;

use crate::cameras;
use crate::stages::Stage;
use crate::streams::Stream;
use crate::table::STAGED;

/// What a staged error changes.
#[derive(Clone, Copy)]
pub enum Change {
    /// Where an optical frame sits in its parent.
    Frames(fn(nalgebra::Isometry3<f64>) -> nalgebra::Isometry3<f64>),
    /// What is staged beside the evidence.
    Staged(&'static Stage, fn(&mut World, &Stream)),
}

/// An error that the catalogue has no subject for: what has it must be staged first.
pub struct StagedError {
    pub name: &'static str,
    pub change: Change,
    /// Words of relations that name it.
    pub words: &'static [&'static str],
    /// Texts of messages that name it.
    pub texts: &'static [&'static str],
    /// The rules that must see it where they judge the stream.
    pub seen_by: &'static [&'static str],
}

/// An error.
#[derive(Clone, Copy)]
pub enum Error {
    /// Of the catalogue.
    Known(&'static Fault),
    /// Staged.
    Staged(&'static StagedError),
}

/// Every error: of inertial sensors, of poses, of fixes and of their stamps, and of what is staged beside them.
pub fn all() -> impl Iterator<Item = Error> {
    let is_meant = |fault: &&Fault| {
        let families = [Family::Imu, Family::Pose, Family::Fix, Family::Time];
        families.contains(&fault.family)
    };
    let known = faults::catalogue().filter(is_meant).map(Error::Known);
    known.chain(STAGED.iter().copied().flatten().map(Error::Staged))
}

/// A mistake of the catalogue.
pub fn known(name: &str) -> &'static Fault {
    faults::catalogue().find(|fault| fault.name == name).unwrap()
}

/// Puts a mistake of the catalogue into every subject that a stream is; false where it cannot have it.
pub fn inject(fault: &Fault, world: &mut World, stream: &Stream) -> bool {
    let subjects = fault.change.subjects(world);
    let subjects: Vec<Subject> = subjects.into_iter().filter(|subject| is_of(subject, stream)).collect();
    let applied = subjects.iter().filter(|subject| fault.change.apply(world, subject));
    applied.count() > 0
}

/// Whether a subject is a stream, or one of its topics.
fn is_of(subject: &Subject, stream: &Stream) -> bool {
    match &subject.at {
        SubjectPlace::Stream(at) => at == stream,
        SubjectPlace::Topic { bag, topic } => {
            *bag == stream.bag && stream.places.iter().any(|place| place.topic() == topic)
        }
        _ => false,
    }
}

impl Error {
    pub fn name(self) -> &'static str {
        match self {
            Self::Known(fault) => fault.name,
            Self::Staged(error) => error.name,
        }
    }

    /// The rules that must see it where they judge the stream.
    pub fn seen_by(self) -> &'static [&'static str] {
        match self {
            Self::Known(fault) => fault.seen_by,
            Self::Staged(error) => error.seen_by,
        }
    }

    /// Whether a finding names it, alone or among those that it says fit as well; `same` are other relations that change the stream in
    /// the same way. A hint that names it counts here.
    pub fn is_named_by(self, finding: &Finding, same: &[&str]) -> bool {
        match self {
            Self::Known(fault) => fault.is_named_by(&finding.clone().likely(), same),
            Self::Staged(error) => {
                let relation = finding.relation.as_deref();
                relation.is_some_and(|word| error.words.contains(&word))
                    || error.texts.iter().any(|text| finding.text().contains(text))
            }
        }
    }

    /// Whether a finding shows it and names nothing else.
    pub fn is_shown_by(self, finding: &Finding) -> bool {
        let names = finding.relation.as_deref().is_some_and(|word| word != "clockwise-yaw");
        let is_seen = self
            .seen_by()
            .iter()
            .any(|seen| seen.starts_with(finding.rule.as_str()));
        // A base that is tilted shows in the tree, too.
        (is_seen || finding.rule == "TREE13") && !names && !finding.text().contains("Causes that fit all")
    }

    /// Whether a row is of a rule that must see it.
    pub fn is_seen_in(self, row: &Row) -> bool {
        self.seen_by().iter().any(|seen| {
            let (code, subject) = seen.split_once(' ').unwrap_or((seen, ""));
            row.rule == code && (row.subject == "platform" || row.subject.starts_with(subject))
        })
    }

    /// What has to be staged for it.
    pub fn stage(self) -> Option<&'static Stage> {
        match self {
            Self::Staged(StagedError {
                change: Change::Staged(stage, _),
                ..
            }) => Some(stage),
            _ => None,
        }
    }

    /// Other relations that change a stream in the same way.
    pub fn same_as(self, world: &World, stream: &Stream) -> Vec<&'static str> {
        let Self::Known(fault) = self else { return Vec::new() };
        let subjects = fault.change.subjects(world);
        let of_stream = subjects.iter().filter(|subject| is_of(subject, stream));
        of_stream
            .flat_map(|subject| fault.change.same_as(world, subject))
            .collect()
    }

    /// Puts the error into a stream, after its stage; false where it cannot have it.
    pub fn inject(self, world: &mut World, stream: &Stream) -> bool {
        match self {
            Self::Known(fault) => inject(fault, world, stream),
            Self::Staged(error) => match error.change {
                Change::Staged(stage, change) => {
                    stage.family == stream.family && {
                        change(world, stream);
                        true
                    }
                }
                Change::Frames(change) => {
                    stream.family == Family::Camera && {
                        cameras::turn(world, stream, change);
                        true
                    }
                }
            },
        }
    }
}
