//! The frame trees at one timestamp: which edges exist then, what they were made from, and which do not exist.

use std::collections::{BTreeMap, BTreeSet};
use std::fmt::Write;

use crate::run::Run;
use crate::world::tf2::{Buffer, Extrapolation, Factor};
use crate::world::{FrameId, World};

use super::super::Style;
use super::super::place::Locator;
use super::super::style::Ink;
use super::super::text::{one_line, stamp};
use super::origin::{age, rooms, seconds, who};
use super::{Names, pose_words, shown, title};

/// Maximum depth of indentation.
const MAX_INDENT: usize = 24;

/// The trees of every world and namespace at a timestamp.
pub fn render(run: &Run, at_ns: i64, style: Style) -> String {
    let locator = Locator::inside(&run.sources);
    let rooms = rooms(run);
    let mut out = format!("{}\n", style.paint(Ink::Strong, &format!("At {}", stamp(at_ns))));
    for (world, namespace) in &rooms {
        let names = Names::new(world, &locator);
        out.push('\n');
        if rooms.len() > 1 {
            let whose = format!("{}, TF of {namespace}", title(world, &names));
            let _ = writeln!(out, "{}", style.paint(Ink::Strong, &one_line(&whose)));
        }
        room(world, namespace, at_ns, &names, style, &mut out);
    }
    out
}

fn room(world: &World, namespace: &str, at_ns: i64, names: &Names<'_>, style: Style, out: &mut String) {
    let (buffer, origins) = world.tf2(namespace);
    let mut children: BTreeMap<FrameId, Vec<Factor>> = BTreeMap::new();
    let mut silent: BTreeMap<&FrameId, Extrapolation> = BTreeMap::new();
    for (child, edge) in buffer.edges_at(at_ns) {
        match edge {
            Ok(edge) => children.entry(edge.parent.clone()).or_default().push(edge),
            Err(what) => {
                silent.insert(child, what);
            }
        }
    }
    for edges in children.values_mut() {
        edges.sort_by(|a, b| a.child.cmp(&b.child));
    }
    let below: BTreeSet<FrameId> = children.values().flatten().map(|edge| edge.child.clone()).collect();
    let mut roots: Vec<&FrameId> = buffer.frames().filter(|frame| !below.contains(*frame)).collect();
    roots.sort();
    let who = |edge: &Factor| {
        let mut said = format!("{}, {}", who(world, &origins, edge, names), age(edge.made_from, at_ns));
        let others: Vec<String> = others(&buffer, edge);
        if !others.is_empty() {
            let _ = write!(said, "; at other times under {}", others.join(", "));
        }
        said
    };
    let mut opened: BTreeSet<FrameId> = BTreeSet::new();
    // Frames on a cycle have no root.
    let looped = below.iter();
    for (start, is_loop) in roots
        .into_iter()
        .map(|root| (root, false))
        .chain(looped.map(|frame| (frame, true)))
    {
        if opened.contains(start) || (!is_loop && !children.contains_key(start)) {
            continue;
        }
        let note = if is_loop { "  ! the parents form a cycle" } else { "" };
        let _ = writeln!(out, "{}{note}", style.paint(Ink::Strong, &shown(start.as_str())));
        opened.insert(start.clone());
        let mut stack = vec![(start.clone(), String::new(), 0, 0)];
        // Frame, prefix of its children, depth, and the number of children already written.
        while let Some((frame, indent, depth, written)) = stack.pop() {
            let edges = children.get(&frame).map_or(&[][..], Vec::as_slice);
            let Some(edge) = edges.get(written) else { continue };
            let is_last = written + 1 == edges.len();
            let branch = if is_last {
                style.pick("└─ ", "`- ")
            } else {
                style.pick("├─ ", "|- ")
            };
            let name = style.paint(Ink::Strong, &shown(edge.child.as_str()));
            let (pose, said) = (pose_words(&edge.parent_from_child), who(edge));
            let _ = writeln!(
                out,
                "{indent}{branch}{name}  {pose}  {}",
                style.paint(Ink::Faint, &said)
            );
            let mut below = indent.clone();
            if depth < MAX_INDENT {
                below.push_str(if is_last { "   " } else { style.pick("│  ", "|  ") });
            }
            stack.push((frame, indent, depth, written + 1));
            if opened.insert(edge.child.clone()) {
                stack.push((edge.child.clone(), below, depth + 1, 0));
            }
        }
    }
    if !silent.is_empty() {
        let _ = writeln!(
            out,
            "\n{}",
            style.paint(
                Ink::Strong,
                "Without a parent at this time, but with one at other times"
            )
        );
    }
    for (child, what) in silent {
        let parents = buffer
            .parents_ever(child)
            .into_iter()
            .map(|parent| format!("`{}`", shown(parent.as_str())));
        let under = parents.collect::<Vec<_>>().join(", ");
        let _ = writeln!(out, "  {}  under {under}: {}", shown(child.as_str()), when(what));
    }
}

/// Other parents of the edge's child.
fn others(buffer: &Buffer, edge: &Factor) -> Vec<String> {
    let parents = buffer.parents_ever(&edge.child).into_iter();
    parents
        .filter(|parent| **parent != edge.parent)
        .map(|parent| format!("`{}`", shown(parent.as_str())))
        .collect()
}

fn when(what: Extrapolation) -> String {
    match what {
        Extrapolation::Past {
            requested_ns,
            earliest_ns,
        } => format!("begins {} s later", seconds(earliest_ns.saturating_sub(requested_ns))),
        Extrapolation::Future {
            requested_ns,
            latest_ns,
        } => format!("ended {} s before", seconds(requested_ns.saturating_sub(latest_ns))),
        Extrapolation::Single { requested_ns, only_ns } if only_ns > requested_ns => {
            format!(
                "a single sample {} s later",
                seconds(only_ns.saturating_sub(requested_ns))
            )
        }
        Extrapolation::Single { requested_ns, only_ns } => {
            format!(
                "a single sample {} s before",
                seconds(requested_ns.saturating_sub(only_ns))
            )
        }
    }
}
