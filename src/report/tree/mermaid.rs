//! The frame tree as Mermaid text, for Markdown pages.

use std::collections::BTreeMap;
use std::fmt::Write;

use crate::run::Run;

use super::super::place::Locator;
use super::{Links, Names, label, outsiders, shown, title, worlds};

/// A flowchart: solid edges are constant, dotted ones move, `!` marks disputed ones; frames outside every tree stand alone.
pub fn render(run: &Run) -> String {
    let locator = Locator::inside(&run.sources);
    let mut out = "flowchart TD\n".to_owned();
    let several = worlds(run).count() > 1;
    for (index, world) in worlds(run).enumerate() {
        let names = Names::new(world, &locator);
        if several {
            let _ = writeln!(out, "  subgraph w{index}[{}]", quoted(&title(world, &names)));
        }
        let links = Links::new(world, &names, "x");
        let mut ids: BTreeMap<&str, String> = BTreeMap::new();
        for frame in &world.graph().frames {
            let id = format!("w{index}f{}", ids.len());
            let _ = writeln!(out, "  {id}[{}]", quoted(&shown(frame.as_str())));
            ids.insert(frame.as_str(), id);
        }
        for ((parent, child), link) in &links.of {
            if let (Some(from), Some(to)) = (ids.get(parent.as_str()), ids.get(child.as_str())) {
                let arrow = if link.moves() { "-.->" } else { "-->" };
                let _ = writeln!(out, "  {from} {arrow}|{}| {to}", quoted(&label(link, "! ")));
            }
        }
        let outside = outsiders(world, &names);
        for (number, frame) in outside.iter().flat_map(BTreeMap::keys).enumerate() {
            let _ = writeln!(
                out,
                "  w{index}o{number}([{}])",
                quoted(&format!("{} (in no tree)", shown(frame)))
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
