//! All constant translations by source.

use std::collections::BTreeMap;

use crate::analysis::{names::has_word, places::cover};
use crate::source::{Place, SourceId};
use crate::world::{ClaimKind, FrameId, Literal, World};

/// Frames that may be far from everything.
const WORLDS: &[&str] = &[
    "world", "map", "earth", "odom", "utm", "ecef", "enu", "ned", "origin", "global", "site", "datum", "local",
];

/// A translation as stated.
#[derive(Debug)]
pub(crate) struct StatedTranslation<'a> {
    /// What it belongs to, for messages and rows.
    pub name: String,
    /// As written, in the format's metres.
    pub xyz: [f64; 3],
    /// Its literals, where the text is known.
    pub literals: &'a [Literal],
    /// The pair of frames, if known.
    pub frames: Option<(FrameId, FrameId)>,
    /// Whether it is that of a URDF joint.
    pub is_joint: bool,
    /// Its place.
    pub place: Place,
}

impl StatedTranslation<'_> {
    /// Length, metres as declared.
    pub(crate) fn norm(&self) -> f64 {
        let [x, y, z] = self.xyz;
        x.hypot(y).hypot(z)
    }

    /// Whether one of the frames is a world, from which anything may be far.
    pub(crate) fn is_from_a_world(&self) -> bool {
        self.frames
            .iter()
            .any(|(target, source)| has_word(target, WORLDS) || has_word(source, WORLDS))
    }
}

/// All finite translations by source: of every joint, every file and every static TF edge.
pub(crate) fn by_source(world: &World) -> BTreeMap<SourceId, Vec<StatedTranslation<'_>>> {
    let mut all: BTreeMap<SourceId, Vec<StatedTranslation<'_>>> = BTreeMap::new();
    for claim in world.claims.iter().filter(|claim| claim.has_translation) {
        let Some(pose) = &claim.pose else { continue };
        let name = match &claim.kind {
            ClaimKind::Joint { joint, .. } => format!("joint `{joint}`"),
            ClaimKind::File { .. } => format!("`{}`", claim.label),
        };
        all.entry(claim.place.source).or_default().push(StatedTranslation {
            name,
            xyz: pose.translation_m,
            literals: &claim.translation_literals,
            is_joint: matches!(claim.kind, ClaimKind::Joint { .. }),
            frames: claim
                .frames
                .clone()
                .or_else(|| Some((FrameId::new(claim.label.clone()), FrameId::new("")))),
            place: cover(&claim.translation_literals, &claim.place),
        });
    }
    for bag in &world.bags {
        for edge in bag.tf.iter().filter(|edge| edge.is_static) {
            let Some(sample) = edge.first() else { continue };
            all.entry(bag.source).or_default().push(StatedTranslation {
                name: format!("`{}` from `{}` on {}", edge.parent, edge.child, edge.topic),
                xyz: sample.pose.translation_m,
                literals: &[],
                is_joint: false,
                frames: Some((edge.parent.clone(), edge.child.clone())),
                place: Place::message(bag.source, sample.at.clone()),
            });
        }
    }
    all
}
