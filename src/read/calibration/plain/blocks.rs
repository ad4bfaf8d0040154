//! Texts of keys in sections or braces: ini files, Boost's info files, and tables of Lua.

use super::super::document::{Fault, Kind, Node};
use super::lines::{fault, mapping};
use super::{scalar, text_lines, value, words};
use crate::source::Span;

/// Deepest nesting of blocks.
const MAX_DEPTH: usize = 100;

/// Where a part of a text begins in it.
fn offset(part: &str, whole: &str) -> usize {
    part.as_ptr() as usize - whole.as_ptr() as usize
}

/// `[section]` and `key = value`; `//`, `;` and `#` begin comments.
pub(super) fn ini(text: &str) -> (Node, Option<Fault>) {
    let mut sections: Vec<(Node, Vec<(Node, Node)>)> = Vec::new();
    for (start, line) in text_lines(text) {
        let end = ["//", ";", "#"].iter().filter_map(|mark| line.find(mark)).min();
        let said = end.and_then(|end| line.get(..end)).unwrap_or(line).trim();
        if said.is_empty() {
            continue;
        }
        let at = start + offset(said, line);
        let section = said.strip_prefix('[').and_then(|rest| rest.strip_suffix(']'));
        if let Some(name) = section {
            sections.push((scalar(name, Span::new(at + 1, at + 1 + name.len())), Vec::new()));
        } else if let Some((key, rest)) = said.split_once('=') {
            let key = key.trim();
            let behind = at + offset(rest, said);
            let name = scalar(key, Span::new(at, at + key.len()));
            let entry = (name, value(words(rest, behind).collect(), behind));
            match sections.last_mut() {
                Some((_, entries)) => entries.push(entry),
                None => sections.push((scalar("", Span::new(at, at)), vec![entry])),
            }
        }
    }
    let section = |(name, entries): (Node, Vec<(Node, Node)>)| {
        let end = entries.last().map_or(name.span.end, |(_, value)| value.span.end);
        let span = Span::new(name.span.start, end.max(name.span.end));
        (name, Node::new(span, Kind::Mapping(entries)))
    };
    (mapping(text, sections.into_iter().map(section).collect()), None)
}

/// `key value` and `{ }`; `;` begins a comment, `#` a directive.
pub(super) fn info(text: &str) -> (Node, Option<Fault>) {
    let mut open: Vec<(Node, Vec<(Node, Node)>)> = vec![(scalar("", Span::new(0, 0)), Vec::new())];
    for (start, line) in text_lines(text) {
        let said = line.split(';').next().unwrap_or_default().trim();
        if said.is_empty() || said.starts_with('#') {
            continue;
        }
        let at = start + offset(said, line);
        match said {
            "{" => {
                let Some(name) = open
                    .last_mut()
                    .and_then(|(_, entries)| entries.pop())
                    .map(|(key, _)| key)
                else {
                    return (closed(text, open), Some(fault(at, "a block has no name")));
                };
                if open.len() > MAX_DEPTH {
                    return (closed(text, open), Some(fault(at, "blocks are nested too deep")));
                }
                open.push((name, Vec::new()));
            }
            "}" => {
                let Some((name, entries)) = (open.len() > 1).then(|| open.pop()).flatten() else {
                    return (
                        closed(text, open),
                        Some(fault(at, "there is a `}` without a `{` before it")),
                    );
                };
                let span = Span::new(name.span.start, at + 1);
                if let Some((_, above)) = open.last_mut() {
                    above.push((name, Node::new(span, Kind::Mapping(entries))));
                }
            }
            _ => {
                let mut all = words(said, at);
                let Some((key, span)) = all.next() else { continue };
                let entry = (scalar(key, span), value(all.collect(), span.end));
                if let Some((_, entries)) = open.last_mut() {
                    entries.push(entry);
                }
            }
        }
    }
    let unclosed = (open.len() > 1).then(|| fault(text.len(), "a block is never closed"));
    (closed(text, open), unclosed)
}

/// All blocks that are open, closed where the reading ends.
fn closed(text: &str, mut open: Vec<(Node, Vec<(Node, Node)>)>) -> Node {
    while open.len() > 1 {
        let Some((name, entries)) = open.pop() else { break };
        let mut node = Node::new(Span::new(name.span.start, text.len()), Kind::Mapping(entries));
        node.cut = true;
        if let Some((_, above)) = open.last_mut() {
            above.push((name, node));
        }
    }
    mapping(text, open.pop().map(|(_, entries)| entries).unwrap_or_default())
}

/// The texts and numbers that Lua tables give to names; computed values are not followed.
pub(super) fn lua(text: &str) -> (Node, Option<Fault>) {
    let mut entries = Vec::new();
    for (start, line) in text_lines(text) {
        let said = line.split("--").next().unwrap_or_default();
        let Some((key, rest)) = said.split_once('=') else {
            continue;
        };
        let (key, rest) = (key.trim(), rest.trim().trim_end_matches([',', ';']).trim());
        let is_name = |key: &str| {
            !key.is_empty()
                && key
                    .chars()
                    .all(|letter| letter.is_alphanumeric() || "_.".contains(letter))
        };
        let plain = rest
            .strip_prefix('"')
            .and_then(|rest| rest.strip_suffix('"'))
            .unwrap_or(rest);
        if !is_name(key) || plain.contains(['{', '}', '(', '"']) {
            continue;
        }
        let at = |part: &str| Span::new(start + offset(part, line), start + offset(part, line) + part.len());
        entries.push((scalar(key, at(key)), scalar(plain, at(plain))));
    }
    (mapping(text, entries), None)
}
