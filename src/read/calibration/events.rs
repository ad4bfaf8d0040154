//! From the YAML parser's events to documents, within bounds.
//!
//! Aliases are expanded up to a cap, nesting is limited (through aliases as well), and a fault ends reading; everything
//! before it is kept. Knows nothing of transforms.

use std::collections::{BTreeMap, BTreeSet};

use granit_parser::{ErrorKind, Event, Parser, ScalarStyle, ScanError, StructureStyle, Tag};

use crate::source::Span;

use super::document::{Documents, Fault, Kind, Node};
use super::repair::OffsetMap;

/// Nodes that aliases may add. Expansion of nested aliases grows without bound otherwise ("billion laughs").
const MAX_ALIASED: usize = 200_000;
/// Nodes of a document, about 100 bytes each.
const MAX_NODES: usize = 1_000_000;
/// Deepest nesting of collections; the parser refuses more.
const MAX_DEPTH: usize = 200;

/// How far the parser looks for the colon that would make a `{` or `[` a key, in characters: YAML's own limit, and a
/// short one. With the first, a fault hides everything before it.
const LOOKAHEADS: [usize; 2] = [1024, 64];

/// Reads all documents of `text`; `map` converts spans to the source's text.
pub(crate) fn build(text: &str, map: &OffsetMap) -> Documents {
    let [long, short] = LOOKAHEADS;
    let documents = build_with(text, map, long);
    if documents.fault.is_none() || !documents.roots.is_empty() {
        return documents;
    }
    let nearer = build_with(text, map, short);
    if nearer.roots.is_empty() { documents } else { nearer }
}

fn build_with(text: &str, map: &OffsetMap, lookahead: usize) -> Documents {
    let options = granit_parser::options! {
        emit_comments: false,
        flow_nesting_limit: MAX_DEPTH,
        block_nesting_limit: MAX_DEPTH,
        simple_key_max_lookahead: lookahead,
    };
    let mut builder = Builder::new(text, map);
    for next in Parser::new_from_str_with_options(text, options) {
        let step = match next {
            Ok((event, span)) => builder.event(event, &span),
            Err(error) => Err(Fault {
                at: map.back(error.marker().byte_offset().unwrap_or(0)),
                message: plain(&error),
            }),
        };
        if let Err(fault) = step {
            builder.cut_off();
            builder.out.fault = Some(fault);
            break;
        }
    }
    builder.out
}

/// An unfinished collection.
struct OpenCollection {
    node: Node,
    key: Option<Node>,
    anchor: usize,
    flow: bool,
    tag_start: Option<usize>,
}

/// A value under an anchor, with its number of nodes and its depth.
#[derive(Clone)]
struct AnchorValue {
    /// `None` where the values under anchors are too many to be kept twice.
    node: Option<Node>,
    size: usize,
    depth: usize,
}

struct Builder<'a> {
    text: &'a str,
    map: &'a OffsetMap,
    open: Vec<OpenCollection>,
    anchors: BTreeMap<usize, AnchorValue>,
    nodes: usize,
    aliased: usize,
    /// Nodes kept under anchors. Anchors inside of anchors contain the same values again.
    anchored: usize,
    out: Documents,
}

impl<'a> Builder<'a> {
    fn new(text: &'a str, map: &'a OffsetMap) -> Self {
        Self {
            text,
            map,
            open: Vec::new(),
            anchors: BTreeMap::new(),
            nodes: 0,
            aliased: 0,
            anchored: 0,
            out: Documents::default(),
        }
    }

    fn span(&self, span: &granit_parser::Span) -> Span {
        let range = span.byte_range().unwrap_or(0..0);
        Span::new(self.map.back(range.start), self.map.back(range.end))
    }

