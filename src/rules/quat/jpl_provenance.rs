//! QUAT05: quaternions of programs that use, or used, JPL's convention.

use nalgebra::Vector3;

use crate::math::stats::rounded;
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
                let (apart, directions) = readings(claim);
                let by_mounting = if directions.is_empty() {
                    ""
                } else {
                    "compare both readings with the mounting, or "
                };
                let step = format!("{by_mounting}look up the convention of the program version that wrote the numbers");
                let doubt = format!("{doubt}.{directions}");
                let words = (what.as_str(), apart.as_str(), step.as_str(), ["", ""]);
                judge_one(world, subject, words, &doubt, &claim.place, out);
            }
        }
        for states in &world.jpl {
            let subject = format!("quaternions of {}", world.path(states.place.source));
            let writers = [" (written by a converter)", " (written by OpenVINS itself)"];
            let step = "find out which program wrote the file";
            let words = ("quaternions", "inverse rotations", step, writers);
            judge_one(world, subject, words, &format!("{}.", states.value), &states.place, out);
        }
    }
}

/// How far apart the rotations of the two conventions are, and where the axis of the sensor points under either that differs most: a look
/// at the mounting decides.
fn readings(claim: &Claim) -> (String, String) {
    let (Some((target, source)), Some(pose)) = (&claim.frames, &claim.pose) else {
        return ("inverse rotations".to_owned(), String::new());
    };
    let turn = pose.isometry().rotation;
    let apart = format!("{:.1} deg apart", turn.angle_to(&turn.inverse()).to_degrees());
    let axes = [("z", Vector3::z()), ("x", Vector3::x()), ("y", Vector3::y())];
    let alike = |axis: &Vector3<f64>| (turn * axis).dot(&(turn.inverse() * axis));
    let Some((name, axis)) = axes.into_iter().min_by(|a, b| alike(&a.1).total_cmp(&alike(&b.1))) else {
        return (apart, String::new());
    };
    let [read, inverse] = [turn, turn.inverse()].map(|turn| {
        let [x, y, z] = <[f64; 3]>::from(turn * axis).map(|value| rounded(value, 2));
        format!("({x:.2}, {y:.2}, {z:.2})")
    });
    let directions = format!(
        " Read as Hamilton, {name} of `{source}` points along {read} of `{target}`; read as JPL, along {inverse}. The mounting shows which \
         reading is right."
    );
    (apart, directions)
}

fn judge_one(
    world: &World,
    subject: String,
    (what, apart, step, [hamilton, jpl]): (&str, &str, &str, [&str; 2]),
    doubt: &str,
    place: &Place,
    out: &mut Judge,
) {
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
    let message = format!("{what} may be Hamilton or JPL: the two readings are {apart}");
    let finding = Finding::note(subject, message, place.clone())
        .hint()
        .label("read as Hamilton or as JPL?")
        .detail(format!(
            "Why that is in doubt: {doubt} The same numbers are inverse rotations in the two conventions. A comment in the file that names \
             the convention may come from a template, not from the program that wrote the numbers."
        ))
        .help(format!(
            "{step}, and declare the convention in frames-lint.yaml:\n\
             (1) Hamilton{hamilton}: `conventions: [{{file: {}, quaternion: {{algebra: hamilton}}}}]`\n\
             (2) JPL{jpl}: the same with `algebra: jpl`",
            file.file
        ));
    out.fail(finding.measured(count(2)));
}
