//! A scene as pure data: entities with a place in a tree, at a time or always, and the views that show them.
//!
//! Independent of the viewer. Everything spatial is under [`WORLD`], whose axes are x east or forward, y north or left, z up.

use std::collections::BTreeMap;

use nalgebra::{Isometry3, Vector3};

use crate::source::MeshFile;

/// The root of all spatial entities.
pub const WORLD: &str = "world";

/// An entity's place in the tree: names from the top, without slashes of their own.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Path(Vec<String>);

impl Path {
    /// An entity at the top.
    pub fn top(name: impl Into<String>) -> Self {
        Self(vec![name.into()])
    }

    /// The child entity of this name.
    #[must_use]
    pub fn then(&self, name: impl Into<String>) -> Self {
        let mut names = self.0.clone();
        names.push(name.into());
        Self(names)
    }

    /// Names from the top.
    pub fn names(&self) -> &[String] {
        &self.0
    }

    /// As in reports: `world/map/base_link`.
    pub fn words(&self) -> String {
        self.0.join("/")
    }

    /// Whether it is `other` or below it.
    pub fn is_in(&self, other: &Self) -> bool {
        self.0.starts_with(&other.0)
    }
}

/// A colour: red, green, blue.
pub type Color = [u8; 3];

/// Points with labels.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Points {
    /// Metres, in the entity's frame.
    pub xyz_m: Vec<[f32; 3]>,
    /// One for all, or one for each.
    pub colors: Vec<Color>,
    /// Metres; negative: pixels.
    pub radius: f32,
    /// One for each, or none.
    pub labels: Vec<String>,
}

/// Lines through points.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Lines {
    /// Metres, in the entity's frame.
    pub strips_m: Vec<Vec<[f32; 3]>>,
    /// The colour of all.
    pub color: Color,
    /// Metres; negative: pixels.
    pub radius: f32,
    /// One for each, or none.
    pub labels: Vec<String>,
}

/// A body of a robot.
#[derive(Clone, Debug, PartialEq)]
pub enum Body {
    /// A file with a mesh that the viewer reads (STL, OBJ, glTF, Collada), and its scale.
    Mesh(MeshFile, [f32; 3]),
    /// Lengths of the sides, metres.
    Box([f32; 3]),
    /// Radius and length along z, metres.
    Cylinder(f32, f32),
    /// Radius, metres.
    Sphere(f32),
}

/// The content of an entity.
#[derive(Clone, Debug, PartialEq)]
pub enum Content {
    /// The pose of its frame in that of the parent entity: `parent_from_child`.
    Pose(Isometry3<f64>),
    /// The axes of its frame, metres long: x red, y green, z blue.
    Axes(f32),
    /// Points.
    Points(Points),
    /// Lines.
    Lines(Lines),
    /// A body.
    Body(Body),
    /// A camera that looks along z, x to the right: `image_from_camera`, row-major, and width and height, pixels.
    Camera([f32; 9], [f32; 2]),
    /// Points in the image of the camera above: x to the right and y down, pixels.
    Pixels(Points),
    /// Points of a plot, x to the right and y up.
    Drawing(Drawing),
    /// A number with its name and colour.
    Number(f64),
    /// How a number is drawn: name and colour, as a line or as points.
    Curve(String, Color, bool),
    /// A line of a log.
    Log(Level, String),
    /// A page in Markdown.
    Page(String),
}

/// Points or a line of a plot.
#[derive(Clone, Debug, PartialEq)]
pub struct Drawing {
    /// x to the right, y up.
    pub strips: Vec<Vec<[f32; 2]>>,
    /// Whether the points are joined.
    pub is_line: bool,
    /// Colour.
    pub color: Color,
    /// Labels below points; none if empty.
    pub label: String,
}

/// The level of a line of the log.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Level {
    /// A note, or a hint.
    Info,
    /// A warning.
    Warning,
    /// An error.
    Error,
}

/// An item of the scene.
#[derive(Clone, Debug, PartialEq)]
pub struct Item {
    /// The entity.
    pub path: Path,
    /// The timestamp from which it is valid, nanoseconds; `None`: always.
    pub stamp_ns: Option<i64>,
    /// What it is.
    pub what: Content,
}

/// How a view shows entities.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// In space.
    Space,
    /// In a plane.
    Plane,
    /// Over time.
    Time,
    /// A log.
    Log,
    /// A page.
    Page,
}

/// A part of the window.
#[derive(Clone, Debug, PartialEq)]
pub struct View {
    /// Its name.
    pub name: String,
    /// How it shows them.
    pub kind: Kind,
    /// The entities shown, with everything below them.
    pub origin: Path,
    /// Entities that are hidden at first.
    pub hidden: Vec<Path>,
    /// The initial range of a plane: the lowest and the highest x, and y downwards; `None`: everything.
    pub bounds: Option<[[f32; 2]; 2]>,
    /// The initial camera; `None`: one that shows everything.
    pub eye: Option<Eye>,
}

/// A camera position, in the axes of the view's origin.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Eye {
    /// Its position, metres.
    pub at_m: [f32; 3],
    /// The point that it looks at, metres.
    pub target_m: [f32; 3],
}

/// Everything.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Scene {
    /// The items.
    pub items: Vec<Item>,
    /// The views; the first one is opened first.
    pub views: Vec<View>,
    /// The initial timestamp, nanoseconds.
    pub at_ns: Option<i64>,
}

impl Scene {
    /// Adds an item that is always valid.
    pub fn always(&mut self, path: &Path, what: Content) {
        self.items.push(Item {
            path: path.clone(),
            stamp_ns: None,
            what,
        });
    }

    /// Adds an item that is valid from a timestamp on.
    pub fn at(&mut self, path: &Path, stamp_ns: i64, what: Content) {
        self.items.push(Item {
            path: path.clone(),
            stamp_ns: Some(stamp_ns),
            what,
        });
    }

    /// Whether an entity, or one below it, has content.
    pub fn has(&self, path: &Path) -> bool {
        self.items.iter().any(|item| item.path.is_in(path))
    }
}

/// The poses of entities at one time.
pub struct Places<'s> {
    own: BTreeMap<&'s Path, &'s Isometry3<f64>>,
}

impl<'s> Places<'s> {
    /// From the last poses up to a timestamp. A moving entity without a pose by then, or without a timestamp, has its first pose.
    pub fn of(scene: &'s Scene, at_ns: Option<i64>) -> Self {
        let mut own: BTreeMap<&Path, &Isometry3<f64>> = BTreeMap::new();
        for item in &scene.items {
            let Content::Pose(pose) = &item.what else { continue };
            let is_past = match (item.stamp_ns, at_ns) {
                (None, _) => true,
                (Some(stamp_ns), Some(at_ns)) => stamp_ns <= at_ns,
                (Some(_), None) => false,
            };
            if is_past {
                own.insert(&item.path, pose);
            } else {
                own.entry(&item.path).or_insert(pose);
            }
        }
        Self { own }
    }

    /// The pose of an entity in the top one: `top_from_entity`.
    pub fn place(&self, of: &Path) -> Isometry3<f64> {
        let above = (1..=of.0.len()).map(|depth| Path(of.0.iter().take(depth).cloned().collect()));
        let poses = above.map(|path| self.own.get(&path).copied().copied());
        poses.flatten().fold(Isometry3::identity(), |place, pose| place * pose)
    }
}

/// Metres as the viewer has them.
pub fn narrow(point: &Vector3<f64>) -> [f32; 3] {
    [point.x as f32, point.y as f32, point.z as f32]
}
