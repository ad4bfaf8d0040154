//! The meshes of a robot with their scales in numbers.

use std::collections::{BTreeMap, BTreeSet};

use crate::source::Place;
use crate::world::World;
use crate::world::robot::{Link, Mesh, NumberList, Robot};

/// A mesh of a robot with its scale in numbers.
#[derive(Debug)]
pub(crate) struct ScaledMesh<'a> {
    /// Its link.
    pub link: &'a Link,
    /// The mesh.
    pub mesh: &'a Mesh,
    /// Its three factors; ones where none are written.
    pub factors: [f64; 3],
}

impl ScaledMesh<'_> {
    /// Whether the mesh is drawn as its mirror image.
    pub(crate) fn is_mirrored(&self) -> bool {
        self.factors.iter().product::<f64>() < 0.0
    }

    /// The scale where it is written, else the file name.
    pub(crate) fn place(&self) -> Place {
        let scale = self.mesh.scale.as_ref();
        scale.map_or_else(|| self.mesh.filename.place.clone(), |list| list.text.place.clone())
    }

    /// The scale as written.
    pub(crate) fn text(&self) -> &str {
        self.mesh
            .scale
            .as_ref()
            .map_or("1 1 1", |list| list.text.value.as_str())
    }

    /// The mesh file as written.
    pub(crate) fn file(&self) -> &str {
        &self.mesh.filename.value
    }

    /// Its name in rows.
    pub(crate) fn subject(&self, world: &World, robot: &Robot) -> String {
        format!(
            "{} of {}",
            self.mesh.usage,
            crate::analysis::urdf::called::link(world, robot, self.link)
        )
    }
}

/// Every mesh of a robot whose scale can be read.
pub(crate) fn scaled(robot: &Robot) -> Vec<ScaledMesh<'_>> {
    let meshes = robot
        .links
        .iter()
        .flat_map(|link| link.meshes.iter().map(move |mesh| (link, mesh)));
    meshes
        .filter_map(|(link, mesh)| {
            let scale = mesh.scale.as_ref().map_or(Some([1.0; 3]), NumberList::array::<3>)?;
            let finite = scale.iter().all(|factor| factor.is_finite());
            finite.then_some(ScaledMesh {
                link,
                mesh,
                factors: scale,
            })
        })
        .collect()
}

/// Files that are used both plain and mirrored, as for the left and right limbs of many robots: mirrored on other links than
/// plain, and together with other mirrored links. A single mirrored mesh is probably an error.
pub(crate) fn mirrored_on_purpose<'a>(meshes: &[ScaledMesh<'a>]) -> BTreeSet<&'a str> {
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
