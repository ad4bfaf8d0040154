//! The document model: YAML and JSON as nodes with byte spans.
//!
//! Owns the nouns; `events` builds them. Knows nothing of transforms.

use std::collections::HashMap;
use std::sync::{Arc, OnceLock};

use crate::source::Span;

/// A value of a document and its place.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Node {
    /// From the first to the last byte of the value in the source's text.
    pub(crate) span: Span,
    /// What it is.
    pub(crate) kind: Kind,
    /// Its explicit tag without the namespace (`opencv-matrix`).
    pub(crate) tag: Option<Box<str>>,
    /// Whether a fault cut it off: what it contains is right, but incomplete.
    pub(crate) cut: bool,
    /// Of a large mapping: where its keys are.
    keys: Keys,
}

/// The last pair of each key of a mapping; made at the first look-up of a key. Not part of the node's value.
#[derive(Clone, Debug, Default)]
struct Keys(OnceLock<Arc<HashMap<Box<str>, usize>>>);

impl PartialEq for Keys {
    fn eq(&self, _: &Self) -> bool {
        true
    }
}

/// Pairs of a mapping from which on keys are looked up in an index: readers look up dozens of keys, some once for each pair.
const MANY_PAIRS: usize = 32;

/// What a node is.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Kind {
    /// A scalar; its type is not decided here.
    Scalar {
        /// The text after escapes.
        text: Box<str>,
        /// Whether it was quoted.
        quoted: bool,
    },
    /// A list.
    Sequence(Vec<Node>),
    /// A mapping in file order; keys may repeat.
    Mapping(Vec<(Node, Node)>),
}

impl Node {
    /// A whole, untagged value.
    pub(crate) fn new(span: Span, kind: Kind) -> Self {
        Self {
            span,
            kind,
            tag: None,
            cut: false,
            keys: Keys::default(),
        }
    }

    /// The text of a scalar.
    pub(crate) fn text(&self) -> Option<&str> {
        match &self.kind {
            Kind::Scalar { text, .. } => Some(text),
            _ => None,
        }
    }

    /// Where the letters of a scalar begin in the source's text, after its quote. `None` where escapes or folded lines move them.
    pub(crate) fn text_start(&self, source: &str) -> Option<usize> {
        let text = self.text()?;
        (self.span.start..=self.span.start + 1).find(|start| source.get(*start..*start + text.len()) == Some(text))
    }

    /// The items of a list.
    pub(crate) fn items(&self) -> Option<&[Node]> {
        match &self.kind {
            Kind::Sequence(items) => Some(items),
            _ => None,
        }
    }

    /// The pairs of a mapping, none for anything else.
    pub(crate) fn pairs(&self) -> &[(Node, Node)] {
        match &self.kind {
            Kind::Mapping(pairs) => pairs,
            _ => &[],
        }
    }

    /// Whether it is a mapping.
    pub(crate) fn is_mapping(&self) -> bool {
        matches!(self.kind, Kind::Mapping(_))
    }

    /// The pair with this key; of repeated keys the last, as most readers take it.
    pub(crate) fn pair(&self, key: &str) -> Option<(&Node, &Node)> {
        let pairs = self.pairs();
        let found = if pairs.len() < MANY_PAIRS {
            pairs.iter().rev().find(|(k, _)| k.text() == Some(key))
        } else {
            let texts = || {
                pairs
                    .iter()
                    .enumerate()
                    .filter_map(|(at, (k, _))| Some((k.text()?.into(), at)))
            };
            let keys = self.keys.0.get_or_init(|| Arc::new(texts().collect()));
            keys.get(key).and_then(|at| pairs.get(*at))
        };
        found.map(|(k, v)| (k, v))
    }

    /// The value under a key.
    pub(crate) fn get(&self, key: &str) -> Option<&Node> {
        self.pair(key).map(|(_, value)| value)
    }
}

impl Documents {
    /// Moves all places by so many bytes.
    pub(crate) fn shift(&mut self, by: usize) {
        fn moved(node: &mut Node, by: usize) {
            node.span = Span::new(node.span.start + by, node.span.end + by);
            match &mut node.kind {
                Kind::Scalar { .. } => {}
                Kind::Sequence(items) => items.iter_mut().for_each(|item| moved(item, by)),
                Kind::Mapping(pairs) => {
                    for (key, value) in pairs {
                        moved(key, by);
                        moved(value, by);
                    }
                }
            }
        }
        self.roots.iter_mut().for_each(|root| moved(root, by));
        if let Some(fault) = &mut self.fault {
            fault.at += by;
        }
    }
}

/// Where reading stopped, and why.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Fault {
    /// The place, in the source's text.
    pub(crate) at: usize,
    /// What is wrong, in plain words.
    pub(crate) message: String,
}

/// All documents of a text.
#[derive(Clone, Debug, Default)]
pub(crate) struct Documents {
    /// The root of each document.
    pub(crate) roots: Vec<Node>,
    /// Keys that occur twice in one mapping, with the place of the later one.
    pub(crate) repeated: Vec<(String, Span)>,
    /// Braces of a template engine (`{{ name }}`).
    pub(crate) templates: Vec<Span>,
    /// Why reading stopped early.
    pub(crate) fault: Option<Fault>,
}
