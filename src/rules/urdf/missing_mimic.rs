//! URDF06: a joint that mimics one that does not exist.

use crate::advice::{literal::is_macro, subject, tally::Tally};
use crate::rules::prelude::*;
use crate::world::robot::Robot;

pub(crate) struct MissingMimic;

impl Rule for MissingMimic {
    const NEEDS: &'static [Need] = &[Need::Robot];
    type Limits = NoLimits;

    fn judge(world: &Estimates, _limits: &NoLimits, out: &mut Judge) {
        let mut right = Tally::new("mimicking joints");
        for robot in subject::whole_robots(world, out) {
            let mut mimics = 0;
            for joint in &robot.joints {
                let Some(mimic) = joint.mimic.as_ref().filter(|mimic| !is_macro(&mimic.value)) else {
                    continue;
                };
                mimics += 1;
                let (name, of) = (&joint.name.value, &mimic.value);
                let found = robot.joints.iter().filter(|joint| joint.name.value == *of).count();
                let measured = Measured::count("joints of the mimicked name", found);
                let message = if found == 0 {
                    format!("joint `{name}` mimics `{of}`, and there is no such joint")
                } else if name == of {
                    format!("joint `{name}` mimics itself")
                } else {
                    right.pass(robot.source, measured.limit(1.0));
                    continue;
                };
                let help = match nearest(robot, of).filter(|_| found == 0) {
                    Some(near) => format!("is `{near}` meant?"),
                    None => "name the joint whose position is followed".to_owned(),
                };
                let finding = Finding::error(
                    crate::analysis::urdf::called::joint(world, robot, joint),
                    message,
                    mimic.place.clone(),
                )
                .label("mimicked joint")
                .help(help)
                .measured(measured.limit(1.0));
                out.fail(finding);
            }
            if mimics == 0 {
                subject::nothing(world, robot, "joint that mimics another", out);
            }
        }
        right.report(world, out);
    }
}

/// The joint whose name is nearest, if it is near at all.
fn nearest<'a>(robot: &'a Robot, name: &str) -> Option<&'a str> {
    let names = robot.joints.iter().map(|joint| joint.name.value.as_str());
    names
        .map(|known| {
            (
                strsim::damerau_levenshtein(&known.to_lowercase(), &name.to_lowercase()),
                known,
            )
        })
        .min()
        .filter(|(distance, _)| *distance <= 2)
        .map(|(_, known)| known)
}
