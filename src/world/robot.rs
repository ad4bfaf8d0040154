//! A robot as its URDF describes it: links, joints and everything else that was written, with places.

use compact_str::CompactString;
use serde::{Deserialize, Serialize};

use crate::source::{Place, SourceId, SourceValue};

use super::claim::{Literal, Pose};

/// A list of numbers of an attribute (`xyz="0 0 1.5"`).
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct NumberList {
    /// The attribute's name: `xyz`, `rpy`, `quat_xyzw`, `scale`, ...
    pub attribute: CompactString,
    /// The attribute's text.
    pub text: SourceValue<CompactString>,
    /// The pieces between whitespace; a piece that is not a number has the value NaN and is reported in `malformed`.
    pub literals: Vec<Literal>,
    /// How many numbers the attribute should have.
    pub expected: usize,
    /// Why a consumer cannot read the list (commas, wrong count, not a number); `None` when it can.
    pub malformed: Option<String>,
}

impl NumberList {
    /// The numbers, if there are exactly `N` and the list is well formed.
    pub fn array<const N: usize>(&self) -> Option<[f64; N]> {
        if self.malformed.is_some() || self.literals.len() != N {
            return None;
        }
        let mut values = [0.0; N];
        for (value, literal) in values.iter_mut().zip(&self.literals) {
            *value = literal.value;
        }
        Some(values)
    }
}

/// An `<origin>` element.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Origin {
    /// The element.
    pub place: Place,
    /// Translation, metres.
    pub xyz: Option<NumberList>,
    /// Fixed-axis roll, pitch, yaw, radians.
    pub rpy: Option<NumberList>,
    /// Quaternion of URDF 1.2, `x y z w`.
    pub quat_xyzw: Option<NumberList>,
}

/// A mesh that a visual or collision element refers to.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Mesh {
    /// `visual` or `collision`.
    pub usage: String,
    /// The file as written (`package://...`, `file://...`, relative).
    pub filename: SourceValue<String>,
    /// Scale factors.
    pub scale: Option<NumberList>,
    /// Whether the file was found; `None` if it cannot be decided (a `package://` outside of the input).
    pub found: Option<bool>,
}

/// An `<inertial>` element.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Inertial {
    /// The element.
    pub place: Place,
    /// Mass, kilograms.
    #[serde(with = "super::number::option")]
    pub mass_kg: Option<f64>,
    /// `ixx ixy ixz iyy iyz izz`, kg m²; `None` if one is missing or not a number.
    #[serde(with = "super::number::option_array")]
    pub inertia: Option<[f64; 6]>,
    /// The `<mass>` element, if there is one.
    pub mass_place: Option<Place>,
    /// The `<inertia>` element, if there is one.
    pub inertia_place: Option<Place>,
}

/// A `<link>`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Link {
    /// The name; empty if the attribute is missing.
    pub name: SourceValue<String>,
    /// The element's start tag.
    pub place: Place,
    /// Its inertia, if any.
    pub inertial: Option<Inertial>,
    /// Meshes of its visuals and collisions.
    pub meshes: Vec<Mesh>,
    /// Whether the link has any `<visual>` or `<collision>`.
    pub has_geometry: bool,
    /// Its visuals.
    #[serde(default)]
    pub visuals: Vec<Visual>,
    /// Its collisions.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub collisions: Vec<Visual>,
}

/// The shape of a part of a link.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Visual {
    /// `link_from_body`; the identity if the numbers are not a pose.
    pub pose: Pose,
    /// Its shape.
    pub shape: Shape,
}

