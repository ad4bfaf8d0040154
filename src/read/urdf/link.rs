//! Links: inertia, visuals, collisions, meshes.

use nalgebra::{Isometry3, Translation3, UnitQuaternion};

use crate::world::robot::{Inertial, Link, Mesh, NumberList, Origin, Shape, Visual};
use crate::world::{FrameRole, Pose};

use super::reader::{Reader, attribute, placed};
use super::xml::Element;

/// Shapes of a `<geometry>`; a consumer reads the first.
const SHAPES: [&str; 5] = ["box", "sphere", "cylinder", "capsule", "mesh"];

impl Reader<'_> {
    /// Reads a `<link>`.
    pub(super) fn link(&mut self, element: &Element<'_>) {
        let name = placed(element, "name");
        if self.waits(&name.value) {
            return;
        }
        self.note_ignored(element);
        let owner = format!("link `{}`", name.value);
        self.note_repeated(element, &["inertial"], &owner);
        self.frame(FrameRole::Link, &name);
        let mut link = Link {
            name,
            place: element.tag_place(),
            inertial: None,
            meshes: Vec::new(),
            has_geometry: false,
            visuals: Vec::new(),
            collisions: Vec::new(),
        };
        for child in element.children() {
            match child.name() {
                "inertial" => {
                    let inertial = self.inertial(&child, &owner);
                    link.inertial.get_or_insert(inertial);
                }
                usage @ ("visual" | "collision") => {
                    link.has_geometry = true;
                    self.shape(&child, usage, &owner, &mut link);
                }
                _ => {}
            }
        }
        self.robot.links.push(link);
    }

    fn inertial(&mut self, element: &Element<'_>, owner: &str) -> Inertial {
        self.note_ignored(element);
        self.note_repeated(
            element,
            &["origin", "mass", "inertia"],
            format_args!("inertial of {owner}"),
        );
        for origin in element.children().filter(|child| child.name() == "origin") {
            self.origin(&origin);
        }
        let mass_kg = element.child("mass").and_then(|mass| {
            self.note_ignored(&mass);
            self.number(&mass, "value")
        });
        let inertia = element.child("inertia").and_then(|inertia| {
            self.note_ignored(&inertia);
            let [ixx, ixy, ixz, iyy, iyz, izz] =
                ["ixx", "ixy", "ixz", "iyy", "iyz", "izz"].map(|name| self.number(&inertia, name));
            Some([ixx?, ixy?, ixz?, iyy?, iyz?, izz?])
        });
        Inertial {
            place: element.place(),
            mass_kg,
            inertia,
            mass_place: element.child("mass").map(|mass| mass.place()),
            inertia_place: element.child("inertia").map(|inertia| inertia.place()),
        }
    }

    /// A single number, if it exists and a consumer can read it.
    fn number(&mut self, element: &Element<'_>, name: &str) -> Option<f64> {
        let list = self.numbers(element, name, 1)?;
        list.array::<1>().map(|[value]| value)
    }

    fn shape(&mut self, element: &Element<'_>, usage: &str, owner: &str, link: &mut Link) {
        self.note_ignored(element);
        self.note_repeated(element, &["origin", "geometry"], format_args!("{usage} of {owner}"));
        let (mut pose, mut shape) = (None, None);
        for child in element.children() {
            match child.name() {
                "origin" => pose = pose_of(&self.origin(&child)),
                "geometry" => shape = self.geometry(&child, usage, owner, &mut link.meshes),
                _ => {}
            }
        }
        if let Some(shape) = shape {
            let pose = pose.unwrap_or_else(|| Pose::from_isometry(&Isometry3::identity()));
            let bodies = if usage == "visual" {
                &mut link.visuals
            } else {
                &mut link.collisions
            };
            bodies.push(Visual { pose, shape });
        }
    }

    fn geometry(&mut self, element: &Element<'_>, usage: &str, owner: &str, meshes: &mut Vec<Mesh>) -> Option<Shape> {
        self.note_ignored(element);
        self.note_repeated(element, &SHAPES, format_args!("geometry of {usage} of {owner}"));
        let mut seen = None;
        for shape in element.children() {
            let name = shape.name();
            if !SHAPES.contains(&name) {
                continue;
            }
            self.note_ignored(&shape);
            let of = match name {
                "box" => self
                    .numbers(&shape, "size", 3)
                    .and_then(|size| size.array::<3>())
                    .map(Shape::Box),
                "sphere" => self.number(&shape, "radius").map(Shape::Sphere),
                "mesh" => {
                    let scale = self.numbers(&shape, "scale", 3);
                    let mesh = self.mesh(&shape, usage, scale);
                    let of = mesh.as_ref().map(|mesh| Shape::Mesh {
                        filename: mesh.filename.value.clone(),
                        scale: mesh.scale.as_ref().and_then(NumberList::array).unwrap_or([1.0; 3]),
                    });
                    meshes.extend(mesh);
                    of
                }
                _ => {
                    let (radius, length) = (self.number(&shape, "radius"), self.number(&shape, "length"));
                    radius
                        .zip(length)
                        .map(|(radius, length)| Shape::Cylinder([radius, length]))
                }
            };
            seen = seen.or(of);
        }
        seen
    }

    fn mesh(&mut self, element: &Element<'_>, usage: &str, scale: Option<NumberList>) -> Option<Mesh> {
        let filename = attribute(element, "filename")?;
        let found = self.meshes.found(&filename.value);
        Some(Mesh {
            usage: usage.to_owned(),
            filename,
            scale,
            found,
        })
    }
}

/// The numbers of an origin as a pose; `None` if they are not a pose.
fn pose_of(origin: &Origin) -> Option<Pose> {
    let list = |numbers: &Option<NumberList>| match numbers {
        None => Some([0.0; 3]),
        Some(numbers) => numbers.array::<3>(),
    };
    let (xyz, [roll, pitch, yaw]) = (list(&origin.xyz)?, list(&origin.rpy)?);
    let rotation = match origin.quat_xyzw.as_ref().and_then(NumberList::array::<4>) {
        Some(xyzw) => Pose::from_raw(xyz, xyzw)?.isometry().rotation,
        None => UnitQuaternion::from_euler_angles(roll, pitch, yaw),
    };
    let pose = Isometry3::from_parts(Translation3::from(xyz), rotation);
    let is_finite = pose
        .translation
        .vector
        .iter()
        .chain(rotation.coords.iter())
        .all(|value| value.is_finite());
    is_finite.then(|| Pose::from_isometry(&pose))
}
