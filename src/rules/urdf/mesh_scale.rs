//! URDF01: a mesh that is flattened, mirrored or a thousand times too large.

use crate::advice::{subject, tally::Tally};
use crate::analysis::urdf::scaled::{ScaledMesh, mirrored_on_purpose, scaled};
use crate::rules::prelude::*;
use crate::world::{World, robot::Robot};

pub(crate) struct MeshScale;

#[derive(Debug, serde::Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Limits {
    /// Scale factor from which a mesh is too large to be a part of a robot.
    pub huge: f64,
}

impl Rule for MeshScale {
    const NEEDS: &'static [Need] = &[Need::Robot];
    type Limits = Limits;

    fn judge(world: &Estimates, limits: &Limits, out: &mut Judge) {
        let mut right = Tally::new("meshes");
        for robot in &world.robots {
            let meshes = scaled(robot);
            if meshes.is_empty() {
                subject::nothing(world, robot, "mesh with a readable scale", out);
            }
            let on_purpose = mirrored_on_purpose(&meshes);
            for scaled in &meshes {
                match judge_scale(world, robot, scaled, on_purpose.contains(scaled.file()), limits) {
                    Some(finding) => out.fail(finding),
                    None => right.pass(robot.source, largest(scaled).limit(limits.huge)),
                }
            }
        }
        right.report(world, out);
    }
}

fn largest(scaled: &ScaledMesh) -> Measured {
    let largest = scaled
        .factors
        .iter()
        .fold(0.0_f64, |largest, factor| largest.max(factor.abs()));
    Measured::new("largest scale factor", largest, "1")
}

fn judge_scale(
    world: &World,
    robot: &Robot,
    scaled: &ScaledMesh,
    on_purpose: bool,
    limits: &Limits,
) -> Option<Finding> {
    let owner = scaled.subject(world, robot);
    let link = &scaled.link.name.value;
    let (text, usage, file) = (scaled.text(), &scaled.mesh.usage, scaled.file());
    if scaled.factors.contains(&0.0) {
        let message = format!("the {usage} mesh of `{link}` is flat: its scale is {text}");
        let finding = Finding::error(owner, message, scaled.place()).label("a factor of zero");
        return Some(
            finding
                .help("replace the 0: a mesh in millimetres needs 0.001 on each axis, one in metres 1")
                .measured(largest(scaled)),
        );
    }
    if scaled.factors.iter().any(|factor| factor.abs() >= limits.huge) {
        let message = format!("the {usage} mesh of `{link}` is probably too large: its scale is {text}");
        let finding = Finding::warning(owner, message, scaled.place())
            .likely()
            .label("too large for a robot")
            .relation("millimetres")
            .help("write 0.001 0.001 0.001 if the mesh is in millimetres, and 1 1 1 if it is in metres")
            .measured(largest(scaled).limit(limits.huge));
        return Some(finding);
    }
    if scaled.is_mirrored() && !on_purpose {
        let message = format!("the {usage} mesh of `{link}` is mirrored: its scale is {text}");
        let finding = Finding::note(owner, message, scaled.place())
            .label("mirrored")
            .detail(format!("The mesh is `{file}`."))
            .help("write positive factors; if a mirrored mesh is intended, mirror the mesh file instead: a negative scale turns its faces inside out")
            .measured(Measured::new("product of the three factors", scaled.factors.iter().product(), "1").at_least(0.0));
        return Some(finding);
    }
    None
}
