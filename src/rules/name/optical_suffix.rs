//! NAME06: camera frames named optical that are not turned to optical axes.

use nalgebra::UnitQuaternion;
use serde::Deserialize;

use crate::math::constants::AxisTurn;
use crate::math::relation::{Relation, Tolerance, classify_rotation};
use crate::math::rotation::rotation_angle_between;
use crate::rules::optical::{Mount, mounts};
use crate::rules::{Judge, Need, Rule, limits_of, names, places};
use crate::verdict::{Finding, Measured, NotEvaluated, Safety};
use crate::world::graph::FrameGraph;
use crate::world::{FrameId, World};

/// NAME06.
pub struct OpticalSuffix;

/// Limits of the page.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Limits {
    /// Deviation up to which a rotation is the optical one, degrees.
    pub exact_deg: f64,
    /// Deviation up to which it may be the optical one with a calibration in it, degrees.
    pub calibrated_deg: f64,
}

/// `link_from_optical` as URDF text.
const OPTICAL_RPY: &str = "-1.5707963267948966 0 -1.5707963267948966";

impl Rule for OpticalSuffix {
    const PAGE: &'static str = include_str!("../../../rules/name/optical-suffix.md");
    const NEEDS: &'static [Need] = &[Need::RobotOrTf];
    type Limits = Limits;

    fn judge(world: &World, limits: &Limits, out: &mut Judge) {
        let graph = world.graph();
        for frame in &graph.frames {
            if let Some(stem) = names::optical_stem(frame) {
                judge_frame(world, graph, frame, &stem, limits, out);
            }
        }
    }
}

/// How far a turn is from the optical one, degrees.
fn off(mount: &Mount) -> f64 {
    rotation_angle_between(&AxisTurn::Optical.quaternion(), &mount.parent_from_optical).to_degrees()
}

/// Whether a mount tells what its optical frame is turned from: the camera's own link, or a mistake wherever it hangs.
fn tells(mount: &Mount, limits: &Limits) -> bool {
    let not_turned = mount.parent_from_optical.angle().to_degrees() <= limits.exact_deg;
    // No camera is rolled by a quarter turn and looks sideways at once: exactly the inverse is a mistake anywhere.
    let inverse = AxisTurn::Optical.quaternion().inverse();
    let is_inverse = rotation_angle_between(&inverse, &mount.parent_from_optical).to_degrees() <= limits.exact_deg;
    mount.is_sibling || (not_turned || is_inverse) && names::optical_stem(mount.parent).is_none()
}

/// The mount of an optical frame that is off most.
fn worst<'a>(graph: &'a FrameGraph, frame: &FrameId) -> Option<Mount<'a>> {
    let stem = names::optical_stem(frame)?;
    mounts(graph, frame, &stem)
        .into_iter()
        .max_by(|a, b| off(a).total_cmp(&off(b)))
}

/// Whether this rule finds more than a calibration in the turn of a frame.
pub(crate) fn reports(world: &World, frame: &FrameId) -> bool {
    let Some(limits) = limits_of::<OpticalSuffix>() else {
        return false;
    };
    worst(world.graph(), frame).is_some_and(|worst| off(&worst) > limits.calibrated_deg && tells(&worst, &limits))
}

/// Whether a frame is turned from the camera's own link as optical frames are.
pub(crate) fn is_turned_from_its_link(world: &World, frame: &FrameId) -> bool {
    let Some(limits) = limits_of::<OpticalSuffix>() else {
        return false;
    };
    worst(world.graph(), frame).is_some_and(|worst| worst.is_sibling && off(&worst) <= limits.calibrated_deg)
}

fn judge_frame(world: &World, graph: &FrameGraph, frame: &FrameId, stem: &[String], limits: &Limits, out: &mut Judge) {
    let subject = format!("frame `{frame}`");
    let mounts = mounts(graph, frame, stem);
    let Some(worst) = mounts.iter().max_by(|a, b| off(a).total_cmp(&off(b))) else {
        out.not_evaluated(
            subject,
            NotEvaluated::TooLittleEvidence,
            "no rigid transform to a parent is known",
        );
        return;
    };
    let deg = off(worst);
    let measured = Measured::new("rotation off optical", deg, "deg")
        .turn()
        .limit(limits.exact_deg);
    if deg <= limits.exact_deg {
        out.pass(subject, [measured]);
        return;
    }
    if !tells(worst, limits) {
        let reason = format!(
            "`{}` is not this camera's own link, and the camera may be mounted at any angle",
            worst.parent
        );
        out.not_evaluated(subject, NotEvaluated::TooLittleEvidence, reason);
        return;
    }
    let place = worst
        .edge
        .or_else(|| graph.edges_to(frame).next())
        .and_then(|edge| places::of_numbers(world, edge));
    let Some(place) = place.or_else(|| places::first(world, frame)) else {
        return;
    };
    let (word, what) = relation(&worst.parent_from_optical, limits);
    let message = format!(
        "`{frame}` is {deg:.1} deg off the optical axes of `{}`{what}",
        worst.parent
    );
    let finding = if deg <= limits.calibrated_deg {
        Finding::warning(subject, message, place).likely()
    } else if worst.is_sibling {
        Finding::error(subject, message, place)
    } else {
        Finding::error(subject, message, place).likely()
    };
    let mut finding = finding.measured(measured).help(
        "an optical frame has z forward, x right, y down: rpy = (-pi/2, 0, -pi/2) from a link with x forward (REP-103)",
    );
    finding.relation = word.map(str::to_owned);
    let edit = worst
        .edge
        .filter(|_| word.is_some())
        .and_then(|edge| places::rpy_edit(world, edge, OPTICAL_RPY));
    out.fail(match edit {
        Some(edit) => finding.fix("turn it to optical axes", Safety::ChangesBehaviour, vec![edit]),
        None => finding,
    });
}

/// The mistake that was made, if it is one of the common ones.
fn relation(parent_from_optical: &UnitQuaternion<f64>, limits: &Limits) -> (Option<&'static str>, String) {
    let is =
        |turn: UnitQuaternion<f64>| rotation_angle_between(&turn, parent_from_optical).to_degrees() <= limits.exact_deg;
    if is(UnitQuaternion::identity()) {
        (Some("optical"), ": it is not turned at all".to_owned())
    } else if is(AxisTurn::XMinus90.quaternion()) {
        (Some("x-90"), ": it is turned about x only".to_owned())
    } else {
        let tolerance = Tolerance {
            angle_rad: limits.exact_deg.to_radians(),
            ..Tolerance::default()
        };
        let known = classify_rotation(&AxisTurn::Optical.quaternion(), parent_from_optical, &tolerance).error();
        (
            known.map(Relation::word),
            known.map_or_else(String::new, |relation| format!(": {}", relation.describe())),
        )
    }
}
