//! Frames of images that are not optical frames.

use serde::Deserialize;

use crate::analysis::name::cameras::{cameras, optical_beside, up};
use crate::analysis::{Estimates, names::has_word};
use crate::world::{BagEvidence, FrameId};

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Limits {
    /// Vertical component of the frame's z axis from which z points up.
    pub min_up: f64,
    /// Deviation up to which a related frame is its optical frame, degrees.
    pub optical_deg: f64,
}

/// Words of cameras that look straight up on purpose.
pub(crate) const UPWARD_WORDS: &[&str] = &["up", "upward", "upwards", "ceiling", "sky", "zenith"];

/// Whether NAME07 reports a camera's frame as not optical.
pub(crate) fn reports(world: &Estimates, bag: &BagEvidence, frame: &FrameId) -> bool {
    let limits = world.limits::<crate::analysis::name::image_frame::Limits>();
    let is_up = || up(world, frame).is_some_and(|(_, z_up)| z_up > limits.min_up && !has_word(frame, UPWARD_WORDS));
    let of_camera = cameras(bag).get(frame).is_some_and(|camera| camera.is_camera(frame));
    of_camera && !frame.has_token("optical") && (optical_beside(world, frame, limits.optical_deg).is_some() || is_up())
}
