//! TREE12: one root, and joints between links that exist.
//!
//! Names are compared without case and stray whitespace: a reference that differs from its link only by those is NAME01's or
//! NAME02's, and would otherwise appear as a second root.

mod undefined_links;

use std::cell::LazyCell;
use std::collections::{BTreeMap, BTreeSet};

use crate::analysis::near::Names;
use crate::analysis::{spelling::loose, tf};
use crate::rules::{
    prelude::*,
    tree::urdf_structure::undefined_links::{MOST_SHOWN, undefined},
};
use crate::world::{FrameId, Robot, robot::Link};

pub(crate) struct UrdfStructure;

impl Rule for UrdfStructure {
    const NEEDS: &'static [Need] = &[Need::Robot];
    type Limits = NoLimits;

    fn judge(world: &Estimates, _limits: &NoLimits, out: &mut Judge) {
        for robot in &world.robots {
            let subject = format!("robot `{}` in {}", robot.name.value, world.path(robot.source));
            if let Some(reason) = &robot.fragment {
                out.too_little(subject, reason);
                continue;
            }
            let is_xacro = world.path(robot.source).to_lowercase().ends_with(".xacro");
            // Properties, materials and the like, or the empty default of an optional include.
            if robot.links.is_empty() && robot.joints.is_empty() && (is_xacro || robot.name.value.is_empty()) {
                out.not_applicable(
                    subject,
                    "it has neither links nor joints: probably a file that others include",
                );
                continue;
            }
            let mut is_right = true;
            judge_robot(robot, &subject, is_xacro, |finding| {
                is_right = false;
                out.fail(finding);
            });
            if is_right {
                out.pass(
                    subject,
                    [Measured::count("root links", 1)
                        .limit(1.0)
                        .samples(robot.links.len() as u64)],
                );
            }
        }
    }
}

fn judge_robot(robot: &Robot, subject: &str, is_xacro: bool, mut fail: impl FnMut(Finding)) {
    let by_name = robot.links.iter().rev().map(|link| (loose(&link.name.value), link));
    let links: BTreeMap<String, &Link> = by_name.collect();
    if robot.links.is_empty() {
        let message = format!("robot `{}` has no links", robot.name.value);
        fail(
            Finding::error(subject, message, robot.name.place.clone())
                .help("add at least one link")
                .measured(Measured::count("links", 0).expected(1.0)),
        );
    }
    let missing = undefined(robot, &links);
    let nameless: Vec<&Link> = robot
        .links
        .iter()
        .filter(|link| link.name.value.trim().is_empty())
        .collect();
    for (index, link) in nameless.iter().enumerate() {
        let finding = Finding::error(subject, "a link has no name", link.place.clone())
            .measured(Measured::count("links without a name", 1).limit(0.0));
        // A name that joints use and no link has is probably this one's: one cause, one finding.
        fail(match missing.get(index) {
            Some(joints) => finding
                .help(format!(
                    "give the link a name: probably `{}`, which joints refer to",
                    joints.name()
                ))
                .related(joints.first.2.place.clone(), "no link has this name"),
            None => finding.help("give the link a name"),
        });
    }
    for joint in &robot.joints {
        for (end, role) in [(&joint.parent, "parent"), (&joint.child, "child")] {
            let name = &joint.name.value;
            if end.is_none() {
                fail(
                    Finding::error(subject, format!("joint `{name}` has no <{role}>"), joint.place.clone())
                        .help(format!("add <{role} link=\"...\"/>"))
                        .measured(Measured::count("missing ends", 1).limit(0.0)),
                );
            }
        }
    }
    let names = LazyCell::new(|| -> Vec<FrameId> {
        let names = robot.links.iter().map(|link| link.name.value.as_str());
        names.map(FrameId::from).collect()
    });
    let index = LazyCell::new(|| Names::new(names.iter()));
    for undefined in missing.iter().skip(nameless.len()) {
        let finding = undefined.finding(subject, &index);
        // A xacro may be mounted on a link of another file.
        let is_mounted = is_xacro && !undefined.is_child;
        fail(if is_mounted { finding.hint() } else { finding });
    }
    // A link that lost its joint to a misspelt child is not a second root of its own.
    let explained = missing.iter().filter(|undefined| undefined.is_child).count();
    if let Some(finding) = judge_roots(robot, subject, &links, explained) {
        fail(finding);
    }
}

fn judge_roots(robot: &Robot, subject: &str, links: &BTreeMap<String, &Link>, explained: usize) -> Option<Finding> {
    let children: BTreeSet<String> = robot
        .joints
        .iter()
        // A joint of a link to itself (refused by the URDF rules) gives it no parent.
        .filter_map(|joint| {
            Some((
                joint.parent.as_ref().map(|link| loose(&link.value)),
                loose(&joint.child.as_ref()?.value),
            ))
        })
        .filter(|(parent, child)| parent.as_ref() != Some(child))
        .map(|(_, child)| child)
        .collect();
    let mut roots: Vec<&Link> = robot
        .links
        .iter()
        .filter(|link| !link.name.value.trim().is_empty() && !children.contains(&loose(&link.name.value)))
        // Of links with one name, the first.
        .filter(|link| {
            links
                .get(&loose(&link.name.value))
                .is_some_and(|first| std::ptr::eq(*first, *link))
        })
        .collect();
    // No root at all is a loop: TREE03's.
    let first = (!roots.is_empty()).then(|| roots.remove(0))?;
    if !roots.is_empty() && roots.len() <= explained {
        return None;
    }
    if let Some(second) = roots.first() {
        let names: Vec<FrameId> = std::iter::once(first)
            .chain(roots.iter().copied())
            .map(|link| link.name.value.as_str().into())
            .collect();
        let message = format!("the robot has {} root links instead of one", names.len());
        let mut finding = Finding::error(subject, message, second.place.clone())
            .label("no joint has this link as its child")
            .detail(format!(
                "The roots are {}. URDF parsers reject a file with two roots.",
                tf::listed(&names)
            ))
            .help("add the joints that mount all but one of them")
            .measured(Measured::count("root links", names.len()).limit(1.0))
            .related(first.place.clone(), "the first root");
        for link in roots.iter().skip(1).take(MOST_SHOWN) {
            finding = finding.related(link.place.clone(), "another root");
        }
        return Some(finding);
    }
    let inertial = first.inertial.as_ref().filter(|_| !robot.joints.is_empty())?;
    let message = format!("root link `{}` has an inertia, which KDL ignores", first.name.value);
    Some(
        Finding::note(subject, message, inertial.place.clone())
            .hint()
            .label("inertia of the root link")
            .help("add an empty root link above it, if you compute dynamics with KDL")
            .measured(Measured::count("root links with inertia", 1).limit(0.0)),
    )
}
