//! The conditions on rotation: often enough, and about two axes.

use nalgebra::{UnitQuaternion, Vector3};

use crate::math::excitation::{BodyRotation, Excitation, LEAST, LEAST_OFF, LEAST_RAD, OFF_RAD};
use crate::verdict::Measured;
use crate::world::BagEvidence;

use super::Condition;
use super::conditions::axis_words;

/// The body that rotates, for reports.
pub(super) struct Body {
    /// Its frame in words.
    pub(super) frame: String,
    /// `frame_from_stream`: rotates the axes of the rotations to those of the frame.
    pub(super) from_stream: UnitQuaternion<f64>,
}

/// Whether rotations show a mounting; `record` is how to move. What they cannot show is named with its direction.
pub(super) fn conditions(bag: &BagEvidence, rotations: &[BodyRotation], body: &Body, record: &str) -> [Condition; 2] {
    let of = rotations.iter().map(|rotation| body.from_stream * rotation.vector);
    let found = Excitation::of(of.collect::<Vec<Vector3<f64>>>());
    let count = found.as_ref().map_or(0, Excitation::count);
    let enough = Condition::judged(
        "rotations",
        format!("{LEAST} rotations by {:.0} deg or more", LEAST_RAD.to_degrees()),
        count >= LEAST,
    )
    .measured(Measured::count("rotations", count).at_least(LEAST as f64))
    .because(match count {
        0 => "it hardly rotates: this motion cannot show where the sensors are to each other".to_owned(),
        _ => format!("only {count} rotations"),
    })
    .record(record)
    .unless_partly_read(bag);
    let (name, asks) = (
        "two axes",
        format!(
            "{LEAST_OFF} of the rotations about axes that differ from the main one by {:.0} deg or more",
            OFF_RAD.to_degrees()
        ),
    );
    let Some(found) = found.filter(|_| count >= LEAST) else {
        let why = "too few rotations to compare their axes";
        return [enough, Condition::open(name, asks, why).record(record)];
    };
    let (off, axis) = (found.off_axis(OFF_RAD), axis_words(&found.main_axis(), &body.frame));
    let mut measured = vec![
        Measured::count("rotations about another axis", off)
            .at_least(LEAST_OFF as f64)
            .samples(count as u64),
    ];
    let errors = [
        (
            "error of the mounting's rotation for 1 deg of noise in each rotation",
            "deg",
            &found.rotation,
        ),
        (
            "error of the lever arm for 1 m of noise in each motion",
            "m",
            &found.translation,
        ),
    ];
    let known = errors
        .into_iter()
        .filter(|(.., information)| !information.is_singular());
    measured.extend(known.map(|(what, unit, information)| Measured::new(what, information.worst_error(), unit)));
    let two = Condition::judged(name, asks, off >= LEAST_OFF)
        .measured(measured)
        .because(format!(
            "{off} of {count} rotations are about another axis than {axis}: this motion cannot show a translation along {axis}, and a \
             rotation about it only by translations"
        ))
        .record(record)
        .unless_partly_read(bag);
    [enough, two]
}
