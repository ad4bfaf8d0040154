//! The streams of a recording that an error can be put into: those of the catalogue, and optical frames.

use frames_lint::faults::Family;
use frames_lint::world::World;

use crate::cameras::is_optical;

pub use frames_lint::faults::motion::{MovingFrame, Stream, StreamPlace};

/// Every stream of a world.
pub fn all(world: &World) -> Vec<Stream> {
    let bags = world.bags.iter().enumerate();
    let edges = bags.flat_map(|(bag, evidence)| evidence.tf.iter().map(move |edge| (bag, edge)));
    let optical = edges
        .filter(|(_, edge)| is_optical(&edge.child))
        .map(|(bag, edge)| Stream {
            bag,
            family: Family::Camera,
            places: vec![StreamPlace::of_edge(edge)],
            frames: [edge.child.canonical().as_str().to_owned()].into(),
            moving: MovingFrame::Other,
            is_standard_fix: false,
        });
    Stream::all(world).chain(optical).collect()
}

/// In a few words.
pub fn name(stream: &Stream) -> String {
    format!("{} {}", stream.family.word(), stream.name())
}
