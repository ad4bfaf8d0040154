//! NAME06: camera frames named optical that are not turned to optical axes.

use nalgebra::UnitQuaternion;
use serde::Deserialize;

use crate::math::constants::AxisTurn;
use crate::math::relation::{Tolerance, classify_rotation};
use crate::math::rotation::rotation_angle_between;
use crate::rules::{Judge, Need, Rule, places};
use crate::verdict::{Edit, Finding, Measured, NotEvaluated, Safety};
use crate::world::graph::{Edge, EdgeOrigin, FrameGraph};
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
            if let Some(stem) = optical_stem(frame) {
                judge_frame(world, graph, frame, &stem, limits, out);
            }
        }
    }
}

/// The words before `optical` or `optical_frame`, if the name ends so.
fn optical_stem(frame: &FrameId) -> Option<Vec<String>> {
    let mut words = frame.tokens();
    if words.last().is_some_and(|word| word == "frame") {
        words.pop();
    }
    (words.pop()? == "optical").then(|| without_ending(words))
}

fn without_ending(mut words: Vec<String>) -> Vec<String> {
    while words.len() > 1 && words.last().is_some_and(|word| word == "link" || word == "frame") {
        words.pop();
    }
    words
}

/// What stands above the optical frame.
struct Mount<'a> {
    parent: &'a FrameId,
    /// Whether the parent is the camera's own link, by name.
    is_sibling: bool,
    parent_from_optical: UnitQuaternion<f64>,
    /// The edge itself, where the parent is the direct one.
    edge: Option<&'a Edge>,
}

/// The camera's own link if it is rigidly connected, else the direct parents.
fn mounts<'a>(graph: &'a FrameGraph, frame: &FrameId, stem: &[String]) -> Vec<Mount<'a>> {
    let is_sibling =
        |other: &FrameId| !stem.is_empty() && optical_stem(other).is_none() && without_ending(other.tokens()) == stem;
    let direct = |edge: &'a Edge| {
        let parent_from_optical = edge.pose?.rotation;
        Some(Mount {
            parent: &edge.parent,
            is_sibling: is_sibling(&edge.parent),
            parent_from_optical,
            edge: Some(edge),
        })
    };
    let above: Vec<Mount> = graph
        .edges_to(frame)
        .filter(|edge| edge.is_rigid)
        .filter_map(direct)
        .collect();
    if above.iter().any(|mount| mount.is_sibling) {
        return above.into_iter().filter(|mount| mount.is_sibling).collect();
    }
    let far = graph.frames.iter().filter(|other| is_sibling(other)).find_map(|other| {
        let (other_from_optical, _) = graph.chain(other, frame, |edge| edge.is_rigid)?;
        let parent_from_optical = other_from_optical.rotation;
        Some(Mount {
            parent: other,
            is_sibling: true,
            parent_from_optical,
            edge: None,
        })
    });
    far.map_or(above, |mount| vec![mount])
}

fn judge_frame(world: &World, graph: &FrameGraph, frame: &FrameId, stem: &[String], limits: &Limits, out: &mut Judge) {
    let subject = format!("frame `{frame}`");
    let off = |mount: &Mount| {
        rotation_angle_between(&AxisTurn::Optical.quaternion(), &mount.parent_from_optical).to_degrees()
    };
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
    let measured = Measured::new("rotation off optical", deg, "deg").limit(limits.exact_deg);
    if deg <= limits.exact_deg {
        out.pass(subject, [measured]);
        return;
    }
    let not_turned = worst.parent_from_optical.angle().to_degrees() <= limits.exact_deg;
    if !worst.is_sibling && (!not_turned || optical_stem(worst.parent).is_some()) {
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
        .and_then(|edge| places::of_edge(world, edge));
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
        .and_then(|edge| rpy_edit(world, edge));
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
            known.map(|relation| relation.word()),
            known.map_or_else(String::new, |relation| format!(": {}", relation.describe())),
        )
    }
}

fn rpy_edit(world: &World, edge: &Edge) -> Option<Edit> {
    let EdgeOrigin::Joint(index) = edge.origin else {
        return None;
    };
    let claim = world.claims.get(index)?;
    let robot = world.robots.iter().find(|robot| robot.source == claim.place.source)?;
    let is_editable = world
        .source(robot.source)
        .is_some_and(|source| source.derived.is_none());
    let joint = robot.joints.iter().find(|joint| joint.name.value == claim.label)?;
    let [origin] = joint.origins.as_slice() else {
        return None;
    };
    let rpy = origin.rpy.as_ref().filter(|_| is_editable)?;
    Some(Edit {
        place: rpy.text.place.clone(),
        replacement: OPTICAL_RPY.to_owned(),
    })
}
