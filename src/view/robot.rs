//! The bodies of links, under their frames: shapes, and meshes that were found in a format that viewers read.

use std::path::Path as FilePath;

use crate::source::MeshFile;
use crate::world::FrameId;
use crate::world::robot::Shape;

use super::placed::FrameEntities;
use super::scene::{Body, Content, Path, Scene};

/// Extensions of the meshes that the viewer reads.
const READABLE: [&str; 5] = ["glb", "gltf", "obj", "stl", "dae"];

/// Draws the robots of a world; a link without a drawable body is shown by its frame.
pub(super) fn robots(placed: &FrameEntities, scene: &mut Scene) {
    for robot in &placed.world().robots {
        let source = placed.world().source(robot.source);
        let file = |name: &str| source?.meshes.get(name).cloned();
        for link in &robot.links {
            let Some(path) = placed.path(&FrameId::new(link.name.value.as_str())).cloned() else {
                continue;
            };
            for (number, visual) in link.visuals.iter().enumerate() {
                if let Some(body) = body(&visual.shape, &file) {
                    let own: Path = path.then(format!("body {}", number + 1));
                    scene.always(&own, Content::Pose(visual.pose.isometry()));
                    scene.always(&own, Content::Body(body));
                }
            }
        }
    }
}

fn body(shape: &Shape, file: &dyn Fn(&str) -> Option<MeshFile>) -> Option<Body> {
    let narrow = |value: f64| value as f32;
    Some(match shape {
        Shape::Box(sides_m) => Body::Box(sides_m.map(narrow)),
        Shape::Cylinder([radius_m, length_m]) => Body::Cylinder(narrow(*radius_m), narrow(*length_m)),
        Shape::Sphere(radius_m) => Body::Sphere(narrow(*radius_m)),
        Shape::Mesh { filename, scale } => {
            let file = file(filename).filter(|file| is_readable(&file.path))?;
            Body::Mesh(file, scale.map(narrow))
        }
    })
}

fn is_readable(file: &FilePath) -> bool {
    let ending = file.extension().map(|ending| ending.to_string_lossy().to_lowercase());
    ending.is_some_and(|ending| READABLE.contains(&ending.as_str()))
}
