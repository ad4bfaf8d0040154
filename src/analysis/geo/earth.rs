//! The poses of local frames in the Earth's frame, as files and TF state them.
//!
//! Owns which frames are the Earth and which are local. Must not judge.

use nalgebra::Isometry3;

use crate::analysis::names;
use crate::analysis::places::cover;
use crate::math::rotation::{deciding_decimals, expected_rounding_error};
use crate::source::{Confidence, Place};
use crate::world::{Claim, FrameId, World};

/// Words of the frame whose origin is the Earth's centre.
const EARTHS: &[&str] = &["earth", "ecef"];

/// Words of local frames beside those of [`names::is_world`].
const LOCALS: &[&str] = &["enu", "ned", "local", "site", "datum", "origin", "ltp"];

/// One statement of `earth_from_local`.
#[derive(Clone, Debug)]
pub(crate) struct EarthPose {
    /// The Earth, canonical.
    pub(crate) earth: FrameId,
    /// The local frame, canonical.
    pub(crate) local: FrameId,
    /// What reports call the statement.
    pub(crate) subject: String,
    /// The poses with their places: of a moving edge all that are kept, else one.
    pub(crate) poses: Vec<(Place, Isometry3<f64>)>,
    /// Whether a rotation and a translation were stated.
    pub(crate) has: (bool, bool),
    /// Where a file has the numbers of the rotation.
    pub(crate) rotation_place: Option<Place>,
    /// Angle that the digits of the rotation excuse, radians.
    pub(crate) rounding_rad: f64,
    /// How sure the reading is.
    pub(crate) reading: Confidence,
}

/// Whether a frame is the Earth's, by its name.
pub(crate) fn is_earth(frame: &FrameId) -> bool {
    names::has_word(frame, EARTHS)
}

impl EarthPose {
    /// Every statement of a world between the Earth and another frame: claims, then TF.
    pub(crate) fn all(world: &World) -> Vec<Self> {
        let claims = world.claims.iter().filter(|claim| claim.is_rigid());
        let mut all: Vec<Self> = claims.filter_map(Self::of_claim).collect();
        for bag in &world.bags {
            for edge in &bag.tf {
                let Some((earth, local, is_inverse)) = ends(&edge.parent.canonical(), &edge.child.canonical()) else {
                    continue;
                };
                let poses = edge.samples.iter().map(|sample| {
                    let place = Place::message(bag.source, sample.at.clone());
                    (place, turned(sample.pose.isometry(), is_inverse))
                });
                all.push(Self {
                    subject: format!("TF `{}` -> `{}` on {}", edge.parent, edge.child, edge.topic),
                    poses: poses.collect(),
                    earth,
                    local,
                    has: (true, true),
                    rotation_place: None,
                    rounding_rad: 0.0,
                    reading: Confidence::Certain,
                });
            }
        }
        all
    }

    fn of_claim(claim: &Claim) -> Option<Self> {
        let (target, source) = claim.frames.as_ref()?;
        let (earth, local, is_inverse) = ends(&target.canonical(), &source.canonical())?;
        let digits = claim.rotation_literals.iter().map(|literal| literal.value);
        Some(Self {
            subject: format!("{} (`{}`)", claim.name(), claim.label),
            poses: vec![(claim.place.clone(), turned(claim.pose?.isometry(), is_inverse))],
            earth,
            local,
            has: (claim.has_rotation, claim.has_translation),
            rotation_place: Some(cover(&claim.rotation_literals, &claim.place)),
            rounding_rad: deciding_decimals(digits).map_or(0.0, expected_rounding_error),
            reading: claim.reading,
        })
    }

    /// Whether the frame is fixed to the Earth, by its name: one that moves need not be level.
    pub(crate) fn is_local(&self) -> bool {
        names::is_world(&self.local) || names::has_word(&self.local, LOCALS)
    }
}

/// The Earth, the other frame, and whether the Earth is the child.
fn ends(parent: &FrameId, child: &FrameId) -> Option<(FrameId, FrameId, bool)> {
    match (is_earth(parent), is_earth(child)) {
        (true, false) => Some((parent.clone(), child.clone(), false)),
        (false, true) => Some((child.clone(), parent.clone(), true)),
        _ => None,
    }
}

fn turned(pose: Isometry3<f64>, is_inverse: bool) -> Isometry3<f64> {
    if is_inverse { pose.inverse() } else { pose }
}
