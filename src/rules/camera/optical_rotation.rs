//! CAMERA01: where cameras look, and whether they are upright, by their optical frames.

mod axes;

use std::cell::LazyCell;

use nalgebra::Vector3;

use crate::analysis::camera::published::{NameAgreement, VERTICAL, looks_against_its_name};
use crate::analysis::motion::mount::{Mounts, flu_from_base};
use crate::analysis::name::optical::is_turned_from_its_link;
use crate::analysis::{names, places};
use crate::rules::prelude::*;
use crate::world::FrameId;

pub(crate) struct OpticalRotation;

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Limits {
    max_pitch_deg: f64,
    min_down: f64,
    pure_pitch_deg: f64,
}

impl Rule for OpticalRotation {
    const NEEDS: &'static [Need] = &[Need::RobotOrTf];
    type Limits = Limits;

    fn judge(world: &Estimates, limits: &Limits, out: &mut Judge) {
        let mounts = LazyCell::new(|| Mounts::of(world));
        for frame in &world.graph().frames {
            if names::optical_stem(frame).is_some() {
                judge_frame(world, (frame, &mounts), limits, out);
            }
        }
    }
}

fn judge_frame(world: &Estimates, (frame, mounts): (&FrameId, &Mounts), limits: &Limits, out: &mut Judge) {
    let subject = format!("view of `{frame}`");
    let Some(mount) = mounts.get(frame) else {
        let why = "no rigid chain of transforms connects it with a base: add the robot description or /tf_static";
        return out.missing(subject, why);
    };
    let base = &mount.base;
    let turned = flu_from_base(world, base) * mount.base_from_sensor.rotation;
    let pitch_deg = (turned * Vector3::z()).z.clamp(-1.0, 1.0).asin().to_degrees();
    let down = -(turned * Vector3::y()).z;
    let pitch =
        Measured::new("angle of the optical axis (z) above the horizon", pitch_deg, "deg").limit(limits.max_pitch_deg);
    let upright = Measured::new("cosine between y (down in the image) and down", down, "1").at_least(limits.min_down);
    let mut edges = world.graph().edges_to(frame);
    let stated = edges.find_map(|edge| places::of_numbers(world, edge));
    let Some(place) = stated.or_else(|| places::first(world, frame)) else {
        return;
    };
    // NAME06 (axes that are not optical) and CAMERA05 (what the lidar sees) report it better.
    let better = |finding: Finding| {
        let about = format!("`{frame}`");
        let finding = finding.unless_about(codes::NAME06, about.as_str());
        finding.unless_about(codes::CAMERA05, about)
    };
    if pitch_deg.abs() > limits.max_pitch_deg {
        if names::has_word(frame, VERTICAL) {
            let why = format!("it looks {pitch_deg:.0} deg over the horizon, as its name allows");
            return out.not_applicable(subject, why);
        }
        let (side, word, relation, turn) = if pitch_deg > 0.0 {
            let turn = format!(
                "if the frame has the axes of a link (x forward, z up), rotate the frame by RPY(-pi/2, 0, -pi/2), which gives {}",
                axes::as_optical(&mount)
            );
            ("above", "up", "looks-up", turn)
        } else {
            let turn = "if the camera does not look down, rotate the frame: z forward, x right, y down (REP-103)";
            ("below", "down", "looks-down", turn.to_owned())
        };
        let message = format!(
            "`{frame}`: the optical axis (z) points {:.0} deg {side} the horizon of `{base}`",
            pitch_deg.abs()
        );
        let finding = Finding::warning(subject, message, place).likely().relation(relation);
        let finding = if is_turned_from_its_link(world, frame) && axes::is_pitched(&turned, limits) {
            let name = format!("if the camera looks {word}, add `{word}` to the name of the frame");
            let detail = "It has the optical rotation from its link, and the link is pitched by 90 deg.";
            finding.hint().detail(detail).help(name)
        } else {
            finding.help(format!(
                "compare the frame with the camera:\n(1) {turn}\n(2) if the camera looks {word}, add `{word}` to the name of the frame"
            ))
        };
        return out.fail(better(finding.measured(pitch)));
    }
    if down < -limits.min_down {
        let message = format!("`{frame}` is upside down in `{base}`: y (down in the image) points up");
        let finding = Finding::warning(subject, message, place)
            .hint()
            .relation("upside-down")
            .help("if the camera is mounted upright, or its driver rotates the images, rotate the frame by 180 deg about z of the frame");
        return out.fail(better(finding.measured([upright, pitch])));
    }
    let looks = turned * Vector3::z();
    if looks_against_its_name(frame, &looks) == NameAgreement::Against {
        let message = format!(
            "`{frame}` looks {} in `{base}`, against its name: the optical axis (z) is {:.0} deg from x",
            if looks.x > 0.0 { "ahead" } else { "back" },
            looks.angle(&Vector3::x()).to_degrees()
        );
        let finding = Finding::warning(subject, message, place)
            .likely()
            .relation("reversed")
            .help("use RPY(-pi/2, 0, -pi/2) from a link with x forward, not RPY(-pi/2, 0, pi/2): z is the direction of view (REP-103)");
        return out.fail(better(finding.measured([pitch, upright])));
    }
    out.pass(subject, [pitch, upright]);
}
