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
    let messages = Measured::new("messages", camera.count as f64, "count").samples(camera.count);
    if frame.has_token("optical") {
        return out.pass(subject, [messages]);
    }
    if !camera.is_camera(frame) {
        let reason =
            "no camera calibration has this frame, and it is not named like a camera's: lidars give images too";
        return out.not_applicable(subject, reason);
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
        return out.fail(match stated {
            Some(stated) => finding.related(stated, "the optical frame"),
            None => finding,
        });
    }
    let Some((base, z_up)) = up(world, frame) else {
        let message = format!(
            "`{frame}`, the frame of {}, does not say that it is an optical frame, and no transform tells how it is turned",
            camera.topic
        );
        let finding = Finding::note(subject, message, place).hint().measured(messages);
        return out.fail(
            finding
                .help("call it `..._optical_frame` if its z axis looks ahead; publish an optical frame if it does not"),
        );
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
        out.too_little(subject, "its z axis is vertical, and the camera may look straight up or down");
    } else {
        out.pass(subject, [measured, messages]);
    }
}