    fn event(&mut self, event: Event<'_>, at: &granit_parser::Span) -> Result<(), Fault> {
        let span = self.span(at);
        match event {
            Event::DocumentStart(..) => self.anchors.clear(),
            Event::Scalar(text, style, anchor, tag) => {
                let quoted = style != ScalarStyle::Plain;
                let mut node = Node::new(
                    span,
                    Kind::Scalar {
                        text: text.into(),
                        quoted,
                    },
                );
                node.tag = tag_name(tag.as_deref());
                self.count(1, span)?;
                self.remember(anchor, &node);
                self.push(node);
            }
            Event::SequenceStart(style, anchor, tag) => {
                self.start(Kind::Sequence(Vec::new()), style, anchor, tag.as_deref(), at)?;
            }
            Event::MappingStart(style, anchor, tag) => {
                let start = at.byte_range().map_or(0, |range| range.start);
                if style == StructureStyle::Flow && self.text.get(start..).is_some_and(|rest| rest.starts_with("{{")) {
                    self.out.templates.push(span);
                }
                self.start(Kind::Mapping(Vec::new()), style, anchor, tag.as_deref(), at)?;
            }
            Event::SequenceEnd | Event::MappingEnd => self.end(span),
            Event::Alias(id) => {
                let fault = |message: String| Fault {
                    at: span.start,
                    message,
                };
                let anchored = self
                    .anchors
                    .get(&id)
                    .ok_or_else(|| fault("this alias refers to a value that contains it".to_owned()))?;
                self.aliased += anchored.size;
                let Some(node) = anchored.node.clone().filter(|_| self.aliased <= MAX_ALIASED) else {
                    return Err(fault(format!("aliases expand to more than {MAX_ALIASED} values")));
                };
                // Nesting stays bounded through aliases as well: readers of a document may recurse.
                if self.open.len() + anchored.depth > MAX_DEPTH {
                    return Err(fault(format!("values are nested more than {MAX_DEPTH} levels deep")));
                }
                self.count(anchored.size, span)?;
                self.push(node);
            }
            _ => {}
        }
        Ok(())
    }

    fn count(&mut self, nodes: usize, span: Span) -> Result<(), Fault> {
        self.nodes += nodes;
        if self.nodes > MAX_NODES {
            return Err(Fault {
                at: span.start,
                message: format!("the file contains more than {MAX_NODES} values; it is read up to here"),
            });
        }
        Ok(())
    }

    fn start(
        &mut self,
        kind: Kind,
        style: StructureStyle,
        anchor: usize,
        tag: Option<&Tag>,
        at: &granit_parser::Span,
    ) -> Result<(), Fault> {
        let span = self.span(at);
        self.count(1, span)?;
        let mut node = Node::new(span, kind);
        node.tag = tag_name(tag);
        self.open.push(OpenCollection {
            node,
            key: None,
            anchor,
            flow: style == StructureStyle::Flow,
            tag_start: at.tag_start().and_then(|mark| mark.byte_offset()),
        });
        Ok(())
    }

    /// Closes the innermost collection. In block style the end is where its last item ends; the event itself is at
    /// the next token.
    fn end(&mut self, at: Span) {
        let Some(mut open) = self.open.pop() else { return };
        let last = match &open.node.kind {
            Kind::Sequence(items) => items.last().map(|item| item.span.end),
            Kind::Mapping(pairs) => pairs.last().map(|(key, value)| value.span.end.max(key.span.end)),
            Kind::Scalar { .. } => None,
        };
        let end = if open.flow { Some(at.end) } else { last };
        if let Some(tag) = open.tag_start {
            open.node.span.start = open.node.span.start.min(self.map.back(tag));
        }
        open.node.span.end = end.unwrap_or(open.node.span.end).max(open.node.span.start);
        if let Kind::Mapping(pairs) = &mut open.node.kind {
            merge(pairs);
            repeated(pairs, &mut self.out.repeated);
        }
        self.remember(open.anchor, &open.node);
        self.push(open.node);
    }

    fn remember(&mut self, anchor: usize, node: &Node) {
        if anchor != 0 {
            let (size, depth) = measure(node);
            let fits = self.anchored + size <= MAX_NODES;
            let node = fits.then(|| node.clone());
            self.anchored += if fits { size } else { 0 };
            self.anchors.insert(anchor, AnchorValue { node, size, depth });
        }
    }

    fn push(&mut self, node: Node) {
        let Some(open) = self.open.last_mut() else {
            self.out.roots.push(node);
            return;
        };
        match &mut open.node.kind {
            Kind::Sequence(items) => items.push(node),
            Kind::Mapping(pairs) => match open.key.take() {
                None => open.key = Some(node),
                Some(key) => pairs.push((key, node)),
            },
            Kind::Scalar { .. } => {}
        }
    }

