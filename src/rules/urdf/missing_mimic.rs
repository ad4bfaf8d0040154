//! URDF06: a joint that mimics a joint that does not exist.

use std::collections::BTreeMap;

use crate::advice::{literal::is_macro, subject, tally::Tally};
use crate::analysis::near::{Names, Reach};
use crate::rules::prelude::*;
use crate::world::FrameId;

pub(crate) struct MissingMimic;

impl Rule for MissingMimic {
    const NEEDS: &'static [Need] = &[Need::Robot];
    type Limits = NoLimits;

    fn judge(world: &Estimates, _limits: &NoLimits, out: &mut Judge) {
        let mut right = Tally::new("mimicking joints");
        for robot in subject::whole_robots(world, out) {
            let mut mimics = 0;
            if robot.joints.iter().all(|joint| joint.mimic.is_none()) {
                subject::nothing(world, robot, "joint that mimics another", out);
                continue;
            }
            let names: Vec<FrameId> = robot
                .joints
                .iter()
                .map(|joint| joint.name.value.as_str().into())
                .collect();
            let index = Names::new(&names);
            let mut joints: BTreeMap<&str, usize> = BTreeMap::new();
            let mut folded: BTreeMap<String, &str> = BTreeMap::new();
            for joint in &robot.joints {
                folded.insert(joint.name.value.to_lowercase(), &joint.name.value);
                *joints.entry(&joint.name.value).or_default() += 1;
            }
            for joint in &robot.joints {
                let Some(mimic) = joint.mimic.as_ref().filter(|mimic| !is_macro(&mimic.value)) else {
                    continue;
                };
                mimics += 1;
                let (name, of) = (&joint.name.value, &mimic.value);
                let found = joints.get(of.as_str()).copied().unwrap_or(0);
                let others = found.saturating_sub(usize::from(name == of));
                let measured = Measured::count("other joints with the mimicked name", others);
                let message = if found == 0 {
                    format!("joint `{name}` mimics joint `{of}`, which does not exist")
                } else if name == of {
                    format!("joint `{name}` mimics itself")
                } else {
                    right.pass(robot.source, measured.expected(1.0));
                    continue;
                };
                let near = || Some(index.nearest(&FrameId::new(of), Reach::SUGGESTION)?.frame.as_str());
                // A name without its prefix: `pinky` for `left_pinky`. Where several joints have it, the one that is named most like the mimic.
                let whole = || {
                    let all = robot.joints.iter().map(|joint| joint.name.value.as_str());
                    let all = all.filter(|known| *known != name && known.ends_with(&format!("_{of}")));
                    let likeness = |known: &str| name.chars().zip(known.chars()).take_while(|(a, b)| a == b).count();
                    all.max_by_key(|known| (likeness(known), std::cmp::Reverse(*known)))
                };
                let near = || folded.get(&of.to_lowercase()).copied().or_else(whole).or_else(near);
                let help = match near().filter(|_| found == 0) {
                    Some(near) => format!("write `{near}`, if that joint is meant"),
                    None => "write the name of the joint that it follows".to_owned(),
                };
                let finding = Finding::error(
                    crate::analysis::urdf::called::joint(world, robot, joint),
                    message,
                    mimic.place.clone(),
                )
                .label("mimicked joint")
                .help(help)
                .measured(measured.expected(1.0));
                out.fail(finding);
            }
            if mimics == 0 {
                subject::nothing(world, robot, "joint that mimics another", out);
            }
        }
        right.report(world, out);
    }
}
