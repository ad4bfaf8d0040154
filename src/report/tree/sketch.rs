//! The content of every drawing: the frames of each world with numbers, its edges, and the frames outside of every tree.
//!
//! Owns the walk over worlds that Graphviz, Mermaid and SVG share. Independent of their looks.

use std::collections::BTreeMap;

use crate::run::Run;

use super::super::place::Locator;
use super::links::{Link, Links};
use super::{Names, outsiders, shown, title, worlds};

/// One world.
pub(super) struct Sketch {
    /// Its title.
    pub(super) title: String,
    /// Names of the frames, for people; a frame's number is its index here.
    pub(super) frames: Vec<String>,
    /// Edges from parent to child, by their numbers, in the order of the names.
    pub(super) edges: Vec<Edge>,
    /// Frames that are named by messages or files, and are in no tree, with where.
    pub(super) outside: Vec<(String, Vec<String>)>,
}

/// One edge with its sources.
pub(super) struct Edge {
    pub(super) parent: usize,
    pub(super) child: usize,
    pub(super) link: Link,
}

/// The worlds of a run that have frames.
pub(super) fn sketches(run: &Run) -> Vec<Sketch> {
    let locator = Locator::inside(&run.sources);
    worlds(run)
        .map(|world| {
            let names = Names::new(world, &locator);
            let graph = world.whole();
            let numbers: BTreeMap<_, usize> = graph.frames.iter().zip(0..).collect();
            let edges = Links::new(world, &names, "x").of.into_iter();
            Sketch {
                title: title(world, &names),
                frames: graph.frames.iter().map(|frame| shown(frame.as_str())).collect(),
                edges: edges
                    .filter_map(|((parent, child), link)| {
                        Some(Edge {
                            parent: *numbers.get(parent)?,
                            child: *numbers.get(child)?,
                            link,
                        })
                    })
                    .collect(),
                outside: outsiders(world, &names)
                    .into_iter()
                    .flatten()
                    .map(|(frame, places)| (shown(frame), places))
                    .collect(),
            }
        })
        .collect()
}
