//! XML elements with the names, values and places of the text as it was written.
//!
//! Owns the way from a text to elements, and spans. Must not know URDF beyond the possible roots of a file.

use std::borrow::Cow;

use roxmltree::{Document, Node, ParsingOptions};

use crate::source::{LineIndex, Place, SourceId, Span};

use super::repair::{self, RepairedText};

/// The root of a text.
#[derive(Debug, PartialEq, Eq)]
pub(super) enum Top {
    /// One `<robot>`; the span of a second element after it, which consumers do not read.
    Robot(Option<Span>),
    /// Parts of a robot without `<robot>` around them.
    Fragment,
    /// Something else: what it is, its place, and what to do.
    Other(String, Option<Span>, Option<String>),
}

/// Elements that make a text without `<robot>` a part of a robot description.
const PARTS: [&str; 14] = [
    "link",
    "joint",
    "gazebo",
    "transmission",
    "material",
    "ros2_control",
    "sensor",
    "macro",
    "property",
    "include",
    "group",
    "if",
    "unless",
    "arg",
];

/// Judges the top of a text by its elements. A xacro file may have any root: the one of the including file counts.
pub(super) fn top(repaired: &RepairedText, xacro: bool) -> Top {
    let Some((name, span)) = repaired.tops.first() else {
        return Top::Other("contains no XML element".to_owned(), None, None);
    };
    if name == "robot" {
        return Top::Robot(repaired.tops.get(1).map(|(_, span)| *span));
    }
    let is_part = |name: &str| PARTS.contains(&name) || name.starts_with("xacro:");
    if repaired.tops.iter().all(|(name, _)| is_part(name)) {
        return Top::Fragment;
    }
    let (what, help) = match name.to_lowercase().as_str() {
        "sdf" | "gazebo" | "world" | "model" => ("an SDF file", Some("convert it to URDF, or leave it out")),
        "launch" => (
            "a launch file",
            Some("check the robot description that it loads instead"),
        ),
        "mujoco" => ("a MuJoCo model", Some("convert it to URDF, or leave it out")),
        "package" => ("a package manifest", None),
        "collada" => ("a COLLADA mesh", None),
        "html" | "!doctype" => (
            "a web page, perhaps saved instead of the file itself",
            Some("download the raw file"),
        ),
        "robot" => (
            "not a robot description for URDF parsers, which require `<robot>` in lower case",
            None,
        ),
        _ if xacro && repaired.tops.len() == 1 => return Top::Robot(None),
        _ => ("not a robot description", None),
    };
    Top::Other(
        format!("the root element is `<{name}>`: this is {what}; a URDF begins with `<robot>`"),
        Some(*span),
        help.map(str::to_owned),
    )
}

/// The original text of the elements.
#[derive(Clone, Copy, Debug)]
pub(super) struct Text<'a> {
    /// The source of the text.
    pub(super) source: SourceId,
    /// As it was written.
    pub(super) original: &'a str,
    /// How many bytes were prepended for the parser.
    pub(super) shift: usize,
}

impl<'a> Text<'a> {
    fn span(&self, range: std::ops::Range<usize>) -> Span {
        let end = self.original.len();
        let at = |offset: usize| offset.saturating_sub(self.shift).min(end);
        Span::new(at(range.start), at(range.end))
    }

    fn slice(&self, span: Span) -> &'a str {
        self.original.get(span.start..span.end).unwrap_or_default()
    }
}

/// A fault of the XML itself.
#[derive(Debug)]
pub(super) struct Fault {
    /// Where the parser stopped.
    pub(super) span: Span,
    /// Its message.
    pub(super) message: String,
}

/// Longest piece of a text without a `>`, bytes, that is parsed without a check: the time for a tag grows with the square of its attributes.
const LONGEST_TAG: usize = 8192;

