//! Source lines with marks under them, drawn by miette. The only file that uses miette.
//!
//! miette counts lines from the start of a text for every label, panics on spans outside it and prints control characters
//! unchanged. It gets our line index, spans inside the text, texts without control characters, and windows of long lines.

use std::cell::OnceCell;
use std::collections::BTreeSet;
use std::fmt;
use std::slice::from_ref;

use miette::{
    Diagnostic, GraphicalReportHandler, GraphicalTheme, LabeledSpan, MietteError, MietteSpanContents, SourceCode,
    SourceSpan, SpanContents, ThemeCharacters, ThemeStyles,
};
use textwrap::core::display_width;

use crate::source::{LineIndex, SourceId, Span};

use super::super::Style;
use super::super::place::Locator;
use super::super::text::{clean_in_place, one_line};

/// Longer lines (a whole JSON file on one line) are shown as a window around the mark.
const LONG_LINE: usize = 240;
/// Bytes shown before and after a mark in a long line.
const WINDOW: usize = 80;
/// Maximum number of bytes under a mark.
const LONGEST_MARK: usize = 120;
/// Two marks whose lines are together larger than this are shown in two snippets.
const LARGEST_SNIPPET: usize = 4096;

/// A mark under a text.
pub(super) struct Mark {
    /// The marked bytes.
    pub(super) span: Span,
    /// A label; may be empty.
    pub(super) note: String,
    /// Whether the finding is about this mark.
    pub(super) primary: bool,
}

/// Draws snippets of the sources of one run.
pub(super) struct Painter<'a> {
    locator: &'a Locator<'a>,
    handler: GraphicalReportHandler,
    style: Style,
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
            style,
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

    /// The lines of one source with marks under them. `None` if the source has no text to show.
    pub(super) fn snippet(&self, id: SourceId, marks: &[Mark]) -> Option<String> {
        let text = self.text(id)?;
        let labels: Vec<LabeledSpan> = marks.iter().filter_map(|mark| label(text, mark)).collect();
        if labels.is_empty() {
            return None;
        }
        let shown = SourceLabels {
            code: Code {
                name: one_line(&self.locator.name(id)),
                text,
                lines: self.locator.lines(id)?,
            },
            labels,
        };
        let mut drawn = String::new();
        self.handler.render_report(&mut drawn, &shown).ok()?;
        // The first line is miette's own headline; ours is above.
        let (_, snippet) = drawn.split_once('\n')?;
        let Some(width) = self.style.width else {
            return Some(snippet.to_owned());
        };
        match (cropped(snippet, width, self.style), marks) {
            ((cropped, true), _) | ((cropped, false), [_]) => Some(cropped),
            // If not all labels fit beside each other, each mark is shown separately.
            ((_, false), marks) => Some(
                marks
                    .iter()
                    .filter_map(|mark| self.snippet(id, from_ref(mark)))
                    .collect(),
            ),
        }
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

/// The mark as a label within one line of the text, on character boundaries, that covers at least one character.
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

/// Columns kept before a label, or a mark without one, if the start of its line is cropped.
const BEFORE_NOTE: usize = 6;
/// Minimum useful number of columns of a line.
const LEAST_WIDTH: usize = 20;

/// A snippet of this width: of each line the part around its marks, with `…` where it is cropped, and whether all marks and labels are
/// included. The line that names the file is kept.
fn cropped(snippet: &str, width: usize, style: Style) -> (String, bool) {
    let (mut out, mut is_whole) = (String::new(), true);
    let mut lines = snippet.lines().map(Line::new).peekable();
    while let Some(first) = lines.next() {
        let mut block = vec![first];
        while let Some(marks) = lines.next_if(|line| line.is_of_marks) {
            block.push(marks);
        }
        let gutter = block.iter().map(|line| line.gutter).max().unwrap_or(0);
        let room = width.saturating_sub(gutter).max(LEAST_WIDTH);
        let marks = || block.iter().filter(|line| line.is_of_marks);
        let first = |is_wanted: fn(char) -> bool| marks().filter_map(|line| line.position(is_wanted)).min();
        let note = first(|c| matches!(c, '╰' | '`'))
            .or_else(|| first(|c| c != ' '))
            .unwrap_or(0);
        let end = marks().map(|line| line.columns).max().unwrap_or(0);
        // As far as the labels need, but not beyond the first of them.
        let from = end.saturating_sub(room).min(note.saturating_sub(BEFORE_NOTE));
        is_whole &= end <= from + room;
        for line in block {
            line.push_cropped(from, room, style, &mut out);
        }
    }
    (out, is_whole)
}

/// A line of a snippet: number and rule in the gutter, then a source line or marks.
struct Line<'s> {
    text: &'s str,
    /// Columns of the gutter; 0 if there is none.
    gutter: usize,
    /// Columns after it.
    columns: usize,
    is_of_marks: bool,
}

impl<'s> Line<'s> {
    fn new(text: &'s str) -> Self {
        let mut line = Self {
            text,
            gutter: 0,
            columns: 0,
            is_of_marks: false,
        };
        let rule = line
            .shown()
            .enumerate()
            .find(|(_, (_, c))| !c.is_ascii_digit() && *c != ' ');
        if let Some((at, (_, c @ ('│' | '|' | '·' | ':')))) = rule {
            line.gutter = at + 2;
            line.is_of_marks = matches!(c, '·' | ':');
        }
        line.columns = display_width(text).saturating_sub(line.gutter);
        line
    }

