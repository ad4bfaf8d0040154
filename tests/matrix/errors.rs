//! What an error is: a mistake of the catalogue, or one like them whose subject is staged beside a recording first.

use frames_lint::faults::{self, Family, Fault, Subject, SubjectPlace};
use frames_lint::verdict::Finding;
use frames_lint::world::World;

use crate::cameras;
use crate::stages::Stage;
use crate::streams::{self, Stream};
use crate::table::STAGED;

/// What an error changes that is not of the catalogue.
pub enum Change {
    /// Where an optical frame sits in its parent.
    Frames(fn(nalgebra::Isometry3<f64>) -> nalgebra::Isometry3<f64>),
    /// What is staged beside the evidence.
    Staged(&'static Stage, fn(&mut World, &Stream)),
}

/// An error.
#[derive(Clone, Copy)]
pub struct Error {
    pub fault: &'static Fault,
    /// What has to be staged for it.
    pub stage: Option<&'static Stage>,
}

/// Every error: of inertial sensors, of poses, of fixes and of their stamps, and of what is staged beside them.
pub fn all() -> impl Iterator<Item = Error> {
    let is_meant = |fault: &&Fault| {
        let families = [Family::Imu, Family::Pose, Family::Fix, Family::Time];
        families.contains(&fault.family)
    };
    let known = faults::catalogue().filter(is_meant);
    let known = known.map(|fault| Error { fault, stage: None });
    known.chain(STAGED.into_iter().flatten().map(|(fault, change)| Error {
        fault,
        stage: change.stage(),
    }))
}

/// A mistake of the catalogue.
pub fn known(name: &str) -> &'static Fault {
    faults::catalogue().find(|fault| fault.name == name).unwrap()
}

/// Puts a mistake into every subject that a stream is; false where it cannot have it.
pub fn inject(fault: &Fault, world: &mut World, stream: &Stream) -> bool {
    let subjects = subjects(fault, world, stream);
    let applied = subjects.iter().filter(|subject| fault.change.apply(world, subject));
    applied.count() > 0
}

/// What of a stream can have a mistake: the stream, or one of its topics.
fn subjects(fault: &Fault, world: &World, stream: &Stream) -> Vec<Subject> {
    let is_of = |subject: &Subject| match &subject.at {
        SubjectPlace::Stream(at) => at == stream,
        SubjectPlace::Topic { bag, topic } => {
            *bag == stream.bag && stream.places.iter().any(|place| place.topic() == topic)
        }
        _ => false,
    };
    let subjects = fault.change.subjects(world).into_iter();
    subjects.filter(is_of).collect()
}

impl Change {
    pub const fn stage(&self) -> Option<&'static Stage> {
        match self {
            Self::Frames(_) => None,
            Self::Staged(stage, _) => Some(stage),
        }
    }

    pub const fn family(&self) -> Family {
        match self {
            Self::Frames(_) => Family::Camera,
            Self::Staged(stage, _) => stage.family,
        }
    }
}

impl faults::Change for Change {
    fn subjects(&self, world: &World) -> Vec<Subject> {
        let streams = streams::all(world).into_iter();
        let of_family = streams.filter(|stream| stream.family == self.family());
        of_family.map(Subject::from).collect()
    }

    fn apply(&self, world: &mut World, subject: &Subject) -> bool {
        let SubjectPlace::Stream(stream) = &subject.at else {
            return false;
        };
        match self {
            Self::Frames(change) => cameras::turn(world, stream, *change),
            Self::Staged(_, change) => change(world, stream),
        }
        true
    }
}

impl Error {
    /// Whether a finding names it, alone or among those that it says fit as well; `same` are other relations that change the stream in
    /// the same way. A hint that names it counts here.
    pub fn is_named_by(self, finding: &Finding, same: &[&str]) -> bool {
        self.fault.is_named_by(&finding.clone().likely(), same)
    }

    /// Whether a finding shows it and names nothing else.
    pub fn is_shown_by(self, finding: &Finding) -> bool {
        let names = finding.relation.as_deref().is_some_and(|word| word != "clockwise-yaw");
        let mut seen_by = self.fault.seen_by.iter();
        let is_seen = seen_by.any(|seen| seen.starts_with(finding.rule.as_str()));
        // A base that is tilted shows in the tree, too.
        (is_seen || finding.rule == "TREE13") && !names && !finding.text().contains("Several causes fit all")
    }

    /// Other relations that change a stream in the same way.
    pub fn same_as(self, world: &World, stream: &Stream) -> Vec<&'static str> {
        let subjects = subjects(self.fault, world, stream);
        let same = subjects.iter().map(|subject| self.fault.change.same_as(world, subject));
        same.flatten().collect()
    }

    /// Puts the error into a stream, after its stage; false where it cannot have it.
    pub fn inject(self, world: &mut World, stream: &Stream) -> bool {
        inject(self.fault, world, stream)
    }
}
