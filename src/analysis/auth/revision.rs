//! Two descriptions of one robot: the one in a recording, compared with a file.
//!
//! Must not report.

use std::collections::BTreeMap;

use serde::Deserialize;

use crate::source::{Derivation, Place};
use crate::world::robot::{Joint, NumberList};
use crate::world::{FrameId, Robot, World};

/// A link or joint that differs.
pub(crate) struct Difference {
    pub(crate) words: String,
    /// Where it is in the file, or the file.
    pub(crate) file: Place,
    /// Where it is in the recorded description, or that description.
    pub(crate) recorded: Place,
}

/// All differences.
pub(crate) struct Differences {
    pub(crate) found: Vec<Difference>,
    /// Fixed joints that differ in the numbers of their origin only.
    pub(crate) rigid: usize,
}

/// The only file that describes the same robot, by links in common; `None` if there are several.
pub(crate) fn counterpart<'w>(world: &'w World, recorded: &Robot, limits: &Limits) -> Option<&'w Robot> {
    let names: Vec<FrameId> = links(recorded).into_keys().collect();
    let shared = |robot: &Robot| {
        let others = links(robot);
        let both = names.iter().filter(|name| others.contains_key(*name)).count();
        both as f64 / (names.len().max(others.len()) as f64).max(1.0)
    };
    let mut files = world
        .robots
        .iter()
        .filter(|robot| robot.fragment.is_none() && !is_recorded(world, robot) && shared(robot) >= limits.shared_links);
    let only = files.next()?;
    files.next().is_none().then_some(only)
}

fn links(robot: &Robot) -> BTreeMap<FrameId, &Place> {
    let named = robot.links.iter().filter(|link| !link.name.value.is_empty());
    named
        .map(|link| (FrameId::new(&link.name.value).canonical(), &link.place))
        .collect()
}

fn joints(robot: &Robot) -> BTreeMap<FrameId, &Joint> {
    let with_child = robot
        .joints
        .iter()
        .filter_map(|joint| Some((joint, joint.child.as_ref()?)));
    with_child
        .map(|(joint, child)| (FrameId::new(&child.value).canonical(), joint))
        .collect()
}

pub(crate) fn differences(file: &Robot, recorded: &Robot, limits: &Limits) -> Differences {
    let (whole_file, whole_recorded) = (Place::whole(file.source), Place::whole(recorded.source));
    let mut all = Differences {
        found: Vec::new(),
        rigid: 0,
    };
    let (of_file, of_recorded) = (links(file), links(recorded));
    for (name, place) in &of_file {
        if !of_recorded.contains_key(name) {
            all.add(format!("link `{name}` is in the file only"), place, &whole_recorded);
        }
    }
    for (name, place) in &of_recorded {
        if !of_file.contains_key(name) {
            all.add(format!("link `{name}` is in the recording only"), &whole_file, place);
        }
    }
    let recorded_joints = joints(recorded);
    for (child, joint) in joints(file) {
        if let Some(other) = recorded_joints.get(&child) {
            compare(&child, joint, other, limits, &mut all);
        }
    }
    all
}

impl Differences {
    fn add(&mut self, words: String, file: &Place, recorded: &Place) {
        self.found.push(Difference {
            words,
            file: file.clone(),
            recorded: recorded.clone(),
        });
    }
}

fn compare(child: &FrameId, file: &Joint, recorded: &Joint, limits: &Limits, all: &mut Differences) {
    let parent = |joint: &Joint| {
        joint
            .parent
            .as_ref()
            .map(|parent| FrameId::new(&parent.value).canonical())
    };
    if parent(file) != parent(recorded) {
        all.add(format!("`{child}` has another parent"), &file.place, &recorded.place);
    } else if file.kind.value != recorded.kind.value {
        let words = format!(
            "the joint of `{child}` is {} in the file and {} in the recording",
            file.kind.value, recorded.kind.value
        );
        all.add(words, &file.place, &recorded.place);
    } else if !same_origin(file, recorded, limits) {
        if file.is_fixed() {
            all.rigid += 1;
        } else {
            all.add(
                format!("the joint of `{child}` has another origin"),
                &file.place,
                &recorded.place,
            );
        }
    }
}

/// Whether the numbers of the first origins agree; numbers that cannot be read count as equal.
fn same_origin(a: &Joint, b: &Joint, limits: &Limits) -> bool {
    let near = |a: Option<[f64; 3]>, b: Option<[f64; 3]>, limit: f64| match (a, b) {
        (Some(a), Some(b)) => a.iter().zip(&b).all(|(a, b)| (a - b).abs() <= limit),
        _ => true,
    };
    near(numbers(a, true), numbers(b, true), limits.same_m)
        && near(numbers(a, false), numbers(b, false), limits.same_rad)
}

/// `xyz` or `rpy` of the first origin; zeros where nothing is written.
fn numbers(joint: &Joint, xyz: bool) -> Option<[f64; 3]> {
    let Some(origin) = joint.origins.first() else {
        return Some([0.0; 3]);
    };
    let list = if xyz { &origin.xyz } else { &origin.rpy };
    list.as_ref().map_or(Some([0.0; 3]), NumberList::array::<3>)
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Limits {
    pub(crate) shared_links: f64,
    pub(crate) same_m: f64,
    pub(crate) same_rad: f64,
    pub(crate) max_differences: f64,
}

/// Whether the robot was described in a recording.
pub(crate) fn is_recorded(world: &World, robot: &Robot) -> bool {
    let source = world.source(robot.source);
    source.is_some_and(|source| matches!(source.derived, Some(Derivation::Message(_))))
}
