//! URDF03: the axis of a moving joint is zero, or not normalised.

use crate::advice::literal::{rewrite_values, with_fix};
use crate::advice::{subject, tally::Tally};
use crate::rules::prelude::*;
use crate::verdict::Safety;
use crate::world::World;
use crate::world::robot::{Joint, NumberList, Robot};

pub(crate) struct JointAxis;

#[derive(Debug, serde::Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Limits {
    /// Largest deviation of the length from 1.
    pub off_unit: f64,
    /// Length under which an axis is zero.
    pub zero: f64,
}

impl Rule for JointAxis {
    const NEEDS: &'static [Need] = &[Need::Robot];
    type Limits = Limits;

    fn judge(world: &Estimates, limits: &Limits, out: &mut Judge) {
        let mut right = Tally::new("axes");
        for robot in &world.robots {
            let mut axes = 0;
            for joint in robot.joints.iter().filter(|joint| moves_along_an_axis(joint)) {
                // Lists that no parser reads are URDF10's, NaN is ROT05's.
                let axis = joint.axis.as_ref().and_then(|list| Some((list, list.array::<3>()?)));
                let Some((list, [x, y, z])) = axis else { continue };
                let length = x.hypot(y).hypot(z);
                if !length.is_finite() {
                    continue;
                }
                axes += 1;
                let measured = Measured::new("length of the axis minus 1", length - 1.0, "1").limit(limits.off_unit);
                if (length - 1.0).abs() <= limits.off_unit {
                    right.pass(robot.source, measured);
                } else {
                    out.fail(finding(world, robot, joint, list, length, limits).measured(measured));
                }
            }
            if axes == 0 {
                subject::nothing(world, robot, "moving joint with a readable axis", out);
            }
        }
        right.report(world, out);
    }
}

fn moves_along_an_axis(joint: &Joint) -> bool {
    matches!(
        joint.kind.value.as_str(),
        "revolute" | "continuous" | "prismatic" | "planar"
    )
}

fn finding(world: &World, robot: &Robot, joint: &Joint, list: &NumberList, length: f64, limits: &Limits) -> Finding {
    let owner = crate::analysis::urdf::called::joint(world, robot, joint);
    let (name, text) = (&joint.name.value, &list.text.value);
    if length < limits.zero {
        return Finding::error(
            owner,
            format!("the axis of joint `{name}` is zero"),
            list.text.place.clone(),
        )
        .label("no direction")
        .help("write the direction that the joint moves about or along; make a joint that does not move `fixed`");
    }
    let unit = list.literals.iter().map(|literal| (literal, literal.value / length));
    let edits = rewrite_values(world, robot.source, unit);
    let finding = Finding::warning(
        owner,
        format!("the axis `{text}` of joint `{name}` has length {length:.4}, not 1"),
        list.text.place.clone(),
    )
    .label("not normalised")
    .help("normalise the axis: some programs do so, others scale the joint's motion by its length");
    with_fix(finding, "normalise the axis", Safety::ChangesBehaviour, edits)
}
