//! NAME04: frames named north-east-down (or east-north-up, north-west-up) that have other axes.

use std::collections::BTreeSet;

use nalgebra::{Isometry3, Vector3};

use crate::analysis::suffix::{found, known_turn, off_deg, place_of, relation_to, siblings};
use crate::analysis::{names, promised::Axes};
use crate::math::relation::Relation;
use crate::rules::prelude::*;
use crate::world::{FrameId, World};

pub(crate) struct NedSuffix;

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Limits {
    /// Deviation from the rotation that the name promises, degrees.
    pub max_deg: f64,
}

impl Rule for NedSuffix {
    const NEEDS: &'static [Need] = &[Need::RobotTfOrLaunch];
    type Limits = Limits;

    fn judge(world: &Estimates, limits: &Limits, out: &mut Judge) {
        let frames: BTreeSet<&FrameId> = world.graphs().flat_map(|graph| &graph.frames).collect();
        for frame in frames {
            let Some(axes) = Axes::of(frame) else { continue };
            let subject = format!("frame `{frame}`");
            let instead = (axes != Axes::Enu).then_some("enu");
            let known = siblings(world, frame, axes.word(), instead)
                .into_iter()
                .find_map(|sibling| Some((sibling, relation_to(world, sibling, frame)?)));
            match known {
                None => {
                    let why = format!("no transform to a frame of the same name without `{}`", axes.word());
                    out.too_little(subject, why);
                }
                Some((sibling, sibling_from_frame)) => {
                    judge_pair(world, (frame, axes), sibling, &sibling_from_frame, limits, out);
                }
            }
        }
    }
}

fn judge_pair(
    world: &World,
    (frame, axes): (&FrameId, Axes),
    sibling: &FrameId,
    sibling_from_frame: &Isometry3<f64>,
    limits: &Limits,
    out: &mut Judge,
) {
    let seen = sibling_from_frame.rotation;
    let deg = axes
        .expected(names::is_world(frame))
        .iter()
        .map(|expected| off_deg(*expected, &seen))
        .fold(f64::INFINITY, f64::min);
    let subject = format!("frame `{frame}`");
    let word = axes.word().to_uppercase();
    let off = Measured::new(format!("rotation from {word} axes"), deg, "deg")
        .turn()
        .limit(limits.max_deg);
    if deg <= limits.max_deg {
        return out.pass(subject, [off]);
    }
    let relation = known_turn(&seen, limits.max_deg);
    let Some(place) = place_of(world, frame) else {
        return;
    };
    let is_down = axes == Axes::Ned;
    let up = if is_down { -Vector3::z() } else { Vector3::z() };
    let has_right_vertical = (seen * Vector3::z()).dot(&up) >= limits.max_deg.to_radians().cos();
    let (set, of_sibling) = match axes {
        Axes::Ned if names::is_world(frame) => ("set rpy = (pi, 0, pi/2) on", "east-north-up"),
        Axes::Ned => ("set rpy = (pi, 0, 0) on", "forward-left-up"),
        Axes::Enu => ("remove the rotation of", "east-north-up"),
        Axes::Nwu => ("set rpy = (0, 0, pi/2) on", "east-north-up"),
    };
    let message = format!("`{frame}` does not have {word} axes: {deg:.1} deg off, if `{sibling}` is {of_sibling}");
    let renamed = match relation {
        Some(Relation::FluFrd) if is_down => {
            format!("; if forward-right-down is meant, write `frd` for `ned` in the name `{frame}`")
        }
        _ => format!("; otherwise rename `{frame}`"),
    };
    let finding = match relation {
        // A free heading with the right vertical may be a local grid, which may be intended.
        None if has_right_vertical => Finding::warning(subject, message, place).likely(),
        _ => Finding::error(subject, message, place),
    };
    let help = format!(
        "if {word} is meant, {set} `{sibling}` -> `{frame}`, since `{sibling}` is {of_sibling} (REP-103){renamed}"
    );
    let finding = finding.measured(off).help(help);
    out.fail(match relation {
        Some(relation) => finding
            .detail(found(relation, sibling, frame))
            .relation(relation.word()),
        None => finding,
    });
}
