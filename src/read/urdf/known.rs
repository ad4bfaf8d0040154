//! Names that consumers of URDF read, and those that are probably misspelt.
//!
//! Owns the table of what urdfdom reads (urdf_parser/src/{link,joint,pose,model}.cpp, URDF 1.2), the names of other
//! tools that real files carry, and the measure of similarity. A name is suggested only if it is
//! missing: an extra name next to the right one does no harm.

use std::collections::BTreeSet;

use crate::source::SourceValue;
use crate::world::robot::IgnoredItem;

use super::xml::Element;

/// What is read of one element.
struct ElementSpec {
    /// Attributes that are read.
    attributes: &'static [&'static str],
    /// Elements inside that are read.
    elements: &'static [&'static str],
    /// Those of them that may occur any number of times.
    many: &'static [&'static str],
    /// Names of other tools or of older formats, intended and ignored: never a misspelling.
    foreign: &'static [&'static str],
    /// Names that are taken for a known one, beyond spelling: `(written, meant)`.
    aliases: &'static [(&'static str, &'static str)],
}

const NOTHING: ElementSpec = ElementSpec {
    attributes: &[],
    elements: &[],
    many: &[],
    foreign: &[],
    aliases: &[],
};

/// What is read of the elements that the reader knows.
static KNOWN: &[(&str, ElementSpec)] = &[
    (
        "robot",
        ElementSpec {
            attributes: &["name", "version"],
            elements: &[
                "link",
                "joint",
                "material",
                "gazebo",
                "transmission",
                "sensor",
                "ros2_control",
            ],
            many: &[
                "link",
                "joint",
                "material",
                "gazebo",
                "transmission",
                "sensor",
                "ros2_control",
            ],
            foreign: &["point", "control", "sensors"],
            ..NOTHING
        },
    ),
    (
        "link",
        ElementSpec {
            attributes: &["name"],
            elements: &["inertial", "visual", "collision"],
            many: &["visual", "collision"],
            foreign: &["type", "frame"],
            ..NOTHING
        },
    ),
    (
        "joint",
        ElementSpec {
            attributes: &["name", "type"],
            elements: &[
                "origin",
                "parent",
                "child",
                "axis",
                "limit",
                "mimic",
                "dynamics",
                "safety_controller",
                "calibration",
            ],
            ..NOTHING
        },
    ),
    (
        "origin",
        ElementSpec {
            attributes: &["xyz", "rpy", "quat_xyzw"],
            aliases: &[
                ("position", "xyz"),
                ("translation", "xyz"),
                ("trans", "xyz"),
                ("pos", "xyz"),
                ("rotation", "rpy"),
                ("orientation", "rpy"),
                ("rot", "rpy"),
                ("euler", "rpy"),
                ("quat", "quat_xyzw"),
                ("quaternion", "quat_xyzw"),
                ("xyzw", "quat_xyzw"),
                ("quat_wxyz", "quat_xyzw"),
                ("wxyz", "quat_xyzw"),
            ],
            ..NOTHING
        },
    ),
    (
        "inertial",
        ElementSpec {
            elements: &["origin", "mass", "inertia"],
            ..NOTHING
        },
    ),
    (
        "mass",
        ElementSpec {
            attributes: &["value"],
            ..NOTHING
        },
    ),
    (
        "inertia",
        ElementSpec {
            attributes: &["ixx", "ixy", "ixz", "iyy", "iyz", "izz"],
            ..NOTHING
        },
    ),
    (
        "visual",
        ElementSpec {
            attributes: &["name"],
            elements: &["origin", "geometry", "material"],
            ..NOTHING
        },
    ),
    (
        "collision",
        ElementSpec {
            attributes: &["name"],
            elements: &["origin", "geometry"],
            foreign: &["material", "verbose"],
            ..NOTHING
        },
    ),
    (
        "geometry",
        ElementSpec {
            elements: &["box", "sphere", "cylinder", "capsule", "mesh"],
            foreign: &["name", "plane", "cdf", "sdf", "cone"],
            ..NOTHING
        },
    ),
    (
        "box",
        ElementSpec {
            attributes: &["size"],
            ..NOTHING
        },
    ),
    (
        "sphere",
        ElementSpec {
            attributes: &["radius"],
            ..NOTHING
        },
    ),
    (
        "cylinder",
        ElementSpec {
            attributes: &["radius", "length"],
            aliases: &[("height", "length"), ("r", "radius")],
            ..NOTHING
        },
    ),
    (
        "capsule",
        ElementSpec {
            attributes: &["radius", "length"],
            aliases: &[("height", "length"), ("r", "radius")],
            ..NOTHING
        },
    ),
    (
        "mesh",
        ElementSpec {
            attributes: &["filename", "scale"],
            aliases: &[("file", "filename"), ("uri", "filename"), ("url", "filename")],
            ..NOTHING
        },
    ),
    (
        "axis",
        ElementSpec {
            attributes: &["xyz"],
            // Written by exporters next to `xyz`, and read by no parser.
            foreign: &["rpy"],
            ..NOTHING
        },
    ),
    (
        "limit",
        ElementSpec {
            attributes: &[
                "lower",
                "upper",
                "effort",
                "velocity",
                "acceleration",
                "deceleration",
                "jerk",
            ],
            foreign: &["power", "k_velocity"],
            aliases: &[
                ("min", "lower"),
                ("max", "upper"),
                ("lower_limit", "lower"),
                ("upper_limit", "upper"),
            ],
            ..NOTHING
        },
    ),
    (
        "mimic",
        ElementSpec {
            attributes: &["joint", "multiplier", "offset"],
            ..NOTHING
        },
    ),
    (
        "parent",
        ElementSpec {
            attributes: &["link"],
            aliases: &[("name", "link"), ("frame", "link")],
            ..NOTHING
        },
    ),
    (
        "child",
        ElementSpec {
            attributes: &["link"],
            aliases: &[("name", "link"), ("frame", "link")],
            ..NOTHING
        },
    ),
];

