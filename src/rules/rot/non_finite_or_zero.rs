//! ROT05: NaN, infinity and the quaternion of all zeros.

use crate::advice::{literal::is_spelled_non_finite, tally::Tally};
use crate::analysis::{places::cover, rot::quaternions, rot::urdf_numbers::number_lists};
use crate::math::rotation::quaternion_norm;
use crate::rules::prelude::*;
use crate::world::bag::{BagEvidence, Faults, TfEdge};
use crate::world::{Claim, ClaimKind, Literal, Robot, Spelling, World};

pub(crate) struct NonFiniteOrZero;

impl Rule for NonFiniteOrZero {
    const NEEDS: &'static [Need] = &[Need::Transforms];
    type Limits = NoLimits;

    fn judge(world: &Estimates, _limits: &NoLimits, out: &mut Judge) {
        let mut right = Tally::new("statements of numbers");
        for robot in &world.robots {
            judge_robot(world, robot, &mut right, out);
            judge_inertials(world, robot, out);
        }
        for claim in &world.claims {
            if let ClaimKind::File { .. } = claim.kind {
                judge_file(world, claim, &mut right, out);
            }
        }
        for stated in quaternions::stated(world) {
            if quaternion_norm(stated.xyzw) <= quaternions::ZERO_NORM {
                let message = format!("the quaternion of {} is all zeros, which is no rotation", stated.name);
                let place = cover(stated.literals, &stated.place);
                let finding = Finding::error(stated.subject(world), message, place)
                    .label("0 0 0 0")
                    .help("write the measured rotation, or 0 0 0 1 (x y z w) for no rotation")
                    .measured(Measured::new("norm of the quaternion", 0.0, "1").expected(1.0));
                out.fail(finding);
            }
        }
        for bag in &world.bags {
            for edge in &bag.tf {
                judge_edge(bag, edge, &mut right, out);
            }
        }
        right.report(world, out);
    }
}

fn judge_robot(world: &World, robot: &Robot, right: &mut Tally, out: &mut Judge) {
    for numbers in number_lists(robot) {
        let broken: Vec<&Literal> = numbers.literals.iter().filter(|l| is_spelled_non_finite(l)).collect();
        let named = || {
            let name = numbers.owner.to_string();
            (format!("{name} of {}", world.path(robot.source)), name)
        };
        report(named, &broken, numbers.literals.len(), &numbers.place, right, out);
    }
}

/// Masses and moments of inertia have no literals in the world; their element is the place.
fn judge_inertials(world: &World, robot: &Robot, out: &mut Judge) {
    for link in &robot.links {
        let Some(body) = &link.inertial else { continue };
        let numbers = body.mass_kg.into_iter().chain(body.inertia.into_iter().flatten());
        let broken = numbers.filter(|number| !number.is_finite()).count();
        if broken > 0 {
            let name = format!("inertial of link `{}`", link.name.value);
            let subject = format!("{name} of {}", world.path(robot.source));
            out.fail(not_finite(
                (subject, name),
                "NaN or infinite",
                broken,
                body.place.clone(),
            ));
        }
    }
}

fn judge_file(world: &World, claim: &Claim, right: &mut Tally, out: &mut Judge) {
    let literals = claim.translation_literals.iter().chain(&claim.rotation_literals);
    let broken: Vec<&Literal> = literals.filter(|literal| !literal.value.is_finite()).collect();
    let name = format!("`{}`", claim.label);
    let named = (format!("{name} of {}", world.path(claim.place.source)), name);
    let numbers = spelled(&claim.spelling);
    if broken.is_empty() && numbers.iter().any(|number| !number.is_finite()) {
        // The text of the numbers is not known: the statement as a whole is the place.
        out.fail(not_finite(named, "NaN or infinite", 1, claim.place.clone()));
    } else {
        report(|| named, &broken, numbers.len(), &claim.place, right, out);
    }
}

fn spelled(spelling: &Spelling) -> Vec<f64> {
    match spelling {
        Spelling::Rpy { xyz, rpy } => xyz.iter().chain(rpy).copied().collect(),
        Spelling::Quaternion { xyz, xyzw, .. } => xyz.iter().chain(xyzw).copied().collect(),
        Spelling::Matrix { values, .. } => values.clone(),
        Spelling::Translation { xyz } => xyz.to_vec(),
    }
}

/// One finding for all broken numbers of a statement, or one more statement that is right. `named` gives the subject, and the name for
/// the message.
fn report(
    named: impl FnOnce() -> (String, String),
    broken: &[&Literal],
    total: usize,
    whole: &Place,
    right: &mut Tally,
    out: &mut Judge,
) {
    match broken.first() {
        Some(first) => {
            let place = Place::text(whole.source, first.span);
            out.fail(not_finite(named(), &format!("`{}`", first.text), broken.len(), place));
        }
        None if total > 0 => right.pass(
            whole.source,
            Measured::count("numbers that are not finite", 0).limit(0.0),
        ),
        None => {}
    }
}

fn not_finite((subject, name): (String, String), what: &str, count: usize, place: Place) -> Finding {
    let message = format!("{name} has a number that is {what}");
    Finding::error(subject, message, place)
        .label("not finite")
        .detail("No transform can be computed from it.")
        .help("write the measured number, or remove the whole transform if it is unknown")
        .measured(Measured::count("numbers that are not finite", count).limit(0.0))
}

fn judge_edge(bag: &BagEvidence, edge: &TfEdge, right: &mut Tally, out: &mut Judge) {
    let subject = format!("`{}` from `{}` on {}", edge.parent, edge.child, edge.topic);
    let kinds: [(&Faults, &str, &str); 2] = [
        (
            &edge.non_finite,
            "NaN or infinity",
            "correct the node that computes the transform, and do not publish a transform with a number that is not finite",
        ),
        (
            &edge.zero_quaternion,
            "all-zero quaternion",
            "set the quaternion (x, y, z, w = 0, 0, 0, 1 for no rotation); if the rotation is not known yet, do not publish the transform",
        ),
    ];
    let mut sound = true;
    for (faults, what, help) in kinds {
        let Some(example) = faults.examples.first() else {
            continue;
        };
        sound = false;
        let message = format!(
            "`{}` -> `{}` on `{}`: {what} in {} of {} transforms; tf2 drops them",
            edge.parent, edge.child, edge.topic, faults.count, edge.count
        );
        let finding = Finding::error(subject.clone(), message, Place::message(bag.source, example.at.clone()))
            .label("first broken transform")
            .help(help)
            .measured(
                Measured::new("broken transforms", faults.count as f64, "count")
                    .limit(0.0)
                    .samples(edge.count),
            );
        out.fail(finding);
    }
    if sound && edge.count > 0 {
        right.pass(bag.source, Measured::count("broken transforms", 0).limit(0.0));
    }
}
