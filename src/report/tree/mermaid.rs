//! The frame tree as Mermaid text, for Markdown pages.

use std::fmt::Write;

use crate::run::Run;

use super::label;
use super::sketch::sketches;

/// A flowchart: solid edges are constant, dotted ones move, `!` marks disputed ones; frames outside every tree are unconnected.
pub fn render(run: &Run) -> String {
    let mut out = "flowchart TD\n".to_owned();
    let sketches = sketches(run);
    let several = sketches.len() > 1;
    for (index, sketch) in sketches.iter().enumerate() {
        if several {
            let _ = writeln!(out, "  subgraph w{index}[{}]", quoted(&sketch.title));
        }
        for (number, frame) in sketch.frames.iter().enumerate() {
            let _ = writeln!(out, "  w{index}f{number}[{}]", quoted(frame));
        }
        for edge in &sketch.edges {
            let arrow = if edge.link.moves() { "-.->" } else { "-->" };
            let label = quoted(&label(&edge.link, "! "));
            let _ = writeln!(
                out,
                "  w{index}f{} {arrow}|{label}| w{index}f{}",
                edge.parent, edge.child
            );
        }
        for (number, (frame, _)) in sketch.outside.iter().enumerate() {
            let _ = writeln!(
                out,
                "  w{index}o{number}([{}])",
                quoted(&format!("{frame} (not in a tree)"))
            );
        }
        if several {
            out.push_str("  end\n");
        }
    }
    out
}

/// A quoted Mermaid string: characters with a meaning in Mermaid or HTML as entity codes.
fn quoted(text: &str) -> String {
    let mut escaped = String::with_capacity(text.len() + 2);
    escaped.push('"');
    for c in text.chars() {
        match c {
            '"' => escaped.push_str("#quot;"),
            '#' => escaped.push_str("#35;"),
            '&' => escaped.push_str("#amp;"),
            '<' => escaped.push_str("#lt;"),
            '>' => escaped.push_str("#gt;"),
            '`' => escaped.push_str("#96;"),
            '\n' => escaped.push_str("<br/>"),
            c => escaped.push(c),
        }
    }
    escaped.push('"');
    escaped
}
