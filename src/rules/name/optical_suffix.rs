//! NAME06: camera frames named optical that do not have optical axes.

use nalgebra::{Isometry3, UnitQuaternion};

use crate::advice::places;
use crate::analysis::name::optical::{Limits, OPTICAL_RPY, is_conclusive, is_doubled, off};
use crate::analysis::places::published_reading;
use crate::analysis::{names, optical::Mount, optical::mounts, suffix};
use crate::math::relation::{Relation, Tolerance, classify_rotation};
use crate::math::{constants::AxisTurn, rotation::rotation_angle_between};
use crate::rules::prelude::*;
use crate::source::Confidence;
use crate::verdict::Safety;
use crate::world::{FrameId, World, graph::FrameGraph};

pub(crate) struct OpticalSuffix;

impl Rule for OpticalSuffix {
    const NEEDS: &'static [Need] = &[Need::RobotTfOrLaunch];
    type Limits = Limits;

    fn judge(world: &Estimates, limits: &Limits, out: &mut Judge) {
        let graph = world.graph();
        for frame in &graph.frames {
            if let Some(stem) = names::optical_stem(frame) {
                judge_frame(world, graph, frame, &stem, limits, out);
            }
        }
        // What only a launch file attaches. A transform that several files publish is judged once.
        let mut judged: Vec<(&FrameId, &FrameId, Option<Isometry3<f64>>)> = Vec::new();
        for launched in world.launched() {
            for edge in launched.edges.iter().filter(|edge| edge.is_published()) {
                let this = (&edge.parent, &edge.child, edge.pose);
                let is_attached = graph.edges_to(&edge.child).next().is_some();
                if let (Some(stem), false, false) =
                    (names::optical_stem(&edge.child), is_attached, judged.contains(&this))
                {
                    judged.push(this);
                    judge_frame(world, launched, &edge.child, &stem, limits, out);
                }
            }
        }
    }
}

fn judge_frame(world: &World, graph: &FrameGraph, frame: &FrameId, stem: &[String], limits: &Limits, out: &mut Judge) {
    let subject = format!("frame `{frame}`");
    let mounts = mounts(graph, frame, stem);
    let Some(worst) = mounts.iter().max_by(|a, b| off(a).total_cmp(&off(b))) else {
        return out.too_little(subject, "no rigid transform to a parent is known");
    };
    let deg = off(worst);
    let measured = Measured::new("rotation from optical axes", deg, "deg")
        .turn()
        .limit(limits.exact_deg);
    if is_doubled(graph, worst, limits) {
        if let Some(finding) = doubled(world, subject, frame, worst) {
            out.fail(finding.measured(measured));
        }
        return;
    }
    if deg <= limits.exact_deg {
        return out.pass(subject, [measured]);
    }
    if !is_conclusive(worst, limits) {
        let why = format!(
            "`{}` is not this camera's own link, so the camera may be mounted at any angle",
            worst.parent
        );
        return out.too_little(subject, why);
    }
    let edge = worst.edge.or_else(|| graph.edges_to(frame).next());
    let place = edge.and_then(|edge| crate::analysis::places::of_numbers(world, edge));
    let Some(place) = place.or_else(|| crate::analysis::places::first(world, frame)) else {
        return;
    };
    let (word, what) = relation(&worst.parent_from_optical, limits);
    let parent = &worst.parent;
    let message = if worst.parent_from_optical.angle().to_degrees() <= limits.exact_deg {
        format!("`{frame}` has the body axes of `{parent}`, not optical axes ({deg:.1} deg off)")
    } else {
        format!("`{frame}` is rotated {deg:.1} deg from optical axes, relative to `{parent}`")
    };
    let reading = edge.map_or(Confidence::Certain, |edge| published_reading(world, edge));
    let (finding, rest) = if deg <= limits.calibrated_deg {
        let rest = format!("; if the {deg:.1} deg were calibrated, add them to the transform of `{parent}`");
        (Finding::warning(subject, message, place).likely(), rest)
    } else if worst.is_sibling {
        (Finding::error(subject, message, place), String::new())
    } else {
        (Finding::error(subject, message, place).likely(), String::new())
    };
    let mut finding = finding
        .confidence(reading)
        .label("this rotation")
        .measured(measured)
        .detail(what)
        .help(format!(
            "give `{frame}` rpy = (-pi/2, 0, -pi/2) relative to `{parent}`: z forward, x right, y down (REP-103){rest}"
        ));
    finding.relation = word.map(str::to_owned);
    let edit = worst
        .edge
        .filter(|_| word.is_some())
        .and_then(|edge| places::rpy_edit(world, edge, OPTICAL_RPY));
    out.fail(match edit {
        Some(edit) => finding.fix("rotate it to optical axes", Safety::ChangesBehaviour, vec![edit]),
        None => finding,
    });
}

/// The finding of an optical frame that is rotated to optical axes below a frame that has them.
fn doubled(world: &World, subject: String, frame: &FrameId, mount: &Mount) -> Option<Finding> {
    let parent = &mount.parent;
    let message = format!("`{frame}` is rotated to optical axes once more, below the optical frame `{parent}`");
    let edge = mount.edge?;
    let finding = Finding::error(subject, message, crate::analysis::places::of_numbers(world, edge)?)
        .likely()
        .confidence(published_reading(world, edge))
        .label("this rotation")
        .detail(format!(
            "`{parent}` has optical axes (z forward, x right, y down). With the rotation applied twice, `{frame}` has z to the right and x up."
        ))
        .relation(Relation::AppliedTwice.word())
        .help(format!(
            "give `{frame}` no rotation relative to `{parent}`, or attach it to the camera's own link, with x forward"
        ));
    Some(finding)
}

/// The mistake, if it is one of the common ones, with a sentence.
fn relation(parent_from_optical: &UnitQuaternion<f64>, limits: &Limits) -> (Option<&'static str>, String) {
    let is =
        |turn: UnitQuaternion<f64>| rotation_angle_between(&turn, parent_from_optical).to_degrees() <= limits.exact_deg;
    if is(UnitQuaternion::identity()) {
        (
            Some("optical"),
            "The transform between the two has no rotation.".to_owned(),
        )
    } else if is(AxisTurn::XMinus90.quaternion()) {
        (
            Some("x-90"),
            "The transform rotates by -90 deg about x only: the yaw of -90 deg is missing.".to_owned(),
        )
    } else {
        let tolerance = Tolerance {
            angle_rad: limits.exact_deg.to_radians(),
            ..Tolerance::default()
        };
        let known = classify_rotation(&AxisTurn::Optical.quaternion(), parent_from_optical, &tolerance).error();
        (
            known.map(Relation::word),
            known.map_or(String::new(), |known| match known {
                Relation::Z180 => "The image would be upside down: 180 deg about the optical axis.".to_owned(),
                known => suffix::directions(parent_from_optical).unwrap_or_else(|| known.describe().to_owned()),
            }),
        )
    }
}
