//! CAMERA01: where cameras look, and whether they are upright, by their optical frames.

use std::cell::LazyCell;

use nalgebra::Vector3;

use crate::analysis::camera::published::{NameAgreement, VERTICAL, looks_against_its_name};
use crate::analysis::{motion::mount::Mounts, names};
use crate::rules::prelude::*;
use crate::world::FrameId;

pub(crate) struct OpticalRotation;

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Limits {
    max_pitch_deg: f64,
    min_down: f64,
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
        return out.missing(
            subject,
            "no rigid chain of transforms connects it with a base: add the robot description or /tf_static",
        );
    };
    let turned = mount.base_from_sensor.rotation;
    let pitch_deg = (turned * Vector3::z()).z.clamp(-1.0, 1.0).asin().to_degrees();
    let down = -(turned * Vector3::y()).z;
    let measured = [
        Measured::new("pitch of the view over the horizon", pitch_deg, "deg").limit(limits.max_pitch_deg),
        Measured::new("cosine between the image's down and the base's down", down, "1").at_least(limits.min_down),
    ];
    let Some(place) = world
        .graph()
        .edges_to(frame)
        .find_map(|edge| crate::analysis::places::of_numbers(world, edge))
        .or_else(|| crate::analysis::places::first(world, frame))
    else {
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
        let message = format!(
            "`{frame}` looks {} in `{}`: its z axis is {:.0} deg {} the horizon",
            if pitch_deg > 0.0 { "up" } else { "down" },
            mount.base,
            pitch_deg.abs(),
            if pitch_deg > 0.0 { "above" } else { "below" }
        );
        let finding = Finding::warning(subject, message, place)
            .likely()
            .relation(if pitch_deg > 0.0 { "looks-up" } else { "looks-down" })
            .help("rotate the frame: z forward, x right, y down (REP-103); if the camera really looks there, add `up` or `down` to its name");
        return out.fail(better(finding.measured(measured)));
    }
    if down < -limits.min_down {
        let message = format!(
            "`{frame}` is upside down in `{}`: its y axis (down in the image) points up",
            mount.base
        );
        let finding = Finding::warning(subject, message, place)
            .hint()
            .relation("upside-down")
            .help("rotate the frame by 180 deg about its z, unless the camera is mounted upside down and its images are not rotated");
        return out.fail(better(finding.measured(measured)));
    }
    let looks = turned * Vector3::z();
    if looks_against_its_name(frame, &looks) == NameAgreement::Against {
        let message = format!(
            "`{frame}` looks {} in `{}`, against its name: its z axis is {:.0} deg from x",
            if looks.x > 0.0 { "ahead" } else { "back" },
            mount.base,
            looks.angle(&Vector3::x()).to_degrees()
        );
        let finding = Finding::warning(subject, message, place)
            .likely()
            .relation("reversed")
            .help("use RPY(-pi/2, 0, -pi/2) from a link with x forward, not RPY(-pi/2, 0, pi/2): z is the direction of view (REP-103)");
        return out.fail(better(finding.measured(measured)));
    }
    out.pass(subject, measured);
}
