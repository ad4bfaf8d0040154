//! CAMERA01: where cameras look, and which way up, by their optical frames.

use nalgebra::Vector3;
use serde::Deserialize;

use crate::rules::motion::mount;
use crate::rules::name::optical_suffix;
use crate::rules::{Judge, Need, Rule, names, places};
use crate::verdict::{Finding, Measured, NotEvaluated};
use crate::world::{FrameId, World};

use super::{VERTICAL, Ways, lidar_in_view, looks_against_its_name};

/// CAMERA01.
pub struct OpticalRotation;

/// Limits of CAMERA01.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Limits {
    max_pitch_deg: f64,
    min_down: f64,
}

impl Rule for OpticalRotation {
    const PAGE: &'static str = include_str!("../../../rules/camera/optical-rotation.md");
    const NEEDS: &'static [Need] = &[Need::RobotOrTf];
    type Limits = Limits;

    fn judge(world: &World, limits: &Limits, out: &mut Judge) {
        for frame in &world.graph().frames {
            if names::optical_stem(frame).is_some() {
                judge_frame(world, frame, limits, out);
            }
        }
    }
}

fn judge_frame(world: &World, frame: &FrameId, limits: &Limits, out: &mut Judge) {
    let subject = format!("view of `{frame}`");
    if optical_suffix::reports(world, frame) {
        let why = "its axes are not the optical ones of its camera, as NAME06 reports";
        return out.not_evaluated(subject, NotEvaluated::NotApplicable, why);
    }
    if lidar_in_view::reports(world, frame) {
        let why = "CAMERA05 reports what is wrong with it, by what a lidar sees";
        return out.not_evaluated(subject, NotEvaluated::NotApplicable, why);
    }
    let Some(mount) = mount(world, frame) else {
        let why = "no rigid chain of transforms leads to a base";
        return out.not_evaluated(subject, NotEvaluated::MissingInput, why);
    };
    let turned = mount.base_from_sensor.rotation;
    let pitch_deg = (turned * Vector3::z()).z.clamp(-1.0, 1.0).asin().to_degrees();
    let down = -(turned * Vector3::y()).z;
    let measured = [
        Measured::new("angle of the view over the horizon", pitch_deg, "deg").limit(limits.max_pitch_deg),
        Measured::new("cosine of the image's down from down", down, "1").limit(limits.min_down),
    ];
    let Some(place) = world
        .graph()
        .edges_to(frame)
        .find_map(|edge| places::of_numbers(world, edge))
        .or_else(|| places::first(world, frame))
    else {
        return;
    };
    if pitch_deg.abs() > limits.max_pitch_deg {
        if names::has_word(frame, VERTICAL) {
            let why = format!("it looks {pitch_deg:.0} deg over the horizon, and its name says that it may");
            return out.not_evaluated(subject, NotEvaluated::NotApplicable, why);
        }
        let message = format!(
            "`{frame}` looks {} in `{}`: its z axis is {:.0} deg {} the horizon",
            if pitch_deg > 0.0 { "up" } else { "down" },
            mount.base,
            pitch_deg.abs(),
            if pitch_deg > 0.0 { "over" } else { "under" }
        );
        let finding = Finding::warning(subject, message, place)
            .likely()
            .relation(if pitch_deg > 0.0 { "looks-up" } else { "looks-down" })
            .help("an optical frame has z forward, x right, y down (REP-103); say `up` or `down` in the name of a camera that looks there");
        return out.fail(measured.into_iter().fold(finding, Finding::measured));
    }
    if down < -limits.min_down {
        let message = format!(
            "`{frame}` is upside down in `{}`: its y axis, the image's down, points up",
            mount.base
        );
        let finding = Finding::warning(subject, message, place)
            .hint()
            .relation("upside-down")
            .help("right for a camera that hangs on its head and whose images are not turned; else turn the frame by 180 deg about its z");
        return out.fail(measured.into_iter().fold(finding, Finding::measured));
    }
    let looks = turned * Vector3::z();
    if looks_against_its_name(frame, &looks) == Ways::Against {
        let message = format!(
            "`{frame}` looks {} in `{}`, and its name says the opposite: its z axis points {:.0} deg from x",
            if looks.x > 0.0 { "ahead" } else { "back" },
            mount.base,
            looks.angle(&Vector3::x()).to_degrees()
        );
        let finding = Finding::warning(subject, message, place)
            .likely()
            .relation("reversed")
            .help("z is the direction of view (REP-103): RPY(-pi/2, 0, -pi/2) from a link with x forward, not RPY(-pi/2, 0, pi/2)");
        return out.fail(measured.into_iter().fold(finding, Finding::measured));
    }
    out.pass(subject, measured);
}
