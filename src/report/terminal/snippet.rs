//! Source lines with marks under them, drawn by miette. The only file that knows miette.
//!
//! miette counts lines from the start of a text for every label, panics on spans outside it and prints whatever stands
//! there. It is given a line index of ours, spans that fit, texts without control characters, and windows of long lines.

use std::cell::OnceCell;
use std::fmt;

use miette::{
    Diagnostic, GraphicalReportHandler, GraphicalTheme, LabeledSpan, MietteError, MietteSpanContents, SourceCode,
    SourceSpan, SpanContents, ThemeCharacters, ThemeStyles,
};

use crate::source::{LineIndex, SourceId, Span};

use super::super::Style;
use super::super::place::Locator;
use super::super::text::{clean_in_place, one_line};

/// Longer lines (a whole JSON file on one line) are shown as a window around the mark.
const LONG_LINE: usize = 240;
/// Bytes shown before and after a mark in a long line.
const WINDOW: usize = 80;
/// A mark covers at most so many bytes.
const LONGEST_MARK: usize = 120;
/// Two marks whose lines are together larger than this are shown in two snippets.
const LARGEST_SNIPPET: usize = 4096;

/// A mark under a text.
pub(super) struct Mark {
    /// What is marked.
    pub(super) span: Span,
    /// What is to be seen there; may be empty.
    pub(super) note: String,
    /// Whether the finding is about this mark.
    pub(super) primary: bool,
}

/// Draws snippets of the sources of one run.
pub(super) struct Painter<'a> {
    locator: &'a Locator<'a>,
    handler: GraphicalReportHandler,
    cleaned: Vec<(SourceId, OnceCell<Option<String>>)>,
}

impl<'a> Painter<'a> {
    pub(super) fn new(locator: &'a Locator<'a>, style: Style) -> Self {
        let theme = GraphicalTheme {
            characters: if style.unicode {
                ThemeCharacters::unicode()
            } else {
                ThemeCharacters::ascii()
            },
            styles: if style.color {
                ThemeStyles::ansi()
            } else {
                ThemeStyles::none()
            },
        };
        Self {
            locator,
            handler: GraphicalReportHandler::new_themed(theme)
                .with_links(false)
                .with_urls(false)
                .without_syntax_highlighting()
                .without_cause_chain()
                .with_context_lines(1)
                .with_width(style.width.unwrap_or(120).max(60)),
            cleaned: locator
                .sources()
                .iter()
                .map(|source| (source.id, OnceCell::new()))
                .collect(),
        }
    }

    /// The lines of one source with marks under them. `None` where the source has no text to show.
    pub(super) fn snippet(&self, id: SourceId, marks: &[Mark]) -> Option<String> {
        let text = self.text(id)?;
        let labels: Vec<LabeledSpan> = marks.iter().filter_map(|mark| label(text, mark)).collect();
        if labels.is_empty() {
            return None;
        }
        let shown = Shown {
            code: Code {
                name: one_line(&self.locator.name(id)),
                text,
                lines: self.locator.lines(id)?,
            },
            labels,
        };
        let mut drawn = String::new();
        self.handler.render_report(&mut drawn, &shown).ok()?;
        // The first line is miette's own headline; ours stands above.
        drawn.split_once('\n').map(|(_, snippet)| snippet.to_owned())
    }

    fn text(&self, id: SourceId) -> Option<&str> {
        let source = self.locator.source(id)?;
        let (_, cell) = self.cleaned.get(id.0 as usize)?;
        let text = cell
            .get_or_init(|| clean_in_place(&source.text))
            .as_deref()
            .unwrap_or(&source.text);
        (!text.trim().is_empty()).then_some(text)
    }
}

/// The mark as a label that lies within one line of the text, on character boundaries, and covers a character.
fn label(text: &str, mark: &Mark) -> Option<LabeledSpan> {
    let last = text.trim_end().char_indices().next_back()?.0;
    let start = floor(text, mark.span.start.min(last));
    let rest = text.get(start..)?;
    let line_end = start + rest.find(['\n', '\r']).unwrap_or(rest.len());
    let end = ceil(text, mark.span.end.min(start + LONGEST_MARK)).clamp(start, line_end);
    let end = if end == start && start < line_end {
        ceil(text, start + 1)
    } else {
        end
    };
    let note = (!mark.note.is_empty()).then(|| one_line(&mark.note));
    Some(if mark.primary {
        LabeledSpan::new_primary_with_span(note, start..end)
    } else {
        LabeledSpan::new_with_span(note, start..end)
    })
}

fn floor(text: &str, offset: usize) -> usize {
    (0..=offset.min(text.len()))
        .rev()
        .find(|at| text.is_char_boundary(*at))
        .unwrap_or(0)
}

fn ceil(text: &str, offset: usize) -> usize {
    (offset..text.len())
        .find(|at| text.is_char_boundary(*at))
        .unwrap_or(text.len())
}

/// A text as miette reads it.
#[derive(Debug)]
struct Code<'a> {
    name: String,
    text: &'a str,
    lines: &'a LineIndex,
}

