//! Frames that are named optical, and their axes.

use serde::Deserialize;

use crate::analysis::optical::{Mount, mounts};
use crate::analysis::{Estimates, names};
use crate::math::{constants::AxisTurn, rotation::rotation_angle_between};
use crate::world::{FrameId, graph::FrameGraph};

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Limits {
    /// Deviation up to which a rotation is the optical one, degrees.
    pub exact_deg: f64,
    /// Deviation up to which it may be the optical one with a calibration in it, degrees.
    pub calibrated_deg: f64,
}

/// `link_from_optical` as URDF text.
pub(crate) const OPTICAL_RPY: &str = "-1.5707963267948966 0 -1.5707963267948966";

/// The angle between a mount's rotation and the optical one, degrees.
pub(crate) fn off(mount: &Mount) -> f64 {
    rotation_angle_between(&AxisTurn::Optical.quaternion(), &mount.parent_from_optical).to_degrees()
}

/// Whether a mount can be judged: its parent is the camera's own link, or its rotation is a mistake under any parent.
pub(crate) fn is_conclusive(mount: &Mount, limits: &Limits) -> bool {
    let not_turned = mount.parent_from_optical.angle().to_degrees() <= limits.exact_deg;
    // No camera is rolled by 90 deg and looks sideways at once: exactly the inverse is a mistake under any parent.
    let inverse = AxisTurn::Optical.quaternion().inverse();
    let is_inverse = rotation_angle_between(&inverse, &mount.parent_from_optical).to_degrees() <= limits.exact_deg;
    mount.is_sibling || (not_turned || is_inverse) && names::optical_stem(mount.parent).is_none()
}

/// Whether a frame is rotated to optical axes below a frame that has them: the parent is named optical, and is not known to have other axes.
pub(crate) fn is_doubled(graph: &FrameGraph, mount: &Mount, limits: &Limits) -> bool {
    let is_optical = names::optical_stem(mount.parent).is_some();
    let has_axes = || worst(graph, mount.parent).is_none_or(|above| off(&above) <= limits.calibrated_deg);
    is_optical && off(mount) <= limits.calibrated_deg && has_axes()
}

/// The mount of an optical frame with the largest deviation.
pub(crate) fn worst<'a>(graph: &'a FrameGraph, frame: &FrameId) -> Option<Mount<'a>> {
    let stem = names::optical_stem(frame)?;
    mounts(graph, frame, &stem)
        .into_iter()
        .max_by(|a, b| off(a).total_cmp(&off(b)))
}

/// Whether NAME06 finds more than a calibration in the rotation of a frame.
pub(crate) fn reports(world: &Estimates, frame: &FrameId) -> bool {
    let limits = world.limits::<crate::analysis::name::optical::Limits>();
    worst(world.graph(), frame)
        .is_some_and(|worst| off(&worst) > limits.calibrated_deg && is_conclusive(&worst, &limits))
}

/// Whether a frame is rotated from the camera's own link as optical frames are.
pub(crate) fn is_turned_from_its_link(world: &Estimates, frame: &FrameId) -> bool {
    let limits = world.limits::<crate::analysis::name::optical::Limits>();
    worst(world.graph(), frame).is_some_and(|worst| worst.is_sibling && off(&worst) <= limits.calibrated_deg)
}
