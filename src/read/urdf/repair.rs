//! Repairs the XML of real URDF files for a strict parser, byte for byte: every repair keeps the
//! length of the text, so that spans of the repaired text are spans of the original.
//!
//! The reference is tinyxml2, which urdfdom uses: it accepts any version in the declaration, a declaration after
//! empty lines, undeclared prefixes, `--` in comments, bare `&` and `<` in values, a NUL as the end of the
//! text, and ignores what follows the first root element. Must not know URDF beyond the name `robot`.

use crate::source::Span;

/// A text that a strict parser accepts, and what the repair found.
#[derive(Debug, Default)]
pub(super) struct RepairedText {
    /// The text, of the same length as the original. Colons in names are underscores: read names from the original.
    pub(super) text: String,
    /// Names of the elements at the top, as written, with their places.
    pub(super) tops: Vec<(String, Span)>,
    /// The first entity declaration of a document type, where a value refers to an entity of it.
    pub(super) entity: Option<Span>,
    /// The first excess that no real robot description has: its place, and what is too much. Reading stops there.
    pub(super) excess: Option<(Span, String)>,
}

/// Repairs `text`; see the module's head.
pub(super) fn repair(text: &str) -> RepairedText {
    let mut lexer = Lexer {
        text,
        out: text.as_bytes().to_vec(),
        entity: None,
        open: 0,
        elements: 0,
        parts: 0,
        report: RepairedText::default(),
    };
    let end = text.find('\0').unwrap_or(text.len());
    lexer.blank(end..text.len());
    for byte in &mut lexer.out {
        if *byte < 0x20 && !matches!(*byte, b'\t' | b'\n' | b'\r') {
            *byte = b' ';
        }
    }
    lexer.run(end);
    let mut report = lexer.report;
    report.text = String::from_utf8(lexer.out).unwrap_or_else(|_| text.to_owned());
    report
}

/// Most attributes of one element; real ones have ten, and parsing costs the square of their number.
const MOST_ATTRIBUTES: usize = 1000;

/// Most elements of a text, and most links and joints among them: a hundred thousand links. A link with its joint takes 5 kB once both are read and
/// judged, 7 kB where everything in them is wrong. The largest known robots have four thousand elements.
pub(super) const MOST_ELEMENTS: usize = 600_000;
pub(super) const MOST_PARTS: usize = 200_000;

/// Whether an element of this name is a link or a joint.
pub(super) fn is_part(name: &str) -> bool {
    matches!(name, "link" | "joint")
}

/// Longest name of an element or attribute, and longest value that is a name, bytes: findings repeat names.
pub(super) const LONGEST_NAME: usize = 1000;

/// Longest reference to a character or a predefined entity that is looked for (`#x10FFFF`), with some leading zeros.
const LONGEST_REFERENCE: usize = 16;

/// Longest value of any attribute, bytes; in a thousand real files the longest has some hundreds.
const LONGEST_VALUE: usize = 16 * 1024;

struct Lexer<'a> {
    text: &'a str,
    out: Vec<u8>,
    /// The first entity declaration.
    entity: Option<Span>,
    /// Elements that are open.
    open: usize,
    elements: usize,
    /// Links and joints among them.
    parts: usize,
    report: RepairedText,
}

