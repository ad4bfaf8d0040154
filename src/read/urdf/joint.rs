//! Joints, and the claim of each: `parent_from_child` at the joint's zero position.

use nalgebra::UnitQuaternion;

use crate::source::{Confidence, SourceValue};
use crate::world::claim::{Claim, ClaimKind, Literal, Pose, Spelling};
use crate::world::robot::{Joint, JointLimit, NumberList, Origin};
use crate::world::{FrameId, FrameRole};

use super::numbers::is_unexpanded;
use super::reader::{Reader, attribute, placed};
use super::xml::Element;

/// Elements of which a joint has one.
const SINGLE: [&str; 9] = [
    "origin",
    "parent",
    "child",
    "axis",
    "limit",
    "mimic",
    "dynamics",
    "safety_controller",
    "calibration",
];

impl Reader<'_> {
    /// Reads a `<joint>`. A conditional one (inside of a xacro condition) contributes its names, but no claim:
    /// which of several alternatives applies is not known.
    pub(super) fn joint(&mut self, element: &Element<'_>, conditional: bool) {
        let joint = Joint {
            name: placed(element, "name"),
            kind: placed(element, "type"),
            place: element.tag_place(),
            parent: end(element, "parent"),
            child: end(element, "child"),
            origins: Vec::new(),
            axis: None,
            limit: None,
            mimic: None,
            is_conditional: conditional,
        };
        let names = [
            Some(&joint.name),
            Some(&joint.kind),
            joint.parent.as_ref(),
            joint.child.as_ref(),
        ];
        if names.into_iter().flatten().any(|name| self.waits(&name.value)) {
            return;
        }
        self.note_ignored(element);
        self.note_repeated(element, &SINGLE, format_args!("joint `{}`", joint.name.value));
        let joint = self.parts(element, joint);
        if let Some(parent) = &joint.parent {
            self.frame(FrameRole::JointParent, parent);
        }
        if let Some(child) = &joint.child {
            self.frame(FrameRole::JointChild, child);
        }
        if !(conditional || self.is_fragment() && origin_waits(element)) {
            self.claim(&joint);
        }
        self.robot.joints.push(joint);
    }

    fn parts(&mut self, element: &Element<'_>, mut joint: Joint) -> Joint {
        for child in element.children() {
            match child.name() {
                "origin" => {
                    let origin = self.origin(&child);
                    // There is one such list, and a hundred thousand joints.
                    joint.origins.reserve_exact(1);
                    joint.origins.push(origin);
                    continue;
                }
                "axis" => {
                    let axis = self.numbers(&child, "xyz", 3);
                    joint.axis = joint.axis.or(axis);
                }
                "limit" => {
                    let limit = self.limit(&child);
                    joint.limit.get_or_insert(limit);
                }
                "mimic" => {
                    let mimicked = attribute(&child, "joint").filter(|name| !self.waits(&name.value));
                    joint.mimic = joint.mimic.or(mimicked);
                    self.numbers(&child, "multiplier", 1);
                    self.numbers(&child, "offset", 1);
                }
                "parent" | "child" => {}
                _ => continue,
            }
            self.note_ignored(&child);
        }
        joint
    }

    fn limit(&mut self, element: &Element<'_>) -> JointLimit {
        let [lower, upper, _, _] = ["lower", "upper", "effort", "velocity"].map(|name| self.numbers(element, name, 1));
        let first = |list: Option<NumberList>| list.and_then(|list| list.literals.into_iter().next());
        JointLimit {
            place: element.place(),
            lower: first(lower),
            upper: first(upper),
        }
    }

    /// Claims `parent_from_child` of a joint that names both.
    fn claim(&mut self, joint: &Joint) {
        let (Some(parent), Some(child)) = (&joint.parent, &joint.child) else {
            return;
        };
        // Consumers read the first origin.
        let origin = joint.origins.first();
        let read = origin.map_or_else(Numbers::none, |origin| Numbers::of(origin, self.reads_quaternions()));
        self.claims.push(Claim {
            frames: Some((FrameId::new(parent.value.as_str()), FrameId::new(child.value.as_str()))),
            label: joint.name.value.clone(),
            pose: read.pose,
            // In URDF, missing numbers are zero: a joint always states a whole transform.
            has_rotation: true,
            has_translation: true,
            spelling: read.spelling,
            translation_literals: read.translation,
            rotation_literals: read.rotation,
            kind: ClaimKind::Joint {
                joint: joint.name.value.clone(),
                fixed: joint.is_fixed(),
                has_origin: origin.is_some(),
            },
            reading: Confidence::Certain,
            doubt: None,
            place: origin.map_or_else(|| joint.place.clone(), |origin| origin.place.clone()),
            target_place: Some(parent.place.clone()),
            source_place: Some(child.place.clone()),
        });
    }
}

