//! The walk over a robot's elements, and the facts that it gathers.
//!
//! Owns the order of reading, frame names and the signs of xacro. Links and joints have files of their own.

use std::collections::{BTreeMap, BTreeSet};
use std::fmt::Display;

use crate::source::{Place, SourceId, SourceValue};
use crate::world::robot::{ConsumerOpinion, IgnoredItem, NumberList, Origin, RepeatedItem, Robot};
use crate::world::{Claim, Facts, FrameId, FrameRole, FrameUse};

use super::known;
use super::mesh::MeshLookup;
use super::numbers::{is_unexpanded, number_list};
use super::xml::Element;

/// Gathers the facts of one text.
pub(super) struct Reader<'a> {
    pub(super) meshes: &'a MeshLookup,
    pub(super) robot: Robot,
    pub(super) claims: Vec<Claim>,
    frames: BTreeMap<(FrameRole, FrameId), (Place, u64)>,
}

impl<'a> Reader<'a> {
    /// A reader for the robot of `root`; `fragment` states why the text cannot be the whole robot.
    pub(super) fn new(
        root: &Element<'_>,
        source: SourceId,
        meshes: &'a MeshLookup,
        fragment: Option<String>,
        consumer: ConsumerOpinion,
    ) -> Self {
        Self {
            meshes,
            robot: Robot {
                source,
                name: placed(root, "name"),
                version: root.attribute("version").map(|attribute| attribute.value.into_owned()),
                links: Vec::new(),
                joints: Vec::new(),
                malformed: Vec::new(),
                ignored: Vec::new(),
                repeated: Vec::new(),
                consumer,
                fragment,
            },
            claims: Vec::new(),
            frames: BTreeMap::new(),
        }
    }

    /// Reads everything under `root`.
    pub(super) fn read(mut self, root: &Element<'_>) -> Facts {
        self.note_ignored(root);
        // Macros nest as deep as the input likes: an explicit stack.
        let mut stack = Vec::new();
        push_children(&mut stack, root, false);
        while let Some((element, conditional)) = stack.pop() {
            match element.name() {
                "link" => self.link(&element),
                "joint" => self.joint(&element, conditional),
                name if self.is_macro(name) => {
                    let conditional = conditional || matches!(local(name), "if" | "unless");
                    push_children(&mut stack, &element, conditional);
                }
                _ => {}
            }
        }
        self.simulator_frames(root);
        self.finish()
    }

    /// Whether links and joints inside of this element are the robot's: macros and conditions of xacro.
    fn is_macro(&self, name: &str) -> bool {
        self.is_fragment() && (name.starts_with("xacro:") || matches!(name, "macro" | "if" | "unless" | "group"))
    }

    /// Whether only a part is read: numbers and names may not be expanded yet.
    pub(super) fn is_fragment(&self) -> bool {
        self.robot.fragment.is_some()
    }

    /// Whether a text is not expanded yet.
    pub(super) fn waits(&self, text: &str) -> bool {
        self.is_fragment() && is_unexpanded(text)
    }

    /// An attribute of `expected` numbers, if it exists and needs no expansion. Malformed ones are also kept separately.
    pub(super) fn numbers(&mut self, element: &Element<'_>, name: &str, expected: usize) -> Option<NumberList> {
        let attribute = element.attribute(name)?;
        if self.waits(&attribute.value) {
            return None;
        }
        let list = number_list(&attribute, expected);
        if list.malformed.is_some() {
            self.robot.malformed.push(list.clone());
        }
        Some(list)
    }

    /// An `<origin>`, with its faults.
    pub(super) fn origin(&mut self, element: &Element<'_>) -> Origin {
        self.note_ignored(element);
        let xyz = self.numbers(element, "xyz", 3);
        let rpy = self.numbers(element, "rpy", 3);
        let mut quat_xyzw = self.numbers(element, "quat_xyzw", 4);
        if let Some(list) = &mut quat_xyzw
            && rpy.is_some()
            && self.reads_quaternions()
            && list.malformed.is_none()
        {
            list.malformed = Some("`rpy` and `quat_xyzw` are both given: URDF parsers refuse the pair".to_owned());
            self.robot.malformed.push(list.clone());
        }
        if let Some(attribute) = element.attribute("quat_xyzw").filter(|_| !self.reads_quaternions()) {
            self.robot.ignored.push(IgnoredItem {
                what: "attribute".to_owned(),
                name: SourceValue::new(attribute.name.to_owned(), attribute.name_place),
                parent: element.name().to_owned(),
                // Spelled correctly, but the robot's version is too low for it.
                meant: None,
            });
        }
        Origin {
            place: element.place(),
            xyz,
            rpy,
            quat_xyzw,
        }
    }

    /// Whether consumers read `quat_xyzw` in this robot: from URDF version 1.1 on.
    pub(super) fn reads_quaternions(&self) -> bool {
        let version = self
            .robot
            .version
            .as_deref()
            .and_then(|version| version.split_once('.'));
        version.is_some_and(|(major, minor)| match (major.parse::<u32>(), minor.parse::<u32>()) {
            (Ok(major), Ok(minor)) => (major, minor) >= (1, 1),
            _ => false,
        })
    }

    /// Keeps the names in `element` that a consumer ignores.
    pub(super) fn note_ignored(&mut self, element: &Element<'_>) {
        self.robot.ignored.extend(known::ignored(element));
    }

