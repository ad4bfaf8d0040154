//! Every list of numbers of a robot description, with its owner.

use std::collections::BTreeSet;
use std::fmt;

use crate::source::Place;
use crate::world::{Literal, Robot, robot::NumberList};

/// The owner of a list of numbers; formatted only for a finding.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Owner<'a> {
    /// The attribute.
    attribute: &'a str,
    /// "joint", "the axis of joint", ...
    of: &'static str,
    /// The joint's or link's name, where there is one.
    name: Option<&'a str>,
}

impl fmt::Display for Owner<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "`{}` of {}", self.attribute, self.of)?;
        self.name.map_or(Ok(()), |name| write!(f, " `{name}`"))
    }
}

/// The numbers of one attribute.
#[derive(Debug)]
pub(crate) struct Numbers<'a> {
    /// "`xyz` of joint `lidar_joint`".
    pub owner: Owner<'a>,
    /// The literals, in order.
    pub literals: &'a [Literal],
    /// Their place.
    pub place: Place,
}

/// Origins, axes, limits and mesh scales, and every other list that a consumer cannot read; each attribute once.
pub(crate) fn number_lists(robot: &Robot) -> Vec<Numbers<'_>> {
    let mut all = Vec::new();
    for joint in &robot.joints {
        let name = Some(joint.name.value.as_str());
        for origin in &joint.origins {
            let lists = [&origin.xyz, &origin.rpy, &origin.quat_xyzw].into_iter().flatten();
            all.extend(lists.map(|list| numbers(list, "joint", name)));
        }
        all.extend(joint.axis.iter().map(|list| numbers(list, "the axis of joint", name)));
        if let Some(limit) = &joint.limit {
            for (attribute, literal) in [("lower", &limit.lower), ("upper", &limit.upper)] {
                all.extend(literal.iter().map(|literal| Numbers {
                    owner: Owner {
                        attribute,
                        of: "joint",
                        name,
                    },
                    literals: std::slice::from_ref(literal),
                    place: Place::text(robot.source, literal.span),
                }));
            }
        }
    }
    for link in &robot.links {
        let scales = link.meshes.iter().filter_map(|mesh| mesh.scale.as_ref());
        all.extend(scales.map(|list| numbers(list, "a mesh of link", Some(&link.name.value))));
    }
    if robot.malformed.is_empty() {
        return all;
    }
    let known: BTreeSet<Place> = all.iter().map(|numbers| numbers.place.clone()).collect();
    let others = robot.malformed.iter().filter(|list| !known.contains(&list.text.place));
    all.extend(others.map(|list| numbers(list, "an element", None)));
    all
}

fn numbers<'a>(list: &'a NumberList, of: &'static str, name: Option<&'a str>) -> Numbers<'a> {
    Numbers {
        owner: Owner {
            attribute: &list.attribute,
            of,
            name,
        },
        literals: &list.literals,
        place: list.text.place.clone(),
    }
}
