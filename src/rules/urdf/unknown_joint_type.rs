//! URDF12: a joint type that no parser knows.

use crate::advice::literal::{is_macro, replace, with_fix};
use crate::advice::{subject, tally::Tally};
use crate::rules::prelude::*;
use crate::verdict::Safety;
use crate::world::World;
use crate::world::robot::{Joint, Robot};

pub(crate) struct UnknownJointType;

/// The types of the URDF specification.
const KNOWN: &[&str] = &["revolute", "continuous", "prismatic", "fixed", "floating", "planar"];

/// Types that some parsers add: PyBullet and Drake read `spherical`/`ball`, Drake `universal` and `screw`.
const EXTENSIONS: &[&str] = &["spherical", "ball", "universal", "screw"];

impl Rule for UnknownJointType {
    const NEEDS: &'static [Need] = &[Need::Robot];
    type Limits = NoLimits;

    fn judge(world: &Estimates, _limits: &NoLimits, out: &mut Judge) {
        let mut right = Tally::new("joint types");
        for robot in &world.robots {
            if robot.joints.is_empty() {
                subject::nothing(world, robot, "joints", out);
            }
            for joint in robot.joints.iter().filter(|joint| !is_macro(&joint.kind.value)) {
                let measured = Measured::count("types outside the specification", 1).limit(0.0);
                match finding(world, robot, joint) {
                    Some(finding) => out.fail(finding.measured(measured)),
                    None => right.count(robot.source),
                }
            }
        }
        right.report(world, out);
    }
}

fn finding(world: &World, robot: &Robot, joint: &Joint) -> Option<Finding> {
    let (name, kind) = (&joint.name.value, joint.kind.value.as_str());
    let owner = crate::analysis::urdf::called::joint(world, robot, joint);
    let place = joint.kind.place.clone();
    if KNOWN.contains(&kind) {
        return None;
    }
    if EXTENSIONS.contains(&kind) {
        let message = format!("joint `{name}` has type `{kind}`, which only some parsers know");
        let finding = Finding::note(owner, message, place).label("not in the URDF specification");
        return Some(finding.help("use the file only in simulators that know the type: urdfdom rejects it"));
    }
    let message = if kind.is_empty() {
        format!("joint `{name}` has no type")
    } else {
        format!("joint `{name}` has type `{kind}`, which does not exist")
    };
    let lower = kind.trim().to_lowercase();
    let near = KNOWN
        .iter()
        .find(|known| strsim::damerau_levenshtein(known, &lower) <= 2);
    let finding = Finding::error(owner, message, place.clone()).label("unknown type");
    Some(match near {
        Some(near) if lower == **near => {
            let edits = replace(world, place, kind, *near).map(|edit| vec![edit]);
            let finding = finding.help(format!("write `{near}`: types are lower case, without whitespace"));
            with_fix(finding, &format!("write `{near}`"), Safety::Safe, edits)
        }
        Some(near) => finding.help(format!("write `{near}`, if that is meant")),
        None => finding.help(format!("write one of {}", KNOWN.join(", "))),
    })
}