/// The shape of a visual or a collision.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Shape {
    /// Lengths of the sides, metres.
    Box(#[serde(with = "super::number::array")] [f64; 3]),
    /// Along z: radius and length, metres.
    Cylinder(#[serde(with = "super::number::array")] [f64; 2]),
    /// Radius, metres.
    Sphere(#[serde(with = "super::number")] f64),
    /// A file.
    Mesh {
        /// As written; [`crate::source::Source::meshes`] has the path here.
        filename: String,
        /// Scale factors.
        #[serde(with = "super::number::array")]
        scale: [f64; 3],
    },
}

/// A joint's `<limit>`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct JointLimit {
    /// The element.
    pub place: Place,
    /// Lower bound: radians, or metres for a prismatic joint.
    pub lower: Option<Literal>,
    /// Upper bound.
    pub upper: Option<Literal>,
}

/// A `<joint>` of the robot's tree (joints of transmissions are not joints).
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Joint {
    /// The name; empty where missing.
    pub name: SourceValue<String>,
    /// The type as written (`fixed`, `revolute`, ...).
    pub kind: SourceValue<String>,
    /// The element's start tag.
    pub place: Place,
    /// The parent link's name; `None` without a `<parent link=...>`.
    pub parent: Option<SourceValue<String>>,
    /// The child link's name.
    pub child: Option<SourceValue<String>>,
    /// Every `<origin>` written; a consumer reads one.
    pub origins: Vec<Origin>,
    /// The axis as written.
    pub axis: Option<NumberList>,
    /// Limits.
    pub limit: Option<JointLimit>,
    /// The joint named by `<mimic>`.
    pub mimic: Option<SourceValue<String>>,
    /// Whether it is below a condition of xacro that was not evaluated (`xacro:if`, `xacro:unless`): it may not exist.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub is_conditional: bool,
}

impl Joint {
    /// Whether the joint is rigid.
    pub fn is_fixed(&self) -> bool {
        self.kind.value == "fixed"
    }
}

/// Something a consumer silently ignores: a misspelt attribute or element.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct IgnoredItem {
    /// `attribute` or `element`.
    pub what: String,
    /// The name as written, with its place.
    pub name: SourceValue<String>,
    /// The element that contains it.
    pub parent: String,
    /// The known name that is probably meant, if one is similar.
    pub meant: Option<String>,
}

/// An element that occurs more often than a consumer reads it.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct RepeatedItem {
    /// The element's name (`origin`, `axis`, `limit`, `parent`, ...).
    pub element: String,
    /// What contains it: `joint` or `link`, `visual`, ..., and the owner's name.
    pub owner: String,
    /// All places, in order.
    pub places: Vec<Place>,
}

/// The result of a consumer's parser for the same text.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum ConsumerOpinion {
    /// It loads, to these edges `(joint, parent, child)`, sorted, with its own numbers `xyz`, `rpy`.
    Loads(Vec<ConsumerJoint>),
    /// It refuses the text, with its own message.
    Refuses(String),
    /// It was not run, and why.
    NotAsked(String),
}

/// A joint as the consumer read it.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ConsumerJoint {
    /// Joint name.
    pub name: String,
    /// Parent link.
    pub parent: String,
    /// Child link.
    pub child: String,
    /// Metres.
    #[serde(with = "super::number::array")]
    pub xyz: [f64; 3],
    /// Radians.
    #[serde(with = "super::number::array")]
    pub rpy: [f64; 3],
}

/// A robot description.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Robot {
    /// The source whose text it is.
    pub source: SourceId,
    /// The robot's name.
    pub name: SourceValue<String>,
    /// The `version` attribute, if written.
    pub version: Option<String>,
    /// Links in file order.
    pub links: Vec<Link>,
    /// Joints in file order.
    pub joints: Vec<Joint>,
    /// Number lists that a consumer cannot read.
    pub malformed: Vec<NumberList>,
    /// Names that a consumer ignores.
    pub ignored: Vec<IgnoredItem>,
    /// Elements written too often.
    pub repeated: Vec<RepeatedItem>,
    /// Second opinion.
    pub consumer: ConsumerOpinion,
    /// Set where only a part could be read (an unexpanded xacro): structure rules cannot judge it.
    pub fragment: Option<String>,
}

impl Robot {
    /// Whether nothing was read of it: no link, no joint, and nothing that consumers read otherwise.
    pub fn is_empty(&self) -> bool {
        let parts = [
            self.links.len(),
            self.joints.len(),
            self.malformed.len(),
            self.ignored.len(),
            self.repeated.len(),
        ];
        parts.iter().all(|count| *count == 0)
    }
}
