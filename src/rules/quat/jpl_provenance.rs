//! QUAT05: quaternions of programs that use, or used, JPL's convention.

use nalgebra::Vector3;

use crate::rules::prelude::*;
use crate::world::{Claim, Doubt, World, conventions::Subject};

pub(crate) struct JplProvenance;

impl Rule for JplProvenance {
    const NEEDS: &'static [Need] = &[];
    type Limits = NoLimits;

    fn judge(world: &Estimates, _limits: &NoLimits, out: &mut Judge) {
        for claim in &world.claims {
            if let Some(Doubt::Algebra(doubt)) = &claim.doubt {
                let subject = format!("`{}` of {}", claim.label, world.path(claim.place.source));
                let what = format!("`{}`: quaternion", claim.label);
                let doubt = format!("{doubt}.{}", directions(claim));
                judge_one(world, (subject, what.as_str()), &doubt, &claim.place, out);
            }
        }
        for states in &world.jpl {
            let subject = format!("quaternions of {}", world.path(states.place.source));
            judge_one(
                world,
                (subject, "quaternions"),
                &format!("{}.", states.value),
                &states.place,
                out,
            );
        }
    }
}

/// Where an axis of the sensor points under either convention: a look at the mounting decides.
fn directions(claim: &Claim) -> String {
    let (Some((target, source)), Some(pose)) = (&claim.frames, &claim.pose) else {
        return String::new();
    };
    let turn = pose.isometry().rotation;
    let [read, inverse] = [turn, turn.inverse()].map(|turn| {
        let z = turn * Vector3::z();
        format!("({:.2}, {:.2}, {:.2})", z.x, z.y, z.z)
    });
    format!(
        " Read as Hamilton, z of `{source}` points along {read} of `{target}`; read as JPL, along {inverse}: the one that the mounting has is right."
    )
}

fn judge_one(world: &World, (subject, what): (String, &str), doubt: &str, place: &Place, out: &mut Judge) {
    let count = |open: usize| Measured::count("possible conventions", open).limit(1.0);
    let file = Subject {
        file: world.path(place.source),
        ..Subject::default()
    };
    let is_declared = world
        .conventions
        .of(&file)
        .is_some_and(|declared| declared.convention.algebra.is_some());
    if is_declared {
        return out.pass(subject, [count(1)]);
    }
    let message = format!("{what} may be Hamilton or JPL: such files exist with both");
    let finding = Finding::note(subject, message, place.clone())
        .hint()
        .label("Hamilton or JPL")
        .detail(format!(
            "Doubt: {doubt} In the other convention the same numbers are the inverse rotation."
        ))
        .help(format!(
            "find out which convention the program that wrote this file used (its version, or the mounting), and declare it in frames-lint.yaml: `conventions: [{{file: {}, quaternion: {{algebra: hamilton}}}}]` (or `jpl`)",
            file.file
        ));
    out.fail(finding.measured(count(2)));
}
