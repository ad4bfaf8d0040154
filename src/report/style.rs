//! The style of text: colour, drawing characters and width. Independent of the content.

use crate::page::url;

/// What the receiver of a text can show.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Style {
    /// Whether ANSI colours may be used.
    pub color: bool,
    /// Whether characters beyond ASCII may be used for drawing.
    pub unicode: bool,
    /// Columns of the terminal; `None`: no limit.
    pub width: Option<usize>,
    /// Whether links (OSC 8) can be shown.
    pub links: bool,
}

/// A meaning that is shown by colour.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Ink {
    Error,
    Warning,
    Note,
    Good,
    Strong,
    Faint,
}

impl Style {
    /// No colour, Unicode drawing, lines of any length: for files and pipes.
    pub const PLAIN: Self = Self {
        color: false,
        unicode: true,
        width: None,
        links: false,
    };

    /// The text in the colour of `ink`, or as it is.
    pub(super) fn paint(self, ink: Ink, text: &str) -> String {
        if !self.color || text.is_empty() {
            return text.to_owned();
        }
        let code = match ink {
            Ink::Error => "1;31",
            Ink::Warning => "1;33",
            Ink::Note => "1;36",
            Ink::Good => "1;32",
            Ink::Strong => "1",
            Ink::Faint => "2",
        };
        format!("\u{1b}[{code}m{text}\u{1b}[0m")
    }

    /// The code of a rule as a link to its page, if links can be shown.
    pub(super) fn link(self, code: &str) -> String {
        if !self.links {
            return code.to_owned();
        }
        format!("\u{1b}]8;;{}\u{1b}\\{code}\u{1b}]8;;\u{1b}\\", url(code))
    }

    /// One of two spellings of a drawing.
    pub(super) fn pick(self, unicode: &'static str, ascii: &'static str) -> &'static str {
        if self.unicode { unicode } else { ascii }
    }

    /// Columns for running text: not too wide to read, not too narrow to wrap.
    pub(super) fn prose_width(self) -> usize {
        self.width.unwrap_or(100).clamp(40, 100)
    }
}