    /// Keeps the elements named `names` that occur more than once in `element`.
    pub(super) fn note_repeated(&mut self, element: &Element<'_>, names: &[&str], owner: impl Display) {
        if element.children().nth(1).is_none() {
            return;
        }
        for name in names {
            let named = || element.children().filter(|child| child.name() == *name);
            if named().nth(1).is_none() {
                continue;
            }
            let places: Vec<Place> = named().map(|child| child.place()).collect();
            self.robot.repeated.push(RepeatedItem {
                element: (*name).to_owned(),
                owner: owner.to_string(),
                places,
            });
        }
    }

    /// Keeps a use of a frame name.
    pub(super) fn frame(&mut self, role: FrameRole, name: &SourceValue<String>) {
        self.frames
            .entry((role, FrameId::new(name.value.as_str())))
            .or_insert_with(|| (name.place.clone(), 0))
            .1 += 1;
    }

    /// Frames that simulator elements name: `<gazebo reference>`, the parent of a `<sensor>`, and the frame that a
    /// simulated sensor stamps its messages with.
    fn simulator_frames(&mut self, root: &Element<'_>) {
        // `<gazebo reference>` may name a joint as well as a link: a joint's name is not a frame.
        let links: BTreeSet<String> = self.robot.links.iter().map(|link| link.name.value.clone()).collect();
        let joints = self.robot.joints.iter().map(|joint| joint.name.value.clone());
        let joints_only: BTreeSet<String> = joints.filter(|name| !links.contains(name)).collect();
        for element in root.descendants() {
            let parent = element.parent();
            let parent = parent.as_ref().map_or("", |parent| parent.name());
            let named = match (parent, element.name()) {
                (_, "gazebo") => attribute(&element, "reference"),
                ("sensor", "parent") => attribute(&element, "link"),
                (_, "frameName" | "frame_name" | "frame_id" | "gz_frame_id" | "ignition_frame_id") => {
                    in_sensor(&element)
                        .then(|| element.words().map(|(name, place)| SourceValue::new(name, place)))
                        .flatten()
                        // Gazebo's own origin, in which contact sensors report: not a frame of the robot.
                        .filter(|name| name.value != "world")
                }
                _ => None,
            };
            if let Some(name) = named
                && !name.value.is_empty()
                && !is_unexpanded(&name.value)
                && !joints_only.contains(&name.value)
            {
                self.frame(FrameRole::Simulator, &name);
            }
        }
    }

    fn finish(self) -> Facts {
        let frames = self.frames.into_iter().map(|((role, frame), (place, count))| FrameUse {
            frame,
            role,
            place,
            count,
        });
        Facts {
            claims: self.claims,
            frames: frames.collect(),
            robots: vec![self.robot],
            ..Facts::default()
        }
    }
}

/// Pushes the child elements so that the first is popped first.
fn push_children<'a>(stack: &mut Vec<(Element<'a>, bool)>, element: &Element<'a>, conditional: bool) {
    let inside: Vec<_> = element.children().map(|child| (child, conditional)).collect();
    stack.extend(inside.into_iter().rev());
}

/// The value of an attribute; empty at the start tag where it is missing.
pub(super) fn placed(element: &Element<'_>, name: &str) -> SourceValue<String> {
    attribute(element, name).unwrap_or_else(|| SourceValue::new(String::new(), element.tag_place()))
}

/// The value of an attribute, if it exists.
pub(super) fn attribute(element: &Element<'_>, name: &str) -> Option<SourceValue<String>> {
    element.attribute(name).map(|attribute| {
        let place = attribute.place();
        SourceValue::new(attribute.value.into_owned(), place)
    })
}

/// How far up a `<sensor>` is looked for.
const SENSOR_DEPTH: usize = 4;

fn in_sensor(element: &Element<'_>) -> bool {
    let mut at = element.parent();
    for _ in 0..SENSOR_DEPTH {
        match at {
            Some(parent) if parent.name() == "sensor" => return true,
            Some(parent) => at = parent.parent(),
            None => return false,
        }
    }
    false
}

/// The name without `xacro:`.
fn local(name: &str) -> &str {
    name.strip_prefix("xacro:").unwrap_or(name)
}

/// Why a `.urdf` is really a xacro and cannot be judged unexpanded; and the place that shows it.
pub(super) fn xacro_sign(root: &Element<'_>) -> Option<(String, Place)> {
    let mut any_xacro = false;
    for element in root.descendants() {
        let name = element.name();
        let parent = element.parent().map_or("", |parent| parent.name());
        any_xacro |= name.starts_with("xacro:");
        if parent == "robot" && name.starts_with("xacro:") && !matches!(local(name), "property" | "arg") {
            return Some((
                format!("contains `<{name}>`, which only xacro expands"),
                element.name_place(),
            ));
        }
        let named = match (parent, name) {
            (_, "link" | "joint") => element.attribute("name"),
            ("joint", "parent" | "child") => element.attribute("link"),
            _ => None,
        };
        if let Some(named) = named.filter(|named| is_unexpanded(&named.value)) {
            return Some((format!("the name `{}` is not expanded", named.value), named.place()));
        }
    }
    // In a file with macros, an expression in a number is xacro's, not a typo.
    let first = || {
        root.descendants()
            .flat_map(|element| element.attributes())
            .find(|attribute| is_unexpanded(&attribute.value))
    };
    let attribute = any_xacro.then(first).flatten()?;
    Some((
        format!("`{}` is not expanded: this is a xacro file", attribute.value),
        attribute.place(),
    ))
}
