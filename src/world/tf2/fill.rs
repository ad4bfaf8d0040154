//! Buffers filled from the facts of a platform: recorded TF, the joints of its URDF, and what launch files publish.

use std::collections::BTreeSet;

use crate::world::World;
use crate::world::bag::{BagEvidence, TfEdge, TfSample};
use crate::world::claim::{Claim, ClaimKind};
use crate::world::frame::FrameId;
use crate::world::graph::EdgeOrigin;

use super::{Buffer, IncomingTransform};

/// The part before `tf` and `tf_static` in a topic's name: `/` of `/tf`, `/robot1/` of `/robot1/tf_static`. One buffer
/// listens to the two topics of one namespace. A topic of another name is a namespace of its own.
pub fn namespace(topic: &str) -> &str {
    match topic.rsplit('/').next() {
        Some(last @ ("tf" | "tf_static")) => topic.strip_suffix(last).unwrap_or(topic),
        _ => topic,
    }
}

/// The namespaces of a recording's TF.
pub fn namespaces(bag: &BagEvidence) -> BTreeSet<&str> {
    bag.tf.iter().map(|edge| namespace(&edge.topic)).collect()
}

impl Buffer {
    /// A buffer that received the recorded transforms of one namespace, in the order of the recording. Tags are indices into
    /// `bag.tf`.
    ///
    /// Evidence holds a thinned series of each edge: times between two kept samples are interpolated over the others.
    pub fn of_recording(bag: &BagEvidence, namespace: &str, cache_ns: Option<i64>) -> Self {
        let mut buffer = Self::new(cache_ns);
        for (tag, edge, sample) in heard(bag, namespace) {
            buffer.hear(edge, sample, tag);
        }
        buffer
    }

    fn hear(&mut self, edge: &TfEdge, sample: &TfSample, tag: usize) {
        let heard = IncomingTransform {
            parent: edge.parent.as_str(),
            child: edge.child.as_str(),
            stamp_ns: sample.at.stamp_ns.unwrap_or(sample.at.log_ns),
            translation_m: sample.pose.translation_m,
            rotation_xyzw: sample.pose.rotation_xyzw,
            is_static: edge.is_static,
            tag,
        };
        // What tf2 would drop is dropped here; other rules report it.
        let _ = self.insert(&heard);
    }
}

/// The samples of a namespace in the order of the recording, with the index of their edge.
fn heard<'a>(bag: &'a BagEvidence, of: &str) -> Vec<(usize, &'a TfEdge, &'a TfSample)> {
    let mut heard: Vec<(usize, &TfEdge, &TfSample)> = bag
        .tf
        .iter()
        .enumerate()
        .filter(|(_, edge)| namespace(&edge.topic) == of)
        .flat_map(|(index, edge)| edge.samples.iter().map(move |sample| (index, edge, sample)))
        .collect();
    heard.sort_by_key(|(index, edge, sample)| (sample.at.log_ns, &edge.topic, sample.at.index, *index));
    heard
}

impl World {
    /// An unlimited buffer of a whole platform, as after `robot_state_publisher`, the static publishers of launch files and all
    /// recordings were played back: the joints of URDFs whose child no recording names (moving ones at their zero position), transforms that are
    /// published for other frames (the first statement of each), then the TF of one namespace of every recording. Tags are indices
    /// into the list of origins.
    pub fn tf2(&self, namespace: &str) -> (Buffer, Vec<EdgeOrigin>) {
        let mut buffer = Buffer::new(None);
        let mut origins: Vec<EdgeOrigin> = Vec::new();
        let recorded: BTreeSet<FrameId> = self
            .bags
            .iter()
            .flat_map(|bag| &bag.tf)
            .filter(|edge| super::namespace(&edge.topic) == namespace)
            .map(|edge| edge.child.canonical())
            .collect();
        let joints = |claim: &Claim| matches!(claim.kind, ClaimKind::Joint { .. });
        let all = || self.claims.iter().enumerate();
        let stated = all()
            .filter(|(_, claim)| joints(claim))
            .chain(all().filter(|(_, claim)| claim.is_published()));
        for (index, claim) in stated {
            let (Some((parent, child)), Some(pose)) = (&claim.frames, &claim.pose) else {
                continue;
            };
            let is_published = claim.is_published();
            let is_known = is_published && !buffer.parents_ever(&child.canonical()).is_empty();
            if is_known || recorded.contains(&child.canonical()) {
                continue;
            }
            let stated = IncomingTransform {
                parent: parent.as_str(),
                child: child.as_str(),
                stamp_ns: 0,
                translation_m: pose.translation_m,
                rotation_xyzw: pose.rotation_xyzw,
                is_static: true,
                tag: origins.len(),
            };
            if buffer.insert(&stated).is_ok() {
                origins.push(if is_published {
                    EdgeOrigin::Published(index)
                } else {
                    EdgeOrigin::Joint(index)
                });
            }
        }
        for (number, bag) in self.bags.iter().enumerate() {
            let first = origins.len();
            origins.extend((0..bag.tf.len()).map(|edge| EdgeOrigin::Tf(number, edge)));
            for (index, edge, sample) in heard(bag, namespace) {
                buffer.hear(edge, sample, first + index);
            }
        }
        (buffer, origins)
    }
}
