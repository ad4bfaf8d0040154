//! The frame tree as Graphviz text.

use std::fmt::Write;

use crate::run::Run;

use super::sketch::sketches;
use super::{Link, label};

/// A directed graph: solid edges are constant, dashed ones move, red ones are disputed; frames outside every tree are dotted.
pub fn render(run: &Run) -> String {
    let mut out = "digraph frames {\n  rankdir=TB;\n  node [shape=box, fontname=\"sans-serif\"];\n".to_owned();
    let sketches = sketches(run);
    let several = sketches.len() > 1;
    for (index, sketch) in sketches.iter().enumerate() {
        if several {
            let _ = writeln!(out, "  subgraph cluster_{index} {{\n  label={};", quoted(&sketch.title));
        }
        for (number, frame) in sketch.frames.iter().enumerate() {
            let _ = writeln!(out, "  w{index}f{number} [label={}];", quoted(frame));
        }
        for edge in &sketch.edges {
            let (label, look) = (quoted(&label(&edge.link, "")), look(&edge.link));
            let _ = writeln!(
                out,
                "  w{index}f{} -> w{index}f{} [label={label}{look}];",
                edge.parent, edge.child
            );
        }
        for (number, (frame, _)) in sketch.outside.iter().enumerate() {
            let _ = writeln!(out, "  w{index}o{number} [label={}, style=dotted];", quoted(frame));
        }
        if several {
            out.push_str("  }\n");
        }
    }
    out.push_str("}\n");
    out
}

fn look(link: &Link) -> &'static str {
    match (link.is_disputed(), link.moves()) {
        (true, _) => ", color=red, fontcolor=red",
        (false, true) => ", style=dashed",
        (false, false) => "",
    }
}

/// A string of the DOT language: only quotes, backslashes and newlines need care.
fn quoted(text: &str) -> String {
    let escaped = text.replace('\\', "\\\\").replace('"', "\\\"").replace('\n', "\\n");
    format!("\"{escaped}\"")
}
