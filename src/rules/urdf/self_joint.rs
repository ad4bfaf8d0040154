//! URDF02: a joint that connects a link with itself.

use crate::advice::{subject, tally::Tally};
use crate::rules::prelude::*;

pub(crate) struct SelfJoint;

impl Rule for SelfJoint {
    const NEEDS: &'static [Need] = &[Need::Robot];
    type Limits = NoLimits;

    fn judge(world: &Estimates, _limits: &NoLimits, out: &mut Judge) {
        let mut right = Tally::new("joints");
        for robot in &world.robots {
            if robot.joints.is_empty() {
                subject::nothing(world, robot, "joints", out);
            }
            for joint in &robot.joints {
                let ends = joint.parent.as_ref().zip(joint.child.as_ref());
                let Some((parent, child)) = ends.filter(|(parent, child)| parent.value == child.value) else {
                    right.pass(
                        robot.source,
                        Measured::count("joints of a link with itself", 0).limit(0.0),
                    );
                    continue;
                };
                let message = format!(
                    "joint `{}` connects link `{}` with itself",
                    joint.name.value, parent.value
                );
                let finding = Finding::error(
                    crate::analysis::urdf::called::joint(world, robot, joint),
                    message,
                    child.place.clone(),
                )
                .label("child")
                .related(parent.place.clone(), "parent")
                .help("name the two links that the joint connects")
                .measured(Measured::count("joints of a link with itself", 1).limit(0.0));
                out.fail(finding);
            }
        }
        right.report(world, out);
    }
}
