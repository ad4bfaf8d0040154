//! ROT04: a quaternion that is not normalised.

use crate::advice::literal::{rewrite_values, with_fix};
use crate::advice::tally::Tally;
use crate::analysis::{places::cover, rot::quaternions, rot::quaternions::StatedQuaternion};
use crate::math::rotation::{allowed_quaternion_norm_error, quaternion_norm};
use crate::rules::prelude::*;
use crate::verdict::Safety;
use crate::world::{BagEvidence, World, bag::TfEdge};

pub(crate) struct QuaternionNorm;

#[derive(Debug, serde::Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Limits {
    /// `| |q|^2 - 1 |` at which tf2 drops a transform.
    pub dropped: f64,
    /// `| |q| - 1 |` of a published quaternion that is worth a warning.
    pub published: f64,
    /// A fix is offered where the norm is off by less than this.
    pub fix: f64,
}

impl Rule for QuaternionNorm {
    const NEEDS: &'static [Need] = &[Need::Transforms];
    type Limits = Limits;

    fn judge(world: &Estimates, limits: &Limits, out: &mut Judge) {
        let mut right = Tally::new("quaternions");
        for stated in quaternions::stated(world) {
            judge_stated(world, &stated, limits, &mut right, out);
        }
        for bag in &world.bags {
            for edge in &bag.tf {
                judge_edge(bag, edge, limits, &mut right, out);
            }
        }
        right.report(world, out);
    }
}

fn judge_stated(world: &World, stated: &StatedQuaternion, limits: &Limits, right: &mut Tally, out: &mut Judge) {
    let norm = quaternion_norm(stated.xyzw);
    // NaN and zero are ROT05's.
    if !norm.is_finite() || norm <= quaternions::ZERO_NORM {
        return;
    }
    let error = norm - 1.0;
    let dropped = (norm * norm - 1.0).abs() >= limits.dropped;
    let allowed = allowed_quaternion_norm_error(stated.xyzw);
    let measured = Measured::new("norm of the quaternion minus 1", error, "1").limit(allowed);
    if error.abs() <= allowed && !dropped {
        return right.pass(stated.place.source, measured);
    }
    let severity = if dropped { Severity::Error } else { Severity::Warning };
    let message = format!(
        "the quaternion of {} is not normalised: its norm differs from 1 by {:.1e}",
        stated.name,
        error.abs()
    );
    let help = if dropped {
        "normalise it, and look for a wrong or lost component: tf2 of ROS 1 drops a transform with such a quaternion, tf2 of ROS 2 \
         normalises it"
    } else {
        "divide its numbers by the norm: a program that uses it as it is does not get a pure rotation"
    };
    let place = cover(stated.literals, &stated.place);
    let [x, y, z, w] = stated.xyzw;
    let finding = Finding::new(severity, stated.subject(world), message, place)
        .label(format!("norm {norm:.6}"))
        .detail(format!(
            "The quaternion is read as x {x}, y {y}, z {z}, w {w}. Rounding to the printed digits explains a difference of {allowed:.1e}."
        ))
        .help(help)
        .measured(measured);
    if error.abs() >= limits.fix {
        return out.fail(finding);
    }
    let unit = stated.literals.iter().map(|literal| (literal, literal.value / norm));
    let edits = rewrite_values(world, stated.place.source, unit);
    out.fail(with_fix(finding, "normalise the quaternion", Safety::Safe, edits));
}

fn judge_edge(bag: &BagEvidence, edge: &TfEdge, limits: &Limits, right: &mut Tally, out: &mut Judge) {
    let subject = format!("`{}` from `{}` on {}", edge.parent, edge.child, edge.topic);
    if let Some(example) = edge.denormalized.examples.first() {
        let norm = quaternion_norm(example.rotation);
        let message = format!(
            "{} of {} transforms {subject} have the norm {norm:.4}; ROS 1 drops them",
            edge.denormalized.count, edge.count
        );
        let finding = Finding::error(subject.clone(), message, Place::message(bag.source, example.at.clone()))
            .label("first dropped transform")
            .help("normalise the quaternion where it is published")
            .measured(
                Measured::new("norm of the quaternion", norm, "1")
                    .limit(1.0)
                    .samples(edge.denormalized.count),
            );
        return out.fail(finding);
    }
    let measured = Measured::new("largest deviation of the norm from 1", edge.worst_norm_error, "1")
        .limit(limits.published)
        .samples(edge.count);
    if edge.worst_norm_error > limits.published {
        let message = format!(
            "the quaternions of {subject} are not normalised: their norm differs from 1 by up to {:.1e}",
            edge.worst_norm_error
        );
        let finding = Finding::warning(subject, message, Place::message(bag.source, edge.first_at.clone()))
            .label("first transform of this edge")
            .detail("tf2 uses them without normalising.")
            .help("normalise the quaternion where it is published")
            .measured(measured);
        out.fail(finding);
    } else if !edge.samples.is_empty() {
        right.pass(bag.source, measured);
    }
}
