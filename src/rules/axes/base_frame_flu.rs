//! AXES13: the axes of a platform's own frame: x forward, y left, z up.

use nalgebra::{Matrix3, Rotation3, UnitQuaternion, Vector3};

use crate::analysis::axes::bases::{Axis, Base, BaseEstimate, Bases, Limits};
use crate::analysis::suffix::axes_in_words;
use crate::math::rotation::rpy_in_words;
use crate::rules::prelude::*;

pub(crate) struct BaseFrameFlu;

impl Rule for BaseFrameFlu {
    const NEEDS: &'static [Need] = &[Need::Bag];
    type Limits = Limits;

    fn judge(world: &Estimates, limits: &Limits, out: &mut Judge) {
        for base in Bases::of(world).bags.iter().flatten() {
            let subject = format!("axes of `{}`, by {}", base.frame, base.stream);
            match &base.seen {
                Ok(seen) => judge_seen(base, subject, seen, limits, out),
                Err((why, reason)) => out.not_evaluated(subject, *why, reason),
            }
        }
    }
}

fn judge_seen(base: &Base, subject: String, seen: &BaseEstimate, limits: &Limits, out: &mut Judge) {
    let measured = [
        Measured::new(
            "steadiness of the direction of motion in the axes of the base (1: always the same)",
            seen.concentration,
            "1",
        )
        .at_least(limits.min_concentration),
        Measured::new("distance driven", seen.way_m, "m").at_least(limits.min_way_m),
    ];
    let Some(up) = seen.up else {
        return out.too_little(subject, "no axis of it points up steadily by its pose");
    };
    let says = |word: &str| base.frame.has_token(word);
    if says("frd") || says("ned") {
        return out.not_applicable(subject, "its name declares other axes (frd or ned)");
    }
    if seen.is_turned() {
        return out.fail(turned(base, subject, seen, up).measured(measured));
    }
    if let Some((axis, sensor)) = seen.gravity.as_ref().filter(|(axis, _)| *axis != up) {
        let why = format!(
            "{} points up by the pose, {} by gravity ({sensor}): the frame that the pose is expressed in, or the sensor, is rotated",
            up.word(),
            axis.word()
        );
        return out.not_applicable(subject, why);
    }
    if up.index != 2 {
        let why = format!(
            "{} points along z of the frame that the pose is expressed in: that frame is not level",
            up.word()
        );
        return out.not_applicable(subject, why);
    }
    if let Some(sensor) = &seen.against {
        let why = format!(
            "the pose rotates opposite to the gyro of {sensor}: the whole pose is expressed in NED/FRD, or the gyro is wrong"
        );
        return out.not_applicable(subject, why);
    }
    match seen.forward {
        Some(forward) if forward.index == 0 && !forward.is_negative => out.pass(subject, measured),
        Some(_) if seen.is_backward() => {
            let message = format!("`{}` moves backwards ({:.0} m along -x)", base.frame, seen.way_m);
            let finding = Finding::note(subject, message, base.place.clone())
                .hint()
                .detail(format!(
                    "Either the platform drove in reverse, or x of `{}` points to the rear.",
                    base.frame
                ));
            let finding = finding.help(format!(
                "if the platform drove forward, rotate `{}` by 180 deg about z, so that x points forward (REP-103); if not, change nothing",
                base.frame
            ));
            out.fail(finding.measured(measured));
        }
        Some(forward) => {
            let why = format!("its pose moves along {}, its velocity does not", forward.word());
            out.not_applicable(subject, why);
        }
        None => {
            let why = format!(
                "it moves in several directions, or obliquely to its axes (agreement {:.2}), so no axis is forward",
                seen.concentration
            );
            out.too_little(subject, why);
        }
    }
}

