//! NAME07: images and camera calibrations whose frame is not the camera's optical one.

use crate::analysis::name::cameras::{Camera, cameras, optical_beside, up};
use crate::analysis::name::image_frame::{Limits, UPWARD_WORDS};
use crate::analysis::names::has_word;
use crate::rules::prelude::*;
use crate::world::{BagEvidence, FrameId, World};

pub(crate) struct ImageFrameNotOptical;

impl Rule for ImageFrameNotOptical {
    const NEEDS: &'static [Need] = &[Need::Bag];
    type Limits = Limits;

    fn judge(world: &Estimates, limits: &Limits, out: &mut Judge) {
        for bag in &world.bags {
            for (frame, camera) in cameras(bag) {
                judge_camera(world, bag, &frame, &camera, limits, out);
            }
        }
    }
}

fn judge_camera(world: &World, bag: &BagEvidence, frame: &FrameId, camera: &Camera, limits: &Limits, out: &mut Judge) {
    let subject = format!("camera frame `{frame}` of {}", world.path(bag.source));
    let messages = Measured::new("images with this frame", camera.count as f64, "count").samples(camera.count);
    if frame.has_token("optical") {
        return out.pass(subject, [messages]);
    }
    if !camera.is_camera(frame) {
        let reason = "no camera calibration has this frame, and its name is not a camera's: lidars publish images too";
        return out.not_applicable(subject, reason);
    }
    let place = Place::message(bag.source, camera.first.clone());
    let help =
        "publish an optical frame, rpy = (-pi/2, 0, -pi/2) from the camera's link, and set it as the driver's frame_id";
    let why =
        "Images are expressed in the camera's optical frame: z forward, x right, y down (REP-103, CameraInfo.msg).";
    if let Some((optical, stated)) = optical_beside(world, frame, limits.optical_deg) {
        let message = format!(
            "`{}` has frame_id `{frame}` instead of the camera's optical frame `{optical}`",
            camera.topic
        );
        let finding = Finding::error(subject, message, place)
            .detail(format!("The x axis of `{frame}` points forward. {why}"))
            .help(format!("set the driver's frame_id to `{optical}`"))
            .measured(messages)
            .relation("optical");
        return out.fail(match stated {
            Some(stated) => finding.related(stated, "the optical frame"),
            None => finding,
        });
    }
    let Some((base, z_up)) = up(world, frame) else {
        let message = format!(
            "`{}`: the name of frame `{frame}` does not say optical, and no transform shows its axes",
            camera.topic
        );
        let finding = Finding::note(subject, message, place).hint().measured(messages);
        return out.fail(finding.help(
            "if its z axis points forward, rename it to `..._optical_frame`; otherwise publish an optical frame, and use that",
        ));
    };
    let measured = Measured::new("vertical component of z", z_up, "1").at_least(limits.min_up);
    if z_up > limits.min_up && !has_word(frame, UPWARD_WORDS) {
        let message = format!(
            "`{}`: z of `{frame}` points up in `{base}`, so it is not an optical frame",
            camera.topic
        );
        let finding = Finding::error(subject, message, place)
            .likely()
            .relation("optical")
            .detail(why)
            .help(help);
        out.fail(finding.measured(measured).measured(messages));
    } else if z_up.abs() > limits.min_up {
        out.too_little(
            subject,
            "its z axis is vertical, and the camera may look straight up or down",
        );
    } else {
        out.pass(subject, [measured, messages]);
    }
}
