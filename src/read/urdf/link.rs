//! Links: inertia, visuals, collisions, meshes.

use crate::world::FrameRole;
use crate::world::robot::{Inertial, Link, Mesh, NumberList};

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
        };
        for child in element.children() {
            match child.name() {
                "inertial" => {
                    let inertial = self.inertial(&child, &owner);
                    link.inertial.get_or_insert(inertial);
                }
                usage @ ("visual" | "collision") => {
                    link.has_geometry = true;
                    self.shape(&child, usage, &owner, &mut link.meshes);
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

    /// A single number, if it is there and a consumer can read it.
    fn number(&mut self, element: &Element<'_>, name: &str) -> Option<f64> {
        let list = self.numbers(element, name, 1)?;
        list.array::<1>().map(|[value]| value)
    }

    fn shape(&mut self, element: &Element<'_>, usage: &str, owner: &str, meshes: &mut Vec<Mesh>) {
        self.note_ignored(element);
        self.note_repeated(element, &["origin", "geometry"], format_args!("{usage} of {owner}"));
        for child in element.children() {
            match child.name() {
                "origin" => {
                    self.origin(&child);
                }
                "geometry" => self.geometry(&child, usage, owner, meshes),
                _ => {}
            }
        }
    }

    fn geometry(&mut self, element: &Element<'_>, usage: &str, owner: &str, meshes: &mut Vec<Mesh>) {
        self.note_ignored(element);
        self.note_repeated(element, &SHAPES, format_args!("geometry of {usage} of {owner}"));
        for shape in element.children() {
            let name = shape.name();
            if !SHAPES.contains(&name) {
                continue;
            }
            self.note_ignored(&shape);
            match name {
                "box" => drop(self.numbers(&shape, "size", 3)),
                "sphere" => drop(self.numbers(&shape, "radius", 1)),
                "mesh" => {
                    let scale = self.numbers(&shape, "scale", 3);
                    meshes.extend(self.mesh(&shape, usage, scale));
                }
                _ => {
                    self.numbers(&shape, "radius", 1);
                    self.numbers(&shape, "length", 1);
                }
            }
        }
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
