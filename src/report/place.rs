//! Places in the words of a report: path, line and column, message of a recording.
//!
//! Builds one line index for each text, and only for texts that a report points into.

use std::borrow::Cow;
use std::cell::OnceCell;
use std::sync::Arc;

use crate::source::{Derivation, LineColumn, LineIndex, MessageRef, Place, Source, SourceId, SourcePart};

/// Finds lines and messages of places.
pub(super) struct Locator<'a> {
    sources: &'a [Arc<Source>],
    lines: OnceCell<Vec<OnceCell<LineIndex>>>,
    /// The omitted part of every path.
    folder: &'a str,
}

/// A place, found.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Spot {
    /// Path of the file or recording.
    pub(super) path: String,
    /// First character, where the place is in a text.
    pub(super) start: Option<LineColumn>,
    /// One past the last character.
    pub(super) end: Option<LineColumn>,
    /// The message, where the place is in a recording or in a text that one carried.
    pub(super) message: Option<MessageRef>,
    /// Whether lines count in the expansion of a macro file: `path` has other lines.
    pub(super) expanded: bool,
}

impl<'a> Locator<'a> {
    /// For places of these sources, whose indices are their ids.
    pub(super) fn new(sources: &'a [Arc<Source>]) -> Self {
        Self {
            sources,
            lines: OnceCell::new(),
            folder: "",
        }
    }

    /// As [`Locator::new`], with paths relative to the deepest common folder of the sources.
    pub(super) fn inside(sources: &'a [Arc<Source>]) -> Self {
        let folder = |source: &'a Arc<Source>| {
            source
                .path
                .rfind('/')
                .and_then(|at| source.path.get(..=at))
                .unwrap_or("")
        };
        let common = sources.iter().map(folder).reduce(|a, b| {
            let ends = a
                .match_indices('/')
                .map(|(at, _)| at + 1)
                .filter_map(|end| a.get(..end));
            ends.rev().find(|start| b.starts_with(start)).unwrap_or("")
        });
        Self {
            folder: common.unwrap_or(""),
            ..Self::new(sources)
        }
    }

    /// The omitted part of every path: ends with a slash, or is empty.
    pub(super) fn folder(&self) -> &'a str {
        self.folder
    }

    fn path(&self, source: &'a Source) -> &'a str {
        source.path.strip_prefix(self.folder).unwrap_or(&source.path)
    }

    /// The path of a source, including the omitted folder.
    pub(super) fn whole_path(&self, id: SourceId) -> &'a str {
        self.source(id).map_or("?", |source| &source.path)
    }

    /// Every source.
    pub(super) fn sources(&self) -> &'a [Arc<Source>] {
        self.sources
    }

    /// The source with this id.
    pub(super) fn source(&self, id: SourceId) -> Option<&'a Source> {
        self.sources.get(id.0 as usize).map(AsRef::as_ref)
    }

    /// The line index of a source's text.
    pub(super) fn lines(&self, id: SourceId) -> Option<&LineIndex> {
        let source = self.source(id)?;
        let cells = self
            .lines
            .get_or_init(|| self.sources.iter().map(|_| OnceCell::new()).collect());
        let cell = cells.get(id.0 as usize)?;
        Some(cell.get_or_init(|| LineIndex::new(&source.text)))
    }

    /// The place where a place in an expansion is written; any other place unchanged.
    pub(super) fn written<'p>(&self, place: &'p Place) -> Cow<'p, Place> {
        let written = self.source(place.source).and_then(|source| source.written(place));
        written.map_or(Cow::Borrowed(place), Cow::Owned)
    }

    /// The text at a place; `None` where its source has none.
    pub(super) fn text(&self, place: &Place) -> Option<&'a str> {
        let place = &*self.written(place);
        let span = place.span()?;
        self.source(place.source)?.text.get(span.start..span.end)
    }

    /// Where a place is.
    pub(super) fn find(&self, place: &Place) -> Spot {
        let place = &*self.written(place);
        let Some(source) = self.source(place.source) else {
            return Spot {
                path: "?".to_owned(),
                start: None,
                end: None,
                message: None,
                expanded: false,
            };
        };
        let locate = |offset| Some(self.lines(place.source)?.locate(&source.text, offset));
        let span = place.span();
        let message = match (&place.at, &source.derived) {
            (SourcePart::Message(message), _) => Some(message.as_ref().clone()),
            (_, Some(Derivation::Message(message))) => Some(message.clone()),
            _ => None,
        };
        Spot {
            path: self.path(source).to_owned(),
            start: span.and_then(|span| locate(span.start)),
            end: span.and_then(|span| locate(span.end.max(span.start))),
            message,
            expanded: matches!(source.derived, Some(Derivation::Expansion)),
        }
    }

    /// The path of a place's source.
    pub(super) fn path_of(&self, place: &Place) -> &'a str {
        self.source(place.source).map_or("?", |source| self.path(source))
    }

    /// The source in a few words: its path, and its origin (`drive.mcap /robot_description[0]`).
    pub(super) fn name(&self, id: SourceId) -> String {
        match self.source(id) {
            None => "?".to_owned(),
            Some(source) => match &source.derived {
                None => self.path(source).to_owned(),
                Some(Derivation::Included) => format!("{} (included)", self.path(source)),
                Some(Derivation::Expansion) => format!("{} (expanded)", self.path(source)),
                Some(Derivation::Message(message)) => {
                    format!("{} {}[{}]", self.path(source), message.topic, message.index)
                }
            },
        }
    }

    /// The place in a few words: `robot.urdf:12:5`, `drive.mcap /tf message 3`.
    pub(super) fn short(&self, place: &Place) -> String {
        let place = &*self.written(place);
        let spot = self.find(place);
        match (&place.at, spot.start) {
            (SourcePart::Message(message), _) => format!("{} {} message {}", spot.path, message.topic, message.index),
            (_, Some(at)) => format!("{}:{}:{}", self.name(place.source), at.line, at.column),
            _ => self.name(place.source),
        }
    }
}
