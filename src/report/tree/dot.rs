//! The frame tree as Graphviz text.

use std::collections::BTreeMap;
use std::fmt::Write;

use crate::run::Run;

use super::super::place::Locator;
use super::{Link, Links, Names, label, outsiders, shown, title, worlds};

/// A directed graph: solid edges are constant, dashed ones move, red ones are disputed; frames outside every tree are dotted.
pub fn render(run: &Run) -> String {
    let locator = Locator::inside(&run.sources);
    let mut out = "digraph frames {\n  rankdir=TB;\n  node [shape=box, fontname=\"sans-serif\"];\n".to_owned();
    let several = worlds(run).count() > 1;
    for (index, world) in worlds(run).enumerate() {
        let names = Names::new(world, &locator);
        if several {
            let _ = writeln!(
                out,
                "  subgraph cluster_{index} {{\n  label={};",
                quoted(&title(world, &names))
            );
        }
        let links = Links::new(world, &names, "x");
        let mut ids: BTreeMap<&str, String> = BTreeMap::new();
        for frame in &world.graph().frames {
            let id = format!("w{index}f{}", ids.len());
            let _ = writeln!(out, "  {id} [label={}];", quoted(&shown(frame.as_str())));
            ids.insert(frame.as_str(), id);
        }
        for ((parent, child), link) in &links.of {
            if let (Some(from), Some(to)) = (ids.get(parent.as_str()), ids.get(child.as_str())) {
                let _ = writeln!(
                    out,
                    "  {from} -> {to} [label={}{}];",
                    quoted(&label(link, "")),
                    look(link)
                );
            }
        }
        let outside = outsiders(world, &names);
        for (number, frame) in outside.iter().flat_map(BTreeMap::keys).enumerate() {
            let _ = writeln!(
                out,
                "  w{index}o{number} [label={}, style=dotted];",
                quoted(&shown(frame))
            );
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
