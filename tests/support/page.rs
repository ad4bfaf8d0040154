//! A page of HTML as the parser of browsers reads it: what it complains of, and what stands where.
//!
//! Also a part of the unit tests of the report.

use std::cell::RefCell;

use html5ever::tendril::TendrilSink;
use html5ever::{ParseOpts, parse_document};
use markup5ever_rcdom::{Handle, NodeData, RcDom};

/// A parsed page.
pub(crate) struct Page {
    dom: RcDom,
    /// What the parser complains of.
    pub(crate) errors: Vec<String>,
}

/// One part of a selector: `a`, `.finding`, `tr.item`, `#made`, `[onerror]`, `a[href^=http]`, `[id=plot-1]`.
struct Compound {
    tag: String,
    /// Name, how it is compared (nothing, `=` whole, `~` a word of it, `^` its beginning), and with what.
    attributes: Vec<(String, char, String)>,
}

impl Page {
    /// Reads a page.
    pub(crate) fn parse(text: &str) -> Self {
        let dom = parse_document(RcDom::default(), ParseOpts::default()).one(text);
        let errors = RefCell::borrow(&dom.errors).iter().map(ToString::to_string).collect();
        Self { dom, errors }
    }

    /// The texts of the elements that a selector finds, in order. Of selectors it knows compounds with blanks between them, and commas.
    pub(crate) fn texts(&self, selector: &str) -> Vec<String> {
        self.find(selector).iter().map(text).collect()
    }

    /// The values of an attribute of the elements that a selector finds.
    pub(crate) fn attributes(&self, selector: &str, name: &str) -> Vec<String> {
        let found = self.find(selector);
        found.iter().filter_map(|element| attribute(element, name)).collect()
    }

    fn find(&self, selector: &str) -> Vec<Handle> {
        let ways: Vec<Vec<Compound>> = selector
            .split(", ")
            .map(|way| way.split(' ').map(Compound::parse).collect())
            .collect();
        let mut found = Vec::new();
        descend(&self.dom.document, &mut Vec::new(), &mut |element, above| {
            let fits = |way: &Vec<Compound>| {
                let (last, before) = way.split_last().expect("a selector");
                let mut above = above.iter().rev();
                last.fits(element) && before.iter().rev().all(|part| above.any(|one| part.fits(one)))
            };
            if ways.iter().any(fits) {
                found.push(element.clone());
            }
        });
        found
    }
}

impl Compound {
    fn parse(text: &str) -> Self {
        let mut attributes = Vec::new();
        let mut rest = text;
        let end = |rest: &str| rest.find(['.', '#', '[']).unwrap_or(rest.len());
        let (tag, others) = rest.split_at(end(rest));
        rest = others;
        while let Some(sign) = rest.chars().next() {
            let inner = rest.get(1..).unwrap_or_default();
            if sign == '[' {
                let (inside, behind) = inner.split_once(']').expect("a closed bracket");
                let (name, value) = inside.split_once('=').unwrap_or((inside, ""));
                let how = match (inside.contains('='), name.strip_suffix('^')) {
                    (false, _) => (name, ' '),
                    (true, Some(name)) => (name, '^'),
                    (true, None) => (name, '='),
                };
                attributes.push((how.0.to_owned(), how.1, value.to_owned()));
                rest = behind;
            } else {
                let (word, behind) = inner.split_at(end(inner));
                let (name, how) = if sign == '#' { ("id", '=') } else { ("class", '~') };
                attributes.push((name.to_owned(), how, word.to_owned()));
                rest = behind;
            }
        }
        Self {
            tag: tag.to_owned(),
            attributes,
        }
    }

    fn fits(&self, element: &Handle) -> bool {
        let NodeData::Element { name, .. } = &element.data else {
            return false;
        };
        let has = |(key, how, wanted): &(String, char, String)| {
            attribute(element, key).is_some_and(|value| match how {
                '=' => value == *wanted,
                '^' => value.starts_with(wanted.as_str()),
                '~' => value.split_whitespace().any(|word| word == wanted),
                _ => true,
            })
        };
        (self.tag.is_empty() || *name.local == *self.tag) && self.attributes.iter().all(has)
    }
}

fn descend(node: &Handle, above: &mut Vec<Handle>, see: &mut impl FnMut(&Handle, &[Handle])) {
    if matches!(node.data, NodeData::Element { .. }) {
        see(node, above);
    }
    above.push(node.clone());
    for child in node.children.borrow().iter() {
        descend(child, above, see);
    }
    above.pop();
}

fn attribute(element: &Handle, name: &str) -> Option<String> {
    let NodeData::Element { attrs, .. } = &element.data else {
        return None;
    };
    let attrs = attrs.borrow();
    let found = attrs.iter().find(|one| *one.name.local == *name)?;
    Some(found.value.to_string())
}

fn text(node: &Handle) -> String {
    match &node.data {
        NodeData::Text { contents } => contents.borrow().to_string(),
        _ => node.children.borrow().iter().map(text).collect(),
    }
}
