//! Syntax trees of programming languages, as tree-sitter builds them: with places, and across syntax errors.

use std::ops::ControlFlow;

use tree_sitter::{Language, Node, ParseOptions, ParseState, Parser, Tree};

use crate::source::Span;

/// The parser looks up every 100 steps. It may do so this often before it is stopped, for a text of any length: in a text with errors it
/// considers every possible continuation, and for some texts it does not end.
const MIN_CHECKS: usize = 2000;
/// And once more for this number of bytes. Of 10,000 correct files of C++, Python and Rust the hardest needed one for 17 bytes.
const BYTES_PER_CHECK: usize = 4;

/// Deepest nesting of brackets that is parsed: time grows with its square. Code that people write has some twenty levels.
const MAX_DEPTH: usize = 1000;

/// The tree of a text; otherwise where the parser was stopped, and why.
pub(super) fn parse(text: &str, language: &Language) -> Result<Tree, (Span, String)> {
    let start = Span::new(0, 0);
    if let Some(at) = too_deep(text) {
        let message = format!("brackets are nested more than {MAX_DEPTH} deep here");
        return Err((Span::new(at, at + 1), message));
    }
    let mut parser = Parser::new();
    parser
        .set_language(language)
        .map_err(|error| (start, error.to_string()))?;
    let mut left = MIN_CHECKS + text.len() / BYTES_PER_CHECK;
    let mut at = 0;
    let mut progress = |state: &ParseState| {
        at = at.max(state.current_byte_offset());
        left = left.saturating_sub(1);
        if left > 0 {
            ControlFlow::Continue(())
        } else {
            ControlFlow::Break(())
        }
    };
    let options = ParseOptions::new().progress_callback(&mut progress);
    let mut rest = |at: usize, _| text.as_bytes().get(at..).unwrap_or_default();
    parser
        .parse_with_options(&mut rest, None, Some(options))
        .ok_or_else(|| {
            let at = (0..=at.min(text.len()))
                .rev()
                .find(|at| text.is_char_boundary(*at))
                .unwrap_or(0);
            let message = "the text before this has too many syntax errors to be parsed".to_owned();
            (Span::new(at, at), message)
        })
}

/// The bracket that is nested too deep. Those in words and comments count as well.
fn too_deep(text: &str) -> Option<usize> {
    let mut depth = 0_usize;
    text.bytes().position(|byte| {
        match byte {
            b'(' | b'[' | b'{' => depth += 1,
            b')' | b']' | b'}' => depth = depth.saturating_sub(1),
            _ => {}
        }
        depth > MAX_DEPTH
    })
}

/// All nodes below one, itself among them, in the order of the text.
pub(super) fn nodes(root: Node<'_>) -> Vec<Node<'_>> {
    let mut found = Vec::new();
    let mut cursor = root.walk();
    loop {
        found.push(cursor.node());
        if cursor.goto_first_child() {
            continue;
        }
        while !cursor.goto_next_sibling() {
            if !cursor.goto_parent() || cursor.node() == root {
                return found;
            }
        }
    }
}

/// Named children.
pub(super) fn children(node: Node<'_>) -> Vec<Node<'_>> {
    node.named_children(&mut node.walk()).collect()
}

pub(super) fn span(node: Node<'_>) -> Span {
    Span::from(node.byte_range())
}

/// The text of a node.
pub(super) fn text<'a>(node: Node<'_>, source: &'a str) -> &'a str {
    source.get(node.byte_range()).unwrap_or_default()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn brackets_without_end_are_refused_where_they_are_too_deep() {
        let language = tree_sitter_python::LANGUAGE.into();
        for bracket in ["(", "[", "{"] {
            let deep = format!("x = {}", bracket.repeat(200_000));
            let (span, message) = parse(&deep, &language).unwrap_err();
            assert_eq!(span.start, 4 + MAX_DEPTH);
            assert!(message.contains("nested more than 1000 deep"), "{message}");
        }
        let wide = format!("x = {}", "(1)+".repeat(20_000) + "1");
        assert!(parse(&wide, &language).is_ok());
    }
}
