//! The positions of frames in a drawing: columns by depth, rows so that a parent is between its children.
//!
//! Positions are columns and half rows, without sizes or looks. Deterministic, and without recursion: inputs may be of any
//! depth.

use std::collections::BTreeMap;

use super::sketch::Sketch;

/// A frame with its position.
pub(super) struct FramePosition {
    /// Its number in the sketch.
    pub(super) frame: usize,
    /// Column, from the root on.
    pub(super) depth: usize,
    /// Position from the top, in half rows.
    pub(super) half_row: u32,
    /// Index of the parent it is drawn under, in the same list; `None` for roots.
    pub(super) parent: Option<usize>,
    /// The edge to that parent, by its index in the sketch.
    pub(super) edge: Option<usize>,
}

/// Frames that are connected.
#[derive(Default)]
pub(super) struct Tree {
    /// Its frames; parents come before their children.
    pub(super) frames: Vec<FramePosition>,
    /// Edges, by their indices in the sketch, that are not between a frame and the parent it is drawn under.
    pub(super) others: Vec<usize>,
    /// Height, in half rows.
    pub(super) half_rows: u32,
}

/// The trees of a sketch, the largest first, then by the first name.
pub(super) fn trees(sketch: &Sketch) -> Vec<Tree> {
    let mut below: BTreeMap<usize, Vec<(usize, usize)>> = BTreeMap::new();
    let mut beside: BTreeMap<usize, Vec<usize>> = BTreeMap::new();
    let mut has_parent = vec![false; sketch.frames.len()];
    for (number, edge) in sketch.edges.iter().enumerate() {
        below.entry(edge.parent).or_default().push((edge.child, number));
        beside.entry(edge.parent).or_default().push(edge.child);
        beside.entry(edge.child).or_default().push(edge.parent);
        if let Some(has) = has_parent.get_mut(edge.child).filter(|_| edge.parent != edge.child) {
            *has = true;
        }
    }
    let mut members: Vec<Vec<usize>> = Vec::new();
    let mut seen = vec![false; sketch.frames.len()];
    for start in 0..sketch.frames.len() {
        let mut stack = vec![start];
        let mut found = Vec::new();
        while let Some(frame) = stack.pop() {
            if let Some(seen) = seen.get_mut(frame).filter(|seen| !**seen) {
                *seen = true;
                found.push(frame);
                stack.extend(beside.get(&frame).into_iter().flatten());
            }
        }
        if !found.is_empty() {
            found.sort_unstable();
            members.push(found);
        }
    }
    members.sort_by(|a, b| (b.len(), a.first()).cmp(&(a.len(), b.first())));
    members
        .iter()
        .map(|members| tree(members, &below, &has_parent))
        .collect()
}

fn tree(members: &[usize], below: &BTreeMap<usize, Vec<(usize, usize)>>, has_parent: &[bool]) -> Tree {
    let is_root = |frame: &usize| !has_parent.get(*frame).copied().unwrap_or(false);
    let mut tree = Tree::default();
    let mut place: BTreeMap<usize, usize> = BTreeMap::new();
    // Frames that no root leads to are on a cycle, which is opened at its first name.
    let roots = members.iter().filter(|frame| is_root(frame));
    for start in roots.chain(members) {
        let mut stack = vec![(*start, None, None, 0)];
        while let Some((frame, parent, edge, depth)) = stack.pop() {
            if place.contains_key(&frame) {
                tree.others.extend(edge);
                continue;
            }
            let here = tree.frames.len();
            place.insert(frame, here);
            tree.frames.push(FramePosition {
                frame,
                depth,
                half_row: 0,
                parent,
                edge,
            });
            let children = below.get(&frame).into_iter().flatten().rev();
            stack.extend(children.map(|(child, edge)| (*child, Some(here), Some(*edge), depth + 1)));
        }
    }
    tree.others.sort_unstable();
    place_rows(&mut tree);
    tree
}

/// Leaves take the next row; parents the middle of their first and last child. Children come after their parents in the list, so
/// one pass from the end suffices.
fn place_rows(tree: &mut Tree) {
    let mut children: Vec<Option<(u32, u32)>> = vec![None; tree.frames.len()];
    let mut has_children = vec![false; tree.frames.len()];
    for parent in tree.frames.iter().filter_map(|position| position.parent) {
        if let Some(has) = has_children.get_mut(parent) {
            *has = true;
        }
    }
    let mut next = 0;
    for (position, has_children) in tree.frames.iter_mut().zip(&has_children) {
        if !has_children {
            position.half_row = next;
            next += 2;
        }
    }
    tree.half_rows = next;
    for index in (0..tree.frames.len()).rev() {
        let Some(position) = tree.frames.get_mut(index) else {
            continue;
        };
        if let Some(Some((first, last))) = children.get(index) {
            position.half_row = u32::midpoint(*first, *last);
        }
        let row = position.half_row;
        if let Some(span) = position.parent.and_then(|parent| children.get_mut(parent)) {
            let (first, last) = span.unwrap_or((row, row));
            *span = Some((first.min(row), last.max(row)));
        }
    }
}