/// A base with other axes than FLU.
fn turned(base: &Base, subject: String, seen: &BaseEstimate, up: Axis) -> Finding {
    let spelled = seen.forward.and_then(|forward| spelled(forward, up));
    let frame = &base.frame;
    let axes = spelled.as_ref().map_or_else(
        || format!("{} points up", up.word()),
        |letters| format!("its axes are {}", axes_in_words(letters)),
    );
    let says = if seen.forward.is_some() {
        "pose and motion"
    } else {
        "the pose"
    };
    let because = match &seen.gravity {
        Some((axis, sensor)) if *axis != up => {
            format!(
                "Shown by {says} of {}. Gravity of {sensor} shows {} of `{frame}` up, but the pose shows {} up, and rotates opposite to that gyro. Leave \
                 {sensor} as it is.",
                base.stream,
                axis.word(),
                up.word()
            )
        }
        Some((_, sensor)) => format!("Shown by {says} of {} and by gravity of {sensor}.", base.stream),
        None => format!("Shown by {says} of {}.", base.stream),
    };
    // What else explains it, and what to do then.
    let (doubt, else_do) = if seen.is_upside_down() && seen.gravity.is_none() {
        if seen.is_up_reordered {
            (
                " Alternatively, the frame that the pose is expressed in may have z down, or the quaternion may be in the order w, x, y, z.",
                "find the cause that applies, then:\n(1) if the frame that the pose is expressed in has z down, publish the pose in a frame with z up\n\
                 (2) if the quaternion is in the order w, x, y, z, publish the quaternion as x, y, z, w\n(3) otherwise ",
            )
        } else {
            (
                " Alternatively, the frame that the pose is expressed in may have z down.",
                "find the cause that applies, then:\n(1) if the frame that the pose is expressed in has z down, publish the pose in a frame with z up\n(2) otherwise ",
            )
        }
    } else if !seen.is_upside_down() && seen.twist_agrees.is_none() {
        (
            " Alternatively, the yaw of the orientation may count from another direction than x of the position.",
            "find the cause that applies, then:\n(1) if the yaw of the orientation does not count from x of the position, correct the yaw\n(2) otherwise ",
        )
    } else {
        ("", "")
    };
    let message = format!("`{frame}` is not x forward, y left, z up: {axes}");
    let known = match spelled.as_deref() {
        Some("FRD") => " FRD is the convention of aerospace and of SAE J670.",
        Some("RFU") => " RFU is the body frame of many inertial navigation systems.",
        Some("RDF") => " RDF is the convention of a camera's optical frame.",
        _ => "",
    };
    let finding = if doubt.is_empty() {
        Finding::error(subject, message, base.place.clone())
    } else {
        Finding::warning(subject, message, base.place.clone())
    };
    let finding = finding
        .likely()
        .detail(format!("{because}{doubt}{known}"))
        .unless(codes::CROSS08);
    let (Some(letters), Some(forward)) = (spelled, seen.forward) else {
        return finding.help(format!(
            "{else_do}publish `{frame}` with x forward, y left, z up (REP-103), twist and covariances too; keep the present axes as a \
             child frame with a name of its own, and let it be the parent of the sensors"
        ));
    };
    let present_from_flu = present_from_flu(forward, up);
    let (to_flu, back) = (
        rpy_in_words(&present_from_flu),
        rpy_in_words(&present_from_flu.inverse()),
    );
    let word = letters.to_lowercase();
    let size = Measured::new(
        "rotation from x forward, y left, z up",
        present_from_flu.angle().to_degrees(),
        "deg",
    );
    finding
        .relation(word.as_str())
        .measured(size.expected(0.0))
        .help(format!(
            "{else_do}publish `{frame}` with x forward, y left, z up (REP-103): multiply the orientation of the pose by {to_flu} from the \
             right, and rotate twist and covariances into the new axes. Publish `{frame}` -> `{frame}_{word}` with {back}, and move what was \
             measured in the present axes below `{frame}_{word}`: the parent of a sensor's transform, or `frame_id` of data in `{frame}`"
        ))
}

/// The rotation from axes that are forward, left, up to the present ones.
fn present_from_flu(forward: Axis, up: Axis) -> UnitQuaternion<f64> {
    let (forward, up) = (forward.vector(), up.vector());
    let columns = Matrix3::from_columns(&[forward, up.cross(&forward), up]);
    UnitQuaternion::from_rotation_matrix(&Rotation3::from_matrix_unchecked(columns))
}

/// Where x, y and z point, as letters: `FLU`, `FRD`, `RFU`. `None` where forward and up lie along one axis.
fn spelled(forward: Axis, up: Axis) -> Option<String> {
    let left = up.vector().cross(&forward.vector());
    (left.norm() > 0.5).then(|| {
        let letter = |axis: Vector3<f64>| {
            let [f, l, u] = [forward.vector(), left, up.vector()].map(|direction| axis.dot(&direction).round());
            match (f, l, u) {
                (1.0, ..) => 'F',
                (-1.0, ..) => 'B',
                (_, 1.0, _) => 'L',
                (_, -1.0, _) => 'R',
                (.., 1.0) => 'U',
                _ => 'D',
            }
        };
        [Vector3::x(), Vector3::y(), Vector3::z()].map(letter).iter().collect()
    })
}
