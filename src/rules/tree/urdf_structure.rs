//! TREE12: one root, and joints between links that exist.
//!
//! Names are compared without case and stray blanks here: a reference that misses its link only by those is NAME01's or
//! NAME02's, and would otherwise show up as a second root.

use std::collections::{BTreeMap, BTreeSet};

use crate::rules::near::{Reach, nearest};
use crate::rules::spelling::loose;
use crate::rules::{Judge, Need, NoLimits, Rule, tf};
use crate::source::Placed;
use crate::verdict::{Finding, Measured, NotEvaluated};
use crate::world::robot::Link;
use crate::world::{FrameId, Robot, World};

/// TREE12.
pub struct UrdfStructure;

impl Rule for UrdfStructure {
    const PAGE: &'static str = include_str!("../../../rules/tree/urdf-structure.md");
    const NEEDS: &'static [Need] = &[Need::Robot];
    type Limits = NoLimits;

    fn judge(world: &World, _limits: &NoLimits, out: &mut Judge) {
        for robot in &world.robots {
            let subject = format!("robot `{}` in {}", robot.name.value, world.path(robot.source));
            let placeholder = "the file holds neither links nor joints: a placeholder, or no robot";
            let is_empty = robot.links.is_empty() && robot.joints.is_empty();
            if let Some(reason) = robot.fragment.as_deref().or(is_empty.then_some(placeholder)) {
                out.not_evaluated(subject, NotEvaluated::TooLittleEvidence, reason);
                continue;
            }
            let findings = judge_robot(robot, &subject);
            if findings.is_empty() {
                let roots = Measured::count("root links", 1).limit(1.0);
                out.pass(subject, [roots.samples(robot.links.len() as u64)]);
            }
            for finding in findings {
                out.fail(finding);
            }
        }
    }
}

fn judge_robot(robot: &Robot, subject: &str) -> Vec<Finding> {
    let mut findings = Vec::new();
    let by_name = robot.links.iter().rev().map(|link| (loose(&link.name.value), link));
    let links: BTreeMap<String, &Link> = by_name.collect();
    for link in robot.links.iter().filter(|link| link.name.value.trim().is_empty()) {
        findings.push(
            Finding::error(subject, "a link has no name", link.place.clone())
                .help("give the link a name")
                .measured(Measured::count("links without a name", 1).limit(0.0)),
        );
    }
    for joint in &robot.joints {
        for (end, role) in [(&joint.parent, "parent"), (&joint.child, "child")] {
            let name = &joint.name.value;
            let finding = match end {
                None => Finding::error(subject, format!("joint `{name}` has no <{role}>"), joint.place.clone())
                    .help(format!("add <{role} link=\"...\"/>"))
                    .measured(Measured::count("missing ends", 1).limit(0.0)),
                // An empty name is TREE04's.
                Some(link) if link.value.is_empty() || links.contains_key(&loose(&link.value)) => continue,
                Some(link) => undefined(subject, name, role, link, robot),
            };
            findings.push(finding);
        }
    }
    findings.extend(judge_roots(robot, subject, &links));
    findings
}

fn undefined(subject: &str, joint: &str, role: &str, link: &Placed<String>, robot: &Robot) -> Finding {
    let names: Vec<FrameId> = robot.links.iter().map(|link| link.name.value.as_str().into()).collect();
    let near = nearest(&FrameId::new(link.value.as_str()), &names, Reach::SUGGESTION);
    let help = match near {
        Some(near) => format!("define the link, or was `{}` meant?", near.frame),
        None => "define the link, or name one that exists".to_owned(),
    };
    let message = format!(
        "joint `{joint}` names `{}` as its {role}, and there is no such link",
        link.value
    );
    Finding::error(subject, message, link.place.clone())
        .label("no link of this name")
        .help(help)
        .measured(Measured::count("undefined links", 1).limit(0.0))
}

fn judge_roots(robot: &Robot, subject: &str, links: &BTreeMap<String, &Link>) -> Option<Finding> {
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
    if let Some(second) = roots.first() {
        let names: Vec<FrameId> = std::iter::once(first)
            .chain(roots.iter().copied())
            .map(|link| link.name.value.as_str().into())
            .collect();
        let message = format!(
            "the robot has {} root links instead of one: {}",
            names.len(),
            tf::listed(&names)
        );
        let mut finding = Finding::error(subject, message, second.place.clone())
            .label("no joint has this link as its child")
            .help("add the joints that mount the other roots; parsers refuse a description with two")
            .measured(Measured::count("root links", names.len()).limit(1.0))
            .related(first.place.clone(), "the first root");
        for link in roots.iter().skip(1) {
            finding = finding.related(link.place.clone(), "another root");
        }
        return Some(finding);
    }
    let inertial = first.inertial.as_ref().filter(|_| !robot.joints.is_empty())?;
    let message = format!("the root link `{}` has an inertia, which KDL ignores", first.name.value);
    Some(
        Finding::note(subject, message, inertial.place.clone())
            .hint()
            .help("put an empty root link above it, if dynamics are computed with KDL")
            .measured(Measured::count("root links with inertia", 1).limit(0.0)),
    )
}
