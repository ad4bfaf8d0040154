//! NAME07: images and camera calibrations whose frame is not the camera's optical one.

use serde::Deserialize;

use crate::rules::names::has_word;
use crate::rules::{Judge, Need, Rule, limits_of};
use crate::source::Place;
use crate::verdict::{Finding, Measured, NotEvaluated};
use crate::world::{BagEvidence, FrameId, World};

use super::cameras::{Camera, cameras, optical_beside, up};

/// NAME07.
pub struct ImageFrameNotOptical;

/// Limits of the page.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Limits {
    /// Share of the vertical in the frame's z axis from which z is up.
    pub min_up: f64,
    /// Deviation up to which a frame beside it is its optical one, degrees.
    pub optical_deg: f64,
}

/// Words of cameras that look straight up on purpose.
const UPWARD_WORDS: &[&str] = &["up", "upward", "upwards", "ceiling", "sky", "zenith"];

impl Rule for ImageFrameNotOptical {
    const PAGE: &'static str = include_str!("../../../rules/name/image-frame-not-optical.md");
    const NEEDS: &'static [Need] = &[Need::Bag];
    type Limits = Limits;

    fn judge(world: &World, limits: &Limits, out: &mut Judge) {
        for bag in &world.bags {
            for (frame, camera) in cameras(bag) {
                judge_camera(world, bag, &frame, &camera, limits, out);
            }
        }
    }
}

/// Whether this rule says of a camera's frame that it is no optical one.
pub(crate) fn reports(world: &World, bag: &BagEvidence, frame: &FrameId) -> bool {
    let Some(limits) = limits_of::<ImageFrameNotOptical>() else {
        return false;
    };
    let is_up = || up(world, frame).is_some_and(|(_, z_up)| z_up > limits.min_up && !has_word(frame, UPWARD_WORDS));
    let of_camera = cameras(bag).get(frame).is_some_and(|camera| camera.is_camera(frame));
    of_camera && !frame.has_token("optical") && (optical_beside(world, frame, limits.optical_deg).is_some() || is_up())
}

fn judge_camera(world: &World, bag: &BagEvidence, frame: &FrameId, camera: &Camera, limits: &Limits, out: &mut Judge) {
    let subject = format!("camera frame `{frame}` of {}", world.path(bag.source));
    let messages = Measured::new("messages", camera.count as f64, "count").samples(camera.count);
    if frame.has_token("optical") {
        out.pass(subject, [messages]);
        return;
    }
    if !camera.is_camera(frame) {
        let reason =
            "no camera calibration has this frame, and it is not named like a camera's: lidars give images too";
        out.not_evaluated(subject, NotEvaluated::NotApplicable, reason);
        return;
    }
    let place = Place::message(bag.source, camera.first.clone());
    let help = "an image's frame_id is the camera's optical frame: z forward, x right, y down (REP-103, CameraInfo.msg); \
                publish one, rpy = (-pi/2, 0, -pi/2) from the camera's link, and name it in the driver";
    if let Some((optical, stated)) = optical_beside(world, frame, limits.optical_deg) {
        let message = format!(
            "{} is in `{frame}`, whose x axis looks ahead: the camera's optical frame is `{optical}`",
            camera.topic
        );
        let finding = Finding::error(subject, message, place)
            .help(help)
            .measured(messages)
            .relation("optical");
        out.fail(match stated {
            Some(stated) => finding.related(stated, "the optical frame"),
            None => finding,
        });
        return;
    }
    let Some((base, z_up)) = up(world, frame) else {
        let message = format!(
            "`{frame}`, the frame of {}, does not say that it is an optical frame, and no transform tells how it is turned",
            camera.topic
        );
        let finding = Finding::note(subject, message, place).hint().measured(messages);
        out.fail(
            finding
                .help("call it `..._optical_frame` if its z axis looks ahead; publish an optical frame if it does not"),
        );
        return;
    };
    let measured = Measured::new("share of the vertical in z", z_up, "1").limit(limits.min_up);
    if z_up > limits.min_up && !has_word(frame, UPWARD_WORDS) {
        let message = format!(
            "`{frame}`, the frame of {}, has its z axis up in `{base}`: it is no optical frame, whose z axis looks ahead",
            camera.topic
        );
        let finding = Finding::error(subject, message, place)
            .likely()
            .relation("optical")
            .help(help);
        out.fail(finding.measured(measured).measured(messages));
    } else if z_up.abs() > limits.min_up {
        let reason = "its z axis is vertical, and the camera may look straight up or down";
        out.not_evaluated(subject, NotEvaluated::TooLittleEvidence, reason);
    } else {
        out.pass(subject, [measured, messages]);
    }
}
