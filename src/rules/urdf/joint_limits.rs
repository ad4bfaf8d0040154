//! URDF04: joint limits that are missing, reversed, or in degrees.

use std::f64::consts::PI;

use crate::advice::literal::{is_macro, rewrite_values, with_fix};
use crate::advice::{subject, tally::Tally};
use crate::rules::prelude::*;
use crate::verdict::Safety;
use crate::world::robot::{Joint, JointLimit, Robot};
use crate::world::{Literal, World};

pub(crate) struct JointLimits;

#[derive(Debug, serde::Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Limits {
    /// Turns from which a limit of a revolute joint looks like degrees.
    pub least_turns: f64,
    /// Largest number that may be degrees; larger ones mean "no limit".
    pub most_deg: f64,
}

impl Rule for JointLimits {
    const NEEDS: &'static [Need] = &[Need::Robot];
    type Limits = Limits;

    fn judge(world: &Estimates, limits: &Limits, out: &mut Judge) {
        let mut right = Tally::new("limits");
        for robot in &world.robots {
            let limited = robot
                .joints
                .iter()
                .filter(|joint| needs_limit(joint))
                .collect::<Vec<_>>();
            if limited.is_empty() {
                subject::nothing(world, robot, "revolute or prismatic joint", out);
            }
            for joint in limited {
                match &joint.limit {
                    None if robot.fragment.is_none() => out.fail(missing(world, robot, joint)),
                    None => {}
                    Some(limit) => judge_limit(world, robot, joint, limit, limits, &mut right, out),
                }
            }
        }
        right.report(world, out);
    }
}

fn needs_limit(joint: &Joint) -> bool {
    matches!(joint.kind.value.as_str(), "revolute" | "prismatic")
}

fn missing(world: &World, robot: &Robot, joint: &Joint) -> Finding {
    let message = format!("{} joint `{}` has no <limit>", joint.kind.value, joint.name.value);
    Finding::note(
        crate::analysis::urdf::called::joint(world, robot, joint),
        message,
        joint.place.clone(),
    )
    .label("a limit is required here")
    .help("add <limit lower upper effort velocity>, or make the joint `continuous`: urdfdom rejects the file")
    .measured(Measured::count("limits", 0).expected(1.0))
}

fn judge_limit(
    world: &World,
    robot: &Robot,
    joint: &Joint,
    limit: &JointLimit,
    limits: &Limits,
    right: &mut Tally,
    out: &mut Judge,
) {
    let both = [&limit.lower, &limit.upper];
    // Text that is no number is URDF10's; a macro is expanded elsewhere.
    if both
        .into_iter()
        .flatten()
        .any(|literal| !literal.value.is_finite() || is_macro(&literal.text))
    {
        return;
    }
    let [lower, upper] = both.map(|literal| literal.as_ref().map_or(0.0, |literal| literal.value));
    let is_revolute = joint.kind.value == "revolute";
    let unit = if is_revolute { "rad" } else { "m" };
    let owner = crate::analysis::urdf::called::joint(world, robot, joint);
    let name = &joint.name.value;
    let literals: Vec<&Literal> = both.into_iter().flatten().collect();
    let place = literals
        .iter()
        .map(|literal| literal.span)
        .reduce(crate::source::Span::cover)
        .map_or_else(|| limit.place.clone(), |span| Place::text(robot.source, span));
    if lower > upper {
        let message = format!("the limits of joint `{name}` are reversed: lower {lower} is above upper {upper}");
        // Bullet reads lower above upper as "free", and its own models write 1 and -1 for that.
        let is_idiom = !is_revolute && upper >= -1.0 && lower <= 1.0 && [lower, upper].iter().all(|b| b.fract() == 0.0);
        let severity = if is_idiom { Severity::Note } else { Severity::Error };
        let finding = Finding::new(severity, owner, message, place)
            .label("lower is above upper")
            .help("exchange the two numbers, or correct the sign of one")
            .measured(Measured::new("upper minus lower", upper - lower, unit).at_least(0.0));
        return out.fail(finding);
    }
    let largest = lower.abs().max(upper.abs());
    let measured = Measured::new("largest limit", largest, unit);
    if !is_revolute || !looks_like_degrees(lower, upper, limits) {
        right.pass(robot.source, measured);
        return;
    }
    let message = format!(
        "the limits {lower} and {upper} of joint `{name}` are probably degrees: as radians {:.0} turns",
        largest / (2.0 * PI)
    );
    let radians = literals.iter().map(|literal| (*literal, literal.value.to_radians()));
    let edits = rewrite_values(world, robot.source, radians);
    let whole = [lower, upper].iter().all(|bound| bound.fract() == 0.0);
    let finding = if whole {
        Finding::error(owner, message, place)
    } else {
        Finding::warning(owner, message, place)
    };
    let finding = finding
        .likely()
        .label("degrees?")
        .help("write radians (90 degrees are 1.5707963267948966); make a joint without limits `continuous`")
        .relation("degrees")
        .measured(measured.limit(2.0 * PI * limits.least_turns));
    out.fail(with_fix(
        finding,
        "convert the limits to radians",
        Safety::ChangesBehaviour,
        edits,
    ));
}

/// Above the turns a joint makes, below the numbers that mean "no limit" (1e16, 999999, DBL_MAX, 100 and 1000).
fn looks_like_degrees(lower: f64, upper: f64, limits: &Limits) -> bool {
    let largest = lower.abs().max(upper.abs());
    let power_of_ten = largest.log10().fract() == 0.0 && (lower + upper == 0.0 || lower == 0.0);
    largest > 2.0 * PI * limits.least_turns && largest <= limits.most_deg && !power_of_ten
}
