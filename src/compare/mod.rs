//! Two platforms, or two recordings of one, compared with each other: which transforms, conventions and clocks changed, by how much, and
//! what explains it.
//!
//! Pure: two runs in, changes out. Owns what counts as a change. Must not lay out a report; the rules judge either alone.

mod checks;
mod clocks;
mod transforms;

use crate::run::Run;
use crate::source::Place;
use crate::verdict::Measured;

/// What a change is about. In the order of reports.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Kind {
    /// Poses of frames, and which frames there are.
    Transform,
    /// Where the origin of a map is on the Earth.
    Origin,
    /// Types and frames of topics.
    Convention,
    /// Stamps compared with the recorder's clock, rates.
    Clock,
    /// Outcomes of rules.
    Check,
}

impl Kind {
    /// The word used in reports.
    pub fn word(self) -> &'static str {
        match self {
            Self::Transform => "transform",
            Self::Origin => "origin",
            Self::Convention => "convention",
            Self::Clock => "clock",
            Self::Check => "check",
        }
    }
}

/// One difference of the second from the first.
#[derive(Clone, Debug, PartialEq)]
pub struct Change {
    /// What it is about.
    pub kind: Kind,
    /// The frame, pair of frames, topic or rule.
    pub subject: String,
    /// What changed, with the number.
    pub message: String,
    /// What explains it; empty where nothing does.
    pub explanation: String,
    /// The word of the relation that turns the first into the second.
    pub relation: Option<&'static str>,
    /// By how much.
    pub measured: Vec<Measured>,
    /// Where it is stated in the first, and in the second.
    pub stated: [Vec<String>; 2],
}

impl Change {
    fn new(kind: Kind, subject: impl Into<String>, message: impl Into<String>) -> Self {
        Self {
            kind,
            subject: subject.into(),
            message: message.into(),
            explanation: String::new(),
            relation: None,
            measured: Vec::new(),
            stated: [Vec::new(), Vec::new()],
        }
    }
}

/// What was compared, and what differs.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Comparison {
    /// The changes, by kind and subject.
    pub changes: Vec<Change>,
    /// Transforms that both have, whether they changed or not.
    pub transforms: usize,
    /// Topics that both have.
    pub topics: usize,
    /// Checks that were judged in both.
    pub checks: usize,
}

impl Comparison {
    /// Whether there was anything that both have.
    pub fn is_empty(&self) -> bool {
        self.transforms + self.topics + self.checks == 0
    }
}

/// The differences of `b` from `a`.
pub fn compare(a: &Run, b: &Run) -> Comparison {
    let mut comparison = Comparison::default();
    transforms::compare(a, b, &mut comparison);
    clocks::compare(a, b, &mut comparison);
    checks::compare(a, b, &mut comparison);
    comparison
        .changes
        .sort_by(|a, b| (a.kind, &a.subject, &a.message).cmp(&(b.kind, &b.subject, &b.message)));
    comparison
}

/// The path of a source and, in a text, the line.
fn place_words(run: &Run, place: &Place) -> String {
    let Some(source) = run.sources.get(place.source.0 as usize) else {
        return "?".to_owned();
    };
    let before = place.span().and_then(|span| source.text.get(..span.start));
    match before {
        Some(before) => format!("{}:{}", source.path, before.matches('\n').count() + 1),
        None => source.path.clone(),
    }
}
