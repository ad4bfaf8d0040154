//! Every roll, pitch, yaw that a file states: of URDF joints and of calibration files. Those of visuals do not place
//! frames and are left out.

use crate::analysis::places::cover;
use crate::source::Place;
use crate::world::{ClaimKind, FrameId, Literal, Spelling, World};

/// Roll, pitch and yaw as stated.
#[derive(Debug)]
pub(crate) struct Angles<'a> {
    /// What they belong to, for messages.
    pub name: String,
    /// Radians, as the format declares them.
    pub rpy: [f64; 3],
    /// The three literals, or none.
    pub literals: &'a [Literal],
    /// The pair of frames, if known.
    pub frames: Option<(FrameId, FrameId)>,
    /// Whether the transform is constant.
    pub is_rigid: bool,
    /// The place of the angles.
    pub place: Place,
}

impl Angles<'_> {
    /// Their name in rows.
    pub(crate) fn subject(&self, world: &World) -> String {
        format!("angles of {} of {}", self.name, world.path(self.place.source))
    }

    /// The literals, where each spells the stated radians: a file that declares degrees spells other numbers.
    pub(crate) fn radian_literals(&self) -> &[Literal] {
        let same = |(literal, angle): (&Literal, &f64)| (literal.value - angle).abs() <= 1e-12;
        if self.literals.len() == 3 && self.literals.iter().zip(&self.rpy).all(same) {
            self.literals
        } else {
            &[]
        }
    }
}

/// All finite angles of joints and files.
pub(crate) fn stated(world: &World) -> Vec<Angles<'_>> {
    let mut all = Vec::new();
    for robot in &world.robots {
        for joint in &robot.joints {
            let frames = joint
                .parent
                .as_ref()
                .zip(joint.child.as_ref())
                .map(|(parent, child)| (FrameId::new(&*parent.value), FrameId::new(&*child.value)));
            for list in joint.origins.iter().filter_map(|origin| origin.rpy.as_ref()) {
                let Some(rpy) = list.array::<3>() else { continue };
                all.push(Angles {
                    name: format!("joint `{}`", joint.name.value),
                    rpy,
                    literals: &list.literals,
                    frames: frames.clone(),
                    is_rigid: joint.is_fixed(),
                    place: list.text.place.clone(),
                });
            }
        }
    }
    for claim in &world.claims {
        if let (ClaimKind::File { .. }, Spelling::Rpy { rpy, .. }, true) =
            (&claim.kind, &claim.spelling, claim.has_rotation)
        {
            all.push(Angles {
                name: format!("`{}`", claim.label),
                rpy: *rpy,
                literals: &claim.rotation_literals,
                frames: claim.frames.clone(),
                is_rigid: true,
                place: cover(&claim.rotation_literals, &claim.place),
            });
        }
    }
    all.retain(|angles| angles.rpy.iter().all(|angle| angle.is_finite()));
    all
}
