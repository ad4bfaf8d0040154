//! Joints of a URDF that are missing, or between other links.

use crate::faults::{Change, Subject, SubjectPlace};
use crate::world::robot::{ConsumerOpinion, Joint};
use crate::world::{Claim, ClaimKind, FrameId, FrameRole, World};

/// A mistake in the tree of a description.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum JointMistake {
    /// The joint is not there.
    Missing,
    /// Another joint has the same child.
    SecondParent,
    /// The root is the child of a joint below it.
    Loop,
}

impl Change for JointMistake {
    fn subjects(&self, world: &World) -> Vec<Subject> {
        let joints = world.claims.iter().enumerate().filter_map(|(number, claim)| {
            let ClaimKind::Joint { joint, .. } = &claim.kind else {
                return None;
            };
            let (parent, child) = claim.frames.as_ref()?;
            (*self != Self::SecondParent || other_link(world, claim).is_some()).then(|| Subject {
                name: format!("joint `{joint}`"),
                words: [joint.as_str(), parent.as_str(), child.as_str()]
                    .map(|word| format!("`{word}`"))
                    .to_vec(),
                at: SubjectPlace::Claim(number),
            })
        });
        joints.collect()
    }

    fn apply(&self, world: &mut World, subject: &Subject) -> bool {
        let SubjectPlace::Claim(number) = subject.at else {
            return false;
        };
        let Some(claim) = world.claims.get(number).cloned() else {
            return false;
        };
        let Some((parent, child)) = claim.frames.clone() else {
            return false;
        };
        let done = match self {
            Self::Missing => remove(world, number, &claim),
            Self::SecondParent => other_link(world, &claim).is_some_and(|other| add(world, &claim, &other, &child)),
            Self::Loop => {
                let root = root_above(world, &parent);
                add(world, &claim, &child, &root)
            }
        };
        world.forget();
        done
    }
}

/// The ends of the joints of the description of a claim.
fn ends<'w>(world: &'w World, claim: &'w Claim) -> impl Iterator<Item = (&'w FrameId, &'w FrameId)> {
    let source = claim.place.source;
    let joints = world
        .claims
        .iter()
        .filter(move |other| other.place.source == source && matches!(other.kind, ClaimKind::Joint { .. }));
    joints.filter_map(|joint| joint.frames.as_ref().map(|(parent, child)| (parent, child)))
}

/// A link that is neither parent nor child of a joint, nor directly below it.
fn other_link(world: &World, claim: &Claim) -> Option<FrameId> {
    let (parent, child) = claim.frames.as_ref()?;
    let above = ends(world, claim)
        .find(|(_, other)| *other == parent)
        .map(|(above, _)| above);
    let beside = ends(world, claim)
        .filter(|(of, other)| *of == parent && *other != child)
        .map(|(_, other)| other);
    above.into_iter().chain(beside).next().cloned()
}

fn root_above(world: &World, link: &FrameId) -> FrameId {
    let mut root = link.clone();
    // No chain is longer than the list of joints.
    for _ in 0..world.claims.len() {
        let joints = world
            .claims
            .iter()
            .filter(|claim| matches!(claim.kind, ClaimKind::Joint { .. }));
        let mut ends = joints.filter_map(|joint| joint.frames.as_ref());
        match ends.find(|(_, child)| *child == root) {
            Some((parent, _)) => root = parent.clone(),
            None => break,
        }
    }
    root
}

fn remove(world: &mut World, number: usize, claim: &Claim) -> bool {
    let Some((parent, child)) = &claim.frames else {
        return false;
    };
    let source = claim.place.source;
    world.claims.remove(number);
    for robot in world.robots.iter_mut().filter(|robot| robot.source == source) {
        robot.joints.retain(|joint| joint.name.value != claim.label);
        if let ConsumerOpinion::Loads(read) = &mut robot.consumer {
            read.retain(|joint| joint.name != claim.label);
        }
    }
    let ends = [(parent, FrameRole::JointParent), (child, FrameRole::JointChild)];
    for used in &mut world.frames {
        let is_end = ends
            .iter()
            .any(|(frame, role)| used.frame == **frame && used.role == *role);
        if is_end && used.place.source == source {
            used.count = used.count.saturating_sub(1);
        }
    }
    world
        .frames
        .retain(|used| used.count > 0 || used.place.source != source);
    true
}

/// Adds a joint like another, between other links.
fn add(world: &mut World, like: &Claim, parent: &FrameId, child: &FrameId) -> bool {
    let name = format!("{}_too", like.label);
    let source = like.place.source;
    let Some(robot) = world.robots.iter_mut().find(|robot| robot.source == source) else {
        return false;
    };
    let Some(old) = robot
        .joints
        .iter()
        .find(|joint| joint.name.value == like.label)
        .cloned()
    else {
        return false;
    };
    let mut joint = Joint { ..old };
    joint.name.value.clone_from(&name);
    for (end, link) in [(&mut joint.parent, parent), (&mut joint.child, child)] {
        if let Some(end) = end {
            link.as_str().clone_into(&mut end.value);
        }
    }
    robot.joints.push(joint);
    if let ConsumerOpinion::Loads(read) = &mut robot.consumer
        && let Some(mut other) = read.iter().find(|joint| joint.name == like.label).cloned()
    {
        other.name.clone_from(&name);
        (other.parent, other.child) = (parent.as_str().to_owned(), child.as_str().to_owned());
        read.push(other);
    }
    let mut claim = like.clone();
    if let ClaimKind::Joint { joint, .. } = &mut claim.kind {
        joint.clone_from(&name);
    }
    claim.label = name;
    claim.frames = Some((parent.clone(), child.clone()));
    world.claims.push(claim);
    true
}
