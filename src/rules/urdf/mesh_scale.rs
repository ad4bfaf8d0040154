//! URDF01: a mesh that is flattened, mirrored or drawn a thousand times too large.

use std::collections::{BTreeMap, BTreeSet};

use crate::rules::tally::Tally;
use crate::rules::{Judge, Need, Rule};
use crate::source::Place;
use crate::verdict::{Finding, Measured};
use crate::world::World;
use crate::world::robot::{Link, Mesh, Robot};

use super::subject;

/// URDF01.
pub struct MeshScale;

/// Limits of URDF01.
#[derive(Debug, serde::Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Limits {
    /// Scale factor from which a mesh is too large to be a part of a robot.
    pub huge: f64,
}

/// A mesh of a robot with its scale in numbers.
struct Scaled<'a> {
    link: &'a Link,
    mesh: &'a Mesh,
    scale: [f64; 3],
}

impl Scaled<'_> {
    fn is_mirrored(&self) -> bool {
        self.scale.iter().product::<f64>() < 0.0
    }

    fn place(&self) -> Place {
        let scale = self.mesh.scale.as_ref();
        scale.map_or_else(|| self.mesh.filename.place.clone(), |list| list.text.place.clone())
    }

    fn text(&self) -> &str {
        self.mesh
            .scale
            .as_ref()
            .map_or("1 1 1", |list| list.text.value.as_str())
    }

    fn file(&self) -> &str {
        &self.mesh.filename.value
    }

    fn subject(&self, world: &World, robot: &Robot) -> String {
        format!("{} of {}", self.mesh.usage, subject::link(world, robot, self.link))
    }
}

impl Rule for MeshScale {
    const PAGE: &'static str = include_str!("../../../rules/urdf/mesh-scale.md");
    const NEEDS: &'static [Need] = &[Need::Robot];
    type Limits = Limits;

    fn judge(world: &World, limits: &Limits, out: &mut Judge) {
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

fn scaled(robot: &Robot) -> Vec<Scaled<'_>> {
    let meshes = robot
        .links
        .iter()
        .flat_map(|link| link.meshes.iter().map(move |mesh| (link, mesh)));
    meshes
        .filter_map(|(link, mesh)| {
            let scale = mesh.scale.as_ref().map_or(Some([1.0; 3]), |list| list.array::<3>())?;
            let finite = scale.iter().all(|factor| factor.is_finite());
            finite.then_some(Scaled { link, mesh, scale })
        })
        .collect()
}

/// Files that are drawn both ways round, as the left and right limbs of many robots are: mirrored on other links than
/// plain, and together with other mirrored links. A single mirrored mesh looks like a slip.
fn mirrored_on_purpose<'a>(meshes: &[Scaled<'a>]) -> BTreeSet<&'a str> {
    let mut by_file: BTreeMap<&str, [BTreeSet<&str>; 2]> = BTreeMap::new();
    for scaled in meshes {
        let file = scaled.mesh.filename.value.as_str();
        let [plain, mirrored] = by_file.entry(file).or_default();
        let links = if scaled.is_mirrored() { mirrored } else { plain };
        links.insert(scaled.link.name.value.as_str());
    }
    let both = by_file
        .iter()
        .filter(|(_, [plain, mirrored])| !mirrored.is_empty() && !plain.is_empty() && plain.is_disjoint(mirrored));
    let both: Vec<(&str, usize)> = both.map(|(file, [_, mirrored])| (*file, mirrored.len())).collect();
    if both.iter().map(|(_, links)| links).sum::<usize>() < 2 {
        return BTreeSet::new();
    }
    both.into_iter().map(|(file, _)| file).collect()
}

fn largest(scaled: &Scaled) -> Measured {
    let largest = scaled
        .scale
        .iter()
        .fold(0.0_f64, |largest, factor| largest.max(factor.abs()));
    Measured::new("largest scale factor", largest, "1")
}

fn judge_scale(world: &World, robot: &Robot, scaled: &Scaled, on_purpose: bool, limits: &Limits) -> Option<Finding> {
    let owner = scaled.subject(world, robot);
    let link = &scaled.link.name.value;
    let (text, usage, file) = (scaled.text(), &scaled.mesh.usage, scaled.file());
    if scaled.scale.contains(&0.0) {
        let message = format!("the {usage} mesh of `{link}` is flattened: its scale is {text}");
        let finding = Finding::error(owner, message, scaled.place()).label("a factor of zero");
        return Some(
            finding
                .help("write 1 for an axis that is not scaled")
                .measured(largest(scaled)),
        );
    }
    if scaled.scale.iter().any(|factor| factor.abs() >= limits.huge) {
        let message = format!("the {usage} mesh of `{link}` is enlarged: its scale is {text}");
        let finding = Finding::warning(owner, message, scaled.place())
            .likely()
            .label("a part of a robot, or of a town?")
            .relation("millimetres")
            .help("meshes in millimetres need 0.001 0.001 0.001, the inverse of this")
            .measured(largest(scaled).limit(limits.huge));
        return Some(finding);
    }
    if scaled.is_mirrored() && !on_purpose {
        let message = format!("the {usage} mesh `{file}` of `{link}` is mirrored: its scale is {text}");
        let finding = Finding::note(owner, message, scaled.place())
            .label("drawn mirrored")
            .help("mirror the mesh file itself, if that is meant: a negative scale turns the faces inside out")
            .measured(Measured::new("product of the factors", scaled.scale.iter().product(), "1").limit(0.0));
        return Some(finding);
    }
    None
}
