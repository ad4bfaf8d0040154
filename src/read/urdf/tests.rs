//! Tests of the URDF reader: small robots, written out where they are read.

#![allow(clippy::float_cmp)] // numbers are kept as written, to the last bit

mod corpus;
mod hostile;
mod names;
mod numbers;
mod quirks;
mod reading;
mod xacro;

use super::{MeshLookup, read, read_unexpanded};
use crate::source::{LineIndex, Place, ReadStatus, Source, SourceId, SourceKind};
use crate::world::robot::Robot;
use crate::world::{Claim, Facts, FrameRole};

/// A text and what was read of it.
struct UrdfResult {
    source: Source,
    facts: Facts,
}

fn read_with(text: &str, meshes: &MeshLookup) -> UrdfResult {
    let mut source = Source::new(SourceId(7), "robot.urdf", SourceKind::Urdf);
    source.text = text.to_owned();
    let facts = read(&mut source, meshes);
    UrdfResult { source, facts }
}

fn read_text(text: &str) -> UrdfResult {
    read_with(text, &MeshLookup::default())
}

fn read_xacro(text: &str) -> UrdfResult {
    let mut source = Source::new(SourceId(7), "robot.urdf.xacro", SourceKind::Xacro);
    source.text = text.to_owned();
    let facts = read_unexpanded(&mut source, &MeshLookup::default());
    UrdfResult { source, facts }
}

/// Two links and a joint between them, with these elements inside.
fn joint_with(inside: &str) -> String {
    format!(
        "<robot name=\"r\"><link name=\"base\"/><link name=\"arm\"/><joint name=\"j\" type=\"fixed\">\
         <parent link=\"base\"/><child link=\"arm\"/>{inside}</joint></robot>"
    )
}

impl UrdfResult {
    fn robot(&self) -> &Robot {
        &self.facts.robots[0]
    }

    fn claim(&self) -> &Claim {
        assert_eq!(self.facts.claims.len(), 1, "one joint, one claim");
        &self.facts.claims[0]
    }

    /// The text at a place.
    fn at(&self, place: &Place) -> &str {
        assert_eq!(place.source, SourceId(7));
        let span = place.span().expect("a place in the text");
        &self.source.text[span.start..span.end]
    }

    fn line(&self, place: &Place) -> usize {
        let span = place.span().expect("a place in the text");
        LineIndex::new(&self.source.text)
            .locate(&self.source.text, span.start)
            .line
    }

    /// Names of frames in one role.
    fn frames(&self, role: FrameRole) -> Vec<&str> {
        let used = self.facts.frames.iter().filter(|used| used.role == role);
        used.map(|used| used.frame.as_str()).collect()
    }

    /// The reasons of malformed lists, with their text.
    fn malformed(&self) -> Vec<(&str, &str)> {
        let lists = self.robot().malformed.iter();
        lists
            .map(|list| (list.text.value.as_str(), list.malformed.as_deref().unwrap()))
            .collect()
    }

    /// Ignored names that are meant to be others, as `written>meant`.
    fn meant(&self) -> Vec<String> {
        let ignored = self.robot().ignored.iter();
        ignored
            .filter_map(|ignored| Some(format!("{}>{}", ignored.name.value, ignored.meant.as_ref()?)))
            .collect()
    }

    fn is_clean(&self) -> bool {
        self.source.status == ReadStatus::Read && self.source.problems.is_empty()
    }
}