/// Parses a text that needs no repair; `None` if a strict parser refuses it, or could take too long.
pub(in crate::read) fn parse_strict(text: &str) -> Option<Document<'_>> {
    let (mut pieces, mut start) = (0, 0);
    for end in memchr::memchr_iter(b'>', text.as_bytes()).chain([text.len()]) {
        pieces += 1;
        if end - start > LONGEST_TAG || pieces > repair::MOST_ELEMENTS {
            return None;
        }
        start = end + 1;
    }
    let document = Document::parse(text).ok()?;
    // The repair reports what is too long, with its place.
    let is_short = |node: Node<'_, '_>| {
        node.tag_name().name().len() <= repair::LONGEST_NAME
            && node
                .attributes()
                .all(|attribute| attribute.range().len() <= repair::LONGEST_NAME)
    };
    let mut parts = 0;
    let is_usual = document.descendants().all(|node| {
        parts += usize::from(repair::is_part(node.tag_name().name()));
        is_short(node) && parts <= repair::MOST_PARTS
    });
    is_usual.then_some(document)
}

/// Parses a repaired text (with `text.shift` bytes prepended).
pub(super) fn parse<'t>(repaired: &'t str, text: Text<'_>) -> Result<Document<'t>, Fault> {
    let options = ParsingOptions {
        allow_dtd: false,
        ..ParsingOptions::default()
    };
    Document::parse_with_options(repaired, options).map_err(|error| {
        let position = error.pos();
        let index = LineIndex::new(repaired);
        let line = index.line_start(position.row.saturating_sub(1) as usize).unwrap_or(0);
        let columns = position.col.saturating_sub(1) as usize;
        let within: usize = repaired
            .get(line..)
            .map_or(0, |rest| rest.chars().take(columns).map(char::len_utf8).sum());
        let at = match error {
            // The parser reports the beginning, but the end is what is missing.
            roxmltree::Error::UnclosedRootNode => repaired.trim_end().len().saturating_sub(1),
            _ => line + within,
        };
        let span = text.span(at..at + 1);
        let said = error.to_string();
        let said = said.split(" at ").next().unwrap_or(&said).to_owned();
        Fault {
            span: boundary(text.original, span),
            message: said,
        }
    })
}

/// The span widened to whole characters, or the last character at the end of the text.
fn boundary(text: &str, span: Span) -> Span {
    let mut start = span.start.min(text.len().saturating_sub(1));
    while start > 0 && !text.is_char_boundary(start) {
        start -= 1;
    }
    let mut end = (start + 1).min(text.len());
    while end < text.len() && !text.is_char_boundary(end) {
        end += 1;
    }
    Span::new(start, end)
}

/// An attribute as it was written.
#[derive(Clone, Debug)]
pub(super) struct Attribute<'a> {
    /// Its name, with its prefix.
    pub(super) name: &'a str,
    /// The place of the name.
    pub(super) name_place: Place,
    /// The value, with references resolved.
    pub(super) value: Cow<'a, str>,
    /// The value's bytes in the text, without quotes.
    pub(super) span: Span,
    /// Whether the value's bytes are the value: pieces of it have spans.
    pub(super) verbatim: bool,
    source: SourceId,
}

impl Attribute<'_> {
    /// The place of the value.
    pub(super) fn place(&self) -> Place {
        Place::text(self.source, self.span)
    }
}

/// An element as it was written.
#[derive(Clone, Copy, Debug)]
pub(super) struct Element<'a> {
    node: Node<'a, 'a>,
    text: Text<'a>,
}

impl<'a> Element<'a> {
    /// The root element of a document.
    pub(super) fn root(document: &'a Document<'a>, text: Text<'a>) -> Self {
        Self {
            node: document.root_element(),
            text,
        }
    }

