//! NAME05: frames named forward-right-down or forward-left-up that have other axes.

use nalgebra::UnitQuaternion;

use crate::analysis::promised::BodyAxes;
use crate::analysis::suffix::{found, known_turn, off_deg, place_of, relation_to, siblings};
use crate::math::relation::Relation;
use crate::rules::prelude::*;
use crate::source::Confidence;
use crate::world::{Claim, ClaimKind, FrameId, World};

pub(crate) struct FluFrdSuffix;

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Limits {
    /// Deviation from the rotation that the names promise, degrees.
    pub max_deg: f64,
}

impl Rule for FluFrdSuffix {
    const NEEDS: &'static [Need] = &[Need::Transforms];
    type Limits = Limits;

    fn judge(world: &Estimates, limits: &Limits, out: &mut Judge) {
        for frame in &world.graph().frames {
            if let Some(axes) = BodyAxes::of(frame) {
                judge_frame(world, frame, axes, limits, out);
            }
        }
        for claim in &world.claims {
            if matches!(claim.kind, ClaimKind::File { .. }) && claim.has_rotation {
                judge_claim(world, claim, limits, out);
            }
        }
    }
}

/// Two frames of one name, and the rotation between them.
struct Pair<'a> {
    subject: String,
    frame: &'a FrameId,
    axes: BodyAxes,
    other: &'a FrameId,
    other_axes: BodyAxes,
    other_from_frame: UnitQuaternion<f64>,
    reading: Confidence,
}

fn judge_frame(world: &World, frame: &FrameId, axes: BodyAxes, limits: &Limits, out: &mut Judge) {
    let subject = format!("frame `{frame}`");
    // A pair of both words is judged once, as the frame that is forward-right-down.
    let instead = (axes == BodyAxes::Frd).then_some(BodyAxes::Flu.word());
    let known = siblings(world, frame, axes.word(), instead)
        .into_iter()
        .find_map(|other| Some((other, relation_to(world, other, frame)?.rotation)));
    let Some(((other, other_from_frame), place)) = known.zip(place_of(world, frame)) else {
        let of_both =
            axes == BodyAxes::Flu && !siblings(world, frame, axes.word(), Some(BodyAxes::Frd.word())).is_empty();
        if !of_both {
            out.too_little(
                subject,
                format!("no transform to a frame of the same name without `{}`", axes.word()),
            );
        }
        return;
    };
    let other_axes = BodyAxes::of(other).unwrap_or(BodyAxes::Plain);
    let pair = Pair {
        subject,
        frame,
        axes,
        other,
        other_axes,
        other_from_frame,
        reading: Confidence::Certain,
    };
    judge_pair(&pair, place, limits, out);
}

fn judge_claim(world: &World, claim: &Claim, limits: &Limits, out: &mut Judge) {
    let Some(((target, source), pose)) = claim.frames.as_ref().zip(claim.pose.as_ref()) else {
        return;
    };
    let ((target_axes, target_stem), (source_axes, source_stem)) = (BodyAxes::split(target), BodyAxes::split(source));
    if target_stem != source_stem || target_axes == source_axes {
        return;
    }
    let rotation = pose.isometry().rotation;
    let subject = format!("{} in {}", claim.name(), world.path(claim.place.source));
    let reading = claim.reading;
    let source_is_marked = source_axes == BodyAxes::Frd || target_axes == BodyAxes::Plain;
    let pair = if source_is_marked {
        Pair {
            subject,
            frame: source,
            axes: source_axes,
            other: target,
            other_axes: target_axes,
            other_from_frame: rotation,
            reading,
        }
    } else {
        let other_from_frame = rotation.inverse();
        Pair {
            subject,
            frame: target,
            axes: target_axes,
            other: source,
            other_axes: source_axes,
            other_from_frame,
            reading,
        }
    };
    judge_pair(&pair, claim.place.clone(), limits, out);
}

fn judge_pair(pair: &Pair, place: Place, limits: &Limits, out: &mut Judge) {
    let Pair { frame, other, .. } = pair;
    let expected = pair.axes.turn(pair.other_axes);
    let deg = off_deg(expected, &pair.other_from_frame);
    let axes = pair.axes.word().to_uppercase();
    let off = Measured::new(format!("rotation from {axes} axes"), deg, "deg")
        .turn()
        .limit(limits.max_deg);
    if deg <= limits.max_deg {
        return out.pass(pair.subject.as_str(), [off]);
    }
    let relation = known_turn(&pair.other_from_frame, limits.max_deg);
    let message = format!("`{frame}` does not have {axes} axes: {deg:.1} deg off, relative to `{other}`");
    let name = match (pair.axes, relation) {
        (BodyAxes::Flu, Some(Relation::FluFrd)) => format!(" to `{}`", frame.as_str().replace("flu", "frd")),
        _ => String::new(),
    };
    let help = match expected {
        Some(_) => {
            format!("set the rotation between `{other}` and `{frame}` to rpy = (pi, 0, 0), or rename `{frame}`{name}")
        }
        None => format!(
            "correct what applies:\n(1) if `{other}` is forward-left-up (REP-103), remove the rotation between `{other}` and `{frame}`, or rename \
             `{frame}`{name}\n(2) if `{other}` is forward-right-down, rename `{other}` so that it says that"
        ),
    };
    // The frame without a suffix may have other axes, as a sensor in its mounting: only the names disagree.
    let is_open = relation.is_none() || (pair.axes == BodyAxes::Flu && relation == Some(Relation::FluFrd));
    let finding = if is_open {
        Finding::warning(pair.subject.as_str(), message, place).likely()
    } else {
        Finding::error(pair.subject.as_str(), message, place)
    };
    let mut finding = finding.confidence(pair.reading).measured(off).help(help);
    if let Some(relation) = relation {
        finding = finding.detail(found(relation, other, frame)).relation(relation.word());
    }
    out.fail(finding);
}
