//! QUAT04: whether a constant rotation between two orientations is on the side that frame names and mountings state.

use nalgebra::UnitQuaternion;

use crate::advice::{diagnosis::rule_of, together::report_once};
use crate::analysis::motion::{BagMotion, Motion};
use crate::analysis::quat::oriented::{Claim, OrientationStream, oriented};
use crate::math::constants::AxisTurn;
use crate::math::sides::{Constant, Sides, one_sided, sides};
use crate::rules::prelude::*;

pub(crate) struct LeftVsRightMultiplication;

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Limits {
    min_turn_deg: f64,
    min_pairs: usize,
    max_pairs: usize,
    max_step_s: f64,
    max_spread_deg: f64,
    min_ratio: f64,
    min_constant_deg: f64,
    named_deg: f64,
}

impl Rule for LeftVsRightMultiplication {
    const NEEDS: &'static [Need] = &[Need::Bag];
    type Limits = Limits;

    fn judge(world: &Estimates, limits: &Limits, out: &mut Judge) {
        let motion = Motion::of(world);
        for bag in &motion.bags {
            judge_bag(world, &motion, bag, limits, out);
        }
    }
}

fn judge_bag(world: &Estimates, motion: &Motion, bag: &BagMotion, limits: &Limits, out: &mut Judge) {
    let all = oriented(world, motion, bag);
    let mut off = Vec::new();
    for (index, b) in all.iter().enumerate().skip(1) {
        // It is compared with the first orientation that states a common frame.
        let mut before = all.iter().take(index);
        let Some((a, claim)) = before.find_map(|a| Some((a, Claim::of(world, a, b)?))) else {
            let why = "its frames are neither those of another orientation nor tied to them: a constant rotation on either side is allowed";
            out.missing(&b.subject, why);
            continue;
        };
        off.extend(judge_pair(a, b, claim, limits, out));
    }
    report_once(off, "differ in the same way", out);
}

fn judge_pair(
    a: &OrientationStream,
    b: &OrientationStream,
    claim: Claim,
    limits: &Limits,
    out: &mut Judge,
) -> Option<Finding> {
    let subject = format!("{} against {}", b.subject, a.subject);
    let mut little = |why: String| {
        out.too_little(&subject, why);
        None
    };
    let pairs = pairs(a, b, &claim, limits);
    if pairs.len() < limits.min_pairs {
        return little(format!(
            "only {} orientations at the same times, {} are needed",
            pairs.len(),
            limits.min_pairs
        ));
    }
    let found = sides(&pairs)?;
    let turned_deg = found.turned_rad.to_degrees();
    if turned_deg < limits.min_turn_deg {
        return little(format!(
            "they rotate by only {turned_deg:.0} deg, {} deg are needed to distinguish the world's side from the body's",
            limits.min_turn_deg
        ));
    }
    let is_constant = |constant: &Constant| constant.spread_rad.to_degrees() <= limits.max_spread_deg;
    // If the bodies are tied, only the world may differ; else only the body.
    let (claimed, other) = if claim.bodies.is_some() {
        (found.left, found.right)
    } else {
        (found.right, found.left)
    };
    let measured = measured(&found, pairs.len(), limits);
    let is_steadier = is_constant(&other) && claimed.spread_rad >= limits.min_ratio * other.spread_rad;
    // Of a platform that only yaws, the yaw between the two may be that of their worlds.
    let least = is_steadier.then(|| one_sided(&pairs, &found, claim.bodies.is_none()));
    let of_other = least
        .flatten()
        .filter(|least| least.angle().to_degrees() >= limits.min_constant_deg);
    if !is_constant(&claimed) && of_other.is_none() {
        return little(format!(
            "they do not differ by a constant rotation: the spread is {:.0} deg on the world's side, {:.0} deg on the body's",
            found.left.spread_rad.to_degrees(),
            found.right.spread_rad.to_degrees()
        ));
    }
    let Some(constant) = of_other else {
        out.pass(subject, measured);
        return None;
    };
    let mut finding = contradiction(a, b, &claim, &constant, &found, &subject, limits);
    if let Some(aspect) = a.shown_by.or(b.shown_by) {
        finding = finding.unless(rule_of(aspect));
    }
    Some(finding.unless(codes::CROSS08).measured(measured))
}

