//! URDF09: mesh files that do not exist.

use crate::advice::subject;
use crate::rules::prelude::*;
use crate::world::World;
use crate::world::robot::{Link, Mesh, Robot};

pub(crate) struct MeshMissing;

#[derive(Debug, serde::Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Limits {
    /// How many places are shown beside the first one.
    pub shown: usize,
}

impl Rule for MeshMissing {
    const NEEDS: &'static [Need] = &[Need::Robot];
    type Limits = Limits;

    fn judge(world: &Estimates, limits: &Limits, out: &mut Judge) {
        for robot in &world.robots {
            let meshes: Vec<(&Link, &Mesh)> = robot
                .links
                .iter()
                .flat_map(|link| link.meshes.iter().map(move |mesh| (link, mesh)))
                .collect();
            let missing: Vec<(&Link, &Mesh)> = meshes
                .iter()
                .copied()
                .filter(|(_, mesh)| mesh.found == Some(false))
                .collect();
            let found = meshes.iter().filter(|(_, mesh)| mesh.found == Some(true)).count();
            let unknown = meshes.len() - missing.len() - found;
            // Where all are missing, the description was probably copied without its meshes.
            let is_slip = found > 0;
            if meshes.is_empty() {
                subject::nothing(world, robot, "mesh", out);
            } else if let Some(finding) = finding(world, robot, &missing, is_slip, limits) {
                out.fail(finding);
            } else if found > 0 {
                out.pass(
                    format!("meshes of {}", world.path(robot.source)),
                    [
                        Measured::count("missing meshes", 0).limit(0.0),
                        Measured::count("meshes found", found),
                    ],
                );
            }
            if unknown > 0 {
                out.missing(
                    format!("meshes elsewhere of {}", world.path(robot.source)), format!(
                        "{unknown} of {} meshes are in packages that are not among the inputs: add the folders of these packages",
                        meshes.len()
                    ),
                );
            }
        }
    }
}

fn finding(
    world: &World,
    robot: &Robot,
    missing: &[(&Link, &Mesh)],
    is_slip: bool,
    limits: &Limits,
) -> Option<Finding> {
    let (link, first) = missing.first()?;
    let message = match missing.len() {
        1 if !is_slip => format!("the only mesh of robot `{}` has no file", robot.name.value),
        n if !is_slip => format!(
            "the files of all {n} meshes of robot `{}` are missing",
            robot.name.value
        ),
        1 => format!("the {} mesh file of `{}` does not exist", first.usage, link.name.value),
        n => format!("{n} meshes have no file, the first is that of `{}`", link.name.value),
    };
    let file = &first.filename.value;
    let detail = match missing.len() - 1 {
        0 => format!("Missing: `{file}`."),
        more => {
            let mut files: Vec<&str> = missing.iter().map(|(_, mesh)| mesh.filename.value.as_str()).collect();
            files.sort_unstable();
            files.dedup();
            match files.len() - 1 {
                0 => format!("Missing: `{file}`, which {} meshes use.", more + 1),
                1 => format!("Missing: `{file}` and one more file."),
                others => format!("Missing: `{file}` and {others} more files."),
            }
        }
    };
    let subject = format!("meshes of {}", world.path(robot.source));
    let severity = if is_slip { Severity::Warning } else { Severity::Note };
    let mut finding = Finding::new(severity, subject, message, first.filename.place.clone())
        .label("no such file")
        .detail(detail)
        .help("correct the path (it is case-sensitive), or add the file. If the package is elsewhere, give its folder to frames-lint as one more path")
        .measured(Measured::count("missing meshes", missing.len()).limit(0.0));
    for (link, mesh) in missing.iter().skip(1).take(limits.shown) {
        finding = finding.related(
            mesh.filename.place.clone(),
            format!("no such file, link `{}`", link.name.value),
        );
    }
    Some(finding)
}