/// The link that an end of a joint names; `None` if it has no name.
fn end(element: &Element<'_>, which: &str) -> Option<SourceValue<String>> {
    attribute(&element.child(which)?, "link")
}

/// Whether a joint's transform needs xacro: in its numbers, or as a block that a macro inserts.
fn origin_waits(joint: &Element<'_>) -> bool {
    let is_block = |name: &str| name.starts_with("xacro:") || name == "insert_block";
    joint.children().any(|child| {
        let open = child.name() == "origin" && child.attributes().any(|attribute| is_unexpanded(&attribute.value));
        open || is_block(child.name())
    })
}

/// The numbers of an origin in the form of a claim.
struct Numbers {
    pose: Option<Pose>,
    spelling: Spelling,
    translation: Vec<Literal>,
    rotation: Vec<Literal>,
}

impl Numbers {
    /// A joint without `<origin>`: the identity, by definition.
    fn none() -> Self {
        Self {
            pose: Some(Pose::IDENTITY),
            spelling: Spelling::Rpy {
                xyz: [0.0; 3],
                rpy: [0.0; 3],
            },
            translation: Vec::new(),
            rotation: Vec::new(),
        }
    }

    /// The numbers of an origin. A quaternion next to `rpy` counts only if consumers read it.
    fn of(origin: &Origin, reads_quaternions: bool) -> Self {
        let xyz = Vector::<3>::of(origin.xyz.as_ref());
        let quaternion = origin
            .quat_xyzw
            .as_ref()
            .filter(|_| reads_quaternions || origin.rpy.is_none());
        if let Some(list) = quaternion {
            let xyzw = Vector::<4>::of(Some(list));
            return Self {
                pose: xyz
                    .sound
                    .zip(xyzw.sound)
                    .and_then(|(xyz, xyzw)| Pose::from_raw(xyz, xyzw)),
                spelling: Spelling::Quaternion {
                    xyz: xyz.written,
                    xyzw: xyzw.written,
                    order_known: true,
                },
                translation: xyz.literals,
                rotation: xyzw.literals,
            };
        }
        let rpy = Vector::<3>::of(origin.rpy.as_ref());
        Self {
            pose: xyz.sound.zip(rpy.sound).and_then(|(xyz, rpy)| pose(xyz, rpy)),
            spelling: Spelling::Rpy {
                xyz: xyz.written,
                rpy: rpy.written,
            },
            translation: xyz.literals,
            rotation: rpy.literals,
        }
    }
}

/// `R = Rz(yaw) Ry(pitch) Rx(roll)`, radians, metres. `None` for numbers that are not finite.
fn pose(xyz: [f64; 3], rpy: [f64; 3]) -> Option<Pose> {
    let [roll, pitch, yaw] = rpy;
    let rotation = UnitQuaternion::from_euler_angles(roll, pitch, yaw).coords;
    Pose::from_raw(xyz, [rotation.x, rotation.y, rotation.z, rotation.w])
}

/// `N` numbers of a list.
struct Vector<const N: usize> {
    /// The numbers, if a consumer can read them; zeros where the attribute is missing.
    sound: Option<[f64; N]>,
    /// The numbers as far as they are written; NaN for the rest.
    written: [f64; N],
    literals: Vec<Literal>,
}

impl<const N: usize> Vector<N> {
    fn of(list: Option<&NumberList>) -> Self {
        let Some(list) = list else {
            return Self {
                sound: Some([0.0; N]),
                written: [0.0; N],
                literals: Vec::new(),
            };
        };
        let mut written = [f64::NAN; N];
        for (slot, literal) in written.iter_mut().zip(&list.literals) {
            *slot = literal.value;
        }
        Self {
            sound: list.array::<N>(),
            written,
            literals: list.literals.clone(),
        }
    }
}
