//! CAMERA05: whether a camera looks at what the lidar sees, and is upright.

use crate::analysis::camera::in_view::{Views, cameras};
use crate::analysis::camera::looks::{Fault, Limits, ViewEstimate};
use crate::analysis::{camera::published::RecordedCamera, camera::views::Attitude};
use crate::rules::prelude::*;
use crate::world::{FrameId, World};

pub(crate) struct LidarInView;

impl Rule for LidarInView {
    const NEEDS: &'static [Need] = &[Need::Bag];
    type Limits = Limits;

    fn judge(world: &Estimates, limits: &Limits, out: &mut Judge) {
        let views = Views::of(world);
        for (key, camera) in cameras(world) {
            let subject = format!("what lidars show of `{}` in {}", key.1, world.path(camera.bag.source));
            match views.0.get(&key) {
                Some(Ok(shown)) => judge_shown(world, &camera, &key.1, shown, subject, limits, out),
                Some(Err((reason, why))) => out.not_evaluated(subject, *reason, why),
                None => {}
            }
        }
    }
}

fn judge_shown(
    world: &World,
    camera: &RecordedCamera,
    frame: &FrameId,
    shown: &ViewEstimate,
    subject: String,
    limits: &Limits,
    out: &mut Judge,
) {
    let Attitude {
        pitch_deg,
        roll_deg,
        height_m,
    } = shown.attitude;
    let measured = [
        Measured::new("share of the lidar's points in the image", shown.share, "1")
            .limit(limits.blind * shown.most)
            .samples(shown.points as u64),
        Measured::new("largest share for a level camera there", shown.most, "1"),
        Measured::new("pitch of the view over the ground", pitch_deg, "deg").samples(shown.clouds as u64),
        Measured::new("roll of the image over the ground", roll_deg, "deg").limit(limits.max_roll_deg),
        Measured::new("height over the ground", height_m, "m"),
    ];
    let fault = match &shown.judged {
        Err((reason, why)) => return out.not_evaluated(subject, *reason, why),
        Ok(None) => return out.pass(subject, measured),
        Ok(Some(fault)) => fault,
    };
    let edge = world
        .graph()
        .edges_to(frame)
        .find_map(|edge| crate::analysis::places::of_numbers(world, edge));
    let place = edge.unwrap_or_else(|| camera.place());
    let (topic, base) = (&shown.topic, &shown.base);
    let finding = match fault {
        Fault::UpsideDown => Finding::warning(
            subject,
            format!("`{frame}` is upside down over the ground on `{topic}`: its y axis points up"),
            place,
        )
        .hint()
        .relation("upside-down")
        .help("rotate the frame by 180 deg about its z, unless the camera is mounted upside down and its images are not rotated"),
        Fault::Under => Finding::error(
            subject,
            format!("`{frame}` is {:.2} m below the ground on `{topic}`", -height_m),
            place,
        )
        .likely()
        .detail(format!("The ground is below `{base}`."))
        .relation("translation-negated")
        .help("correct the sign of z, or invert the transform"),
        Fault::Mistaken(mistakes, share) => {
            let Some(first) = mistakes.first() else { return };
            let others: Vec<&str> = mistakes.iter().skip(1).map(|other| other.word()).collect();
            let others = if others.is_empty() {
                String::new()
            } else {
                format!(" Indistinguishable here: {}.", others.join(", "))
            };
            let looks = if pitch_deg.abs() > limits.max_pitch_deg {
                format!("has a pitch of {pitch_deg:+.0} deg")
            } else if roll_deg.abs() > limits.max_roll_deg {
                format!("has a roll of {roll_deg:+.0} deg")
            } else {
                "looks away from the points".to_owned()
            };
            let message = format!("`{frame}` {looks}: {}", first.text());
            let detail = format!(
                "As published, {:.1} % of the points on `{topic}` are in its image; corrected, {:.1} %, and the image is upright over the ground.{others}",
                100.0 * shown.share,
                100.0 * share
            );
            let finding = if shown.share < limits.blind * shown.most {
                Finding::error(subject, message, place)
            } else {
                Finding::warning(subject, message, place)
            };
            finding.likely().detail(detail).relation(first.word()).help(first.help())
        }
    };
    let finding = finding
        .related(camera.place(), "the camera")
        .label("transform of the frame");
    out.fail(finding.measured(measured));
}
