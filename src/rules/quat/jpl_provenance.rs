//! QUAT05: quaternions of programs that use, or used, JPL's algebra.

use crate::rules::prelude::*;
use crate::world::{Doubt, World, conventions::Subject};

pub(crate) struct JplProvenance;

impl Rule for JplProvenance {
    const NEEDS: &'static [Need] = &[];
    type Limits = NoLimits;

    fn judge(world: &Estimates, _limits: &NoLimits, out: &mut Judge) {
        for claim in &world.claims {
            if let Some(Doubt::Algebra(doubt)) = &claim.doubt {
                let subject = format!("`{}` of {}", claim.label, world.path(claim.place.source));
                judge_one(world, subject, doubt, &claim.place, out);
            }
        }
        for states in &world.jpl {
            let subject = format!("quaternions of {}", world.path(states.place.source));
            judge_one(world, subject, &states.value, &states.place, out);
        }
    }
}

fn judge_one(world: &World, subject: String, doubt: &str, place: &Place, out: &mut Judge) {
    let count = |open: usize| Measured::count("algebras that it may be of", open).limit(1.0);
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
    let message = format!("the algebra of {subject} is not told by the file: {doubt}");
    let finding = Finding::note(subject, message, place.clone())
        .hint()
        .label("Hamilton's or JPL's")
        .help(
            "in JPL's algebra the same numbers are the inverse rotation: find out which program wrote them, and say it in frames-lint.yaml: \
             `conventions: [{file: ..., quaternion: {algebra: jpl}}]`",
        );
    out.fail(finding.measured(count(2)));
}
