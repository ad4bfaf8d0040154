//! The frame tree as text, for a terminal.

use std::collections::{BTreeMap, BTreeSet};
use std::fmt::Write;

use crate::run::Run;
use crate::world::graph::Component;
use crate::world::{FrameId, World};

use super::super::Style;
use super::super::place::Locator;
use super::super::style::Ink;
use super::super::text::{one_line, plural};
use super::{Link, Links, Names, outsiders, pose_words, shown, title, worlds};

/// Maximum depth of indentation: a chain of thousands of frames stays readable, and small.
const MAX_INDENT: usize = 24;

/// The trees of all worlds.
pub fn render(run: &Run, style: Style) -> String {
    let locator = Locator::inside(&run.sources);
    let mut out = String::new();
    let several = worlds(run).count() > 1;
    for world in worlds(run) {
        let names = Names::new(world, &locator);
        if several || !names.folder.is_empty() {
            gap(&mut out);
            let title = title(world, &names);
            let title = if several { format!("Platform {title}") } else { title };
            let _ = writeln!(out, "{}", style.paint(Ink::Strong, &title));
        }
        world_text(world, &names, style, &mut out);
    }
    if out.is_empty() {
        out.push_str("No frames: the inputs contain none.\n");
    } else if !locator.folder().is_empty() {
        let _ = writeln!(
            out,
            "\n{}",
            style.paint(Ink::Faint, &one_line(&format!("Paths in {}", locator.folder())))
        );
    }
    out
}

fn world_text(world: &World, names: &Names, style: Style, out: &mut String) {
    let links = Links::new(world, names, style.pick("×", "x"));
    let components = world.whole().components();
    for (index, component) in components.iter().enumerate() {
        gap(out);
        if components.len() > 1 {
            let frames = plural(component.members.len(), "frame");
            let heading = format!("Tree {} of {}, {frames}", index + 1, components.len());
            let _ = writeln!(out, "{}", style.paint(Ink::Strong, &heading));
        }
        Walk {
            world,
            links: &links,
            style,
            opened: BTreeSet::new(),
            path: BTreeSet::new(),
        }
        .component(component, out);
    }
    list(
        "Transforms stated by files, not edges of the tree",
        &links.beside,
        style,
        out,
    );
    let [messages, files] = outsiders(world, names);
    list("Frames of messages, not in the tree", &messages, style, out);
    list("Frames of files, not in the tree", &files, style, out);
}

/// An empty line between parts.
fn gap(out: &mut String) {
    if !out.is_empty() {
        out.push('\n');
    }
}

fn list<K: AsRef<str>>(heading: &str, frames: &BTreeMap<K, Vec<String>>, style: Style, out: &mut String) {
    if frames.is_empty() {
        return;
    }
    gap(out);
    let _ = writeln!(out, "{}", style.paint(Ink::Strong, heading));
    for (frame, places) in frames {
        let _ = writeln!(
            out,
            "  {}  {}",
            shown(frame.as_ref()),
            style.paint(Ink::Faint, &places.join(", "))
        );
    }
}

/// One walk over a component, with its own stack: inputs may be of any depth.
struct Walk<'a> {
    world: &'a World,
    links: &'a Links<'a>,
    style: Style,
    opened: BTreeSet<&'a FrameId>,
    path: BTreeSet<&'a FrameId>,
}

enum Step<'a> {
    Enter {
        frame: &'a FrameId,
        parent: Option<&'a FrameId>,
        /// The prefix of the children of the parent.
        indent: String,
        depth: usize,
        last: bool,
    },
    Leave(&'a FrameId),
}

impl<'a> Walk<'a> {
    fn component(&mut self, component: &'a Component, out: &mut String) {
        for root in &component.roots {
            self.from(root, out);
        }
        // Frames that no root leads to are on a cycle, or below one.
        if component.members.iter().all(|frame| self.opened.contains(frame)) {
            return;
        }
        for cycle in self.world.whole().cycles() {
            let start = cycle.first().and_then(|frame| component.members.get(frame));
            if let Some(start) = start.filter(|start| !self.opened.contains(start)) {
                let arrow = self.style.pick(" → ", " -> ");
                let names: Vec<String> = cycle.iter().chain(cycle.first()).map(|f| shown(f.as_str())).collect();
                let warning = format!("! no root: the parents form a cycle: {}", names.join(arrow));
                let _ = writeln!(out, "{}", self.style.paint(Ink::Error, &warning));
                self.from(start, out);
            }
        }
        for rest in &component.members {
            if !self.opened.contains(rest) {
                self.from(rest, out);
            }
        }
    }

