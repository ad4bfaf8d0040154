//! What is to be seen, as pure data: entities with a place in a tree, at a time or always, and the views that show them.
//!
//! Must not know the viewer. Everything spatial stands under [`WORLD`], whose axes are x east or forward, y north or left, z up.

use std::collections::BTreeMap;

use nalgebra::{Isometry3, Vector3};

use crate::source::MeshFile;

/// The entity that everything spatial stands under.
pub const WORLD: &str = "world";

/// An entity's place in the tree: names from the top, without slashes of their own.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Path(Vec<String>);

impl Path {
    /// An entity at the top.
    pub fn top(name: impl Into<String>) -> Self {
        Self(vec![name.into()])
    }

    /// The entity of this name beneath.
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

    /// As reports have it: `world/map/base_link`.
    pub fn words(&self) -> String {
        self.0.join("/")
    }

    /// Whether it is `other` or stands beneath it.
    pub fn is_in(&self, other: &Self) -> bool {
        self.0.starts_with(&other.0)
    }
}

/// A colour: red, green, blue.
pub type Color = [u8; 3];

/// Points with what is told of each.
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

/// What an entity shows.
#[derive(Clone, Debug, PartialEq)]
pub enum What {
    /// Where its frame stands in that of the entity above: `parent_from_child`.
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
    /// Points of a plane, x to the right and y up: what a plot shows.
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
    /// Words beneath points; none where empty.
    pub label: String,
}

/// How loud a line of the log is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Level {
    /// A note, or a hint.
    Info,
    /// A warning.
    Warning,
    /// An error.
    Error,
}

/// Something to be seen.
#[derive(Clone, Debug, PartialEq)]
pub struct Item {
    /// The entity.
    pub path: Path,
    /// The stamp from which on it holds, nanoseconds; always where `None`.
    pub stamp_ns: Option<i64>,
    /// What it is.
    pub what: What,
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
    /// How it shows.
    pub kind: Kind,
    /// What is shown, with everything beneath.
    pub origin: Path,
    /// Entities that are there and hidden at first.
    pub hidden: Vec<Path>,
    /// What of a plane is seen at first: the lowest and the highest x, and y downwards; everything where `None`.
    pub bounds: Option<[[f32; 2]; 2]>,
    /// Where one looks from at first; from where everything is seen where `None`.
    pub eye: Option<Eye>,
}

/// Where one looks from, in the axes of the view's origin.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Eye {
    /// Where the eye is, metres.
    pub at_m: [f32; 3],
    /// What it looks at, metres.
    pub target_m: [f32; 3],
}

/// Everything.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Scene {
    /// What is to be seen.
    pub items: Vec<Item>,
    /// The views, the one that is looked at first before all others.
    pub views: Vec<View>,
    /// The stamp that is looked at first, nanoseconds.
    pub at_ns: Option<i64>,
}

impl Scene {
    /// Adds what holds always.
    pub fn always(&mut self, path: &Path, what: What) {
        self.items.push(Item {
            path: path.clone(),
            stamp_ns: None,
            what,
        });
    }

    /// Adds what holds from a stamp on.
    pub fn at(&mut self, path: &Path, stamp_ns: i64, what: What) {
        self.items.push(Item {
            path: path.clone(),
            stamp_ns: Some(stamp_ns),
            what,
        });
    }

    /// Whether an entity, or one beneath it, shows anything.
    pub fn has(&self, path: &Path) -> bool {
        self.items.iter().any(|item| item.path.is_in(path))
    }
}

/// Where entities stand at one moment.
pub struct Places<'s> {
    own: BTreeMap<&'s Path, &'s Isometry3<f64>>,
}

impl<'s> Places<'s> {
    /// By the last poses up to a stamp. What moves and has no pose yet then stands where it will be first, and where there is no stamp.
    pub fn of(scene: &'s Scene, at_ns: Option<i64>) -> Self {
        let mut own: BTreeMap<&Path, &Isometry3<f64>> = BTreeMap::new();
        for item in &scene.items {
            let What::Pose(pose) = &item.what else { continue };
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

    /// Where an entity stands in that at the top: `top_from_entity`.
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
