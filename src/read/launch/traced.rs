//! Texts that know where each of their letters is written, through substitutions.

use crate::source::Span;

use super::Word;

/// Longer texts are cut off: substitutions can make texts that grow without end.
const MAX_LENGTH: usize = 4096;

/// Where a byte comes from.
#[derive(Clone, Copy, Debug)]
struct Origin {
    at: usize,
    is_open: bool,
    is_default: bool,
}

/// A text with the place of each of its bytes.
#[derive(Clone, Debug, Default)]
pub(super) struct TracedText {
    text: String,
    origins: Vec<Origin>,
}

impl TracedText {
    /// The text of a value at `span`, letter by letter where it was not changed in reading.
    pub(super) fn new(text: &str, span: Span) -> Self {
        let last = span.end.saturating_sub(1).max(span.start);
        let origins = (0..text.len()).map(|index| Origin {
            at: (span.start + index).min(last),
            is_open: false,
            is_default: false,
        });
        Self {
            text: text.to_owned(),
            origins: origins.collect(),
        }
    }

    pub(super) fn text(&self) -> &str {
        &self.text
    }

    /// Whether a part of it is not known.
    pub(super) fn is_open(&self) -> bool {
        self.origins.iter().any(|origin| origin.is_open)
    }

    /// Whether a part of it is a default.
    pub(super) fn is_default(&self) -> bool {
        self.origins.iter().any(|origin| origin.is_default)
    }

    /// The same, marked as unknown.
    pub(super) fn opened(mut self) -> Self {
        for origin in &mut self.origins {
            origin.is_open = true;
        }
        self
    }

    /// The same, marked as a default.
    pub(super) fn defaulted(mut self) -> Self {
        for origin in &mut self.origins {
            origin.is_default = true;
        }
        self
    }

    /// A part of it.
    pub(super) fn part(&self, range: std::ops::Range<usize>) -> Self {
        let text = self.text.get(range.clone()).unwrap_or_default();
        let origins = self.origins.get(range).unwrap_or_default();
        Self {
            text: text.to_owned(),
            origins: if text.is_empty() { Vec::new() } else { origins.to_vec() },
        }
    }

    /// Appends another.
    pub(super) fn push(&mut self, other: &Self) {
        if self.text.len() + other.text.len() > MAX_LENGTH {
            *self = std::mem::take(self).opened();
            return;
        }
        self.text.push_str(&other.text);
        self.origins.extend(&other.origins);
    }

    /// Its words: separated by whitespace outside of `$(...)`.
    pub(super) fn words(&self) -> Vec<Word> {
        let mut words = Vec::new();
        let mut start = None;
        let mut depth = 0_usize;
        for (index, letter) in self.text.char_indices() {
            match letter {
                '(' => depth += 1,
                ')' => depth = depth.saturating_sub(1),
                _ => {}
            }
            if letter.is_whitespace() && depth == 0 {
                words.extend(start.take().and_then(|start| self.word(start..index)));
            } else if start.is_none() {
                start = Some(index);
            }
        }
        words.extend(start.and_then(|start| self.word(start..self.text.len())));
        words
    }

    /// All of it as one word.
    pub(super) fn whole(&self) -> Option<Word> {
        self.word(0..self.text.len())
    }

    fn word(&self, range: std::ops::Range<usize>) -> Option<Word> {
        let part = self.part(range);
        let (first, last) = (part.origins.first()?, part.origins.last()?);
        // Pieces from several places: the place is that of the first.
        let end = if last.at >= first.at && last.at - first.at < part.text.len() * 2 {
            last.at + 1
        } else {
            first.at + 1
        };
        Some(Word {
            span: Span::new(first.at, end),
            is_open: part.is_open(),
            is_default: part.is_default(),
            text: part.text,
        })
    }
}