    fn from(&mut self, root: &'a FrameId, out: &mut String) {
        let mut stack = vec![Step::Enter {
            frame: root,
            parent: None,
            indent: String::new(),
            depth: 0,
            last: true,
        }];
        while let Some(step) = stack.pop() {
            match step {
                Step::Leave(frame) => {
                    self.path.remove(frame);
                }
                Step::Enter {
                    frame,
                    parent,
                    indent,
                    depth,
                    last,
                } => {
                    let below = self.line(frame, parent, &indent, depth, last, out);
                    if !self.opened.insert(frame) {
                        continue;
                    }
                    self.path.insert(frame);
                    stack.push(Step::Leave(frame));
                    let children = self.links.children(frame);
                    for (index, child) in children.iter().enumerate().rev() {
                        stack.push(Step::Enter {
                            frame: child,
                            parent: Some(frame),
                            indent: below.clone(),
                            depth: depth + 1,
                            last: index + 1 == children.len(),
                        });
                    }
                }
            }
        }
    }

    /// Writes a frame and the sources of its edge; returns the prefix of its children.
    fn line(
        &self,
        frame: &'a FrameId,
        parent: Option<&'a FrameId>,
        indent: &str,
        depth: usize,
        last: bool,
        out: &mut String,
    ) -> String {
        let style = self.style;
        let name = style.paint(Ink::Strong, &shown(frame.as_str()));
        let Some(parent) = parent else {
            let _ = writeln!(out, "{name}");
            return String::new();
        };
        let branch = if last {
            style.pick("└─ ", "`- ")
        } else {
            style.pick("├─ ", "|- ")
        };
        let mut below = indent.to_owned();
        if depth <= MAX_INDENT {
            below.push_str(if last { "   " } else { style.pick("│  ", "|  ") });
        }
        let deep = if depth > MAX_INDENT {
            format!("(depth {depth}) ")
        } else {
            String::new()
        };
        let link = self.links.get(parent, frame);
        let pose = link.map_or_else(String::new, link_pose);
        let note = self.note(frame, parent);
        let _ = writeln!(
            out,
            "{}",
            format!("{indent}{branch}{deep}{name}{pose}{note}").trim_end()
        );
        for statement in link.into_iter().flat_map(|link| &link.statements) {
            let who = style.paint(Ink::Faint, &statement.who);
            let differs = match (&statement.differs, &statement.parent_from_child) {
                (Some(differs), Some(pose)) => {
                    let mark = style.paint(Ink::Error, &format!("! {differs}"));
                    format!("  {mark}: {}", pose_words(pose))
                }
                _ => String::new(),
            };
            let _ = writeln!(out, "{below}    {who}{differs}");
        }
        below
    }

    /// Anomalies of the frame under this parent.
    fn note(&self, frame: &FrameId, parent: &FrameId) -> String {
        let mut notes = Vec::new();
        if self.path.contains(frame) {
            notes.push("! cycle: leads back to itself".to_owned());
        } else if self.opened.contains(frame) && !self.links.children(frame).is_empty() {
            notes.push("children shown above".to_owned());
        }
        let others: Vec<String> = self
            .world
            .whole()
            .parents_of(frame)
            .into_iter()
            .filter(|other| *other != parent)
            .map(|other| format!("`{}`", shown(other.as_str())))
            .collect();
        if !others.is_empty() {
            notes.push(format!("! also under {}", others.join(", ")));
        }
        if notes.is_empty() {
            String::new()
        } else {
            format!("  [{}]", notes.join("; "))
        }
    }
}

fn link_pose(link: &Link) -> String {
    let Some(leading) = link.leading() else {
        return "  (no valid pose)".to_owned();
    };
    let pose = leading.parent_from_child.as_ref().map(pose_words).unwrap_or_default();
    if leading.constant {
        format!("  {pose}")
    } else {
        format!("  {pose} ({})", leading.moment)
    }
}