    /// Closes everything that is open after a fault. Incomplete values are marked, and an incomplete list is
    /// dropped with its numbers: nine numbers of sixteen are not a rotation.
    fn cut_off(&mut self) {
        while let Some(mut open) = self.open.pop() {
            open.node.cut = true;
            let keep = match &open.node.kind {
                Kind::Sequence(items) => items.iter().any(Node::is_mapping),
                _ => true,
            };
            if keep {
                let end = match &open.node.kind {
                    Kind::Sequence(items) => items.last().map(|item| item.span.end),
                    Kind::Mapping(pairs) => pairs.last().map(|(_, value)| value.span.end),
                    Kind::Scalar { .. } => None,
                };
                open.node.span.end = end.unwrap_or(open.node.span.end).max(open.node.span.start);
                self.push(open.node);
            } else if let Some(parent) = self.open.last_mut() {
                parent.key = None;
            }
        }
    }
}

/// Number of nodes in a value, itself included, and its depth.
fn measure(node: &Node) -> (usize, usize) {
    let (mut count, mut deepest) = (0, 0);
    let mut todo = vec![(node, 1)];
    while let Some((node, depth)) = todo.pop() {
        count += 1;
        deepest = deepest.max(depth);
        match &node.kind {
            Kind::Scalar { .. } => {}
            Kind::Sequence(items) => todo.extend(items.iter().map(|item| (item, depth + 1))),
            Kind::Mapping(pairs) => {
                todo.extend(
                    pairs
                        .iter()
                        .flat_map(|(key, value)| [(key, depth + 1), (value, depth + 1)]),
                );
            }
        }
    }
    (count, deepest)
}

/// Merge keys (`<<: *base`): pairs of the base that the mapping does not contain itself.
fn merge(pairs: &mut Vec<(Node, Node)>) {
    let Some(at) = pairs
        .iter()
        .position(|(key, value)| key.text() == Some("<<") && value.is_mapping())
    else {
        return;
    };
    let (_, base) = pairs.remove(at);
    if let Kind::Mapping(inherited) = base.kind {
        let mut own: BTreeSet<String> = pairs
            .iter()
            .filter_map(|(key, _)| key.text().map(str::to_owned))
            .collect();
        for (key, value) in inherited {
            if key.text().is_none_or(|text| own.insert(text.to_owned())) {
                pairs.push((key, value));
            }
        }
    }
}

fn repeated(pairs: &[(Node, Node)], out: &mut Vec<(String, Span)>) {
    let mut seen = BTreeSet::new();
    for (key, _) in pairs {
        if let Some(text) = key.text()
            && !seen.insert(text)
        {
            out.push((text.to_owned(), key.span));
        }
    }
}

fn tag_name(tag: Option<&Tag>) -> Option<Box<str>> {
    tag.map(|tag| tag.suffix().trim_start_matches('!').into())
}

/// A parser's error in plain words.
fn plain(error: &ScanError) -> String {
    match error.kind() {
        ErrorKind::RecursionLimitExceeded => format!("values are nested more than {MAX_DEPTH} levels deep"),
        ErrorKind::TabNotAllowed | ErrorKind::TabInBlockIndentation | ErrorKind::TabInIndentation => {
            "there is a tab where only spaces are allowed".to_owned()
        }
        ErrorKind::UnknownAnchor => "this alias refers to no anchor above it".to_owned(),
        ErrorKind::SimpleKeyExpected | ErrorKind::InvalidSimpleKey => {
            "this line is not `key: value` (is the space after the colon missing?)".to_owned()
        }
        ErrorKind::UnclosedFlowCollection { open } => format!("`{open}` is never closed"),
        ErrorKind::UnexpectedEofFlowSequence => "the file ends inside `[ ... ]`".to_owned(),
        ErrorKind::UnexpectedEofFlowMapping => "the file ends inside `{ ... }`".to_owned(),
        ErrorKind::UnclosedQuotedScalar => "a quotation mark is never closed".to_owned(),
        _ => error.info(),
    }
}
