//! URDF08: a mass or an inertia that no rigid body can have.

use crate::advice::{subject, tally::Tally};
use crate::analysis::urdf::moments::{is_placeholder, principal_moments, rounding};
use crate::rules::prelude::*;
use crate::world::World;
use crate::world::robot::{Inertial, Joint, Link, Robot};

pub(crate) struct InertiaInvalid;

#[derive(Debug, serde::Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Limits {
    /// Allowed rounding error as a share of the largest principal moment.
    pub relative: f64,
    /// The most that few printed digits may excuse, as a share of the largest principal moment.
    pub digits: f64,
    /// Moments up to this are zero, kg m².
    pub absolute: f64,
    /// Share of the largest principal moment up to which a broken bound is a note.
    pub gross: f64,
    /// Mass under which a link is only a frame, kilograms.
    pub weightless_kg: f64,
    /// Mass under which a fixed link hardly matters, kilograms.
    pub light_kg: f64,
}

impl Rule for InertiaInvalid {
    const NEEDS: &'static [Need] = &[Need::Robot];
    type Limits = Limits;

    fn judge(world: &Estimates, limits: &Limits, out: &mut Judge) {
        let mut right = Tally::new("inertias");
        for robot in &world.robots {
            let bodies = robot
                .links
                .iter()
                .filter_map(|link| Some((link, link.inertial.as_ref()?)));
            let bodies: Vec<(&Link, &Inertial)> = bodies.collect();
            if bodies.is_empty() {
                subject::nothing(world, robot, "inertial element", out);
            }
            let mut zero = Vec::new();
            for (link, body) in bodies {
                if body.inertia == Some([0.0; 6]) && body.mass_kg.is_none_or(|mass| mass >= 0.0) {
                    zero.push((link, body));
                } else if let Some(finding) = judge_body(world, robot, link, body, limits) {
                    out.fail(finding);
                } else {
                    right.count(robot.source);
                }
            }
            if let Some(finding) = all_zero(world, robot, &zero) {
                out.fail(finding);
            }
        }
        right.report(world, out);
    }
}

fn judge_body(world: &World, robot: &Robot, link: &Link, body: &Inertial, limits: &Limits) -> Option<Finding> {
    let owner = crate::analysis::urdf::called::link(world, robot, link);
    let name = &link.name.value;
    if let Some(mass) = body.mass_kg.filter(|mass| *mass < 0.0) {
        let finding = Finding::error(
            owner,
            format!("the mass of `{name}` is negative: {mass} kg"),
            body.mass_place.clone().unwrap_or_else(|| body.place.clone()),
        )
        .label("negative mass")
        .help("write the mass of the link, or leave <inertial> out if it is not known")
        .measured(Measured::new("mass", mass, "kg").limit(0.0));
        return Some(finding);
    }
    let inertia = body
        .inertia
        .filter(|inertia| inertia.iter().all(|moment| moment.is_finite()))?;
    let [least, middle, largest] = principal_moments(inertia)?;
    let tolerance =
        limits.absolute + (limits.relative * largest.abs()).max(rounding(inertia).min(limits.digits * largest.abs()));
    let place = body.inertia_place.clone().unwrap_or_else(|| body.place.clone());
    let slight = limits.gross * largest.abs();
    let is_weightless = body.mass_kg.is_some_and(|mass| mass < limits.weightless_kg);
    let is_filled_in = is_weightless || is_placeholder(inertia);
    let severity = |is_slight: bool| {
        if is_slight || is_filled_in {
            Severity::Note
        } else {
            Severity::Warning
        }
    };
    let finding = if least < -tolerance {
        let message = format!("the inertia of `{name}` has a negative principal moment: {least:.3e} kg m²");
        Finding::new(severity(least >= -slight), owner, message, place)
            .label("a principal moment is negative")
            .help("look for a wrong sign or too large products of inertia: simulators reject it or become unstable")
            .measured(Measured::new("smallest principal moment", least, "kg m²").limit(0.0))
    } else if least + middle < largest - tolerance {
        let sum = (least + middle).max(0.0);
        let ratio = match largest / sum {
            ratio if ratio < 2.0 => format!("{:.1} % above", 100.0 * (ratio - 1.0)),
            ratio if ratio.is_finite() => format!("{ratio:.1} times"),
            // The others are zero.
            _ => "larger than".to_owned(),
        };
        let message = format!("impossible inertia of `{name}`: one principal moment is {ratio} the sum of the others");
        // A light link that is fixed to another is lumped into it, where its own moments hardly matter.
        let is_light = body.mass_kg.is_none_or(|mass| mass < limits.light_kg) && is_fixed(robot, link);
        let is_slight = largest - (least + middle) <= slight;
        Finding::new(severity(is_slight || is_light), owner, message, place)
            .label("violates the triangle inequality")
            .detail(format!(
                "The largest principal moment is {} kg m². In a rigid body it is at most the sum of the two others, {} kg m².",
                brief(largest),
                brief(sum)
            ))
            .help("take the inertia from CAD, about the centre of mass, or from the formula of a box or cylinder")
            .measured(Measured::new("largest principal moment, compared with the sum of the others", largest, "kg m²").limit(least + middle))
    } else {
        return None;
    };
    Some(finding)
}

/// A moment, in words.
fn brief(moment: f64) -> String {
    if (1e-3..1e4).contains(&moment) {
        format!("{moment:.3}")
    } else {
        format!("{moment:.3e}")
    }
}

fn is_fixed(robot: &Robot, link: &Link) -> bool {
    let name = &link.name.value;
    let mut above = robot
        .joints
        .iter()
        .filter(|joint| joint.child.as_ref().is_some_and(|child| child.value == *name));
    above.any(Joint::is_fixed)
}

fn all_zero(world: &World, robot: &Robot, zero: &[(&Link, &Inertial)]) -> Option<Finding> {
    let (link, body) = zero.first()?;
    let heavy = zero
        .iter()
        .filter(|(_, body)| body.mass_kg.is_some_and(|mass| mass > 0.0))
        .count();
    let message = format!(
        "{} of {} links have zero inertia, {heavy} of them with a mass",
        zero.len(),
        robot.links.len()
    );
    Some(
        Finding::note(
            format!("zero inertias of {}", world.path(robot.source)),
            message,
            body.place.clone(),
        )
        .label(format!("all moments of `{}` are zero", link.name.value))
        .help(
            "write the moments of the links that move in a simulation; zero is harmless on links that are only a frame",
        )
        .measured(Measured::count("links with zero inertia", zero.len())),
    )
}