    /// Its characters with their offsets, without colour codes.
    fn shown(&self) -> impl Iterator<Item = (usize, char)> {
        let mut is_code = false;
        self.text.char_indices().filter(move |(_, c)| {
            let was_code = is_code;
            is_code = *c == '\u{1b}' || is_code && *c != 'm';
            !(was_code || is_code)
        })
    }

    /// The first column after the gutter with such a character.
    fn position(&self, is_wanted: fn(char) -> bool) -> Option<usize> {
        self.shown().skip(self.gutter).position(|(_, c)| is_wanted(c))
    }

    /// Adds the gutter and `room` columns after it, from `from` on.
    fn push_cropped(&self, from: usize, room: usize, style: Style, out: &mut String) {
        if self.gutter == 0 || from == 0 && self.columns <= room {
            out.push_str(self.text);
            out.push('\n');
            return;
        }
        let shown: BTreeSet<usize> = self.shown().map(|(at, _)| at).collect();
        let (start, end) = (self.gutter + from, self.gutter + from + room);
        let is_cut = self.gutter + self.columns > end;
        let cut = style.pick("…", "~");
        let mut column = 0;
        for (at, c) in self.text.char_indices() {
            if !shown.contains(&at) {
                out.push(c);
                continue;
            }
            let wide = display_width(c.encode_utf8(&mut [0; 4]));
            match column {
                _ if column < self.gutter => out.push(c),
                _ if column < start || column + wide > end => {}
                _ if column == start && from > 0 && !self.is_of_marks => out.push_str(cut),
                _ if column + wide == end && is_cut => out.push_str(cut),
                _ => out.push(c),
            }
            column += wide;
        }
        out.truncate(out.trim_end_matches(' ').len());
        out.push('\n');
    }
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

    /// First byte, zero-based line and zero-based column of the part shown for a span.
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
struct SourceLabels<'a> {
    code: Code<'a>,
    labels: Vec<LabeledSpan>,
}

impl fmt::Display for SourceLabels<'_> {
    fn fmt(&self, _: &mut fmt::Formatter<'_>) -> fmt::Result {
        Ok(())
    }
}

impl std::error::Error for SourceLabels<'_> {}

impl Diagnostic for SourceLabels<'_> {
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
        draw_in(text, spans, Style::PLAIN)
    }

    fn draw_in(text: &str, spans: &[(usize, usize)], style: Style) -> String {
        let mut source = Source::new(SourceId(0), "a.json", SourceKind::Json);
        source.text = text.to_owned();
        let sources = [source.into()];
        let locator = Locator::new(&sources);
        let marks: Vec<Mark> = spans
            .iter()
            .map(|(start, end)| Mark {
                span: Span::new(*start, *end),
                note: "here".to_owned(),
                primary: true,
            })
            .collect();
        Painter::new(&locator, style)
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
    fn lines_are_cropped_around_their_marks_at_the_width_of_the_terminal() {
        let before = "x".repeat(100);
        let text = format!("short\n{before} é value {before}\n{before}\n");
        let at = text.find("value").unwrap_or(0);
        for (width, color) in [(80, false), (60, false), (60, true), (30, true)] {
            let style = Style {
                color,
                width: Some(width),
                ..Style::PLAIN
            };
            let drawn = draw_in(&text, &[(at, at + 5)], style);
            let plain: String = Line::new(&drawn).shown().map(|(_, c)| c).collect();
            assert!(plain.lines().all(|line| line.chars().count() <= width), "{plain}");
            let line = plain.lines().find(|line| line.contains("value")).unwrap_or_default();
            let column = |line: &str, what: &str| {
                line.find(what)
                    .map(|at| line.get(..at).map(|before| before.chars().count()))
            };
            assert!(line.starts_with(" 2 │ …x") && line.ends_with("x…"), "{plain}");
            // The mark is under what it marks.
            let mark = plain.lines().find(|line| line.contains("┬")).unwrap_or_default();
            assert_eq!(column(line, "value"), column(mark, "──┬──"), "{plain}");
            assert!(
                plain.contains("╰── here") && plain.contains("[a.json:2:104]"),
                "{plain}"
            );
            // A line without a mark is shown from its start.
            assert!(
                plain
                    .lines()
                    .any(|line| line.starts_with(" 3 │ xxx") && line.ends_with('…')),
                "{plain}"
            );
            assert!(drawn.contains('\u{1b}') == color);
        }
        let wide = Style {
            width: Some(400),
            ..Style::PLAIN
        };
        assert_eq!(draw_in(&text, &[(at, at + 5)], wide), draw(&text, &[(at, at + 5)]));
        // Two marks without room beside each other are shown one by one, each with its label.
        let style = Style {
            width: Some(40),
            ..Style::PLAIN
        };
        let both = draw_in(&text, &[(6, 16), (at, at + 5)], style);
        assert!(both.lines().all(|line| line.chars().count() <= 40), "{both}");
        assert_eq!(both.matches("╰── here").count(), 2, "{both}");
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
        let sources = [source.into()];
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
