//! Every list of numbers that a robot description states, with the name of what it belongs to.

use std::collections::BTreeSet;

use crate::source::Place;
use crate::world::robot::NumberList;
use crate::world::{Literal, Robot};

/// The numbers of one attribute.
#[derive(Debug)]
pub(super) struct Numbers<'a> {
    /// "`xyz` of joint `lidar_joint`".
    pub owner: String,
    /// The literals, in order.
    pub literals: &'a [Literal],
    /// Where they stand.
    pub place: Place,
}

/// Origins, axes, limits and mesh scales, and every other list that a consumer cannot read; each attribute once.
pub(super) fn number_lists(robot: &Robot) -> Vec<Numbers<'_>> {
    let mut all = Vec::new();
    for joint in &robot.joints {
        let owner = format!("joint `{}`", joint.name.value);
        for origin in &joint.origins {
            for list in [&origin.xyz, &origin.rpy, &origin.quat_xyzw].into_iter().flatten() {
                all.push(numbers(list, &owner));
            }
        }
        all.extend(
            joint
                .axis
                .iter()
                .map(|list| numbers(list, &format!("the axis of {owner}"))),
        );
        if let Some(limit) = &joint.limit {
            for (name, literal) in [("lower", &limit.lower), ("upper", &limit.upper)] {
                all.extend(literal.iter().map(|literal| Numbers {
                    owner: format!("`{name}` of {owner}"),
                    literals: std::slice::from_ref(literal),
                    place: Place::text(robot.source, literal.span),
                }));
            }
        }
    }
    for link in &robot.links {
        let scales = link.meshes.iter().filter_map(|mesh| mesh.scale.as_ref());
        all.extend(scales.map(|list| numbers(list, &format!("a mesh of link `{}`", link.name.value))));
    }
    let known: BTreeSet<Place> = all.iter().map(|numbers| numbers.place.clone()).collect();
    let others = robot.malformed.iter().filter(|list| !known.contains(&list.text.place));
    all.extend(others.map(|list| numbers(list, "an element")));
    all
}

fn numbers<'a>(list: &'a NumberList, owner: &str) -> Numbers<'a> {
    Numbers {
        owner: format!("`{}` of {owner}", list.attribute),
        literals: &list.literals,
        place: list.text.place.clone(),
    }
}
