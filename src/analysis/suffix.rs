//! Frames with a word for axes in their name: the frame of the same name without it, and the rotation between the two.
//!
//! Must not judge.

use std::collections::BTreeSet;

use nalgebra::{Isometry3, UnitQuaternion};

use crate::math::{constants::AxisTurn, relation::Relation, rotation::rotation_angle_between};
use crate::source::Place;
use crate::world::{FrameId, World};

/// Frames of the same name without `word`, or with `instead` in its place, by name.
pub(crate) fn siblings<'a>(world: &'a World, frame: &FrameId, word: &str, instead: Option<&str>) -> Vec<&'a FrameId> {
    let stem: Vec<String> = frame.tokens().into_iter().filter(|token| token != word).collect();
    if stem.is_empty() {
        return Vec::new();
    }
    let mut found: BTreeSet<&FrameId> = world.frames_of_words(&stem).collect();
    for at in (0..=stem.len()).take_while(|_| instead.is_some()) {
        let mut words = stem.clone();
        words.splice(at..at, instead.map(str::to_owned));
        found.extend(world.frames_of_words(&words));
    }
    found.into_iter().filter(|other| *other != frame).collect()
}

/// `sibling_from_frame`: over rigid edges if possible, else at the first samples of moving ones.
pub(crate) fn relation_to(world: &World, sibling: &FrameId, frame: &FrameId) -> Option<Isometry3<f64>> {
    let over = |is_rigid: bool| {
        let mut graphs = world.graphs();
        graphs.find_map(|graph| graph.chain(sibling, frame, |edge| edge.is_rigid || !is_rigid))
    };
    let chain = over(true).or_else(|| over(false));
    chain.map(|(sibling_from_frame, _)| sibling_from_frame)
}

/// The angle between a rotation and the expected one (`None`: no rotation), degrees.
pub(crate) fn off_deg(expected: Option<AxisTurn>, seen: &UnitQuaternion<f64>) -> f64 {
    let expected = expected.map_or_else(UnitQuaternion::identity, AxisTurn::quaternion);
    rotation_angle_between(&expected, seen).to_degrees()
}

/// The constant rotation between conventions that a rotation is, within `max_deg`, if it is one. Looking for mistakes in the
/// numbers does not help here: applied to the identity, most of them give the same.
pub(crate) fn known_turn(seen: &UnitQuaternion<f64>, max_deg: f64) -> Option<Relation> {
    if off_deg(None, seen) <= max_deg {
        return Some(Relation::Equal);
    }
    let turn = AxisTurn::all()
        .iter()
        .find(|turn| off_deg(Some(**turn), seen) <= max_deg)?;
    Relation::from_word(turn.word())
}

/// What the rotation between two frames is instead of the expected one, as a sentence.
pub(crate) fn found(relation: Relation, sibling: &FrameId, frame: &FrameId) -> String {
    let pair = format!("`{sibling}` -> `{frame}`");
    match relation {
        Relation::Equal => format!("`{sibling}` and `{frame}` have the same axes."),
        Relation::FluFrd => format!("{pair} is rotated by 180 deg about x (FLU/FRD)."),
        Relation::NedEnu => format!("{pair} exchanges x and y and negates z (NED/ENU)."),
        other => other.describe().to_owned(),
    }
}

/// Where axes point, in words: `FLU` is x forward, y left, z up.
pub(crate) fn axes_in_words(letters: &str) -> String {
    let word = |letter| match letter {
        'F' => "forward",
        'B' => "backward",
        'L' => "left",
        'R' => "right",
        'U' => "up",
        _ => "down",
    };
    let axes = ["x", "y", "z"].into_iter().zip(letters.chars());
    let words: Vec<String> = axes.map(|(axis, letter)| format!("{axis} {}", word(letter))).collect();
    words.join(", ")
}

/// Where the axes of an optical frame point, as a sentence, if each is along one of its parent's.
pub(crate) fn directions(parent_from_optical: &UnitQuaternion<f64>) -> Option<String> {
    const WORDS: [[&str; 2]; 3] = [["forward", "backward"], ["left", "right"], ["up", "down"]];
    let axes = parent_from_optical.to_rotation_matrix();
    let word = |column: usize| {
        let axis = axes.matrix().column(column);
        let (row, value) = axis.iter().enumerate().find(|(_, value)| value.abs() > 0.99)?;
        WORDS.get(row)?.get(usize::from(*value < 0.0)).copied()
    };
    let [x, y, z] = [word(0)?, word(1)?, word(2)?];
    Some(format!(
        "The x, y, z axes of the frame point {x}, {y}, {z}, but should point right, down, forward."
    ))
}

/// Where the frame is stated in the tree, else where it is named first.
pub(crate) fn place_of(world: &World, frame: &FrameId) -> Option<Place> {
    let mut edges = world.graphs().flat_map(|graph| graph.edges_to(frame));
    edges
        .find_map(|edge| crate::analysis::places::of_edge(world, edge))
        .or_else(|| crate::analysis::places::first(world, frame))
}