fn measured(found: &Sides, pairs: usize, limits: &Limits) -> [Measured; 3] {
    // The limit is that of the reading that fits better.
    let spread = |what: &str, constant: &Constant, other: &Constant| {
        let measured = Measured::new(what, constant.spread_rad.to_degrees(), "deg").samples(pairs as u64);
        if constant.spread_rad <= other.spread_rad {
            measured.limit(limits.max_spread_deg)
        } else {
            measured
        }
    };
    [
        spread(
            "scatter of the rotation in the axes of the world",
            &found.left,
            &found.right,
        ),
        spread(
            "scatter of the rotation in the axes of the body",
            &found.right,
            &found.left,
        ),
        Measured::new(
            "rotation of the platform in the recording",
            found.turned_rad.to_degrees(),
            "deg",
        )
        .at_least(limits.min_turn_deg),
    ]
}

/// Orientations of both at the times of `a`; of the same body if the bodies are tied.
fn pairs(
    a: &OrientationStream,
    b: &OrientationStream,
    claim: &Claim,
    limits: &Limits,
) -> Vec<(UnitQuaternion<f64>, UnitQuaternion<f64>)> {
    let a_from_b = claim.bodies.unwrap_or_else(UnitQuaternion::identity);
    let count: usize = a.turned.runs.iter().map(Vec::len).sum();
    let every = count.div_ceil(limits.max_pairs.max(1)).max(1);
    let rows = a.turned.runs.iter().flatten().step_by(every);
    rows.filter_map(|(t_s, turned)| Some((turned * a_from_b, b.turned.at(*t_s, limits.max_step_s)?)))
        .collect()
}

fn contradiction(
    a: &OrientationStream,
    b: &OrientationStream,
    claim: &Claim,
    constant: &UnitQuaternion<f64>,
    found: &Sides,
    subject: &str,
    limits: &Limits,
) -> Finding {
    let degrees = constant.angle().to_degrees();
    let axis = constant.axis().map_or_else(String::new, |axis| {
        format!(
            "The axis of the rotation is ({:+.2}, {:+.2}, {:+.2}). ",
            axis.x, axis.y, axis.z
        )
    });
    let [of_world, of_body] = [&found.left, &found.right].map(|one| one.spread_rad.to_degrees());
    let name = |frame: &Option<crate::world::FrameId>| frame.as_ref().map_or("?", |frame| frame.as_str()).to_owned();
    let (side, stated, why, help) = if claim.bodies.is_some() {
        let (one, other) = (name(&a.body), name(&b.body));
        let stated = if one == other {
            format!("both are of `{one}`")
        } else {
            format!("TF connects `{other}` rigidly to `{one}`")
        };
        (
            "body",
            stated,
            format!(
                "The rotation between the two is constant in the axes of the body (scatter {of_body:.1} deg), not in the axes of the world \
                 (scatter {of_world:.1} deg)."
            ),
            "correct one of the two, by the cause:\n(1) a sensor is mounted with this rotation: add the rotation to the transform of the \
             sensor\n(2) one has other body axes, such as FRD: give that one a `child_frame_id` of its own, and publish its \
             transform\n(3) the poses of one were moved to another world from the wrong side: multiply from the left, \
             `new_from_world * world_from_body`",
        )
    } else {
        (
            "world",
            format!("both are in `{}`", name(&a.world)),
            format!(
                "The rotation between the two is constant in the axes of the world (scatter {of_world:.1} deg), not in the axes of the body \
                 (scatter {of_body:.1} deg)."
            ),
            "correct one of the two, by the cause:\n(1) one is not aligned with that frame: give that one a `frame_id` of its own, and \
             publish the transform between the two frames\n(2) a rotation of the body, such as a mounting, was multiplied from the \
             left: multiply from the right, `world_from_body * body_from_new`",
        )
    };
    let message = format!("{} and {}: {stated}, but {degrees:.0} deg apart", b.subject, a.subject);
    let finding = Finding::warning(subject, message, b.place.clone())
        .likely()
        .detail(format!("{why} {axis}The data do not show which of the two is wrong."))
        .help(help)
        .related(a.place.clone(), "compared with this orientation")
        .measured(
            Measured::new(format!("constant rotation of the {side}"), degrees, "deg").limit(limits.min_constant_deg),
        );
    let near = |turn: &&AxisTurn| constant.angle_to(&turn.quaternion()).to_degrees() <= limits.named_deg;
    match AxisTurn::all().iter().find(near) {
        Some(turn) => finding.relation(turn.word()),
        None => finding,
    }
}