/// The names in `element` that a consumer silently ignores. At the top of a robot only those similar to a known name are
/// listed: many elements of other tools are there.
pub(super) fn ignored(element: &Element<'_>) -> Vec<IgnoredItem> {
    let parent = element.name();
    let Some((_, known)) = KNOWN.iter().find(|(name, _)| *name == parent) else {
        return Vec::new();
    };
    // Nearly every element is spelled right and needs no list.
    if element.attribute_names().all(|name| known.attributes.contains(&name))
        && element.children().all(|child| known.elements.contains(&child.name()))
    {
        return Vec::new();
    }
    let mut found = Vec::new();
    let attributes: Vec<_> = element.attributes().collect();
    let written: BTreeSet<&str> = attributes.iter().map(|attribute| attribute.name).collect();
    for attribute in &attributes {
        if known.attributes.contains(&attribute.name) || attribute.name.starts_with("xmlns") {
            continue;
        }
        let meant = meant(attribute.name, known.attributes, known.foreign, known.aliases)
            .filter(|near| !written.contains(near));
        found.push(IgnoredItem {
            what: "attribute".to_owned(),
            name: SourceValue::new(attribute.name.to_owned(), attribute.name_place.clone()),
            parent: parent.to_owned(),
            meant: meant.map(str::to_owned),
        });
    }
    let inside: BTreeSet<&str> = element.children().map(|child| child.name()).collect();
    for child in element.children() {
        let name = child.name();
        if known.elements.contains(&name) {
            continue;
        }
        let meant = meant(name, known.elements, known.foreign, &[])
            .filter(|near| known.many.contains(near) || !inside.contains(near));
        found.push(IgnoredItem {
            what: "element".to_owned(),
            name: SourceValue::new(name.to_owned(), child.name_place()),
            parent: parent.to_owned(),
            meant: meant.map(str::to_owned),
        });
    }
    if parent == "robot" {
        found.retain(|ignored| ignored.meant.is_some());
    }
    found
}

/// Whether a consumer reads elements of this name inside of `parent`; true if the reader does not read its content.
pub(super) fn reads(parent: &str, name: &str) -> bool {
    KNOWN
        .iter()
        .find(|(element, _)| *element == parent)
        .is_none_or(|(_, known)| known.elements.contains(&name))
}

/// Longest name that is compared: the time is the product of the lengths.
const LONGEST: usize = 32;

/// The known name that `written` is probably meant to be.
fn meant(
    written: &str,
    known: &[&'static str],
    foreign: &[&str],
    aliases: &[(&str, &'static str)],
) -> Option<&'static str> {
    if written.len() > LONGEST || written.contains(':') || foreign.contains(&written) {
        return None;
    }
    if let Some((_, name)) = aliases.iter().find(|(alias, _)| *alias == written) {
        return Some(name);
    }
    known
        .iter()
        .filter_map(|name| nearness(written, name).map(|distance| (distance, *name)))
        .min()
        .map(|(_, name)| name)
}

/// Damerau-Levenshtein distance if it is small for the length, 0 for the same letters in another order or case.
fn nearness(written: &str, name: &str) -> Option<usize> {
    let sorted = |text: &str| {
        let mut letters: Vec<char> = text.to_lowercase().chars().collect();
        letters.sort_unstable();
        letters
    };
    if sorted(written) == sorted(name) {
        return Some(0);
    }
    let distance = strsim::damerau_levenshtein(&written.to_lowercase(), name);
    let allowed = match written.len().min(name.len()) {
        0..=2 => 0,
        3..=4 => 1,
        _ => 2,
    };
    (distance <= allowed).then_some(distance)
}