impl Code<'_> {
    /// First byte of a zero-based line and the first byte after its newline.
    fn line(&self, line: usize) -> (usize, usize) {
        let end = self.text.len();
        let start = self.lines.line_start(line).unwrap_or(end);
        (start, self.lines.line_start(line + 1).unwrap_or(end))
    }

    fn is_long(&self, line: usize) -> bool {
        let (start, end) = self.line(line);
        end - start > LONG_LINE
    }

    /// First byte, zero-based line and zero-based column of what is shown for a span.
    fn window(&self, span: Span, context: usize) -> (Span, usize, usize) {
        let at = self.lines.locate(self.text, span.start);
        let first = at.line - 1;
        let last = self.lines.locate(self.text, span.end.max(span.start + 1) - 1).line - 1;
        if context == 0 {
            return (span, first, at.column - 1);
        }
        let (mut from, mut line) = (self.line(first).0, first);
        if self.is_long(first) {
            from = floor(self.text, span.start.saturating_sub(WINDOW)).max(from);
        } else {
            while line > 0 && line + context > first && !self.is_long(line - 1) {
                line -= 1;
                from = self.line(line).0;
            }
        }
        let mut to = self.line(last).1;
        if self.is_long(last) {
            to = ceil(self.text, span.end + WINDOW).min(to);
        } else {
            let below = (last + 1..=last + context)
                .take_while(|line| !self.is_long(*line))
                .last();
            to = below.map_or(to, |line| self.line(line).1);
        }
        let column = if from == self.line(line).0 {
            0
        } else {
            self.lines.locate(self.text, from).column - 1
        };
        (Span::new(from, to), line, column)
    }
}

impl SourceCode for Code<'_> {
    fn read_span<'a>(
        &'a self,
        span: &SourceSpan,
        context_lines_before: usize,
        _context_lines_after: usize,
    ) -> Result<Box<dyn SpanContents<'a> + 'a>, MietteError> {
        let wanted = Span::new(span.offset(), span.offset() + span.len());
        if wanted.end > self.text.len() {
            return Err(MietteError::OutOfBounds);
        }
        let (shown, line, column) = self.window(wanted, context_lines_before);
        let data = self.text.get(shown.start..shown.end).ok_or(MietteError::OutOfBounds)?;
        if data.len() > LARGEST_SNIPPET {
            return Err(MietteError::OutOfBounds);
        }
        Ok(Box::new(MietteSpanContents::new_named(
            self.name.clone(),
            data.as_bytes(),
            SourceSpan::from((shown.start, data.len())),
            line,
            column,
            data.lines().count(),
        )))
    }
}

/// The labels of one source. The headline stays empty: it is ours.
#[derive(Debug)]
struct Shown<'a> {
    code: Code<'a>,
    labels: Vec<LabeledSpan>,
}

impl fmt::Display for Shown<'_> {
    fn fmt(&self, _: &mut fmt::Formatter<'_>) -> fmt::Result {
        Ok(())
    }
}

impl std::error::Error for Shown<'_> {}

impl Diagnostic for Shown<'_> {
    fn source_code(&self) -> Option<&dyn SourceCode> {
        Some(&self.code)
    }

    fn labels(&self) -> Option<Box<dyn Iterator<Item = LabeledSpan> + '_>> {
        Some(Box::new(self.labels.iter().cloned()))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::source::{Source, SourceKind};

    fn draw(text: &str, spans: &[(usize, usize)]) -> String {
        let mut source = Source::new(SourceId(0), "a.json", SourceKind::Json);
        source.text = text.to_owned();
        let sources = [source];
        let locator = Locator::new(&sources);
        let marks: Vec<Mark> = spans
            .iter()
            .map(|(start, end)| Mark {
                span: Span::new(*start, *end),
                note: "here".to_owned(),
                primary: true,
            })
            .collect();
        Painter::new(&locator, Style::PLAIN)
            .snippet(SourceId(0), &marks)
            .unwrap_or_default()
    }

    #[test]
    fn a_span_shows_its_line_and_its_neighbours() {
        let drawn = draw("one\ntwo\nthree\nfour\nfive\n", &[(8, 13)]);
        assert_eq!(
            drawn,
            "   ╭─[a.json:3:1]\n 2 │ two\n 3 │ three\n   · ──┬──\n   ·   ╰── here\n 4 │ four\n   ╰────\n"
        );
    }

    #[test]
    fn odd_spans_are_shown_and_never_panic() {
        let text = "é\r\nab\ttwo\n\u{1b}[31mx\n\nlast";
        for start in 0..=text.len() + 3 {
            for length in [0, 1, 5, 400] {
                let drawn = draw(text, &[(start, start + length), (0, 1)]);
                assert!(drawn.contains("here"), "{start}+{length}: {drawn}");
                assert!(!drawn.contains('\u{1b}'), "{drawn}");
            }
        }
        for text in ["", "\n", "  \n "] {
            assert_eq!(draw(text, &[(0, 1)]), "");
        }
        assert!(draw("x", &[(5, 2)]).contains("1 │ x"));
    }

    #[test]
    fn a_file_on_one_line_is_shown_in_part() {
        let text = format!("{{{}\"k\": 1{}}}", " ".repeat(50_000), " é".repeat(50_000));
        let drawn = draw(&text, &[(50_001, 50_004), (90_000, 90_001)]);
        assert!(drawn.contains("[a.json:1:50002]"), "{drawn}");
        assert!(drawn.contains("\"k\": 1"));
        assert!(drawn.len() < 3000, "{} bytes", drawn.len());
    }

    #[test]
    fn cost_does_not_grow_with_the_offset() {
        // 200,000 lines; a reader that counts from the start would walk 2.6 GB for these.
        let text = "a line text\n".repeat(200_000);
        let started = std::time::Instant::now();
        let mut source = Source::new(SourceId(0), "a.yaml", SourceKind::Yaml);
        source.text = text;
        let sources = [source];
        let locator = Locator::new(&sources);
        let painter = Painter::new(&locator, Style::PLAIN);
        for _ in 0..300 {
            let mark = Mark {
                span: Span::new(2_399_000, 2_399_004),
                note: String::new(),
                primary: true,
            };
            assert!(painter.snippet(SourceId(0), &[mark]).is_some());
        }
        assert!(started.elapsed().as_secs() < 5, "{:?}", started.elapsed());
    }
}
