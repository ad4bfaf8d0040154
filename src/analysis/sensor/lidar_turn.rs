//! Possible causes where the clouds of a lidar are rotated about z from its mounting by 90 or 180 deg.
//!
//! Must not measure.

use std::sync::Arc;

use crate::analysis::ouster::{Axes, Part};
use crate::analysis::{Estimates, hand_eye::HandEye, lidar::Clouds, ouster};
use crate::tables::{Forward, Lidar, OusterPart};
use crate::world::{FrameId, World};

/// Possible causes of a mounting that is off by quarter turns.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Origin {
    /// An Ouster whose clouds are expressed in its other frame than the one that they name.
    OusterFrame,
    /// An Ouster where TF lacks the half turn between its two frames.
    OusterTf,
    /// An Ouster whose mounting was made for its other frame.
    OusterMounting,
    /// A lidar whose drivers put azimuth 0 on x or on y.
    Driver,
}

/// The possible cause of so many quarter turns of a lidar's mounting, where the device is known.
pub(crate) fn origin(world: &Estimates, clouds: &Clouds, known: &HandEye, quarters: i8) -> Option<Origin> {
    match quarters {
        2 | -2 if ouster::is_of_an_ouster(world, clouds) => {
            Some(half_turn(world, clouds, &known.body, &known.lidar).unwrap_or(Origin::OusterMounting))
        }
        1 | -1 => lidar(world, clouds)
            .filter(|row| has_two_ways(row))
            .map(|_| Origin::Driver),
        _ => None,
    }
}

/// The cause of half a turn of an Ouster, where it is not its mounting.
pub(crate) fn half_turn(world: &Estimates, clouds: &Clouds, body: &FrameId, lidar: &FrameId) -> Option<Origin> {
    let said = clouds.frame().and_then(|frame| Axes::of(&frame));
    let seen = axes(world, clouds);
    if said.is_some() && seen.is_some() && said != seen {
        return Some(Origin::OusterFrame);
    }
    let is_off = unturned(world).iter().any(|(a, b)| in_chain(world, body, lidar, a, b));
    is_off.then_some(Origin::OusterTf)
}

/// The axes that the clouds of an Ouster are expressed in, where they can be determined.
pub(crate) fn axes(world: &Estimates, clouds: &Clouds) -> Option<Axes> {
    let limits = world.limits::<crate::analysis::sensor::ouster_look::Limits>();
    crate::analysis::sensor::ouster_look::look(clouds, &limits).ok()?.axes
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

/// Whether the chain from one frame to another contains the edge between these two.
fn in_chain(world: &World, from: &FrameId, to: &FrameId, a: &FrameId, b: &FrameId) -> bool {
    edges(world, from, to)
        .iter()
        .any(|edge| (edge.parent == *a && edge.child == *b) || (edge.parent == *b && edge.child == *a))
}

/// An edge of the chain from the body to a lidar.
#[derive(Clone, Debug)]
pub(crate) struct Edge {
    pub(crate) parent: FrameId,
    pub(crate) child: FrameId,
    pub(crate) pose: nalgebra::Isometry3<f64>,
}

/// The rigid edges between two frames, from the first to the second.
pub(crate) fn edges(world: &World, from: &FrameId, to: &FrameId) -> Vec<Edge> {
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

/// The lidar of these clouds in the tables: by its packets, by the words of topic and frame, else by the fields of its points.
pub(crate) fn lidar(world: &World, clouds: &Clouds) -> Option<Arc<Lidar>> {
    if let Some(sensor) = &clouds.evidence.packets {
        return world.tables.lidar(&[sensor.maker.to_lowercase()]);
    }
    let mut words = clouds.topic.words();
    words.extend(clouds.frame().map(|frame| frame.tokens()).unwrap_or_default());
    let by_layout = || {
        let name = clouds.driver?.name.to_lowercase();
        // A layout that two makers share identifies neither.
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
pub(crate) fn has_two_ways(lidar: &Lidar) -> bool {
    lidar.sensor == Forward::Y || lidar.driver == Forward::Y
}
