//! AXES13: the axes of a platform's own frame: x forward, y left, z up.

use nalgebra::Vector3;

use crate::analysis::axes::bases::{Axis, Base, Bases, Limits, Seen};
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

fn judge_seen(base: &Base, subject: String, seen: &Seen, limits: &Limits, out: &mut Judge) {
    let measured = [
        Measured::new("agreement on the way forward", seen.concentration, "1").limit(limits.min_concentration),
        Measured::new("way", seen.way_m, "m").limit(limits.min_way_m),
    ];
    let Some(up) = seen.up else {
        return out.too_little(subject, "by its pose, no axis of it points up steadily");
    };
    let says = |word: &str| base.frame.has_token(word);
    if says("frd") || says("ned") {
        return out.not_applicable(subject, "its name says that its axes are others");
    }
    if seen.is_turned() {
        return out.fail(turned(base, subject, seen, up).measured(measured));
    }
    if let Some((axis, sensor)) = seen.gravity.as_ref().filter(|(axis, _)| *axis != up) {
        let why = format!(
            "{} points up by the pose, {} by gravity ({sensor}): the frame that the pose is expressed in, or the sensor, is turned",
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
            "the pose turns against the gyro of {sensor}: all of the pose is expressed in NED/FRD, or the gyro is wrong"
        );
        return out.not_applicable(subject, why);
    }
    match seen.forward {
        Some(forward) if forward.index == 0 && !forward.is_negative => out.pass(subject, measured),
        Some(_) if seen.is_backward() => {
            let message = format!(
                "`{}` goes backwards all the way ({:.0} m along -x): a drive in reverse, or its x axis points to the rear",
                base.frame, seen.way_m
            );
            let finding = Finding::note(subject, message, base.place.clone()).hint();
            let finding = finding.help(
                "x points forward (REP-103): turn the base frame by 180 deg about z if this was no drive in reverse",
            );
            out.fail(finding.measured(measured));
        }
        Some(forward) => {
            let why = format!(
                "by its pose it goes along {}, by its velocity it does not",
                forward.word()
            );
            out.not_applicable(subject, why);
        }
        None => {
            let why = format!(
                "it goes in several directions, or aslant to its axes (agreement {:.2}): no front shows",
                seen.concentration
            );
            out.too_little(subject, why);
        }
    }
}

/// A base that is turned itself.
fn turned(base: &Base, subject: String, seen: &Seen, up: Axis) -> Finding {
    let spelled = seen.forward.and_then(|forward| spelled(forward, up));
    let frame = &base.frame;
    let axes = spelled.as_ref().map_or_else(
        || format!("{} points up", up.word()),
        |letters| format!("its axes point {}", words(letters)),
    );
    let says = if seen.forward.is_some() {
        "pose and motion"
    } else {
        "the pose"
    };
    let because = match &seen.gravity {
        Some((axis, sensor)) if *axis != up => {
            format!(
                "by {says} of {}, where {sensor} on it has z up, and the pose turns against its gyro",
                base.stream
            )
        }
        Some((_, sensor)) => format!("{says} of {} and gravity by {sensor} say so", base.stream),
        None => format!("pose and motion of {} say so", base.stream),
    };
    let doubt = if seen.is_upside_down() && seen.gravity.is_none() {
        if seen.is_up_reordered {
            "; or the frame that the pose is expressed in has z down; or the four numbers of the orientation stand as w, x, y, z"
        } else {
            "; or the frame that the pose is expressed in has z down"
        }
    } else if !seen.is_upside_down() && seen.twist_agrees.is_none() {
        "; or the orientation counts its yaw from another direction than the position"
    } else {
        ""
    };
    let message = format!("`{frame}` is not x forward, y left, z up: {axes} ({because}){doubt}");
    let known = match spelled.as_deref() {
        Some("FRD") => "FRD is the aerospace order (also SAE J670e; as right-handed as FLU): ",
        Some("RFU") => "RFU is the body frame of many inertial navigation systems: ",
        Some("RDF") => "RDF is the order of a camera's optical frame: ",
        _ => "",
    };
    let finding = if doubt.is_empty() {
        Finding::error(subject, message, base.place.clone())
    } else {
        Finding::warning(subject, message, base.place.clone())
    };
    let finding = finding.likely().help(format!(
        "{known}REP-103 wants x forward, y left, z up. Keep the other one as a child frame of its own name (`{frame}_frd`), and publish \
         the pose of `{frame}` as `world_from_{frame} = world_from_now * now_from_flu`"
    ));
    match spelled {
        Some(letters) => finding.relation(letters.to_lowercase()),
        None => finding,
    }
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

fn words(letters: &str) -> String {
    let word = |letter: char| match letter {
        'F' => "forward",
        'B' => "backward",
        'L' => "left",
        'R' => "right",
        'U' => "up",
        _ => "down",
    };
    let told: Vec<String> = ["x", "y", "z"]
        .iter()
        .zip(letters.chars())
        .map(|(axis, letter)| format!("{axis} {}", word(letter)))
        .collect();
    told.join(", ")
}