impl Lexer<'_> {
    fn byte(&self, at: usize) -> u8 {
        self.text.as_bytes().get(at).copied().unwrap_or(0)
    }

    /// Offset of `needle` at or after `from`.
    fn find(&self, from: usize, needle: &str) -> Option<usize> {
        Some(from + self.text.get(from..)?.find(needle)?)
    }

    fn starts(&self, at: usize, prefix: &str) -> bool {
        self.text
            .as_bytes()
            .get(at..)
            .is_some_and(|rest| rest.starts_with(prefix.as_bytes()))
    }

    fn put(&mut self, at: usize, byte: u8) {
        if let Some(slot) = self.out.get_mut(at) {
            *slot = byte;
        }
    }

    /// Replaces a range by spaces, keeping line ends so that a parser's line numbers stay right.
    fn blank(&mut self, range: std::ops::Range<usize>) {
        for byte in self.out.get_mut(range).into_iter().flatten() {
            if *byte != b'\n' {
                *byte = b' ';
            }
        }
    }

    fn run(&mut self, end: usize) {
        let mut at = 0;
        let next_tag = |at: usize| Some(at + self.text.get(at..)?.find('<')?);
        while let Some(open) = next_tag(at).filter(|open| *open < end) {
            self.escape_ampersands(at, open);
            let next = if self.starts(open, "<!--") {
                self.comment(open)
            } else if self.starts(open, "<![CDATA[") {
                self.find(open, "]]>").map(|close| close + 3)
            } else if self.starts(open, "<?") {
                self.instruction(open)
            } else if self.starts(open, "<!") {
                self.document_type(open)
            } else if self.starts(open, "</") {
                self.end_tag(open)
            } else {
                self.start_tag(open)
            };
            // An unfinished piece of markup: the parser will report it, at its place.
            let Some(next) = next else { return };
            at = next;
        }
        self.escape_ampersands(at, end);
    }

    /// `&` that opens no reference becomes `_`: values are read from the original where they differ.
    fn escape_ampersands(&mut self, from: usize, to: usize) {
        let mut at = from;
        // Searched within the range only: a search to the end of the text for every value would cost its square.
        while let Some(found) = self
            .text
            .get(at..to)
            .and_then(|within| within.find('&'))
            .map(|found| at + found)
        {
            let rest = self.text.get(found + 1..to).unwrap_or_default();
            let length = rest.bytes().take(LONGEST_REFERENCE).position(|byte| byte == b';');
            let name = length.and_then(|length| rest.get(..length)).unwrap_or_default();
            let known = matches!(name, "amp" | "lt" | "gt" | "quot" | "apos")
                || name.strip_prefix('#').is_some_and(|number| {
                    let (digits, radix) = number.strip_prefix('x').map_or((number, 10), |hex| (hex, 16));
                    u32::from_str_radix(digits, radix)
                        .ok()
                        .and_then(char::from_u32)
                        .is_some_and(|c| c >= ' ')
                });
            if !known {
                if !name.is_empty() {
                    self.report.entity = self.entity;
                }
                self.put(found, b'_');
            }
            at = found + 1;
        }
    }

    fn comment(&mut self, open: usize) -> Option<usize> {
        let close = self.find(open + 4, "-->")?;
        self.blank(open + 4..close);
        Some(close + 3)
    }

    fn instruction(&mut self, open: usize) -> Option<usize> {
        let close = self.find(open, "?>")? + 2;
        self.blank(open..close);
        Some(close)
    }

    fn document_type(&mut self, open: usize) -> Option<usize> {
        let mut at = open + 2;
        let mut brackets = 0_usize;
        loop {
            match self.byte(at) {
                0 => return None,
                quote @ (b'"' | b'\'') => at = self.find(at + 1, if quote == b'"' { "\"" } else { "'" })?,
                b'[' => brackets += 1,
                b']' => brackets = brackets.saturating_sub(1),
                b'<' if self.starts(at, "<!--") => at = self.find(at + 4, "-->")? + 2,
                b'<' if self.starts(at, "<!ENTITY") && self.entity.is_none() => {
                    let close = self.find(at, ">")? + 1;
                    self.entity = Some(Span::new(at, close));
                }
                b'>' if brackets == 0 => break,
                _ => {}
            }
            at += 1;
        }
        self.blank(open..at + 1);
        Some(at + 1)
    }

    fn end_tag(&mut self, open: usize) -> Option<usize> {
        let close = self.find(open, ">")?;
        self.name(open + 2, close);
        self.open = self.open.saturating_sub(1);
        Some(close + 1)
    }

    fn start_tag(&mut self, open: usize) -> Option<usize> {
        let mut at = self.name(open + 1, self.text.len());
        if at - open > LONGEST_NAME {
            return self.too_much(open, &format!("the name of an element has {} bytes", at - open - 1));
        }
        let name = self.text.get(open + 1..at).unwrap_or_default().to_owned();
        self.elements += 1;
        self.parts += usize::from(is_part(&name));
        if self.elements > MOST_ELEMENTS || self.parts > MOST_PARTS {
            let what = format!("there are more than {MOST_ELEMENTS} elements, or {MOST_PARTS} links and joints");
            self.report.excess = Some((Span::new(open, open + 1), what));
            return None;
        }
        if self.open == 0 && !self.top(open, &name) {
            return None;
        }
        let mut attributes = 0;
        loop {
            at = self.skip_blanks(at);
            match self.byte(at) {
                // Markup inside a tag: the tag was never closed. The parser reports where.
                0 | b'<' => return None,
                b'>' => {
                    self.open += 1;
                    break;
                }
                b'/' if self.byte(at + 1) == b'>' => {
                    at += 1;
                    break;
                }
                _ => {
                    attributes += 1;
                    at = self.attribute(at)?;
                }
            }
        }
        if attributes > MOST_ATTRIBUTES {
            let what = format!("an element has more than {MOST_ATTRIBUTES} attributes");
            return self.too_much(open, &what);
        }
        Some(at + 1)
    }

    /// One attribute from `at`; returns the offset after it.
    fn attribute(&mut self, at: usize) -> Option<usize> {
        let end = self.name(at, self.text.len());
        if end - at > LONGEST_NAME {
            return self.too_much(at, &format!("the name of an attribute has {} bytes", end - at));
        }
        let equals = self.skip_blanks(end);
        if self.byte(equals) != b'=' {
            return Some(equals.max(at + 1));
        }
        let quote = self.skip_blanks(equals + 1);
        let needle = match self.byte(quote) {
            b'"' => "\"",
            b'\'' => "'",
            _ => return Some(quote.max(at + 1)),
        };
        let close = self.find(quote + 1, needle)?;
        let names = matches!(
            self.text.get(at..end),
            Some("name" | "link" | "joint" | "type" | "version")
        );
        if names && close - quote > LONGEST_NAME {
            return self.too_much(at, &format!("a name has {} bytes", close - quote - 1));
        }
        if close - quote > LONGEST_VALUE {
            return self.too_much(
                at,
                &format!("the value of an attribute has {} bytes", close - quote - 1),
            );
        }
        self.escape_ampersands(quote + 1, close);
        for offset in quote + 1..close {
            if self.byte(offset) == b'<' {
                self.put(offset, b'_');
            }
        }
        Some(close + 1)
    }

    /// Ends the reading at something that no robot description has.
    fn too_much(&mut self, at: usize, what: &str) -> Option<usize> {
        self.report.excess = Some((Span::new(at, at + 1), format!("{what}, more than is read")));
        None
    }

    /// A name from `at`: its colons become underscores. Returns the offset after it; the caller
    /// must go on to the next character boundary if it is empty.
    fn name(&mut self, at: usize, limit: usize) -> usize {
        let mut end = at;
        while end < limit {
            match self.byte(end) {
                b' ' | b'\t' | b'\n' | b'\r' | b'=' | b'>' | b'/' | b'<' | b'"' | b'\'' | 0 => break,
                b':' => self.put(end, b'_'),
                _ => {}
            }
            end += 1;
        }
        end
    }

    fn skip_blanks(&self, mut at: usize) -> usize {
        while matches!(self.byte(at), b' ' | b'\t' | b'\n' | b'\r') {
            at += 1;
        }
        at
    }

    /// An element opens at the top; returns whether reading continues. For tinyxml2, text before the first one is not part of the
    /// document, and for urdfdom neither is what follows a robot.
    fn top(&mut self, open: usize, name: &str) -> bool {
        if self.report.tops.is_empty() {
            self.blank(0..open);
        }
        self.report
            .tops
            .push((name.to_owned(), Span::new(open, open + 1 + name.len())));
        let behind_robot =
            self.report.tops.len() > 1 && self.report.tops.first().is_some_and(|(first, _)| first == "robot");
        if behind_robot {
            self.blank(open..self.text.len());
        }
        !behind_robot
    }
}