    /// The name as written, with its prefix.
    pub(super) fn name(&self) -> &'a str {
        self.text.slice(self.name_span())
    }

    fn name_span(&self) -> Span {
        let start = self.node.range().start + 1;
        let input = self.node.document().input_text().as_bytes();
        let behind = input.get(start..).unwrap_or_default();
        let length = behind
            .iter()
            .position(|byte| matches!(byte, b' ' | b'\t' | b'\n' | b'\r' | b'/' | b'>'))
            .unwrap_or(behind.len());
        self.text.span(start..start + length)
    }

    /// The place of the name.
    pub(super) fn name_place(&self) -> Place {
        Place::text(self.text.source, self.name_span())
    }

    /// The whole element.
    pub(super) fn place(&self) -> Place {
        Place::text(self.text.source, self.text.span(self.node.range()))
    }

    /// The start tag.
    pub(super) fn tag_place(&self) -> Place {
        let whole = self.text.span(self.node.range());
        let mut quote = None;
        let close = self.text.slice(whole).bytes().position(|byte| {
            if quote == Some(byte) {
                quote = None;
            } else if quote.is_none() && matches!(byte, b'"' | b'\'') {
                quote = Some(byte);
            }
            quote.is_none() && byte == b'>'
        });
        let end = close.map_or(whole.end, |close| whole.start + close + 1);
        Place::text(self.text.source, Span::new(whole.start, end))
    }

    /// Writes `<name a="1"` as in the repaired text, without the whitespace between attributes and without
    /// attributes of other namespaces.
    pub(super) fn write_start(&self, out: &mut String) {
        let input = self.node.document().input_text();
        out.push('<');
        out.push_str(self.repaired_name());
        for attribute in self
            .node
            .attributes()
            .filter(|attribute| attribute.namespace().is_none())
        {
            out.push(' ');
            out.push_str(input.get(attribute.range()).unwrap_or_default());
        }
    }

    /// Names and values of the attributes as parsed, without places.
    pub(super) fn plain_attributes(&self) -> impl Iterator<Item = (&'a str, &'a str)> + use<'a> {
        self.node
            .attributes()
            .map(|attribute| (attribute.name(), attribute.value()))
    }

    /// The name as in the repaired text.
    pub(super) fn repaired_name(&self) -> &'a str {
        self.node.tag_name().name()
    }

    /// The attributes, in order.
    pub(super) fn attributes(&self) -> impl Iterator<Item = Attribute<'a>> + use<'a> {
        let element = *self;
        self.node
            .attributes()
            .map(move |attribute| element.as_written(&attribute))
    }

    /// Names of the attributes as written, in order.
    pub(super) fn attribute_names(&self) -> impl Iterator<Item = &'a str> + use<'a> {
        let text = self.text;
        self.node
            .attributes()
            .map(move |attribute| text.slice(text.span(attribute.range_qname())))
    }

    /// The attribute of this name.
    pub(super) fn attribute(&self, name: &str) -> Option<Attribute<'a>> {
        self.node
            .attributes()
            .find(|attribute| self.text.slice(self.text.span(attribute.range_qname())) == name)
            .map(|attribute| self.as_written(&attribute))
    }

    fn as_written(&self, attribute: &roxmltree::Attribute<'a, 'a>) -> Attribute<'a> {
        let text = self.text;
        let input = self.node.document().input_text();
        let span = text.span(attribute.range_value());
        let raw = text.slice(span);
        let repaired = input.get(attribute.range_value()).unwrap_or_default();
        // References are resolved; repaired text is taken as it is.
        let referring = memchr::memchr(b'&', raw.as_bytes()).is_some() && repaired == raw;
        let name = text.span(attribute.range_qname());
        Attribute {
            name: text.slice(name),
            name_place: Place::text(text.source, name),
            value: if referring {
                attribute.value().into()
            } else {
                raw.into()
            },
            span,
            verbatim: !referring,
            source: text.source,
        }
    }

    /// The elements directly inside.
    pub(super) fn children(&self) -> impl Iterator<Item = Element<'a>> + use<'a> {
        let text = self.text;
        self.node
            .children()
            .filter(Node::is_element)
            .map(move |node| Element { node, text })
    }

    /// The first element directly inside of this name.
    pub(super) fn child(&self, name: &str) -> Option<Element<'a>> {
        self.children().find(|child| child.name() == name)
    }

    /// All elements inside, however deep, and this one, in the order of the text.
    pub(super) fn descendants(&self) -> impl Iterator<Item = Element<'a>> + use<'a> {
        let text = self.text;
        self.node
            .descendants()
            .filter(Node::is_element)
            .map(move |node| Element { node, text })
    }

    /// The element around.
    pub(super) fn parent(&self) -> Option<Element<'a>> {
        let text = self.text;
        self.node.parent_element().map(|node| Element { node, text })
    }

    /// The text directly inside, without surrounding whitespace, with its place.
    pub(super) fn words(&self) -> Option<(String, Place)> {
        let node = self.node.children().find(Node::is_text)?;
        let span = self.text.span(node.range());
        let raw = self.text.slice(span);
        let words = raw.trim();
        let start = span.start + (raw.len() - raw.trim_start().len());
        let place = Place::text(self.text.source, Span::new(start, start + words.len()));
        (!words.is_empty()).then(|| (words.to_owned(), place))
    }
}
