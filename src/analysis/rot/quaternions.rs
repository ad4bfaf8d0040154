//! Every quaternion that a file states: of calibration files and of URDF 1.2 origins.

use crate::source::Place;
use crate::world::{ClaimKind, Literal, Spelling, World};

/// A norm under which a quaternion is all zeros.
pub(crate) const ZERO_NORM: f64 = 1e-9;

/// A quaternion as stated.
#[derive(Debug)]
pub(crate) struct StatedQuaternion<'a> {
    /// What it belongs to, for messages.
    pub name: String,
    /// As read, `[x, y, z, w]`.
    pub xyzw: [f64; 4],
    /// Its four literals in the order of the file, or none.
    pub literals: &'a [Literal],
    /// The place of the statement.
    pub place: Place,
}

impl StatedQuaternion<'_> {
    /// Its name in rows.
    pub(crate) fn subject(&self, world: &World) -> String {
        format!("quaternion of {} of {}", self.name, world.path(self.place.source))
    }
}

/// All quaternions of files. Those of TF are in the bags' evidence.
pub(crate) fn stated(world: &World) -> Vec<StatedQuaternion<'_>> {
    let mut all = Vec::new();
    for claim in &world.claims {
        let ClaimKind::File { .. } = claim.kind else { continue };
        if let Spelling::Quaternion { xyzw, .. } = claim.spelling {
            all.push(StatedQuaternion {
                name: format!("`{}`", claim.label),
                xyzw,
                literals: four(&claim.rotation_literals),
                place: claim.place.clone(),
            });
        }
    }
    for robot in &world.robots {
        for joint in &robot.joints {
            for list in joint.origins.iter().filter_map(|origin| origin.quat_xyzw.as_ref()) {
                if let Some(xyzw) = list.array::<4>() {
                    all.push(StatedQuaternion {
                        name: format!("joint `{}`", joint.name.value),
                        xyzw,
                        literals: four(&list.literals),
                        place: list.text.place.clone(),
                    });
                }
            }
        }
    }
    all
}

fn four(literals: &[Literal]) -> &[Literal] {
    if literals.len() == 4 { literals } else { &[] }
}
