//! A lidar whose clouds are turned about z against its mounting, by a quarter or half a turn: which rule names it best.
//!
//! One wrong setting shows in several measurements; one rule reports it, and the others point there. Must not measure.

use std::sync::Arc;

use crate::rules::hand_eye::HandEye;
use crate::rules::lidar::Clouds;
use crate::rules::limits_of;
use crate::rules::ouster::{self, Axes, Part};
use crate::tables::{Forward, Lidar, OusterPart};
use crate::world::{FrameId, World};

use super::ouster_frame::{self, OusterFrame};

/// The rule that reports so many quarter turns of a lidar's mounting; `None` where it is AXES12.
pub(crate) fn owner(world: &World, clouds: &Clouds, known: &HandEye, quarters: i8) -> Option<&'static str> {
    match quarters {
        2 | -2 if ouster::is_of_an_ouster(world, clouds) => {
            Some(half_turn(world, clouds, &known.body, &known.lidar).unwrap_or("SENSOR03"))
        }
        1 | -1 => lidar(world, clouds).filter(|row| has_two_ways(row)).map(|_| "SENSOR04"),
        _ => None,
    }
}

/// The rule that reports half a turn of an Ouster for another reason than its mounting.
pub(super) fn half_turn(world: &World, clouds: &Clouds, body: &FrameId, lidar: &FrameId) -> Option<&'static str> {
    let said = clouds.frame().and_then(|frame| Axes::of(&frame));
    let seen = axes(clouds);
    if said.is_some() && seen.is_some() && said != seen {
        return Some("SENSOR01");
    }
    let is_off = unturned(world).iter().any(|(a, b)| in_chain(world, body, lidar, a, b));
    is_off.then_some("SENSOR02")
}

/// The axes that the clouds of an Ouster are told in, where they show.
pub(super) fn axes(clouds: &Clouds) -> Option<Axes> {
    let limits = limits_of::<OusterFrame>()?;
    ouster_frame::look(clouds, &limits).ok()?.axes
}

/// Pairs of the Sensor and the Lidar frame between which the half turn is missing.
fn unturned(world: &World) -> Vec<(FrameId, FrameId)> {
    let is_unturned = |part: &Part<'_>| {
        part.kind == OusterPart::Lidar && part.metadata.is_none() && part.turn().angle_to(&part.pose.rotation) > 1.0
    };
    let parts = Part::all(world).into_iter().filter(is_unturned);
    parts
        .map(|part| (part.statement.target, part.statement.source_frame))
        .collect()
}

/// Whether the way from one frame to another goes over the edge between these two.
fn in_chain(world: &World, from: &FrameId, to: &FrameId, a: &FrameId, b: &FrameId) -> bool {
    edges(world, from, to)
        .iter()
        .any(|edge| (edge.parent == *a && edge.child == *b) || (edge.parent == *b && edge.child == *a))
}

/// An edge of the way from the body to a lidar.
#[derive(Clone, Debug)]
pub(super) struct Edge {
    pub(super) parent: FrameId,
    pub(super) child: FrameId,
    pub(super) pose: nalgebra::Isometry3<f64>,
}

/// The rigid edges between two frames, from the first to the second.
pub(super) fn edges(world: &World, from: &FrameId, to: &FrameId) -> Vec<Edge> {
    let graph = world.graph();
    let Some((_, steps)) = graph.chain(from, to, |edge| edge.is_rigid) else {
        return Vec::new();
    };
    let edges = steps.iter().filter_map(|step| graph.edges.get(step.edge));
    edges
        .filter_map(|edge| {
            Some(Edge {
                parent: edge.parent.clone(),
                child: edge.child.clone(),
                pose: edge.pose?,
            })
        })
        .collect()
}

/// What the tables know of the lidar of these clouds: by the words of topic and frame, else by the layout of its points.
pub(super) fn lidar(world: &World, clouds: &Clouds) -> Option<Arc<Lidar>> {
    let mut words = clouds.topic.words();
    words.extend(clouds.frame().map(|frame| frame.tokens()).unwrap_or_default());
    let by_layout = || {
        let name = clouds.driver?.name.to_lowercase();
        // A layout that two makers share says neither.
        let words: Vec<String> = name
            .split(|letter: char| !letter.is_alphanumeric())
            .map(str::to_owned)
            .collect();
        let is_one = !words.iter().any(|word| word == "or");
        is_one.then(|| world.tables.lidar(&words)).flatten()
    };
    world.tables.lidar(&words).or_else(by_layout)
}

/// Whether clouds of the sensor come with y forward as well as with x forward.
pub(super) fn has_two_ways(lidar: &Lidar) -> bool {
    lidar.sensor == Forward::Y || lidar.driver == Forward::Y
}
